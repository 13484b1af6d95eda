"""Orders of elements and of integrators, as `fmbd refine` observes them.

Steps of one length, by a tolerance that never binds; at the end alone, for between steps outputs are interpolated.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from simulation import load
from simulation import model as build

import fmbd

ELEMENTS = "bodies.*.elements"
FREE = {"simulation.rtol": 1e3, "simulation.duration": 1, "simulation.output_interval": 1}


def test_elements_have_order_four_in_frequencies():
    """Cubic elements; the continuum of the five-bar with locked rotors, by the exact functions of the beam."""
    angles = {"right": 0.9812119840162299, "left": 1.7124877845767905}
    locked = {f"joints.shoulder_{s}.spring": {"stiffness": 5000, "rest": x} for s, x in angles.items()}
    model = load("five_bar.yaml", {"motors": {}, "controllers": {}} | locked)
    study = fmbd.refine(
        model, {ELEMENTS: [4, 8, 16, 32]}, ["frequency.1", "frequency.6"], analysis="frequencies"
    )
    for result, continuum in zip(study.results, (17.3832634601, 111.9319859889)):
        assert result.found.is_settled
        assert abs(result.found.order - 4) < 0.1
        assert abs(result.found.extrapolated - continuum) < result.found.bar.end


def test_elements_have_order_four_in_modes():
    """The hanging five-bar, held at its motors: what gravity does to its frequencies, and to a mode, is in them."""
    model = load("five_bar.yaml", {})
    quantities = ["frequency.1", "frequency.5", "mode.3.rod_right.end.deflection"]
    study = fmbd.refine(model, {ELEMENTS: [4, 8, 16, 32]}, quantities, "modes", lock="all")
    for result in study.results:
        assert result.found.is_settled
        assert abs(result.found.order - 4) < 0.1


def test_elements_have_order_four_in_statics():
    """A cantilever under its weight q: q^2 L^5 / (40 EI) elastic, and in the middle of its middle element.

    Between nodes a cubic is wrong by the deflection of a clamped element, q h^4 / (384 EI); at nodes it is exact, as
    Hermite elements are: q L^4 / (8 EI). What clamps it is exact, too.
    """
    q, L, EI = 2.0, 1.5, 40.0
    model = cantilever(q, L, EI)
    exact = {
        "energy.elastic": q**2 * L**5 / (40 * EI),
        "rod.middle.deflection": -17 * q * L**4 / (384 * EI),
        "rod.end.deflection": -q * L**4 / (8 * EI),
        "root.moment": q * L**2 / 2,
    }
    study = fmbd.refine(model, {ELEMENTS: [1, 3, 9, 27]}, list(exact), analysis="statics")
    energy, middle, end, moment = study.results
    for result in (energy, middle):
        assert result.found.is_settled
        assert abs(result.found.order - 4) < 0.1
        assert abs(result.found.extrapolated - exact[result.quantity]) < result.found.bar.end
    coarsest = study.members[0].measured.values["rod.middle.deflection"]
    assert_allclose(coarsest - exact["rod.middle.deflection"], q * L**4 / (384 * EI), rtol=1e-9)
    for result in (end, moment):
        assert result.found.is_exact
        found = study.members[0].measured.values[result.quantity]
        assert_allclose(np.abs(found), np.abs(exact[result.quantity]), rtol=1e-11)


def cantilever(q, L, EI):
    """A rod of weight q [N/m], clamped, with a point in its middle."""
    rod = {"type": "beam", "length": L, "elements": 1, "mass_per_length": 1, "bending_stiffness": EI}
    return build(
        gravity=[0, -q],
        bodies={"rod": rod | {"points": {"middle": L / 2}}},
        joints={"root": {"type": "weld", "between": ["ground.origin", "rod.start"]}},
    )


def test_elements_have_order_four_over_time():
    """Damped rods of the five-bar under control, tip and end point."""
    model = load(
        "five_bar.yaml",
        {
            "bodies.*.damping.stiffness_proportional": 5e-5,
            "simulation.rtol": 1e-8,
            "simulation.duration": 0.3,
        },
    )
    study = fmbd.refine(
        model, {ELEMENTS: [2, 4, 8, 16]}, ["rod_right.end.deflection", "rod_left.end.position"]
    )
    for result in study.results:
        assert result.found.is_settled
        assert abs(result.found.order - 4) < 0.1
        assert result.time_share < 0.1


@pytest.mark.parametrize(
    ("method", "order", "key", "counts"),
    [
        ("generalized_alpha", 2, "generalized_alpha.step", [100, 200, 400, 800]),
        ("rk45", 5, "max_step", [20, 28, 40, 56]),
        ("baumgarte", 5, "max_step", [20, 28, 40, 56]),
        ("rodas5p", 5, "max_step", [20, 28, 40, 56]),
        ("dop853", 8, "max_step", [8, 11, 15, 20]),
    ],
)
def test_integrators_have_their_orders(method, order, key, counts):
    """radau iterates as exactly as its tolerance asks, so that its order shows over tolerances: test_radau.py."""
    model = load("pendulum.yaml", FREE | {"simulation.method": method})
    (result,) = fmbd.refine(model, {f"simulation.{key}": [1 / n for n in counts]}, ["pivot.angle"]).results
    assert result.found.is_settled
    assert abs(result.found.order - order) < 0.5
