"""The five-bar with its rotors locked: static deflections and frequencies, by SciPy from the matrices alone.

A transmission whose rotor is locked is a spring between ground and crank. The tables were computed for this
project by another program (minimal coordinates, exact loop closure), the continuum from the exact functions
of the beam.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh, null_space
from scipy.optimize import root
from simulation import load

import fmbd

SIDES = ("right", "left")


def locked(elements, gravity):
    start = fmbd.assemble(load("five_bar.yaml")).start.q
    angles = {"right": float(start[1]), "left": float(start[6])}
    springs = {
        f"joints.shoulder_{side}.spring": {"stiffness": "stiffness", "rest": angle}
        for side, angle in angles.items()
    }
    changes = {"motors": {}, "controllers": {}, "bodies.*.elements": elements, "gravity": [0, -gravity]}
    return fmbd.assemble(load("five_bar.yaml", springs | changes))


@pytest.mark.parametrize(
    "elements, right, left",
    [
        (1, [-9.878351061e-4, -4.064593425e-3], [1.0751284830e-3, 4.414918722e-3]),
        (4, [-9.881975895e-4, -4.065681382e-3], [1.0754278326e-3, 4.415817090e-3]),
    ],
)
def test_static_deflection_and_slope_of_the_tips(elements, right, left):
    """K q + g = f + Phi_q^T lambda with Phi = 0."""
    system = locked(elements, gravity=9.81)
    nq = system.planar.nq

    def unbalanced(x):
        q, multipliers = x[:nq], x[nq:]
        m = system.matrices(q, np.zeros(nq))
        return np.append(m.K @ q + m.g - m.f - m.Phi_q.T @ multipliers, m.Phi)

    q = root(unbalanced, np.append(system.start.q, [0, 0]), tol=1e-14).x
    assert np.abs(unbalanced(q)).max() < 1e-10
    found = dict(zip(system.coordinate_names, q))
    for side, tip in zip(SIDES, (right, left)):
        names = f"rod_{side}.w{elements}", f"rod_{side}.slope{elements}"
        assert_allclose([found[name] for name in names], tip, rtol=1e-9)


def frequencies(elements):
    """[Hz], undamped, without gravity, at the start."""
    m = locked(elements, gravity=0).matrices()
    N = null_space(m.Phi_q)
    return np.sqrt(eigh(N.T @ m.K @ N, N.T @ m.M @ N, eigvals_only=True)) / (2 * np.pi)


@pytest.mark.parametrize(
    "elements, published",
    [
        (1, [17.42257581, 21.56384950, 31.10460328, 31.57804725, 141.68161402, 142.42931145]),
        (8, [17.38327390, 21.52835713, 28.06731689, 28.50338863, 111.44666007, 111.96102731]),
    ],
)
def test_first_six_frequencies(elements, published):
    assert_allclose(frequencies(elements)[:6], published, rtol=0, atol=1e-8)


def test_frequencies_converge_to_the_continuum_with_order_four():
    continuum = [17.3832634601, 21.5283483340, 28.0668659431, 28.5029329125, 111.4177309997, 111.9319859889]
    error_8, error_16 = (frequencies(n)[:6] / continuum - 1 for n in (8, 16))
    assert np.all(error_16 > 0)
    assert_allclose(np.log2(error_8 / error_16), 4, atol=0.06)
