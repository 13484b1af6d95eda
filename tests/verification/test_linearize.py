"""State spaces: closed forms, transients of runs, differences of equilibria; names and files."""

import csv
import json

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.io import loadmat
from scipy.linalg import expm
from simulation import load

import fmbd
from fmbd.model import load_model_text

SIDES = ("right", "left")


def motor():
    """R, L, K, J of dc_motor.yaml."""
    m = load("dc_motor.yaml").motors["motor"]
    return m.resistance, m.inductance, m.torque_constant, 0.3


def test_transfer_function_of_a_dc_motor():
    """w / U = K / (L J s^2 + R J s + K^2), i / U = J s / (the same)."""
    R, L, K, J = motor()
    space = fmbd.linearize(load("dc_motor.yaml"), outputs=["shaft.angle.rate", "motor.current"])
    assert space.inputs == (("motor.voltage", "V"),)
    assert [name for name, _ in space.states][-1] == "motor.current"
    f = np.geomspace(0.01, 1000, 30)
    s = 2j * np.pi * f
    below = L * J * s**2 + R * J * s + K**2
    response = space.frequency_response(f)[:, :, 0]
    assert_allclose(response[:, 0], K / below, rtol=1e-9)
    assert_allclose(response[:, 1], J * s / below, rtol=1e-9)
    exact = [0, *np.roots([L * J, R * J, K * K])]
    assert_allclose(np.sort_complex(space.poles()), np.sort_complex(exact), rtol=1e-9, atol=1e-9)
    assert np.isnan(space.gain()).all()  # of an angle that grows for ever


def test_a_load_on_a_cantilever():
    """w / F at rest: l^3 / 3EI; its bending moment at the clamp: l."""
    EI, length = 2.1e11 * 0.030 * 0.002**3 / 12, 0.5
    changes = {"loads": {"tip": {"type": "force", "at": "ruler.end", "force": [0, 0]}}, "signals": {}}
    outputs = ["ruler.end.position", "ruler.start.bending_moment"]
    space = fmbd.linearize(load("cantilever.yaml", changes), inputs=["tip.force.y"], outputs=outputs)
    assert [name for name, _ in space.outputs] == [
        "ruler.end.position.x",
        "ruler.end.position.y",
        "ruler.start.bending_moment",
    ]
    assert_allclose(space.gain()[:, 0], [0, length**3 / (3 * EI), length], rtol=1e-8, atol=1e-12)


def sprung_five_bar(place):
    """Rotors locked, as springs on the cranks that are relaxed where the effector is at (0.1, 0.6)."""
    start = fmbd.assemble(load("five_bar.yaml")).start.q
    springs = {
        f"joints.shoulder_{side}.spring": {"stiffness": 5000, "damping": 50, "rest": float(angle)}
        for side, angle in zip(SIDES, (start[1], start[6]))
    }
    changes = {"motors": {}, "controllers": {}, "gravity": [0, 0], "initial.place": {"effector": place}}
    changes |= {"simulation.duration": 0.2, "simulation.rtol": 1e-11, "simulation.atol": 1e-14}
    return load("five_bar.yaml", springs | changes)


TWO_BEAMS = """
fmbd: 1
gravity: [0, 0]
bodies:
  arm: {type: beam, length: 0.5, elements: 2, mass_per_length: 1, bending_stiffness: 30}
  rod: {type: beam, length: 1, elements: 4, mass_per_length: 1, bending_stiffness: 30}
joints:
  shoulder: {type: weld, between: [ground.origin, arm.start]}
  elbow: {type: weld, between: [arm.end, rod.start]}
loads:
  wind: {type: distributed, "on": rod, force: [0, 0], from: 0.1, to: 0.9}
  push: {type: force, at: rod.end, force: [0, 0]}
  rain: {type: distributed, "on": arm, force: [0, 0]}
"""


