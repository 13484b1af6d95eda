"""A cantilever that moves in its first modes only: what is kept is untouched, what is lost is what theory says."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fmbd
from fmbd.analyses import natural_frequencies
from fmbd.model import load_model_text

CANTILEVER = """
fmbd: 1
bodies: {rod: {type: beam, length: 0.7, elements: 24, mass_per_length: 0.6, bending_stiffness: 5}}
joints: {root: {type: weld, between: [ground.origin, rod.start]}}
loads: {push: {type: force, at: rod.end, force: [0, 1]}}
simulation: {duration: 2, rtol: 1e-9, atol: 1e-12, output_interval: 0.01}
"""
L, EI = 0.7, 5.0
ROOTS = np.array([1.87510406871, 4.69409113297, 7.85475743824, 10.9955407349])  # beta L


def cantilever(modes):
    return load_model_text(CANTILEVER, overrides={"bodies.rod.modes": modes})


@pytest.mark.parametrize("modes", [1, 2, 4])
def test_frequencies_that_are_kept_are_those_of_all_modes(modes):
    system = fmbd.assemble(cantilever(modes))
    assert system.coordinates == [(f"rod.mode{k + 1}", "kg^0.5 m") for k in range(modes)]
    everything = natural_frequencies(fmbd.assemble(cantilever("all")))
    assert_allclose(natural_frequencies(system), everything[:modes], rtol=1e-10)
    assert system.lowered.truncations["rod"].next_frequency == pytest.approx(everything[modes], rel=1e-10)


def test_modes_up_to_a_frequency():
    third = natural_frequencies(fmbd.assemble(cantilever("all")))[2]
    for limit, count in ((0.999 * third, 2), (1.001 * third, 3)):
        assert fmbd.assemble(cantilever({"up_to": float(limit)})).planar.nq == count


@pytest.mark.parametrize("modes", [1, 2, 4])
def test_static_deflection_is_the_sum_over_the_modes(modes):
    """Each mode gives 4 F L^3 / (EI (beta L)^4) at the tip; all of them F L^3 / 3 EI."""
    system = fmbd.assemble(cantilever(modes))
    m = system.matrices()
    tip = system.beams[0].shape(L) @ np.linalg.solve(m.K, m.f)
    kept = (4 / ROOTS[:modes] ** 4).sum()
    assert_allclose(tip, kept * L**3 / EI, rtol=1e-6)
    assert_allclose(system.lowered.truncations["rod"].compliance, 3 * kept, rtol=1e-6)


def test_effective_masses():
    """(2 sigma / beta L)^2 of the mass, sigma = (sinh - sin) / (cosh + cos) at beta L: 61.3 %, 18.8 %, 6.5 %, 3.3 %.

    Shares are those of all modes of the mesh, which leave out the mass that is held with the first node.
    """
    sigma = (np.sinh(ROOTS) - np.sin(ROOTS)) / (np.cosh(ROOTS) + np.cos(ROOTS))
    theory = np.cumsum((2 * sigma / ROOTS) ** 2)
    kept = [fmbd.assemble(cantilever(k)).lowered.truncations["rod"].effective_mass for k in (1, 2, 3, 4)]
    assert_allclose(theory[[0, 3]], [0.6131, 0.8992], atol=1e-4)
    assert_allclose(np.array(kept) / kept[0], theory / theory[0], rtol=1e-5)
    assert theory[3] < kept[3] < 1


def test_outputs_of_a_truncated_beam():
    """Damped to rest, the tip is where the sum over two modes puts it; deflections have their names and places."""
    damped = cantilever(2).with_("bodies.rod.damping", {"modal_ratios": 0.7})
    run = fmbd.simulate(damped)
    expected = (4 / ROOTS[:2] ** 4).sum() * L**3 / EI
    assert run["rod.deflection"][-1, -1] == pytest.approx(expected, rel=1e-6)
    assert run["rod.end.position"][-1] == pytest.approx([L, expected], rel=1e-6)
    assert np.abs(run["energy.balance"]).max() < 1e-8
