"""Every method against what it promises, and against the others.

Orders are measured with steps of one length (a tolerance that never binds) against dop853 at 1e-13.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from simulation import CASES, STIFF, by_dop853, rods, simulate

import fmbd
from fmbd.model import load_model_text

# order of each method in the state at the end; the project's documentation gives the same
ORDERS = {"dop853": 8, "rk45": 5, "rodas5p": 5}


def final_state(name, changes):
    run = simulate(name, {"simulation.output_interval": changes["simulation.duration"]} | changes)
    return np.concatenate([run.position[-1], run.velocity[-1]])


def measured_order(name, method, duration, steps, changes):
    """Slope of log error over log step."""
    base = {"simulation.duration": duration} | changes
    exact = final_state(name, base | by_dop853())
    errors = []
    for count in steps:
        fixed = {
            "simulation.method": method,
            "simulation.max_step": duration / count,
            "simulation.rtol": 1e3,
            "simulation.atol": 1e3,
        }
        errors.append(np.abs(final_state(name, base | fixed) - exact).max())
    return np.polyfit(np.log(1.0 / np.array(steps)), np.log(errors), 1)[0]


@pytest.mark.parametrize("method, order", ORDERS.items())
def test_order_on_the_pendulum(method, order):
    steps = (24, 36, 50) if order > 6 else (40, 60, 90)
    assert measured_order("pendulum.yaml", method, 1.5, steps, {}) > order - 0.3


@pytest.mark.parametrize("method, order", ORDERS.items())
def test_order_on_the_five_bar(method, order):
    """With loops closed, motors, controllers and beams; its fastest vibration takes 2 ms."""
    duration, steps = (0.02, (27, 40, 60)) if order > 6 else (0.1, (200, 280, 400))
    assert measured_order("five_bar.yaml", method, duration, steps, {}) > order - 0.3


def test_order_with_inputs_that_vary():
    """The time derivative of the equations counts in a linearly implicit method."""
    push = {
        "type": "force",
        "at": "rod_right.end",
        "force": ["5*sin(40*t)", "cos(60*t)**2"],
        "frame": "fixed",
    }
    changes = {"loads": {"push": push}}
    assert measured_order("five_bar.yaml", "rodas5p", 0.1, (200, 280, 400), changes) > 4.7


AGREE = {"rodas5p": 1e-11}


@pytest.mark.parametrize("method, rtol", AGREE.items())
def test_five_bar_agrees_with_dop853(method, rtol):
    """Case B of the paper, all coordinates and the forces in the closing joint, at ten times."""
    changes = {"simulation.duration": 1, "simulation.output_interval": 0.1}
    one = simulate("five_bar.yaml", changes | by_dop853())
    other = simulate("five_bar.yaml", changes | {"simulation.method": method, "simulation.rtol": rtol})
    assert_allclose(other.position, one.position, rtol=0, atol=1e-8)
    assert_allclose(other.multipliers, one.multipliers, rtol=0, atol=1e-6)


@pytest.mark.parametrize("method, rtol", AGREE.items())
@pytest.mark.parametrize("model, end, tolerance", CASES)
def test_published_cases_agree_with_dop853(method, rtol, model, end, tolerance):
    changes = {"simulation.duration": end, "simulation.output_interval": end}
    one = simulate(model, changes | by_dop853())
    other = simulate(model, changes | {"simulation.method": method, "simulation.rtol": rtol})
    assert_allclose(other.position[-1], one.position[-1], rtol=0, atol=tolerance)


def test_damped_beams_cost_an_implicit_method_no_more_steps_as_they_are_refined():
    steps = []
    for n in (4, 32):
        changes = {"simulation.method": "rodas5p", "simulation.duration": 0.5, "simulation.rtol": 1e-5}
        steps.append(simulate("five_bar.yaml", changes | STIFF | rods(n)).statistics["steps"])
    assert steps[1] < 1.3 * steps[0]


def test_a_stiff_run_balances_its_energy_and_keeps_its_loop_closed():
    changes = {"simulation.method": "rodas5p", "simulation.duration": 0.5, "simulation.rtol": 1e-8}
    run = simulate("five_bar.yaml", changes | STIFF | rods(8))
    assert np.abs(run["energy.balance"]).max() < 1e-6
    assert run["constraint_error"].max() < 1e-9


def test_the_free_fall_of_the_undamped_five_bar_keeps_its_energy():
    """Motors off, transmissions undamped, ten seconds through near-singular positions; against the kinetic energy."""
    motor = {
        "type": "torque",
        "torque": 0,
        "gear_ratio": 10,
        "rotor_inertia": 0.1,
        "transmission": {"stiffness": 5000},
    }
    run = simulate(
        "five_bar.yaml",
        {
            "motors": {f"motor_{side}": motor | {"joint": f"shoulder_{side}"} for side in ("right", "left")},
            "controllers": {},
            "simulation.duration": 10,
            "simulation.output_interval": 0.01,
            "simulation.rtol": 1e-9,
        },
    )
    energy = run["energy.kinetic"] + run["energy.potential"] + run["energy.elastic"]
    assert np.abs(energy - energy[0]).max() < 1e-8 * run["energy.kinetic"].max()


def test_a_frame_through_both_ends_takes_no_more_steps():
    """Fine damped rods that are held by a row of their own, the slope at the elbow: as many steps as clamped ones."""
    changes = {"simulation.duration": 0.5, "simulation.method": "rodas5p"} | STIFF | rods(16)
    frames = {f"bodies.rod_{side}.frame": "chord" for side in ("right", "left")}
    steps = [simulate("five_bar.yaml", changes | more).statistics["steps"] for more in ({}, frames)]
    assert steps[1] < 1.2 * steps[0]


def test_auto_takes_the_implicit_method_for_fine_damped_beams_and_only_there():
    changes = {"simulation.method": "auto", "simulation.duration": 0.5}
    assert "radau for" in simulate("five_bar.yaml", changes | STIFF | rods(16)).statistics["choice"]
    assert simulate("five_bar.yaml", changes).statistics["choice"] == "dop853"


def test_auto_agrees_with_its_methods_across_the_switch():
    changes = {"simulation.duration": 0.4, "simulation.rtol": 1e-7} | STIFF | rods(10)
    one = simulate("five_bar.yaml", changes | {"simulation.method": "dop853"})
    other = simulate("five_bar.yaml", changes | {"simulation.method": "auto"})
    assert "radau" in other.statistics["choice"]
    assert_allclose(other.position, one.position, rtol=0, atol=2e-6)


def test_auto_writes_every_output_as_its_methods_would():
    """Blocks of outputs end inside steps, some of them inside trials that are then taken back."""
    changes = {
        "simulation.duration": 0.6,
        "simulation.output_interval": 2e-5,
        "simulation.rtol": 1e-6,
    } | rods(8)
    one = simulate("five_bar.yaml", changes | {"simulation.method": "dop853", "simulation.rtol": 1e-9})
    other = simulate("five_bar.yaml", changes | {"simulation.method": "auto"})
    assert_allclose(other.position, one.position, rtol=0, atol=2e-6)


INCONSISTENT = """
fmbd: 1
ground: {points: {B: [1, 0]}}
bodies:
  crank: {type: rigid, mass: 1, inertia: 0.1, points: {tip: [0.4, 0]}}
  coupler: {type: rigid, mass: 1, inertia: 0.1, points: {tip: [1, 0]}}
  rocker: {type: rigid, mass: 1, inertia: 0.1, points: {tip: [0.7, 0]}}
