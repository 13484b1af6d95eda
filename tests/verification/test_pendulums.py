"""A pendulum against its exact motion, a double pendulum against a converged published trajectory."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.special import ellipj, ellipk
from simulation import at, simulate


def test_pendulum_swings_in_elliptic_functions():
    """Released at rest from the horizontal: sin(theta / 2) = k cd(omega t, k), k = sin(45 degrees), theta(0) < 0.

    IFToMM library of multibody benchmarks, problem A01; the period is 4 K(k) / omega = 2.3678419475762373 s.
    """
    omega, m = np.sqrt(9.81 / 1), 0.5
    assert_allclose(4 * ellipk(m) / omega, 2.3678419475762373, rtol=1e-15)
    run = simulate("pendulum.yaml", {"simulation.rtol": 1e-12})
    _, cn, dn, _ = ellipj(omega * run.time, m)
    assert_allclose(run["pivot.angle"], -2 * np.arcsin(np.sqrt(m) * cn / dn), rtol=0, atol=1e-10)


def test_double_pendulum():
    """Modelica Standard Library, MultiBody.Examples.Elementary.DoublePendulum.

    The published result stays within 2e-4 of these values, which another program computed to convergence.
    """
    table = np.array([
        # t, phi1, omega1, phi2, omega2
        [1, -2.9156611573, 2.9445553240, -0.5152147461, -7.2490926552],
        [2, -0.0359672831, -2.4873131282, -0.9041045932, -0.6366710142],
        [3, -2.3179156754, 4.0941647322, -1.7365345730, -0.0503945317],
    ])  # fmt: skip
    run = simulate("double_pendulum.yaml", {"simulation.rtol": 1e-12})
    names = ["first.angle", "first.angle.rate", "second.angle", "second.angle.rate"]
    found = np.stack([run[name] for name in names], axis=-1)
    assert_allclose(found[at(run, table[:, 0])], table[:, 1:], rtol=0, atol=2e-10)


def test_friction_of_the_double_pendulum_accounts_for_its_energy():
    run = simulate("double_pendulum.yaml", {"simulation.rtol": 1e-12})
    assert run["energy.dissipated"][-1] > 1
    assert np.abs(run["energy.balance"]).max() < 1e-9
