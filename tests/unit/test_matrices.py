"""The matrices of the five-bar against the closed forms of the paper, its misprints corrected.

Paper: Hoang et al., Vietnam Journal of Mechanics 44 (4), 2022, pp. 474-489. Its eqs. (21)-(23) are written
out here for one arm, q = [phi, theta1, theta2, e3, e4]; numbers are those of its Table 1.
"""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fmbd.model import load_model, load_model_text
from fmbd.system import assemble
from fmbd.system.matrices import gravity_compensation

FIVE_BAR = Path(__file__).parents[2] / "models" / "five_bar.yaml"

Km, Ke, Ra, Im, r, k, c = 1, 1, 3, 0.1, 10, 5000, 50
m1, l1, s1, I1 = 3, 0.4, 0.2, 0.2
rho, E, l2, h, b = 2712, 7.102e10, 0.5, 0.003, 0.030
m2, EI = rho * l2 * b * h, E * b * h**3 / 12
L0, m3, gravity = 0.6, 0.25, 9.81

# A state of one arm; the matrices there were computed by an independent program, checked symbolically.
Q = np.array([9.0, 0.95, 1.6, 0.02, 0.1])
V = np.array([3.0, 0.5, -0.7, 0.3, -1.1])
M_AT_Q = [
    [0.1, 0.0, 0.0, 0.0, 0.0],
    [0.0, 0.3241044264875425, 0.06867813935805694, 0.14272434582954124, -0.0014661081716391786],
    [0.0, 0.06867813935805694, 0.07277825222857143, 0.146357, -0.0015255],
    [0.0, 0.14272434582954124, 0.146357, 0.29532914285714285, -0.003196285714285715],
    [0.0, -0.0014661081716391786, -0.0015255, -0.003196285714285715, 0.0002905714285714286],
]
H_AT_Q = [0.0, 0.028174656168560595, 0.01484191394004089, 0.030865260030368324, -0.0005068884342894625]
G_AT_Q = [0.0, 2.9754372106701648, -1.2975398477089128, -2.5325814876881045, 0.04140626604364352]
J_E_AT_Q = [
    [0.0, -0.5876069899067535, -0.26224078799100403, -0.557683717391417, 0.0],
    [0.0, -0.19350720617988593, -0.42618044196543936, -0.8300535352352221, 0.0],
]


def mass_matrix(q):
    """M of one arm, (21), one element."""
    _, _, th2, e3, e4 = q
    C, S = np.cos(th2), np.sin(th2)
    bent = 13 / 35 * m2 * e3**2 - 11 / 105 * m2 * e3 * e4 * l2 + m2 * e4**2 * l2**2 / 105
    m22 = I1 + bent - m2 * l1 * e3 * S + m2 * l1 * l2 * e4 * S / 6 + m2 * l2**2 / 3 + m2 * l1 * l2 * C
    m22 += m2 * l1**2 + m3 * (l1**2 + l2**2 + 2 * l1 * l2 * C - 2 * l1 * e3 * S + e3**2)
    m23 = bent - m2 * l1 * S * e3 / 2 + m2 * l1 * l2 * e4 * S / 12 + m2 * l2**2 / 3 + m2 * l1 * l2 * C / 2
    m23 += m3 * (l1 * l2 * C - l1 * e3 * S + l2**2 + e3**2)
    m33 = bent + m2 * l2**2 / 3 + m3 * (l2**2 + e3**2)
    m42 = 7 / 20 * m2 * l2 + m2 * l1 * C / 2 + m3 * (l1 * C + l2)
    m43 = 7 / 20 * m2 * l2 + m3 * l2
    m52 = -m2 * l2**2 / 20 - m2 * l1 * l2 * C / 12
    m53 = -m2 * l2**2 / 20
    m44, m45, m55 = 13 / 35 * m2 + m3, -11 / 210 * m2 * l2, m2 * l2**2 / 105
    return np.array(
        [
            [Im, 0, 0, 0, 0],
            [0, m22, m23, m42, m52],
            [0, m23, m33, m43, m53],
            [0, m42, m43, m44, m45],
            [0, m52, m53, m45, m55],
        ]
    )


