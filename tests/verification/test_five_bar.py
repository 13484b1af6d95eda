"""The paper's five-bar: its start, its control law, its energy; trajectories are those of five_bar.case.yaml.

Model: Hoang et al., Vietnam Journal of Mechanics 44 (4), 2022, pp. 474-489, Table 1, misprints corrected.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from simulation import at, load, simulate

import fmbd

# Case B's law is U = 4 (phi_d - phi) - 1.2 phi' + U_g: phi_d and U_g at the target E_d = (-0.1, 0.7)
SET_POINT = {"motor_right": 15.707963267948964, "motor_left": 20.069018176333845}
FEED_FORWARD = {"motor_right": 0.4399168825710753, "motor_left": -1.3449300040449426}

ACCURATE = {"simulation.rtol": 1e-10}


@pytest.fixture(scope="module")
def case_b():
    return simulate("five_bar.yaml", ACCURATE)


def test_start_is_the_inverse_kinematics_of_the_end_point():
    """The paper's q0 with all digits: the rigid arms reach E = (0.1, 0.6), the transmissions are relaxed."""
    theta = [0.9812119840162299, 1.595798931694258, 1.7124877845767905, -1.2922066244032462]
    right, left = [10 * theta[0], *theta[:2], 0, 0], [10 * theta[2], *theta[2:], 0, 0]
    start = fmbd.assemble(load("five_bar.yaml")).start
    assert_allclose(start.q, right + left, rtol=0, atol=1e-13)
    assert_allclose(start.v, 0, atol=0)


def test_case_b_has_its_potential_energy(case_b):
    """Of gravity and elastic, by the program of five_bar.case.yaml."""
    potential = case_b["energy.potential"] + case_b["energy.elastic"]
    assert_allclose(
        potential[at(case_b, [0.1, 1, 3])], [14.9340466216, 15.9629354737, 15.9463013372], rtol=0, atol=1e-8
    )


@pytest.mark.parametrize("motor", SET_POINT)
def test_case_b_has_the_law_with_gravity_compensation(case_b, motor):
    phi, rate = case_b[f"{motor}.rotor"], case_b[f"{motor}.rotor.rate"]
    law = 4 * (SET_POINT[motor] - phi) - 1.2 * rate + FEED_FORWARD[motor]
    assert_allclose(case_b[f"{motor}.voltage"], law, rtol=0, atol=1e-12)


def test_case_b_balances_its_energy(case_b):
    """Kinetic + potential + elastic + dissipated - work stays what it was; the motors put in some 1.8 J."""
    assert np.abs(case_b["energy.work"]).max() > 1.7
    assert np.abs(case_b["energy.balance"]).max() < 1e-9


def test_case_b_stays_on_its_constraints(case_b):
    assert case_b["constraint_error"].max() < 1e-11
