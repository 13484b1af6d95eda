"""Every law of a spring is one function: its force, tangent, energy and loss belong together.

All springs, frictions and stops of the samples in parts.py, discovered, not listed.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from parts import SAMPLES, model
from physics import build

from fmbd.planar import laws
from fmbd.planar.laws import evaluate_law
from fmbd.system import System
from fmbd.system.applied import nonlinear_forces

STEP = 1e-6


def systems() -> dict[str, System]:
    with_law = [name for name, sample in SAMPLES.items() if name.split(".")[0] != "signals"]
    found = {name: build(model(SAMPLES[name])) for name in with_law}
    return {name: system for name, system in found.items() if system.planar.springs.size}


SYSTEMS = systems()
SPRINGS = [(name, k) for name, system in SYSTEMS.items() for k in range(system.planar.springs.size)]


def evaluate(name: str, k: int, lengths: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Force, stiffness, damping, energy and loss, shape (5, n)."""
    planar = SYSTEMS[name].planar
    out = np.zeros((lengths.size, 5))
    evaluate_law(planar.springs, planar.curves, k, lengths, rates, out)
    return out.T


def states(name: str, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Random lengths and rates, about the rest or the stops."""
    rng = np.random.default_rng(5)
    spring = SYSTEMS[name].planar.springs[k]
    bounds = spring.p[:2][np.isfinite(spring.p[:2])] if spring.kind == laws.STOP else np.zeros(1)
    return spring.rest + rng.choice(bounds, 2000) + 0.2 * rng.normal(size=2000), rng.normal(size=2000)


def test_every_kind_of_law_is_here() -> None:
    kinds = {int(spring.kind) for system in SYSTEMS.values() for spring in system.planar.springs}
    assert kinds == {laws.LINEAR, laws.STOP, laws.BACKLASH, laws.FRICTION, laws.TABLE}


@pytest.mark.parametrize(("name", "k"), SPRINGS)
def test_stiffness_and_damping_are_the_derivatives_of_the_force(name: str, k: int) -> None:
    """Central differences; at a corner, where their two sides differ, either side will do."""
    lengths, rates = states(name, k)
    force, *tangents = evaluate(name, k, lengths, rates)[:3]
    for tangent, (dl, dv) in zip(tangents, ((STEP, 0), (0, STEP)), strict=True):
        ahead, back = (evaluate(name, k, lengths + s * dl, rates + s * dv)[0] for s in (1, -1))
        smooth = np.abs(ahead - 2 * force + back) < 1e-3 * STEP * np.abs(tangent).max(initial=1.0)
        assert smooth.mean() > 0.95
        expected = -(ahead - back) / (2 * STEP)
        scale = np.abs(tangent).max(initial=1.0)
        assert_allclose(tangent[smooth], expected[smooth], rtol=0, atol=1e-3 * scale)


@pytest.mark.parametrize(("name", "k"), SPRINGS)
def test_what_the_force_does_not_store_it_dissipates(name: str, k: int) -> None:
    """f l' = -dE/dl l' - P with P >= 0."""
    lengths, rates = states(name, k)
    force, _, _, _, loss = evaluate(name, k, lengths, rates)
    ahead, back = (evaluate(name, k, lengths + s * STEP, rates)[3] for s in (1, -1))
    stored = (ahead - back) / (2 * STEP) * rates
    assert_allclose(force * rates, -stored - loss, rtol=0, atol=1e-6 * np.abs(force).max())
    assert loss.min() >= 0


def kinked(name: str) -> bool:
    return "'interpolation': 'linear'" in str(SAMPLES[name].changes)


@pytest.mark.parametrize(("name", "k"), [pair for pair in SPRINGS if not kinked(pair[0])])
def test_the_tangent_does_not_jump(name: str, k: int) -> None:
    """Along the length, through all corners, and along the rate, as far as stops push; linear tables have kinks."""
    lengths = states(name, k)[0]
    grid = np.linspace(0, 1, 400_001)
    through = lengths.min() + np.ptp(lengths) * grid
    for along, across in (
        (through, np.full_like(grid, 0.3)),
        (np.full_like(grid, lengths[0]), 4 * grid - 0.9),
    ):
        for tangent in evaluate(name, k, along, across)[1:3]:
            assert np.abs(np.diff(tangent)).max() <= 0.02 * np.ptp(tangent) + 1e-9


@pytest.mark.parametrize(("name", "k"), SPRINGS)
def test_the_second_formulation_has_the_same_law(name: str, k: int) -> None:
    """The linear part, and what the law adds to it by NumPy."""
    planar = SYSTEMS[name].planar
    spring = planar.springs[k]
    lengths, rates = states(name, k)
    for length, rate, force in zip(lengths[:200], rates, evaluate(name, k, lengths, rates)[0], strict=False):
        stretch = np.full(planar.springs.size, length - spring.rest)
        more = nonlinear_forces(planar, stretch, np.full(planar.springs.size, rate))[k]
        assert_allclose(
            -spring.k * stretch[k] - spring.d * rate + more, force, rtol=1e-9, atol=1e-9 * abs(spring.k)
        )