def gravity_forces(q):
    """g of one arm, (21)."""
    _, th1, th2, e3, e4 = q
    C, S = np.cos(th1 + th2), np.sin(th1 + th2)
    g3 = m2 * (-6 * e3 * S + e4 * l2 * S + 6 * l2 * C) / 12 + m3 * (l2 * C - e3 * S)
    g2 = g3 + (m1 * s1 + m2 * l1 + m3 * l1) * np.cos(th1)
    return gravity * np.array([0, g2, g3, (m2 / 2 + m3) * C, -m2 * l2 * C / 12])


def end_point_jacobian(q):
    """J_E of one arm, by (6)."""
    _, th1, th2, e3, _ = q
    C, S = np.cos(th1 + th2), np.sin(th1 + th2)
    along = [-l2 * S - e3 * C, l2 * C - e3 * S]
    whole = [along[0] - l1 * np.sin(th1), along[1] + l1 * np.cos(th1)]
    return np.array([[0, whole[0], along[0], -S, 0], [0, whole[1], along[1], C, 0]])


def mass_gradient(q):
    """dM/dq_k of one arm, last index k, by complex step on the closed form."""
    steps = 1e-30j * np.eye(5)
    return np.stack([mass_matrix(q + step).imag / 1e-30 for step in steps], axis=-1)


def christoffel(q, v):
    """C of one arm, (20) literally."""
    dM = mass_gradient(q)
    return 0.5 * sum((dM[:, :, k] + dM[:, k, :] - dM[:, k, :].T) * v[k] for k in range(5))


@pytest.fixture(scope="module")
def five_bar():
    return assemble(load_model(FIVE_BAR))


@pytest.fixture
def at_state(five_bar):
    """Matrices with both arms in the state (Q, V); the loop is open there, which they do not mind."""
    return five_bar.matrices(np.tile(Q, 2), np.tile(V, 2))


RIGHT, LEFT = slice(0, 5), slice(5, 10)


@pytest.mark.parametrize("arm", [RIGHT, LEFT])
def test_an_arm_has_the_paper_s_mass_coriolis_and_gravity(at_state, arm):
    exact = {"rtol": 1e-12, "atol": 1e-14}
    assert_allclose(at_state.M[arm, arm], mass_matrix(Q), **exact)
    assert_allclose(at_state.M[arm, arm], M_AT_Q, **exact)
    assert_allclose(at_state.C[arm, arm], christoffel(Q, V), rtol=1e-12, atol=1e-13)
    assert_allclose(at_state.C[arm, arm] @ V, H_AT_Q, **exact)
    assert_allclose(at_state.g[arm], gravity_forces(Q), **exact)
    assert_allclose(at_state.g[arm], G_AT_Q, **exact)


def test_mass_rate_less_twice_coriolis_is_skew_symmetric(at_state):
    """The rate of M is that of the closed form, not the one that made C."""
    rate = mass_gradient(Q) @ V
    for arm in (RIGHT, LEFT):
        skew = rate - 2 * at_state.C[arm, arm]
        assert_allclose(skew, -skew.T, atol=1e-12)


def test_arms_meet_only_in_the_constraint(at_state):
    for matrix in (at_state.M, at_state.C, at_state.D, at_state.K):
        assert_allclose(matrix[RIGHT, LEFT], 0, atol=1e-12)
        assert_allclose(matrix[LEFT, RIGHT], 0, atol=1e-12)


