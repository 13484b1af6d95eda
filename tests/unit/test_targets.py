"""Set points of controllers: places that joints are to reach, beside joints that follow a motion, and gravity."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fmbd.errors import ModelError
from fmbd.model import load_model_text
from fmbd.system import System, assemble

ARMS = """
fmbd: 1
gravity: [0, -9.81]
ground: {{points: {{B: [5, 0]}}}}
bodies:
  reacher: {{type: rigid, mass: 2, inertia: 0.1, center_of_mass: [0.5, 0], points: {{hand: [0.8, 0]}}}}
  waver: {{type: rigid, mass: 1, inertia: 0.1, points: {{hand: [1, 0]}}}}
joints:
  left: {{type: revolute, between: [ground.origin, reacher.origin]}}
  right: {{type: revolute, between: [ground.B, waver.origin]}}
motors:
  reach: {{type: torque, joint: left, torque: reaching}}
  wave: {{type: torque, joint: right, torque: waving}}
controllers:
  reaching: {{type: pd, kp: 10, target: {{place: {{reacher.hand: ["0.8*cos(0.7)", "0.8*sin(0.7)"]}}}}{compensating}}}
  waving: {{type: pd, kp: 4, target: "0.3 + sin(t)"}}
initial: {{joints: {{left: 0.2}}}}
"""


def arms(feedforward: str = "") -> System:
    compensating = f", feedforward: {feedforward}" if feedforward else ""
    return assemble(load_model_text(ARMS.format(compensating=compensating)))


def test_a_place_beside_a_target_that_varies():
    """Torques kp (target - angle) at the start: the hand is at its place when the left arm is at 0.7 rad."""
    assert_allclose(arms().matrices().u, [10 * (0.7 - 0.2), 4 * 0.3], rtol=1e-12)


def test_compensation_at_a_target_that_varies():
    """One arm asks for gravity compensation at the target, which the other arm's target leaves open."""
    with pytest.raises(
        ModelError,
        match=r"controllers\.reaching\.feedforward: gravity compensation at the target needs constant targets, "
        r"that of motor wave varies; write \{type: gravity_compensation, computed: online\}",
    ):
        arms("gravity_compensation")


def test_compensation_online_beside_a_target_that_varies():
    """m g s cos(0.2) holds the left arm where it is, the right one has its centre of mass on its axis."""
    u = arms("{type: gravity_compensation, computed: online}").matrices().u
    assert_allclose(u, [10 * (0.7 - 0.2) + 2 * 9.81 * 0.5 * np.cos(0.2), 4 * 0.3], rtol=1e-12)
