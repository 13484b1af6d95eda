"""The five-bar with its rotors locked: static deflections, by SciPy from the matrices alone.

A transmission whose rotor is locked is a spring between ground and crank. The table was computed for this project by
another program (minimal coordinates, exact loop closure). Frequencies are those of five_bar_locked.case.yaml.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import root
from simulation import load

import fmbd

SIDES = ("right", "left")


def locked(elements):
    start = fmbd.assemble(load("five_bar.yaml")).start.q
    angles = {"right": float(start[1]), "left": float(start[6])}
    springs = {
        f"joints.shoulder_{side}.spring": {"stiffness": "stiffness", "rest": angle}
        for side, angle in angles.items()
    }
    changes = {"motors": {}, "controllers": {}, "bodies.*.elements": elements}
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
    system = locked(elements)
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
