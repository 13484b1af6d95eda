"""The paper's own scheme: no projection, constraints stabilised after Baumgarte, delta = 1, omega = 700 1/s.

Hoang et al., Vietnam Journal of Mechanics 44 (4), 2022, pp. 474-489, equation (24) and Table 1. The figures
of the transient (10 ms, 2.9 N) come from the program that gave the numbers of test_five_bar.py.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import null_space
from simulation import load, simulate

import fmbd

DELTA, OMEGA = 1, 700
# The start as the paper prints it, to four digits.
ANGLES = {"shoulder_right": 0.9812, "elbow_right": 1.5958, "shoulder_left": 1.7125, "elbow_left": -1.2922}
PRINTED = {"initial": {"joints": ANGLES, "consistent": False}}
TIGHT = {"simulation.rtol": 1e-12, "simulation.duration": 0.5, "simulation.output_interval": 1e-3}
THE_PAPER_S = {"simulation.method": "baumgarte"}


@pytest.fixture(scope="module")
def projected():
    return simulate("five_bar.yaml", TIGHT)


@pytest.fixture(scope="module")
def from_printed_start(tmp_path_factory):
    """As read back from its archive."""
    archive = tmp_path_factory.mktemp("baumgarte") / "five_bar.vtkhdf"
    fmbd.simulate(load("five_bar.yaml", TIGHT | THE_PAPER_S | PRINTED), archive)
    return fmbd.open_run(archive)


def test_from_the_exact_start_it_is_the_same_trajectory(projected):
    """Both methods solve the same equations: half a second later they agree to what the tolerance leaves."""
    run = simulate("five_bar.yaml", TIGHT | THE_PAPER_S)
    assert_allclose(run.position, projected.position, rtol=0, atol=1e-12)
    assert_allclose(run.multipliers, projected.multipliers, rtol=0, atol=1e-9)
    assert run["constraint_error"].max() < 1e-14


def test_the_printed_start_makes_a_transient_in_the_multipliers(projected, from_printed_start):
    """A peak of 2.9 N at once; after 10 ms what is left is the ringing of rods that were hit, below 0.1 N."""
    difference = np.abs(from_printed_start.multipliers - projected.multipliers).max(axis=1)
    assert difference.argmax() == 0
    assert_allclose(difference[0], 2.9, atol=0.05)
    assert difference[10:].max() < 0.1


def test_the_loop_closes_as_a_critically_damped_oscillator(from_printed_start):
    """Phi'' + 2 delta omega Phi' + omega^2 Phi = 0 with delta = 1: Phi = Phi_0 (1 + omega t) exp(-omega t).

    Phi_0 is the loop error of the printed angles, 1.67e-5 m long.
    """
    run, t = from_printed_start, from_printed_start.time
    gap = run["rod_right.end.position"] - run["rod_left.end.position"]
    assert_allclose(np.hypot(*gap[0]), 1.67e-5, rtol=5e-3)
    decay = (1 + OMEGA * t) * np.exp(-OMEGA * t)
    assert_allclose(gap, decay[:, None] * gap[0], rtol=0, atol=1e-12)
    assert_allclose(run["constraint_error"], np.abs(gap).max(axis=1), rtol=0, atol=1e-15)


def test_accelerations_are_those_of_the_null_space_form(from_printed_start):
    """(24): R spans the null space of Phi_q, so that R^T Phi_q^T = 0 and the multipliers are gone.

    R^T M q'' = R^T (B u - C q' - D q' - K q - g)
    Phi_q q'' = -(d/dt Phi_q) q' - 2 delta omega Phi_q q' - omega^2 Phi
    """
    run = from_printed_start
    for row in (0, 1, 5, 100, 500):
        q, v = run.position[row], run.velocity[row]
        m = run.system.matrices(q, v)
        R = null_space(m.Phi_q)
        force = m.B @ m.u + m.f - (m.C + m.D) @ v - m.K @ q - m.g
        pulled = m.gamma - 2 * DELTA * OMEGA * m.Phi_q @ v - OMEGA**2 * m.Phi
        stacked = np.vstack([R.T @ m.M, m.Phi_q])
        acceleration = np.linalg.solve(stacked, np.concatenate([R.T @ force, pulled]))
        assert_allclose(run.acceleration[row], acceleration, rtol=0, atol=1e-12 * np.abs(acceleration).max())
