"""Where a beam's floating frame sits, and from which end the beam is written, is a choice: it changes the model to
second order in the deflection only.

A linear beam has its deflection w across its frame's x axis and no displacement along it. Two frames that differ by
the beam's own deflection, of order w / L, differ in what "across" and "along" mean by w^2 / L. So when the load is
halved, the deflection is halved, but the difference between two frames becomes a quarter.
"""

import numpy as np
import pytest

import fmbd
from fmbd.model import load_model_text

LOAD = 4.0
MODEL = """
fmbd: 1
bodies:
  arm: {{type: rigid, mass: 1, inertia: 0.05, points: {{A: [0.2, 0]}}}}
  rod: {{type: beam, length: 0.6, elements: 4, mass_per_length: 0.4, bending_stiffness: 3, frame: {frame},
        points: {{inside: 0.45}}, point_masses: {{{tip}: 0.1}}, damping: {{modal_ratios: 0.02}}}}
joints:
  hinge: {{type: revolute, between: [ground.origin, arm.origin], spring: {{stiffness: 8}}}}
  elbow: {{type: weld, between: [{held}]}}
loads: {{blow: {{type: force, at: rod.{tip}, force: [0, {load}]}}}}
simulation: {{duration: 0.2, output_interval: 0.02, rtol: 1e-11, atol: 1e-13}}
"""
# a beam written from its far end points backwards: half a turn between the two points of the weld
FORWARD = {"held": "arm.A, rod.start", "tip": "end"}


def tip_path(load: float, frame: str, backwards: bool = False) -> np.ndarray:
    """Position of the free end of the rod over time, (nt, 2)."""
    text = MODEL.format(load=load, frame=frame, **FORWARD)
    if backwards:
        text = MODEL.format(load=load, frame=frame, held="arm.A, rod.end", tip="start")
        text = text.replace("A: [0.2, 0]", "A: {at: [0.2, 0], angle: pi}").replace(
            "inside: 0.45", "inside: 0.15"
        )
    run = fmbd.simulate(load_model_text(text))
    return run["rod.start.position" if backwards else "rod.end.position"]


@pytest.mark.parametrize(
    ("frame", "backwards"), [("chord", False), ("clamped", True), ("chord", True)], ids=str
)
def test_frames_differ_to_second_order(frame: str, backwards: bool) -> None:
    """Against the frame clamped at the held end: a quarter of the difference at half the load."""
    differences, deflections = [], []
    for load in (LOAD, LOAD / 2):
        expected, found = tip_path(load, "clamped"), tip_path(load, frame, backwards)
        differences.append(np.abs(found - expected).max())
        deflections.append(np.ptp(expected[:, 1]))
    assert deflections[0] / deflections[1] == pytest.approx(2, rel=0.05)
    assert differences[0] / differences[1] == pytest.approx(4, rel=0.15)
    assert differences[1] < 0.5 * deflections[1] ** 2 / 0.6
