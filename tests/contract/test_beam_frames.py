"""The floating frame of a beam is a choice: clamped to its start, to its end, through both, or one for each segment.

A frame carries a straight beam, a deflection w is measured across it, and the beam's axis keeps its length in the
frame, not along the curve. Hence frames that differ by an angle of the order w / L put the beam's points at places
that differ by w^2 / L: what is linear in the deflection agrees, what is quadratic does not.
"""

from copy import deepcopy

import numpy as np
import pytest
from mechanisms import MECHANISMS, chord_frames, turned_round
from physics import assert_same, build, start, trajectory

BEAMS = {"five_bar": ["rod_right", "rod_left"], "shaper": ["rocker", "link"]}
POINTS = {
    "five_bar": ["crank_right.A", "rod_right.mid", "rod_left.mid", "crank_left.A"],
    "shaper": ["crank.tip", "rocker.slot", "rocker.mid", "link.mid", "ram.pin", "weight.center_of_mass"],
}
TIMES = np.linspace(0.0, 0.15, 4)


def mechanism(name):
    """A mechanism with named points inside its beams, moving from the start."""
    data = MECHANISMS[name]()
    for beam in BEAMS[name]:
        data["bodies"][beam].setdefault("points", {})["mid"] = f"0.4*{data['bodies'][beam]['length']}"
    data["initial"].setdefault("rates", {}).update(
        {"shoulder_right": 2, "shoulder_left": -1} if "bar" in name else {}
    )
    return data


def segments(data, beams):
    """The same data, every element of these beams with a frame of its own."""
    data = deepcopy(data)
    for beam in (data["bodies"][name] for name in beams):
        beam["segments"] = beam.get("elements") or len(beam["nodes"]) - 1
    return data


@pytest.mark.parametrize("name", MECHANISMS)
def test_a_straight_beam_has_no_preferred_frame(name):
    """At the start beams are straight and do not bend: all frames give one acceleration, to round-off."""
    data = mechanism(name)
    expected = start(build(data), POINTS[name])
    assert np.abs(expected[:, 1]).max() > 0.4
    other_end = turned_round(data, BEAMS[name])
    for other in (
        other_end,
        chord_frames(data),
        chord_frames(other_end),
        turned_round(data, BEAMS[name][:1]),
        segments(data, BEAMS[name]),
    ):
        assert_same(expected, start(build(other), POINTS[name]))


@pytest.mark.parametrize("name", MECHANISMS)
def test_a_chord_has_no_direction(name):
    """The line through both ends is the same line from either end: the beam may be written either way round."""
    data = chord_frames(mechanism(name))
    expected = trajectory(build(data), POINTS[name], TIMES)
    found = trajectory(build(turned_round(data, BEAMS[name])), POINTS[name], TIMES)
    assert_same(expected, found)


def gentle_push(size):
    """The five-bar at rest without gravity, its motors idle, its end-effector pushed."""
    data = mechanism("five_bar")
    del data["motors"], data["controllers"], data["initial"]["rates"]
    data["gravity"] = [0, 0]
    data["loads"] = {"push": {"type": "force", "at": "rod_right.end", "force": [0.3 * size, -size]}}
    return data


@pytest.mark.parametrize("other", [chord_frames, lambda data: turned_round(data, BEAMS["five_bar"])])
def test_frames_differ_by_the_square_of_the_deflection(other):
    """Half the push: half the motion, a quarter of what the frames differ by."""

    def end(data):
        return trajectory(build(data), ["rod_left.mid", "crank_left.A"], TIMES)[:, 0]

    def turned(data):
        data = other(data)
        data["loads"]["push"]["at"] = data["joints"]["effector"]["between"][0]
        return data

    moved, differences = [], []
    for size in (1.0, 0.5):
        path = end(gentle_push(size))
        moved.append(np.abs(path - path[0]).max())
        differences.append(np.abs(end(turned(gentle_push(size))) - path).max())
    assert moved[0] / moved[1] == pytest.approx(2, rel=0.01)
    assert differences[0] / differences[1] == pytest.approx(4, rel=0.02)
    assert 1e-9 < differences[0] < 1e-2 * moved[0]


def test_cantilever_tip_on_a_line_or_on_a_circle():
    """Clamped, the tip of a cantilever stays at x = L; on the chord it stays at the distance L from the root.

    By symmetry the deflections differ by the cube of the load.
    """
    tips = {}
    for size in (1.0, 0.5):
        for frame in ("clamped", "chord"):
            system = build(f"""
                fmbd: 1
                bodies: {{arm: {{type: beam, length: 2, elements: 2, mass_per_length: 1, bending_stiffness: 100,
                                 frame: {frame}}}}}
                joints: {{root: {{type: weld, between: [ground.origin, arm.start]}}}}
                loads: {{push: {{type: force, at: arm.end, force: [0, {5 * size}]}}}}
                simulation: {{rtol: 1e-12, atol: 1e-14}}
            """)
            tips[size, frame] = trajectory(system, ["arm.end"], np.linspace(0, 0.4, 9))[1:, 0, 0]
        assert tips[size, "clamped"][:, 0] == pytest.approx(2, abs=1e-14)
        assert np.hypot(*tips[size, "chord"].T) == pytest.approx(2, abs=1e-12)
    assert np.abs(tips[1.0, "clamped"][:, 1]).max() > 0.05
    full, half = (np.abs(tips[s, "chord"] - tips[s, "clamped"]).max(axis=0) for s in (1.0, 0.5))
    assert full / half == pytest.approx([4, 8], rel=0.02)
