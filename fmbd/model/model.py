"""The validated model."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fmbd.errors import ModelError
from fmbd.model.beam import Beam
from fmbd.model.controllers import Controller
from fmbd.model.document import Document
from fmbd.model.initial import Initial
from fmbd.model.joints import Joint
from fmbd.model.loads import Load
from fmbd.model.materials import Material
from fmbd.model.motors import Motor
from fmbd.model.points import Ground
from fmbd.model.rigid import RigidBody
from fmbd.model.sections import Section
from fmbd.model.signals import Signal
from fmbd.model.simulation import Simulation
from fmbd.model.springs import Spring


@dataclass(frozen=True, kw_only=True)
class Model:
    """A planar mechanism as its file describes it, all names resolved, all numbers in SI units.

    Parts are in dictionaries by name, in file order. `text` is the YAML source, `path` its file (None for a
    text), `overrides` what was changed since, by path. Changed copies come from `with_`. `files`
    holds the text of the tables that the model names, by name, as they were when the model was first read.
    """

    fmbd: int
    name: str
    description: str | None
    parameters: dict[str, float]
    gravity: tuple[float, float]
    materials: dict[str, Material]
    sections: dict[str, Section]
    ground: Ground
    bodies: dict[str, RigidBody | Beam]
    joints: dict[str, Joint]
    springs: dict[str, Spring]
    loads: dict[str, Load]
    controllers: dict[str, Controller]
    motors: dict[str, Motor]
    signals: dict[str, Signal]
    initial: Initial
    simulation: Simulation
    text: str = field(repr=False)
    path: Path | None
    overrides: Mapping[str, Any]
    document: Document = field(repr=False, compare=False)
    files: Mapping[str, str] = field(repr=False)

    def with_(self, path: str, value: object) -> "Model":
        """A copy in which the value at `path` is another; raises ModelError.

        `bodies.rod.elements`, `parameters.l1`, `gravity.1`; `*` stands for every part that can have the key:
        `bodies.*.elements`. A string is read as YAML. `elements` replaces a beam's `nodes` and vice versa.
        """
        from fmbd.model.loader import load_model_text  # the loader makes models

        kept = {key: old for key, old in self.overrides.items() if key != path}
        return load_model_text(self.text, self.path, kept | {path: value}, self.files)

    def yaml(self) -> str:
        """The model as YAML text with its overrides applied; `text` itself when there are none."""
        from fmbd.model.writing import yaml_text

        return yaml_text(self.document.data) if self.overrides else self.text

    def locate(self, path: tuple[str | int, ...]) -> str:
        """Where a value stands, `file:line:column`."""
        return self.document.locate(path)

    def error(self, path: tuple[str | int, ...], message: str) -> ModelError:
        """The error of a model that is well written but cannot be built."""
        return ModelError([self.document.problem(path, message)])
