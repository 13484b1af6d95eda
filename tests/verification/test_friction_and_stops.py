"""Friction, stops, backlash and springs by table: closed forms of textbooks, and the door against SciPy."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq
from scipy.special import ellipj
from simulation import simulate

import fmbd
from fmbd.model import load_model_text

METHODS = ("dop853", "rodas5p")


def block(law, start, duration, method="dop853", rtol=1e-10, interval=None):
    """The run of a block of 2 kg on a rail; `law` is what acts along it, `start` its place and speed."""
    return fmbd.simulate(
        load_model_text(f"""
fmbd: 1
bodies: {{block: {{type: rigid, mass: 2, inertia: 1}}}}
joints: {{rail: {{type: prismatic, between: [ground.origin, block.origin], {law}}}}}
initial: {{joints: {{rail: {start[0]}}}, rates: {{rail: {start[1]}}}}}
simulation: {{duration: {duration}, output_interval: {interval or duration}, method: {method}, rtol: {rtol}}}
""")
    )


@pytest.mark.parametrize("method", METHODS)
def test_dry_friction_takes_the_same_from_every_swing(method):
    """A block on a spring turns back by 2 F / k earlier after each half period pi / omega, a textbook result.

    k = 200 N/m, m = 2 kg: omega = 10 1/s; F = 3 N. It stops where the spring no longer moves it, |x| < F / k. The
    transition speed v_t blurs the reversal for a time of about v_t m / F: the error is of its order squared.
    """
    errors = []
    for transition_speed in (4e-3, 2e-3, 1e-3):
        law = f"spring: {{stiffness: 200}}, friction: {{coulomb: 3, transition_speed: {transition_speed}}}"
        run = block(law, (0.2, 0), 8 * np.pi / 10, method, interval=np.pi / 10)
        swings = np.arange(7)
        turns = (-1.0) ** swings * (0.2 - 2 * swings * 3 / 200)
        errors.append(np.abs(run["rail.x"][:7] - turns).max())
        assert np.abs(run["energy.balance"]).max() < 1e-7
        assert abs(run["rail.x"][-1]) < 3 / 200
        assert abs(run["rail.x.rate"][-1]) < transition_speed
    assert errors[-1] < 1e-5
    assert errors[0] / errors[2] > 12


def test_what_sticks_creeps_by_the_transition_speed():
    """Pulled by 1 N against 2 N of static friction, v = v_t artanh(1/2) when all has settled."""
    run = block("friction: {coulomb: 1.5, static: 2, stribeck_speed: 1, transition_speed: 1e-4}", (0, 0), 1)
    assert_allclose(run["rail.x.rate"], 0, atol=1e-12)
    model = run.model.with_("loads", {"pull": {"type": "force", "at": "block.origin", "force": [1, 0]}})
    assert_allclose(fmbd.simulate(model)["rail.x.rate"][-1], 1e-4 * np.arctanh(0.5), rtol=1e-6)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("transition", [1e-2, 1e-4])
def test_a_stop_gives_back_what_hunt_and_crossley_say(method, transition):
    """Speeds v before and v' after the impact obey G(b v) = G(-b v'), G(y) = y - ln(1 + y): the depth's part of the
    force, stiffness and mass do not matter. About (1 - 2/3 b v) v for small b v."""
    b, before = 0.9, 0.8
    law = f"limits: {{upper: 0.1, stiffness: 5000, damping: {b}, transition: {transition}}}"
    run = block(law, (0, before), 0.6, method)

    def G(y):
        return y - np.log1p(y)

    after = brentq(lambda v: G(b * before) - G(-b * v), 1e-6, before, xtol=1e-15)
    assert 0.5 < after < before
    assert_allclose(run["rail.x.rate"][-1], -after, rtol=1e-8)
    assert_allclose(run["energy.dissipated"][-1], 0.5 * 2 * (before**2 - after**2), rtol=1e-7)


@pytest.mark.parametrize("method", METHODS)
def test_a_pendulum_bounces_to_rest_on_its_stop(method):
    """Let go at the horizontal, it falls on a stop 0.5 rad past the vertical again and again; all energy is accounted
    for, and at last stiffness times depth is the weight's moment there."""
    changes = {
        "bodies.bob.inertia": 0.1,
        "joints.pivot.limits": {"upper": -0.5, "stiffness": 3e3, "damping": 0.5},
        "joints.pivot.friction": {"viscous": 0.6},
        "simulation": {"duration": 20, "rtol": 1e-9, "method": method},
    }
    run = simulate("pendulum.yaml", changes)
    angle, rate = run["pivot.angle"], run["pivot.angle.rate"]
    assert np.abs(run["energy.balance"]).max() < 1e-6
    assert np.all(np.diff(run["energy.dissipated"]) > -1e-9)
    assert np.sum((rate[1:] < 0) & (rate[:-1] > 0) & (angle[1:] > -0.52)) > 3
    depth = angle[-1] + 0.5
    assert_allclose(3e3 * depth, -9.81 * np.sin(angle[-1]), rtol=1e-6)
    assert_allclose(run["pivot.angle.stop_moment"][-1], 9.81 * np.sin(angle[-1]), rtol=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_backlash_lets_a_block_fly_from_flank_to_flank(method):
    """Half a vibration on each flank, free flight through the gap: T = 2 pi / omega + 2 gap / v, v = omega A.

    The rounding of the flanks, by 1e-4 m, changes energies by 0.025 k w^2, 1e-8 of what is here.
    """
    omega, gap, depth = 10.0, 0.3, 0.05
    period = 2 * np.pi / omega + 2 * gap / (omega * depth)
    law = f"spring: {{stiffness: 200, backlash: {{gap: {gap}, transition: 1e-4}}}}"
    run = block(law, (gap / 2 + depth, 0), 5 * period, method)
    assert_allclose(run["rail.x"][-1], gap / 2 + depth, rtol=0, atol=1e-8)
    assert_allclose(run["rail.x.rate"][-1], 0, atol=1e-4)
    assert abs(run["energy.balance"][-1]) < 1e-8


def test_rounded_flanks_against_quadrature():
    """T = 4 int dx / v with v from the energy, the force rounded over the whole gap."""
    law = "spring: {stiffness: 200, backlash: {gap: 0.1, transition: 0.1}}"

    def force(x):
        xi = np.clip((x - 0.05) / 0.1 + 0.5, 0, 1)
        return 200 * (0.1 * (xi**3 - xi**4 / 2) + max(x - 0.1, 0))

    def energy(x):
        return quad(force, 0, x, points=[min(0.1, x)], epsabs=1e-15, epsrel=1e-13)[0]

    top = energy(0.2)

    def slowness(phi):
        x = 0.2 * np.sin(phi)  # takes the root out of the integrand's end
        return 0.2 * np.cos(phi) / np.sqrt(top - energy(x))

    period = 4 * quad(slowness, 0, np.pi / 2 - 1e-12, points=[np.pi / 6], epsabs=1e-12, epsrel=1e-10)[0]
    run = block(law, (0.2, 0), period)
    assert_allclose(run["rail.x"][-1], 0.2, rtol=0, atol=1e-8)
    assert_allclose(run["rail.x.rate"][-1], 0, atol=1e-6)


def test_a_table_of_a_hardening_spring():
    """m x'' + k1 x + k3 x^3 = 0 from rest at A: x = A cn(Omega t, m), Omega^2 = (k1 + k3 A^2) / mass.

    A table of n points is off by the interpolation alone, of order 3.
    """
    k1, k3, A = 200.0, 4000.0, 0.3
    omega = np.sqrt((k1 + k3 * A**2) / 2)
    times = np.linspace(0, 1, 11)
    exact = A * ellipj(omega * times, k3 * A**2 / (2 * (k1 + k3 * A**2)))[1]
    errors = []
    for n in (51, 201):
        x = np.linspace(-0.4, 0.4, n)
        points = np.column_stack([x, k1 * x + k3 * x**3]).tolist()
        run = block(f"spring: {{force_table: {points}}}", (A, 0), 1, interval=0.1)
        errors.append(np.abs(run["rail.x"] - exact).max())
    assert errors[1] < 1e-5
    assert errors[0] / errors[1] > 4**2.5


def test_a_table_goes_on_straight_at_both_ends():
    """Two points are a linear spring, far beyond them, too; a force at rest moves the middle of the swings."""
    table = "{points: [[-0.01, -1], [0.02, 5]], interpolation: linear}"
    run = block(f"spring: {{force_table: {table}, rest: 0.2}}", (0.695, 0), 1, interval=0.1)
    assert_allclose(run["rail.x"], 0.195 + 0.5 * np.cos(10 * run.time), rtol=0, atol=1e-9)


def test_the_door_against_scipy():
    """The formulas of the model file's keys once more, for one degree of freedom: inertia 20 kg (0.9 m)^2 / 3."""
    run = simulate("door.yaml", {"simulation.rtol": 1e-10})

    def rates(t, y, push):
        angle, rate = y
        dry = 0.6 + (1 - 0.6) * np.exp(-((rate / 0.1) ** 2))
        moment = push * 0.81 - dry * np.tanh(rate / 1e-3) - 1.2 * rate - closer(angle)
        for side, depth in ((-1, angle - 1.9), (1, -angle)):
            if depth > -0.5e-3:
                xi = min(depth / 1e-3 + 0.5, 1)
                taken_up = 1e-3 * (xi**3 - xi**4 / 2) + max(depth - 0.5e-3, 0)
                moment += side * 4000 * taken_up * max(0, 1 - side * 0.4 * rate)
        return [rate, moment / (20 * 0.9**2 / 3)]

    points = np.array([[0, 6], [0.1, 5], [0.3, 4], [1, 4.5], [2, 7]]).T
    curve = PchipInterpolator(*points)

    def closer(angle):
        end = min(max(angle, 0), 2)
        return curve(end) + curve(end, 1) * (angle - end)

    y, expected = np.zeros(2), []
    for start, end, push in ((0, 0.2, 0), (0.2, 0.7, 38), (0.7, 6, 0)):
        times = run.time[(run.time > start - 1e-9) & (run.time < end + 1e-9)].clip(start, end)
        found = solve_ivp(rates, (start, end), y, "DOP853", times, args=(push,), rtol=1e-11, atol=1e-13)
        y = found.y[:, -1]
        expected += list(found.y[0, :-1])
    assert_allclose(run["hinge.angle"], [*expected, y[0]], rtol=0, atol=1e-7)
