"""What lowering a model collects: names, tables and pathways, from which the arrays are then filled."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fmbd.beams import FloatingBeam, Foreshortening
from fmbd.beams.truncation import Truncation
from fmbd.model import Model
from fmbd.planar.arrays import ALONG_X, ALONG_Y, ANGLE, Planar
from fmbd.system.segments import Segmentation
from fmbd.system.signals import SignalTable
from fmbd.system.springs import SpringTable
from fmbd.system.tree import Link, Tree

Term = tuple[int, tuple[str, str], tuple[str, str], tuple[float, float], float]


@dataclass
class Lowered:
    """Names and tables collected on the way; `planar` is complete when `lower` returns.

    `whole` is the tree of the model as written, in which every beam is one body.
    """

    segmentation: Segmentation
    tree: Tree
    whole: Tree
    signals: SignalTable = field(default_factory=SignalTable)
    body_index: dict[str, int] = field(default_factory=dict)
    beams: dict[int, FloatingBeam] = field(default_factory=dict)
    first_elastic: dict[int, int] = field(default_factory=dict)  # the first coordinate of each beam
    truncations: dict[str, Truncation] = field(default_factory=dict)  # by beam
    psi: dict[int, np.ndarray] = field(default_factory=dict)
    omega2: dict[int, np.ndarray] = field(default_factory=dict)
    shortenings: dict[int, Foreshortening] = field(default_factory=dict)  # of the beams that shorten
    modal_damping: dict[int, np.ndarray] = field(default_factory=dict)
    coordinates: list[tuple[str, str]] = field(default_factory=list)
    constraints: list[tuple[str, str]] = field(default_factory=list)
    states: list[tuple[str, str]] = field(default_factory=list)
    stations: dict[tuple[str, str], int] = field(default_factory=dict)
    turning: set[tuple[str, str]] = field(default_factory=set)  # stations whose angle matters
    pathways: dict[Any, int] = field(default_factory=dict)
    terms: list[list[Term]] = field(default_factory=list)
    springs: SpringTable = field(default_factory=SpringTable)
    rest_at_start: list[int] = field(default_factory=list)
    rest_nearby: list[int] = field(default_factory=list)  # springs to start within half a turn of rest
    cut_angles: list[tuple[int, str]] = field(
        default_factory=list
    )  # pathways that follow a cut joint's angle
    turns: dict[str, float] = field(default_factory=dict)  # what the angle of a cut joint is counted from
    relaxed: list[int] = field(default_factory=list)  # pathways that are zero at the start
    planar: Planar = None  # type: ignore[assignment]

    @property
    def model(self) -> Model:
        """The model that is lowered: its beams are cut into segments."""
        return self.segmentation.model

    def outer_point(self, link: Link) -> tuple[str, str]:
        """Body and point of the parent's side of the joint that carries a body."""
        joint = self.model.joints[link.joint or self.model.motors[str(link.motor)].joint]
        ref = joint.between[0 if link.forward else 1]
        return ref.body, ref.point

    def inner_point(self, link: Link) -> tuple[str, str]:
        """Body and point of the carried side; a rotor turns about its own origin."""
        if link.joint is None:
            return link.name, "axis"
        ref = self.model.joints[link.joint].between[1 if link.forward else 0]
        return ref.body, ref.point

    def station(self, body: str, point: str) -> tuple[str, str]:
        """Ask for a station; its index is known once all are collected."""
        self.stations.setdefault((body, point), -1)
        return body, point

    def pathway(self, terms: list[Term]) -> int:
        """Index of the pathway that is the sum of these terms."""
        key = tuple(terms)
        if key not in self.pathways:
            self.pathways[key] = self.own_pathway(terms)
        return self.pathways[key]

    def own_pathway(self, terms: list[Term]) -> int:
        """As `pathway`, but shared with none: the terms of a constraint know its column."""
        self.terms.append(terms)
        for kind, a, b, _, _ in terms:
            if kind == ANGLE:
                self.turning |= {a, b}
            elif kind in (ALONG_X, ALONG_Y):
                self.turning.add(a)
        return len(self.terms) - 1

    def joint_pathway(self, name: str, direction: str, coefficient: float = 1.0) -> int:
        """Index of the pathway that is a joint's coordinate times a number."""
        path = self.pathway([self.joint_term(name, direction, coefficient)])
        if name in self.tree.cut and direction == "angle":
            self.cut_angles.append((path, name))
        return path

    def joint_term(self, name: str, direction: str, coefficient: float = 1.0) -> Term:
        """A joint's coordinate: the second point seen from the first."""
        joint = self.model.joints[name]
        kind = {"x": ALONG_X, "y": ALONG_Y, "angle": ANGLE}[direction]
        a, b = (self.station(ref.body, ref.point) for ref in joint.between)
        return kind, a, b, joint.axis if kind != ANGLE else (1.0, 0.0), coefficient

    def place_point(self, name: str) -> tuple[str, str]:
        """Body and point that a `place` entry names: a joint (its first point) or body.point."""
        if name in self.model.joints:
            ref = self.model.joints[name].between[0]
            return ref.body, ref.point
        body, point = name.split(".")
        return self.segmentation.place(body, point)