@pytest.mark.parametrize("arm", [0, 1])
def test_five_bar_has_the_paper_s_damping_stiffness_and_input(at_state, arm):
    own = (RIGHT, LEFT)[arm]
    D, K, B = np.zeros((5, 5)), np.zeros((5, 5)), np.zeros((5, 2))
    D[:2, :2] = [[c / r**2 + Km * Ke / Ra, -c / r], [-c / r, c]]
    K[:2, :2] = [[k / r**2, -k / r], [-k / r, k]]
    K[3:, 3:] = EI / l2**3 * np.array([[12, -6 * l2], [-6 * l2, 4 * l2**2]])
    B[0, arm] = Km / Ra
    assert_allclose(at_state.D[own, own], D, rtol=1e-13, atol=1e-15)
    assert_allclose(at_state.K[own, own], K, rtol=1e-12, atol=1e-12)
    assert_allclose(at_state.B[own], B, rtol=1e-15)


def test_constraint_is_the_right_end_point_less_the_left_one(at_state):
    """(22), which makes Phi_q^T = [J_E1^T; -J_E2^T] in (23): lambda is the force on the right arm."""
    assert_allclose(at_state.Phi, [L0, 0], atol=1e-15)
    assert_allclose(at_state.Phi_q[:, RIGHT], end_point_jacobian(Q), rtol=1e-14, atol=1e-15)
    assert_allclose(at_state.Phi_q[:, RIGHT], J_E_AT_Q, rtol=1e-13, atol=1e-15)
    assert_allclose(at_state.Phi_q[:, LEFT], -end_point_jacobian(Q), rtol=1e-14, atol=1e-15)


def test_gamma_is_minus_the_centripetal_part_of_the_loop(five_bar):
    """Phi_q q'' = -(d/dt Phi_q) q', by complex step on the closed form."""
    q, v = (
        np.concatenate([Q, [17.0, 1.7, -1.3, -0.01, 0.04]]),
        np.concatenate([V, [1.0, -0.4, 0.6, 0.2, 0.9]]),
    )
    turning = [end_point_jacobian(q[arm] + 1e-30j * v[arm]).imag / 1e-30 @ v[arm] for arm in (RIGHT, LEFT)]
    assert_allclose(five_bar.matrices(q, v).gamma, turning[1] - turning[0], rtol=1e-12)


def test_four_elements_follow_the_general_formula():
    """M and h of an arm for any n, from the sums M_ff, s, p of textbook element matrices, tip mass included.

    m33 = J + e M_ff e, m23 = m33 + X, m22 = I1 + m l1^2 + m33 + 2 X, with X = l1 (S1 cos - s e sin)(theta2),
    and the Coriolis terms that Lagrange's equations give with them.
    """
    n = 4
    a = l2 / n
    M_ff, s, p = np.zeros((10, 10)), np.zeros(10), np.zeros(10)
    element = np.array(
        [
            [156, 22 * a, 54, -13 * a],
            [22 * a, 4 * a**2, 13 * a, -3 * a**2],
            [54, 13 * a, 156, -22 * a],
            [-13 * a, -3 * a**2, -22 * a, 4 * a**2],
        ]
    )
    for i in range(n):
        own = slice(2 * i, 2 * i + 4)
        M_ff[own, own] += m2 / n / 420 * element
        whole = np.array([1 / 2, a / 12, 1 / 2, -a / 12])
        s[own] += m2 / n * whole
        p[own] += m2 / n * (i * a * whole + a * np.array([3 / 20, a / 30, 7 / 20, -a / 20]))
    M_ff[8, 8] += m3
    s[8] += m3
    p[8] += m3 * l2
    M_ff, s, p = M_ff[2:, 2:], s[2:], p[2:]

    rng = np.random.default_rng(4)
    e, e_rate = 0.05 * rng.normal(size=8), rng.normal(size=8)
    th2, w1, w2 = 1.6, 0.5, -0.7
    S1, J, m = m2 * l2 / 2 + m3 * l2, m2 * l2**2 / 3 + m3 * l2**2, m2 + m3
    X = l1 * (S1 * np.cos(th2) - s @ e * np.sin(th2))
    Y = l1 * (S1 * np.sin(th2) + s @ e * np.cos(th2))
    m33 = J + e @ M_ff @ e
    M = np.zeros((11, 11))
    M[0, 0] = Im
    M[1:3, 1:3] = [[I1 + m * l1**2 + m33 + 2 * X, m33 + X], [m33 + X, m33]]
    M[1, 3:] = M[3:, 1] = p + l1 * np.cos(th2) * s
    M[2, 3:] = M[3:, 2] = p
    M[3:, 3:] = M_ff
    spin = 2 * (e @ M_ff @ e_rate) * (w1 + w2)
    coriolis = np.zeros(11)
    coriolis[1] = spin - Y * (w2**2 + 2 * w1 * w2) - 2 * l1 * np.sin(th2) * (s @ e_rate) * (w1 + w2)
    coriolis[2] = spin + Y * w1**2
    coriolis[3:] = -M_ff @ e * (w1 + w2) ** 2 + l1 * w1**2 * np.sin(th2) * s

    system = assemble(load_model(FIVE_BAR, {"bodies.*.elements": n}))
    q = np.concatenate([[9.0, 0.95, th2], e])
    v = np.concatenate([[3.0, w1, w2], e_rate])
    at_state = system.matrices(np.tile(q, 2), np.tile(v, 2))
    assert_allclose(at_state.M[:11, :11], M, rtol=1e-12, atol=1e-15)
    assert_allclose(at_state.C[:11, :11] @ v, coriolis, rtol=1e-12, atol=1e-14)