@pytest.mark.parametrize("segments", [1, 2])
def test_distributed_loads_on_several_beams_or_segments(segments):
    """Deflection of a cantilever of both lengths by q, from a to b: q x^2 (3 L - x) / 6 EI, integrated over x."""
    model = load_model_text(TWO_BEAMS, overrides={"bodies.*.segments": segments})
    found = fmbd.linearize(model, inputs=["wind.force.y", "rain.force.y"], outputs=["rod.end.position.y"])
    primitive = np.poly1d([-1, 3 * 1.5, 0, 0]).integ() / (6 * 30)
    expected = [primitive(1.4) - primitive(0.6), primitive(0.5)]
    assert_allclose(found.gain()[0], expected, rtol=1e-6)


def test_the_five_bar_settles_as_its_modes_say():
    """Let go beside its rest, all coordinates and rates follow expm(A t): two heavily damped joint modes, and beams.

    What is left is of second order, a quarter of it from half the distance.
    """
    space = fmbd.linearize(sprung_five_bar([0.1, 0.6]))
    names = [name for name, _ in space.states]
    start = space.base.linearisation.system.start.q
    rest = dict(zip(space.base.linearisation.system.coordinate_names, start))
    t = np.linspace(0, 0.2, 201)
    free = np.array([expm(space.A * x) for x in t])
    half = len(names) // 2

    def left(distance):
        run = fmbd.simulate(sprung_five_bar([0.1 + distance, 0.6]))
        assert_allclose(run.time, t, atol=1e-12)
        moved = np.stack([run[name] - rest.get(name, 0.0) for name in names], axis=-1)
        error, size = np.abs(free @ moved[0] - moved), np.abs(moved)
        return [np.max(error[:, part]) / np.max(size[:, part]) for part in (slice(half), slice(half, None))]

    far, near = np.array(left(1e-5)), np.array(left(5e-6))
    assert np.all(near < 2e-4)
    assert_allclose(far / near, 2, rtol=0.05)
    fast = [pole for pole in space.poles() if pole.imag > 0 and -pole.real / abs(pole) > 0.5]
    assert_allclose([-p.real / abs(p) for p in sorted(fast, key=abs)], [0.55, 0.68], atol=5e-3)


def test_gains_are_differences_of_equilibria():
    """Under a load on the effector, controllers at work: positions, reactions, voltages, at first order."""
    outputs = ["rod_right.end.position", "effector.force", "motor_left.voltage", "rod_left.bending_moment"]

    def robot(fx, fy):
        push = {"type": "force", "at": "rod_right.end", "force": [fx, fy]}
        return load("five_bar.yaml", {"loads": {"push": push}})

    def rest(*force):
        found = fmbd.equilibrium(robot(*force))
        return np.concatenate([np.atleast_1d(found[name]) for name in outputs])

    space = fmbd.linearize(robot(1, -2), inputs=["push.force.x", "push.force.y"], outputs=outputs)
    h = 1e-3
    expected = [
        (rest(1 + h, -2) - rest(1 - h, -2)) / (2 * h),
        (rest(1, -2 + h) - rest(1, -2 - h)) / (2 * h),
    ]
    assert_allclose(space.gain().T, expected, rtol=0, atol=1e-6 * np.abs(expected).max())


def test_the_torque_of_a_held_motor_is_an_output():
    """The left rotor held: what its shaft must take when the effector is pushed, from equilibria."""

    def robot(fx):
        push = {"type": "force", "at": "rod_right.end", "force": [fx, 0]}
        return load("five_bar.yaml", {"loads": {"push": push}})

    outputs = ["motor_left.torque", "effector.force"]
    space = fmbd.linearize(robot(0), inputs=["push.force.x"], outputs=outputs, lock=["motor_left"])

    def rest(fx):
        found = fmbd.equilibrium(robot(fx), lock=["motor_left"])
        return np.array([found["motor_left.torque"], *found["effector.force"]])

    assert_allclose(space.gain()[:, 0], (rest(1e-3) - rest(-1e-3)) / 2e-3, rtol=0, atol=1e-6)
    assert ("motor_left.voltage", "V") not in fmbd.linearize(robot(0), lock=["motor_left"]).inputs


