"""Runs that cannot go on say why; runs that only look so go on."""

from pathlib import Path

import pytest

import fmbd
from fmbd.model import load_model, load_model_text

FIVE_BAR = Path(__file__).parents[2] / "models" / "five_bar.yaml"
ARM = """
fmbd: 1
bodies: {{arm: {{type: rigid, mass: 2, inertia: 0.1, points: {{E: [1, 0]}}}}}}
joints: {{hinge: {{type: revolute, between: [ground.origin, arm.origin]{driven}}}}}
loads: {{push: {{type: force, at: arm.E, force: ["{push}", 0]}}}}
"""


def test_a_first_step_that_is_far_too_long_is_taken_back() -> None:
    """Damped fine beams are stiff: the first guess of the step overflows, which is not the mechanism's fault."""
    changes = {
        "bodies.*.elements": 8,
        "bodies.*.damping": {"modal_ratios": 0.02},
        "simulation.duration": 2e-3,
    }
    assert fmbd.simulate(load_model(FIVE_BAR, changes)).status == "complete"


def test_a_load_without_a_value() -> None:
    run = fmbd.simulate(load_model_text(ARM.format(driven="", push="sqrt(t - 0.5)")))
    assert run.status.startswith("stopped: at t = 0 s the accelerations are not numbers")


def test_a_prescribed_motion_without_a_value() -> None:
    with pytest.raises(
        fmbd.ModelError, match=r"joints\.hinge\.driven: the prescribed motion has no finite value"
    ):
        fmbd.assemble(load_model_text(ARM.format(driven=", driven: sqrt(t - 0.5)", push="1")))