def test_controller_gives_the_reference_voltages_at_the_start(five_bar):
    """U = Kp (phi_d - phi) - Kd phi' + U_g with Kp = 4, phi_d and U_g for the end point (-0.1, 0.7)."""
    phi_d = np.array([15.707963267948964, 20.069018176333845])
    U_g = np.array([0.4399168825710753, -1.3449300040449426])
    phi = 10 * np.array([0.9812119840162299, 1.7124877845767905])
    assert_allclose(five_bar.matrices().u, 4 * (phi_d - phi) + U_g, rtol=1e-12)


def test_gravity_compensation_is_that_of_the_rigid_closed_loop(five_bar):
    """G = g_a - Phi_a^T Phi_p^-T g_p, a: theta1, p: theta2 of both arms, end point at (-0.1, 0.7)."""
    q = five_bar.start.q.copy()
    th11, th21 = 1.5707963267948964, 2.0069018176333845
    for arm, th1, base in ((RIGHT, th11, L0 / 2), (LEFT, th21, -L0 / 2)):
        rod = np.arctan2(0.7 - l1 * np.sin(th1), -0.1 - base - l1 * np.cos(th1))
        q[arm] = [10 * th1, th1, rod - th1, 0, 0]
    g = np.concatenate([gravity_forces(q[RIGHT]), gravity_forces(q[LEFT])])
    Phi_q = np.hstack([end_point_jacobian(q[RIGHT]), -end_point_jacobian(q[LEFT])])
    active, passive = [1, 6], [2, 7]
    G = g[active] - Phi_q[:, active].T @ np.linalg.solve(Phi_q[:, passive].T, g[passive])
    torques = gravity_compensation(five_bar, q)
    assert_allclose(torques, G, rtol=1e-12)
    assert_allclose(torques, [1.46638961, -4.48310001], rtol=1e-8)


def test_redundant_constraints_leave_the_motion_alone():
    """A plate on two rails: y and angle are held twice; it slides as on one, the spare does nothing."""
    rails = """
        fmbd: 1
        gravity: [3, -9.81]
        ground: {points: {far: [1, 0]}}
        bodies: {plate: {type: rigid, mass: 2, inertia: 0.1, points: {far: [1, 0]}}}
        joints:
          rail: {type: prismatic, between: [ground.origin, plate.origin]}
          spare: {type: prismatic, between: [ground.far, plate.far], cut: true}
    """
    acceleration, multipliers = assemble(load_model_text(rails)).matrices().accelerations()
    assert_allclose(acceleration, [3], rtol=1e-14)
    assert_allclose(multipliers, 0, atol=1e-14)
