"""The compiled recursion and the matrices of the paper are one model: they move alike."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from simulation import load, simulate

import fmbd


def test_scipy_finds_the_same_trajectory_from_the_matrices_alone():
    """Case B of the five-bar for 0.2 s, in which the rods swing six times; SciPy sees the matrices only."""
    changes = {"simulation.rtol": 1e-10, "simulation.duration": 0.2}
    system = fmbd.assemble(load("five_bar.yaml", changes))
    nq = system.planar.nq

    def rates(t, y):
        q, v = y[:nq], y[nq:]
        return np.append(v, system.matrices(q, v, t).accelerations()[0])

    y0 = np.append(system.start.q, system.start.v)
    scipy = solve_ivp(rates, (0, 0.2), y0, method="DOP853", rtol=1e-10, atol=1e-10).y[:, -1]
    run = simulate("five_bar.yaml", changes)
    assert_allclose(run.position[-1], scipy[:nq], rtol=0, atol=1e-8)
    assert_allclose(run.velocity[-1], scipy[nq:], rtol=0, atol=1e-8)
