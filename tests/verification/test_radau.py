"""Radau IIA: its coefficients, its orders, agreement with dop853, stiff beams, energy.

Orders are slopes of the error at the end over the number of steps, from runs at several tolerances.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from simulation import CASES, STIFF, by_dop853, rods, simulate

from fmbd.solvers.radau import radau

STAGES = (3, 5)


def by_radau(stages, rtol):
    return {"simulation.method": "radau", "simulation.radau.stages": stages, "simulation.rtol": rtol}


def test_three_stages_have_the_published_coefficients():
    """Hairer and Wanner, Solving Ordinary Differential Equations II, table IV.5.6, and the estimate (IV.8.19)."""
    r = np.sqrt(6)
    A = [
        [(88 - 7 * r) / 360, (296 - 169 * r) / 1800, (-2 + 3 * r) / 225],
        [(296 + 169 * r) / 1800, (88 + 7 * r) / 360, (-2 - 3 * r) / 225],
        [(16 - r) / 36, (16 + r) / 36, 1 / 9],
    ]
    method = radau(3)
    assert_allclose(method.c, [(4 - r) / 10, (4 + r) / 10, 1], rtol=0, atol=1e-15)
    assert_allclose(method.A, A, rtol=0, atol=1e-15)
    assert_allclose(method.error, [-(13 + 7 * r) / 3, (-13 + 7 * r) / 3, -1 / 3], rtol=1e-14)


@pytest.mark.parametrize("stages", STAGES)
def test_coefficients_satisfy_the_order_conditions(stages):
    """Quadrature of order 2 s - 1, collocation of order s; the eigenvectors give A^-1 back."""
    method = radau(stages)
    for k in range(1, 2 * stages):
        assert_allclose(method.A[-1] @ method.c ** (k - 1), 1 / k, rtol=1e-14)
    for k in range(1, stages + 1):
        assert_allclose(method.A @ method.c ** (k - 1), method.c**k / k, rtol=0, atol=1e-15)
    inverse = method.mu * np.outer(method.right, method.left)
    for mu, right, left in zip(method.mus, method.rights, method.lefts):
        inverse = inverse + (mu * np.outer(right, left)).real
    assert_allclose(inverse @ method.A, np.eye(stages), rtol=0, atol=1e-13)


def final_state(run):
    assert run.status == "complete"
    return np.concatenate([run.position[-1], run.velocity[-1]])


def measured_order(name, duration, stages, tolerances):
    """Slope of log error over log step."""
    ends = {"simulation.duration": duration, "simulation.output_interval": duration}
    exact = final_state(simulate(name, ends | by_dop853()))
    steps, errors = [], []
    for rtol in tolerances:
        run = simulate(name, ends | by_radau(stages, rtol))
        steps.append(run.statistics["steps"])
        errors.append(np.abs(final_state(run) - exact).max())
    return -np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize("stages", STAGES)
def test_order_on_the_pendulum(stages):
    tolerances = 10.0 ** -np.arange(6, 11)
    assert measured_order("pendulum.yaml", 1.5, stages, tolerances) > 2 * stages - 1.3


@pytest.mark.parametrize("stages", STAGES)
def test_order_on_the_five_bar(stages):
    """With loops closed, motors, controllers and beams; its fastest vibration takes 2 ms."""
    tolerances = 10.0 ** -np.arange(6, 11)
    assert measured_order("five_bar.yaml", 0.1, stages, tolerances) > 2 * stages - 1.3


@pytest.mark.parametrize("stages", STAGES)
def test_five_bar_agrees_with_dop853(stages):
    """Case B of the paper, all coordinates and the forces in the closing joint, at ten times.

    Between steps the collocation polynomial is only of order s, so that the step control keeps it good enough.
    """
    changes = {"simulation.duration": 1, "simulation.output_interval": 0.1}
    one = simulate("five_bar.yaml", changes | by_dop853())
    other = simulate("five_bar.yaml", changes | by_radau(stages, 1e-12))
    assert_allclose(other.position, one.position, rtol=0, atol=1e-8)
    assert_allclose(other.multipliers, one.multipliers, rtol=0, atol=1e-5)
    assert np.abs(other["energy.balance"]).max() < 1e-9


@pytest.mark.parametrize("stages", STAGES)
@pytest.mark.parametrize("model, end, tolerance", CASES)
def test_published_cases_agree_with_dop853(stages, model, end, tolerance):
    changes = {"simulation.duration": end, "simulation.output_interval": end}
    one = simulate(model, changes | by_dop853())
    other = simulate(model, changes | by_radau(stages, 1e-11))
    assert_allclose(other.position[-1], one.position[-1], rtol=0, atol=tolerance)


@pytest.mark.parametrize("stages", STAGES)
def test_damped_beams_cost_no_more_steps_as_they_are_refined(stages):
    """Their fastest vibrations are far shorter than a step; energy and loops keep to the tolerance all the same."""
    steps = []
    for n in (4, 32):
        run = simulate(
            "five_bar.yaml", {"simulation.duration": 0.5} | by_radau(stages, 1e-8) | STIFF | rods(n)
        )
        assert np.abs(run["energy.balance"]).max() < 1e-7
        assert run["constraint_error"].max() < 1e-9
        steps.append(run.statistics["steps"] + run.statistics["rejected_steps"])
    assert steps[1] < 1.5 * steps[0]


def test_a_tangent_that_misses_gravity_compensation_costs_no_accuracy():
    """Newton's method does not need it; compare a linearly implicit method, whose order would suffer."""
    online = {"type": "gravity_compensation", "computed": "online"}
    changes = {"simulation.duration": 0.1, "simulation.output_interval": 0.1}
    changes["controllers.position_control.feedforward"] = online
    one = simulate("five_bar.yaml", changes | by_dop853())
    other = simulate("five_bar.yaml", changes | by_radau(5, 1e-11))
    assert_allclose(other.position[-1], one.position[-1], rtol=0, atol=1e-9)
