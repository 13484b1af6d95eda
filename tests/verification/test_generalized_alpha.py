"""Generalised-alpha: order, damping, energy and agreement with dop853, in both formulations.

What Arnold and Bruls prove (Multibody System Dynamics 18, 2007): order 2 in places, velocities and multipliers, at
index 3 for every spectral radius below 1. Stabilised, 1 is allowed, too.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from simulation import STIFF, by_dop853, load, rods, simulate

from fmbd.errors import ModelError

VARIANTS = [("stabilised", 0.8), ("stabilised", 1.0), ("index3", 0.8)]
# absolute coordinates, two reactions as multipliers
CUT_PENDULUM = {
    "bodies.bob.inertia": 0.1,
    "joints": {
        "pivot": {"type": "revolute", "between": ["ground.origin", "bob.origin"], "cut": True},
        "free": {"type": "free", "between": ["ground.origin", "bob.origin"]},
    },
    "initial": {"joints": {"free": {"angle": "-pi/2"}}},
}
# five bars that hang and swing: motors off, nothing damps
FREE = {
    "motors": {},
    "controllers": {},
    "initial": {
        "place": {"effector": [0.1, -0.6]},
        "hints": {"shoulder_right": -1, "elbow_right": -1.6, "shoulder_left": -1.7, "elbow_left": 1.3},
    },
}


def generalized_alpha(formulation="stabilised", radius=0.8, step=None):
    options = {"formulation": formulation, "spectral_radius": radius, "step": step}
    return {"simulation.method": "generalized_alpha", "simulation.generalized_alpha": options}


def deviations(run, exact):
    """Largest errors of coordinates, rates, multipliers and first-order states over a run."""
    kinds = ("position", "velocity", "multipliers", "states")
    both = [(getattr(run, kind), getattr(exact, kind)) for kind in kinds]
    return np.array([np.abs(one - other).max() for one, other in both if one.size])


@pytest.mark.parametrize("formulation, radius", [*VARIANTS, ("stabilised", 0.0)])
@pytest.mark.parametrize(
    "model, duration, steps, changes",
    [
        ("pendulum.yaml", 1.5, 200, CUT_PENDULUM),
        ("five_bar.yaml", 0.05, 1600, {}),
        ("verification/andrews.yaml", 0.03, 4000, {}),
        ("dc_motor.yaml", 2, 2000, {}),
    ],
    ids=["pendulum", "five_bar", "andrews", "dc_motor"],
)
def test_order_two_in_places_rates_multipliers_and_currents(
    model, duration, steps, changes, formulation, radius
):
    """Half the step, a quarter of the error; Newton takes two corrections with one factorisation."""
    base = changes | {"simulation.duration": duration, "simulation.output_interval": duration / 10}
    exact = simulate(model, base | by_dop853(1e-12))
    errors = []
    for count in (steps, 2 * steps):
        run = simulate(model, base | generalized_alpha(formulation, radius, duration / count))
        errors.append(deviations(run, exact))
        statistics = run.statistics
        assert statistics["steps"] == pytest.approx(count, abs=3)
        assert statistics["rejected_steps"] == 0
        assert statistics["factorisations"] < 1.05 * count
        assert statistics["evaluations"] < 3.05 * count + 10
    assert_allclose(errors[0] / errors[1], 4, rtol=0.2)


@pytest.mark.parametrize("formulation", ["stabilised", "index3"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-7])
def test_adaptive_steps_keep_the_error_in_proportion(rtol, formulation):
    """The error of a step is of order 3, that of the run of order 2: the tolerance to the power 2/3."""
    base = {"simulation.duration": 1, "simulation.output_interval": 0.01}
    exact = simulate("five_bar.yaml", base | by_dop853(1e-12))
    run = simulate("five_bar.yaml", base | generalized_alpha(formulation) | {"simulation.rtol": rtol})
    assert run.status == "complete"
    assert deviations(run, exact)[0] < 0.7 * rtol ** (2 / 3)
    assert run.statistics["rejected_steps"] < 0.1 * run.statistics["steps"]


def test_constraints_hold_in_place_and_velocity_or_in_place_only():
    changes = {"simulation.duration": 0.02, "simulation.output_interval": 0.02}
    rates = {}
    for formulation in ("stabilised", "index3"):
        run = simulate("five_bar.yaml", changes | generalized_alpha(formulation, step=1e-4))
        assert run["constraint_error"][-1] < 1e-12
        rates[formulation] = run["velocity_constraint_error"][-1]
    assert rates["stabilised"] < 1e-11
    assert 1e-9 < rates["index3"] < 1e-6


def test_without_damping_energy_does_not_drift():
    """Ten seconds of free swinging at spectral radius 1: the trend of the balance is lost in its scatter."""
    changes = FREE | {"simulation.duration": 10, "simulation.output_interval": 0.01}
    run = simulate("five_bar.yaml", changes | generalized_alpha(radius=1, step=5e-4))
    balance = run["energy.balance"] / run["energy.kinetic"].max()
    slope, start = np.polyfit(run.time, balance, 1)
    scatter = (balance - start - slope * run.time).std()
    assert np.abs(balance).max() < 1e-5
    assert np.abs(slope) * 10 < 0.5 * scatter


@pytest.mark.parametrize("radius, left", [(1, 1), (0.5, 1e-9), (0, 1e-20)])
def test_the_spectral_radius_says_what_is_left_of_fast_vibrations(radius, left):
    """A mass on a spring, 50 steps of 100 periods each: amplitudes fall as a power of the radius."""
    model = {
        "gravity": [0, 0],
        "joints": {
            "pivot": {
                "type": "revolute",
                "between": ["ground.origin", "bob.origin"],
                "spring": {"stiffness": (2 * np.pi) ** 2},
            }
        },
        "initial": {"joints": {"pivot": 1e-3}},
        "simulation.duration": 5000,
        "simulation.output_interval": 100,
    }
    run = simulate("pendulum.yaml", model | generalized_alpha(radius=radius, step=100))
    energy = run["energy.elastic"] + run["energy.kinetic"]
    if radius == 1:
        assert_allclose(energy, energy[0], rtol=1e-9)
    else:
        assert energy[-1] < left * energy[0]


def test_damped_beams_cost_no_more_steps_as_they_are_refined():
    changes = STIFF | generalized_alpha() | {"simulation.duration": 0.5, "simulation.rtol": 1e-4}
    steps = []
    for n in (4, 32):
        steps.append(simulate("five_bar.yaml", changes | rods(n)).statistics["steps"])
    assert steps[1] < 1.3 * steps[0]


def test_flat_positions_of_the_four_bars_are_passed():
    """The mechanism could fold there, and stops methods of high order; it stays a parallelogram for all ten seconds."""
    run = simulate("four_bars.yaml", generalized_alpha() | {"simulation.rtol": 1e-7})
    assert run.status == "complete"
    feet = [run[f"foot{k}.angle"] for k in range(3)]
    assert np.ptp(feet, axis=0).max() < 1e-9
    assert np.abs(run["energy.balance"]).max() < 2e-3


def test_friction_and_stops_are_stepped_across():
    exact = simulate("door.yaml", by_dop853(1e-9))
    run = simulate("door.yaml", generalized_alpha() | {"simulation.rtol": 1e-7})
    assert_allclose(run.position, exact.position, rtol=0, atol=1e-4)


def test_index_3_refuses_a_spectral_radius_of_one():
    with pytest.raises(ModelError, match="spectral_radius: must be below 1 for index3"):
        load("five_bar.yaml", generalized_alpha("index3", 1))
