"""A joint is one thing, whether it carries a body, is gone through backwards, or closes a loop.

Two bodies each float above the ground on springs; the joint under test joins them. Whichever of the three joints is
cut, the mechanism is the same: the joint carries body b, carries body a against its direction, or becomes a constraint.
"""

from itertools import chain, combinations
from typing import Any, get_args

import numpy as np
import pytest
import yaml
from mechanisms import cut_at
from numpy.testing import assert_allclose
from physics import assert_same, build, run, start, trajectory

from fmbd.model.joints import FREE_COORDINATES, Joint

POINTS = ["a.origin", "a.tip", "b.origin", "b.far"]
TIMES = np.linspace(0.0, 0.3, 4)
#: The start of each coordinate, its rate there, and a motion that has both; the angle is more than half a turn.
START = {"x": (0.11, 0.4), "y": (-0.07, -0.3), "angle": (3.9, 1.2)}
DRIVEN = {"x": "0.11 + 0.1*sin(4*t)", "y": "-0.07 - 0.3*t + 0.2*t**3", "angle": "3.9 + 0.6*sin(2*t)"}
STOP = {"stiffness": 20, "damping": 0.5, "transition": 0.02}

MODEL = """
fmbd: 1
gravity: [0.3, -2]
ground: {points: {A: [-0.3, 0.1], B: {at: [0.2, 0], angle: 0.3}}}
joints:
  float_a: {type: free, between: [ground.A, a.origin],
            spring: {x: {stiffness: 9}, y: {stiffness: 8, damping: 0.1}, angle: {stiffness: 2, rest: 0.3}}}
  float_b: {type: free, between: [b.origin, ground.B], friction: {angle: 0.1}}
initial:
  joints: {float_a: {x: 0.02, y: 0.03, angle: 0.2}}
  rates: {float_a: {x: 0.5, y: -0.2, angle: 0.8}}
simulation: {rtol: 1e-13, atol: 1e-14}
"""
RIGID = """
  a: {type: rigid, mass: 1.2, inertia: 0.05, center_of_mass: [0.1, 0.02],
      points: {tip: {at: [0.3, 0.1], angle: 0.7}}}
  b: {type: rigid, mass: 0.7, inertia: 0.02, center_of_mass: [-0.05, 0.1],
      points: {pin: {at: [0.05, -0.1], angle: -0.4}, far: [0.2, 0.1]}}
"""
BEAMS = """
  a: {type: beam, length: 0.5, elements: 2, mass_per_length: 2, bending_stiffness: 3, points: {origin: 0.1, tip: 0.4},
      point_masses: {end: 0.3}}
  b: {type: beam, length: 0.4, elements: 1, frame: chord, mass_per_length: 2, bending_stiffness: 2,
      points: {origin: 0.1, pin: 0.15, far: 0.4}}
"""


def model(bodies: str, kind: str, driven: tuple[str, ...], cut: str) -> dict[str, Any]:
    free = [c for c in FREE_COORDINATES[kind] if c not in driven]
    data: dict[str, Any] = yaml.safe_load(MODEL)
    data["bodies"] = yaml.safe_load(bodies)
    joint = data["joints"]["joint"] = {"type": kind, "between": ["a.tip", "b.pin"], "axis": [1, 0.4]}
    if free:
        joint["spring"] = {c: {"stiffness": 6, "damping": 0.2, "rest": 0.05} for c in free}
        joint["friction"] = {c: {"viscous": 0.1, "coulomb": 0.02, "transition_speed": 0.1} for c in free}
        joint["limits"] = {c: {"lower": START[c][0] - 0.02, "upper": START[c][0] + 0.02} | STOP for c in free}
        data["initial"]["joints"]["joint"] = {c: START[c][0] for c in free}
        data["initial"]["rates"]["joint"] = {c: START[c][1] for c in free}
    if driven:
        joint["driven"] = {c: DRIVEN[c] for c in driven}
    return cut_at(data, [cut])


def options() -> list[tuple[str, tuple[str, ...]]]:
    """Every type of joint with every choice of driven coordinates."""
    found = []
    for kind in get_args(Joint.model_fields["type"].annotation):
        free = FREE_COORDINATES[kind]
        found += [
            (kind, some) for some in chain.from_iterable(combinations(free, n) for n in range(len(free) + 1))
        ]
    return found


def cases() -> list[Any]:
    """All options with rigid bodies; with beams none or all of the coordinates driven."""
    some = [(kind, driven) for kind, driven in options() if driven in ((), FREE_COORDINATES[kind])]
    return [(RIGID, *option) for option in options()] + [(BEAMS, *option) for option in some]


@pytest.mark.parametrize(("bodies", "kind", "driven"), cases())
def test_a_joint_is_the_same_in_the_tree_and_cut(bodies, kind, driven):
    """Accelerations at the start, and a run: forwards, backwards and as a constraint."""
    systems = {cut: build(model(bodies, kind, driven, cut)) for cut in ("float_b", "float_a", "joint")}
    for cut, system in systems.items():
        assert system.tree.cut == (cut,)
    at_start = {cut: start(system, POINTS) for cut, system in systems.items()}
    later = {cut: trajectory(system, POINTS, TIMES) for cut, system in systems.items()}
    assert np.ptp(later["float_b"][:, 0], axis=0).max() > 0.01
    for cut in ("float_a", "joint"):
        assert_same(at_start["float_b"], at_start[cut])
        assert_same(later["float_b"], later[cut])


@pytest.mark.parametrize(("kind", "driven"), options())
def test_a_cut_joint_holds(kind, driven):
    """Its constraints are met by positions, rates and accelerations, along a run; it has as many as it should."""
    system = build(model(RIGID, kind, driven, "joint"))
    assert len(system.constraints) == 3 - len(FREE_COORDINATES[kind]) + len(driven)
    if not system.constraints:
        return
    block = run(system, TIMES)
    assert block.constraint_error.max() < 1e-11
    assert np.abs(block.energy["balance"]).max() < 1e-9
    for q, v, a, t in zip(block.position, block.velocity, block.acceleration, block.time):
        equations = system.matrices(q, v, t)
        assert_allclose(
            equations.Phi_q @ a, equations.gamma, atol=1e-10 * np.abs(equations.Phi_q).max() * np.abs(a).max()
        )
