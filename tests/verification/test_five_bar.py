"""The paper's five-bar: trajectories against an independent program.

Model: Hoang et al., Vietnam Journal of Mechanics 44 (4), 2022, pp. 474-489, Table 1, misprints corrected.
The numbers were computed for this project by another program: minimal coordinates, exact loop closure,
tolerance 1e-13; its equations were checked by symbolic derivation, its integration by an extrapolation
method and by SUNDIALS IDA. It is trusted to 1e-11 in positions and 1e-9 in multipliers.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from simulation import at, columns, load, simulate

import fmbd

# phi, theta1, theta2, w_tip, slope_tip (the paper's e3, e4) of the right arm, then of the left
COORDINATES = [
    "motor_right.rotor", "shoulder_right.angle", "elbow_right.angle", "rod_right.end.deflection",
    "rod_right.end.slope", "motor_left.rotor", "shoulder_left.angle", "elbow_left.angle",
    "rod_left.end.deflection", "rod_left.end.slope",
]  # fmt: skip

# time, the coordinates above, end point E_x E_y, multipliers lambda_x lambda_y, kinetic and potential energy
CASE_A_ONE_ELEMENT = np.array([
    [0.05, 9.80557161683, 0.979352290709, 1.60257812878, -0.00153087371516, -0.00635140965189,
     17.1283004947, 1.71347839783, -1.29914214832, 0.00172101650512, 0.00712716962796,
     0.100119641514, 0.598801875093, 5.8515581964, -0.556382910939, 0.00496605563678, 14.8066905471],
    [0.1, 9.7860113972, 0.977415435535, 1.60508722251, -0.000840799776538, -0.0034160738593,
     17.1386958606, 1.7145007025, -1.30097502456, 0.000813759608856, 0.00325404771203,
     0.100243764987, 0.597542239148, 5.32035601273, -0.458044863938, 0.0169878400658, 14.7912852948],
    [0.25, 9.66892836662, 0.965665845118, 1.62847160898, -0.000634151126102, -0.00259369551919,
     17.2011538664, 1.72077848541, -1.32300749014, 0.000628008625645, 0.0026088778326,
     0.10095189554, 0.589770639166, 5.4881833714, -0.517397058191, 0.069672322661, 14.6980146852],
    [0.5, 9.34475133034, 0.933172977889, 1.6975672938, -0.00123302479374, -0.00500441493945,
     17.3767720697, 1.73840931476, -1.38836471421, 0.00114657937057, 0.00468289334656,
     0.102553795004, 0.56694121926, 6.41625458807, -0.599146501724, 0.157673355422, 14.4264337416],
])  # fmt: skip
CASE_A_FOUR_ELEMENTS = np.array([
    [0.5, 9.34475183483, 0.933172516346, 1.69778850305, -0.00134316665966, -0.00549815766005,
     17.3767721555, 1.73841152433, -1.38884815055, 0.00138694287046, 0.00562411880122,
     0.102553581887, 0.56694104597, 6.57298342822, -0.620749589844, 0.157667195737, 14.4264068435],
])  # fmt: skip
CASE_B_ONE_ELEMENT = np.array([
    [0.1, 10.0965117276, 1.00824904522, 1.57082355557, -0.000946287548745, -0.00384912478319,
     17.2719676832, 1.72777861594, -1.29425257211, 0.000773512419854, 0.00311222971525,
     0.0908848391415, 0.605820009152, 5.63914997988, -0.564256690173, 1.65002743547, 14.9340466216],
    [1, 14.8450151548, 1.48409070844, 1.03702091357, -0.000942601254293, -0.00388732062364,
     19.6738487779, 1.96826024141, -1.27253487116, 0.000896465011558, 0.00366854145711,
     -0.071612572085, 0.689977565466, 3.88099933712, 0.271956921468, 0.310699055419, 15.9629354737],
    [3, 15.7039672765, 1.57010274838, 0.931039376347, -0.000982251224509, -0.00397961471259,
     20.0686848709, 2.00776574399, -1.26949531263, 0.000872995203334, 0.00358574889864,
     -0.10004892916, 0.699565872989, 3.66604237962, 0.297006542907, 9.77168962787e-06, 15.9463013372],
])  # fmt: skip

# Case B's law is U = 4 (phi_d - phi) - 1.2 phi' + U_g: phi_d and U_g at the target E_d = (-0.1, 0.7)
SET_POINT = {"motor_right": 15.707963267948964, "motor_left": 20.069018176333845}
FEED_FORWARD = {"motor_right": 0.4399168825710753, "motor_left": -1.3449300040449426}

ACCURATE = {"simulation.rtol": 1e-10}
SHORT_CIRCUITED = {"motors.motor_right.voltage": 0, "motors.motor_left.voltage": 0, "controllers": {}}


def assert_run_is(run, table):
    """Positions to 1e-8, multipliers to 1e-6 N, energies to 1e-8 J."""
    assert run.status == "complete"
    rows = at(run, table[:, 0])
    assert_allclose(columns(run, *COORDINATES)[rows], table[:, 1:11], rtol=0, atol=1e-8)
    for rod in ("rod_right", "rod_left"):
        assert_allclose(run[f"{rod}.end.position"][rows], table[:, 11:13], rtol=0, atol=1e-8)
    multipliers = columns(run, "multipliers.effector.x", "multipliers.effector.y")
    assert_allclose(multipliers[rows], table[:, 13:15], rtol=0, atol=1e-6)
    assert_allclose(run["energy.kinetic"][rows], table[:, 15], rtol=0, atol=1e-8)
    potential = run["energy.potential"] + run["energy.elastic"]
    assert_allclose(potential[rows], table[:, 16], rtol=0, atol=1e-8)


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


def test_case_a_falling_with_motors_at_zero_volts():
    run = simulate("five_bar.yaml", ACCURATE | SHORT_CIRCUITED | {"simulation.duration": 0.5})
    assert_run_is(run, CASE_A_ONE_ELEMENT)


def test_case_a_with_four_elements_a_rod():
    changes = SHORT_CIRCUITED | {"simulation.duration": 0.5, "bodies.*.elements": 4}
    assert_run_is(simulate("five_bar.yaml", ACCURATE | changes), CASE_A_FOUR_ELEMENTS)


def test_case_b_under_control(case_b):
    assert_run_is(case_b, CASE_B_ONE_ELEMENT)


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
