"""A pendulum against its exact motion, and where the energy of a double pendulum goes."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.special import ellipj, ellipk
from simulation import simulate


def test_pendulum_swings_in_elliptic_functions():
    """Released from the horizontal: sin(theta / 2) = -k cd(omega t, k) with k = sin(45 degrees).

    IFToMM library of multibody benchmarks, problem A01; the period is 4 K(k) / omega = 2.3678419475762373 s.
    """
    omega, m = np.sqrt(9.81 / 1), 0.5
    assert_allclose(4 * ellipk(m) / omega, 2.3678419475762373, rtol=1e-15)
    run = simulate("pendulum.yaml", {"simulation.rtol": 1e-12})
    _, cn, dn, _ = ellipj(omega * run.time, m)
    assert_allclose(run["pivot.angle"], -2 * np.arcsin(np.sqrt(m) * cn / dn), rtol=0, atol=1e-10)


def test_friction_of_the_double_pendulum_accounts_for_its_energy():
    run = simulate("double_pendulum.yaml", {"simulation.rtol": 1e-12})
    assert run["energy.dissipated"][-1] > 1
    assert np.abs(run["energy.balance"]).max() < 1e-9