joints:
  a: {type: revolute, between: [ground.origin, crank.origin]}
  b: {type: revolute, between: [crank.tip, coupler.origin]}
  c: {type: revolute, between: [ground.B, rocker.origin]}
  d: {type: revolute, between: [coupler.tip, rocker.tip], cut: true}
initial: {joints: {a: 1, b: -0.6, c: 1.3}, rates: {a: 2}, consistent: false}
simulation: {rtol: 1e-9}
"""


@pytest.mark.parametrize("method", ["dop853", "rodas5p"])
def test_an_inconsistent_start_is_moved_at_once_whatever_the_first_step(method):
    ends = []
    for longest in (1e-3, 1e-1):
        changes = {"simulation.method": method, "simulation.max_step": longest}
        ends.append(fmbd.simulate(load_model_text(INCONSISTENT, overrides=changes)).position[-1])
    assert_allclose(ends[1], ends[0], rtol=0, atol=1e-7)


def test_auto_goes_on_where_its_trial_cannot():
    """Implicit methods may stop at the flat positions of the four-bars, the first at 0.714 s; dop853 steps over it."""
    changes = {"simulation.method": "auto", "simulation.rtol": 1e-5, "simulation.max_step": 0.005}
    run = simulate("four_bars.yaml", changes | {"simulation.duration": 60})
    assert run.time[-1] > 0.8