def test_motors_without_controllers_are_let_go_at_the_voltage_that_holds():
    """Trimmed where it stands, a step of voltage moves the robot as the nonlinear equations say, to second order."""
    idle = {"controllers": {}, "motors.*.voltage": 0, "motors.*.transmission.damping": 50}
    space = fmbd.linearize(load("five_bar.yaml", idle))
    assert space.base.constant == ("motor_right", "motor_left")
    lin = space.base.linearisation
    trim = dict(zip(("right", "left"), lin.arrangement.inputs()))
    step = 1e-3
    fed = {f"motors.motor_{side}.voltage": float(trim[side] + step * (side == "right")) for side in SIDES}
    system = fmbd.assemble(load("five_bar.yaml", idle | fed))
    q0 = lin.state[0]

    def rate(t, y):
        q, v = np.split(y, 2)
        return np.concatenate([v, system.accelerations(q, v, t)[0]])

    t = np.linspace(0, 0.1, 11)
    moved = solve_ivp(rate, (0, t[-1]), np.append(q0, 0 * q0), "DOP853", t, rtol=1e-10, atol=1e-14).y
    columns = [system.coordinate_names.index(name) for name, _ in space.states[: q0.size - 2]]
    exact = (moved[: q0.size].T - q0)[:, columns]
    n, u = len(space.A), step * space.B[:, 0]
    whole = np.block([[space.A, u[:, None]], [np.zeros((1, n + 1))]])
    linear = np.array([(expm(whole * x) @ np.eye(n + 1)[n])[: len(columns)] for x in t])
    assert np.abs(linear - exact).max() < 1e-4 * np.abs(exact).max()


def test_open_loop_takes_the_controllers_out():
    """The five-bar at its target: with them it is stable, at the constant voltages that hold it it falls."""
    closed, opened = (fmbd.linearize(load("five_bar.yaml"), open_loop=opened) for opened in (False, True))
    assert closed.poles().real.max() < 0 < opened.poles().real.max()
    assert_allclose(opened.B, closed.B, rtol=1e-7, atol=1e-12)
    Km, Ra, inertia, kd = 1, 3, 0.1, 1.2
    row = [name for name, _ in closed.states].index("motor_right.rotor.rate")
    assert_allclose(closed.A[row, row] - opened.A[row, row], -Km / Ra * kd / inertia, rtol=1e-6)


def test_files_of_a_state_space(tmp_path):
    space = fmbd.linearize(load("five_bar.yaml"), outputs=["rod_right.end.position"])
    f = np.array([0.1, 1.0, 10.0])
    for suffix in ("npz", "mat", "json", "csv", "h5"):
        space.save(tmp_path / f"space.{suffix}", f)
    mat = loadmat(tmp_path / "space.mat", squeeze_me=True)
    with np.load(tmp_path / "space.npz") as npz:
        for name in ("A", "B", "C", "D", "response"):
            expected = getattr(space, name) if name != "response" else space.frequency_response(f)
            assert_allclose(npz[name], expected, rtol=0)
            assert_allclose(mat[name], expected, rtol=0)
    assert mat["inputs"].tolist() == ["motor_right.voltage", "motor_left.voltage"]
    assert mat["output_units"].tolist() == ["m", "m"]
    assert json.loads((tmp_path / "space.json").read_text())["states"] == [name for name, _ in space.states]
    head, *rows = csv.reader((tmp_path / "space.csv").read_text().splitlines())
    values = np.array([row[1:] for row in rows], float)
    n = len(space.A)
    assert head[1 : n + 1] == [name for name, _ in space.states]
    assert_allclose(values[:n, :n], space.A, rtol=0)
    assert_allclose(values[n:, :n], space.C, rtol=0)


def test_unknown_names():
    with pytest.raises(
        fmbd.UnknownQuantity, match=r"unknown input 'motor_right\.volts', did you mean 'motor_right\.voltage'"
    ):
        fmbd.linearize(load("five_bar.yaml"), inputs=["motor_right.volts"])
    with pytest.raises(fmbd.UnknownQuantity, match=r"no quantity .rod_right\.end\.positions"):
        fmbd.linearize(load("five_bar.yaml"), outputs=["rod_right.end.positions"])
    with pytest.raises(fmbd.UnknownQuantity, match="unknown motor 'arm'"):
        fmbd.modes(load("five_bar.yaml"), lock="arm")
