"""A pendulum against its exact motion, a double pendulum against a converged published trajectory."""

import numpy as np
from numpy.testing import assert_allclose
from scipy.special import ellipj, ellipk
from simulation import at, columns, simulate


def test_pendulum_swings_in_elliptic_functions():
    """Released from the horizontal: sin(theta / 2) = -k cd(omega t, k) with k = sin(45 degrees).

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
    found = columns(run, "first.angle", "first.angle.rate", "second.angle", "second.angle.rate")
    assert_allclose(found[at(run, table[:, 0])], table[:, 1:], rtol=0, atol=2e-10)


def test_friction_of_the_double_pendulum_accounts_for_its_energy():
    run = simulate("double_pendulum.yaml", {"simulation.rtol": 1e-12})
    assert run["energy.dissipated"][-1] > 1
    assert np.abs(run["energy.balance"]).max() < 1e-9


def test_pin_force_of_a_pendulum():
    """Project Chrono's unit test JOINT_revolute, case 1, whose reactions are from ADAMS, to six digits.

    Mass 1 kg, moment of inertia 0.1 kg m^2, centre of mass 2 m from the pin, released from the horizontal;
    another program gave the digits beyond six. Force of the body on the ground.
    """
    table = np.array([
        # t, x, y of the centre of mass, R_x, R_y
        [1, -0.89238149, -1.78987577, -11.461238, -23.227328],
        [2.5, -0.26550634, -1.98229826, -3.776608, -28.435743],
        [5, -1.99968387, -0.03555875, -0.510230, -0.248260],
    ])  # fmt: skip
    changes = {
        "bodies.bob": {"type": "rigid", "mass": 1, "inertia": 0.1, "center_of_mass": [0, -2]},
        "initial": {"joints": {"pivot": "pi/2"}},
        "gravity": [0, -9.80665],
        "simulation": {"rtol": 1e-12, "duration": 5, "output_interval": 0.5},
    }
    run = simulate("pendulum.yaml", changes)
    rows = at(run, table[:, 0])
    assert_allclose(run["bob.center_of_mass.position"][rows], table[:, 1:3], rtol=0, atol=1e-8)
    assert_allclose(run["pivot.force"][rows], table[:, 3:], rtol=0, atol=1e-6)
    assert_allclose(run["pivot.force"][0], [0, -0.239187], rtol=0, atol=1e-6)
