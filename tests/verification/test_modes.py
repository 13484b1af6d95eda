"""Modes against closed forms and published numbers: loops, gravity, rotating frames, dampers, motors, controllers."""

import csv
import json

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq, fsolve
from simulation import G, load, model, revolute, table_on_three_cranks

import fmbd

BALL = {"type": "rigid", "mass": 2, "inertia": 0.1}
UNDAMPED = {"motors.*.transmission.damping": 0, "gravity": [0, 0]}


def bob(length, mass=1.0):
    """A point mass at the end of a massless bar along x."""
    return {
        "type": "rigid",
        "mass": mass,
        "inertia": 0,
        "center_of_mass": [length, 0],
        "points": {"end": [length, 0]},
    }


def pendulum(angle, **joint):
    return model(
        gravity=[0, -G],
        bodies={"bob": bob(0.8, 1.5)},
        joints={"hinge": revolute("ground.origin", "bob.origin", **joint)},
        initial={"joints": {"hinge": angle}},
    )


@pytest.mark.parametrize("about", ["start", "equilibrium"])
@pytest.mark.parametrize(
    ("elements", "published"),
    [
        (1, [17.42257581, 21.56384950, 31.10460328, 31.57804725, 141.68161402, 142.42931145]),
        (8, [17.38327390, 21.52835713, 28.06731689, 28.50338863, 111.44666007, 111.96102731]),
    ],
)
def test_five_bar_with_locked_rotors(elements, published, about):
    """Computed for this project by another program (minimal coordinates, exact loop closure)."""
    robot = load("five_bar.yaml", UNDAMPED | {"bodies.*.elements": elements})
    found = fmbd.modes(robot, about=about, lock="all")
    assert_allclose(found.frequencies[:6], published, rtol=0, atol=1e-8)
    assert np.abs(found.damping_ratios).max() < 1e-9


def test_low_frequencies_survive_high_ones():
    """40 elements a rod, up to 0.2 MHz: the first six are those of the continuum (exact beam functions)."""
    robot = load("five_bar.yaml", UNDAMPED | {"bodies.*.elements": 40})
    found = fmbd.modes(robot, about="start", lock="all").frequencies
    continuum = [17.3832634601, 21.5283483340, 28.0668659431, 28.5029329125, 111.4177309997, 111.9319859889]
    assert_allclose(found[:6], continuum, rtol=5e-7)
    assert_allclose(found[0], continuum[0], rtol=2e-9)


def test_damped_joint_modes_of_the_five_bar():
    """The same program: transmissions of 50 N m s/rad damp the two joint modes by 0.55 and 0.68, the beams hardly."""
    found = fmbd.modes(load("five_bar.yaml", {"gravity": [0, 0]}), about="start", lock="all")
    assert_allclose(found.damping_ratios[:2], [0.55, 0.68], atol=5e-3)
    decay = 1 / found.decay_times[2:]
    assert decay.min() > 0.05
    assert decay.max() < 3


def test_a_beam_of_eight_elements():
    """(beta l)^2 sqrt(EI / rho A l^4), beta l = 1.87510406871, to 1e-5; a chord frame gives the same."""
    EI, mass, length = 2.1e11 * 0.030 * 0.002**3 / 12, 7850 * 0.030 * 0.002, 0.5
    changes = {"loads": {}, "signals": {}, "bodies.ruler.elements": 8, "bodies.ruler.damping": {}}
    exact = 1.87510406871**2 * np.sqrt(EI / (mass * length**4)) / (2 * np.pi)
    for frame in ("clamped", "chord"):
        found = fmbd.modes(load("cantilever.yaml", changes | {"bodies.ruler.frame": frame}))
        assert_allclose(found.frequencies[0], exact, rtol=1e-5)


def test_a_pendulum_hangs_and_is_damped():
    """omega^2 = g / l, 2 zeta omega = d / m l^2."""
    found = fmbd.modes(pendulum(-1.0, friction=0.3))
    omega = np.sqrt(G / 0.8)
    assert_allclose(2 * np.pi * found.frequencies, [omega], rtol=1e-9)
    assert_allclose(found.damping_ratios, [0.3 / (1.5 * 0.64) / (2 * omega)], rtol=1e-9)
    assert found.stable


def test_an_upright_pendulum_falls():
    """exp(+- sqrt(g / l) t)."""
    found = fmbd.modes(pendulum(np.pi / 2), about="start")
    assert_allclose(np.sort(found.poles.real), np.array([-1, 1]) * np.sqrt(G / 0.8), rtol=1e-9)
    assert not found.stable
    assert found.base.remarks == ()


def test_the_distance_from_equilibrium_is_remarked():
    """Newton's step from 0.1 rad beside the vertical is tan 0.1."""
    [remark] = fmbd.modes(pendulum(-np.pi / 2 + 0.1), about="start").base.remarks
    assert "not at rest: hinge.angle is accelerated by -1.22" in remark
    assert "an equilibrium is about 0.1 away (hinge.angle)" in remark


def test_a_double_pendulum():
    """Equal bars and point masses: omega^2 = (2 -+ sqrt 2) g / l, amplitudes 1 : +- sqrt 2."""
    found = fmbd.modes(
        model(
            gravity=[0, -G],
            bodies={"a": bob(0.5), "b": bob(0.5)},
            joints={"first": revolute("ground.origin", "a.origin"), "second": revolute("a.end", "b.origin")},
            initial={"joints": {"first": -1.5}},
        )
    )
    omega2 = (2 + np.array([-1, 1]) * np.sqrt(2)) * G / 0.5
    assert_allclose((2 * np.pi * found.frequencies) ** 2, omega2, rtol=1e-9)
    absolute = (found.shapes[:, 1] + found.shapes[:, 0]) / found.shapes[:, 0]  # the second angle is relative
    assert_allclose(absolute, [np.sqrt(2), -np.sqrt(2)], rtol=1e-8)


def rotating(rate):
    """A ball on two springs in a frame that turns; its own turning has a third."""
    springs = {"x": {"stiffness": 50}, "y": {"stiffness": 80}, "angle": {"stiffness": 0.9}}
    loose = {"type": "free", "between": ["hub.origin", "ball.origin"], "spring": springs}
    return model(
        bodies={"hub": {"type": "rigid", "mass": 1, "inertia": 1}, "ball": BALL},
        joints={"spin": revolute("ground.origin", "hub.origin", driven=f"{rate}*t"), "loose": loose},
    )


@pytest.mark.parametrize("rate", [0.0, 2.0, 5.5])
@pytest.mark.parametrize("about", ["start", "equilibrium"])
def test_coriolis_forces_couple_the_motions_in_a_rotating_frame(rate, about):
    """(kx/m - W^2 - w^2) (ky/m - W^2 - w^2) = 4 W^2 w^2; between sqrt(kx/m) = 5 and sqrt(ky/m) = 6.3 it is unstable."""
    found = fmbd.modes(rotating(rate), about=about, moving=True)
    a, b = 25 - rate**2, 40 - rate**2
    w2 = np.roots([1, -(a + b + 4 * rate**2), a * b])
    exact = np.concatenate([1j * np.sqrt(w2.astype(complex)), [3j]])
    exact = np.where(exact.imag > 0, exact, -exact)
    expected = sorted([*exact, *(-p for p in exact if p.imag == 0)], key=abs)
    assert_allclose(sorted(found.poles, key=abs), expected, rtol=1e-9, atol=1e-9)
    assert found.stable == (rate != 5.5)


def test_a_mass_in_a_rotating_slot():
    """omega^2 = k/m - W^2, where the turning has taken it."""
    slide = {"type": "prismatic", "between": ["hub.origin", "ball.origin"]}
    slot = model(
        bodies={"hub": {"type": "rigid", "mass": 1, "inertia": 1}, "ball": BALL},
        joints={
            "spin": revolute("ground.origin", "hub.origin", driven="3*t"),
            "slide": slide | {"spring": {"stiffness": 50, "rest": 0.2}},
        },
    )
    found = fmbd.modes(slot, moving=True)
    assert_allclose(2 * np.pi * found.frequencies, [4.0], rtol=1e-9)


BARS = {"crank": 0.3, "coupler": 0.8, "rocker": 0.6}
BASE, STIFFNESS, REST = 0.7, 30.0, 1.2


def test_a_four_bar_on_a_spring():
    """omega^2 = V'' / m by the crank's angle, both from the geometry of the loop, solved here on its own."""
    bodies = {
        name: {
            "type": "rigid",
            "mass": 2,
            "shape": {"type": "rod", "length": length},
            "points": {"end": [length, 0]},
        }
        for name, length in BARS.items()
    }
    found = fmbd.modes(
        model(
            gravity=[0, -G],
            ground={"points": {"far": [BASE, 0]}},
            bodies=bodies,
            joints={
                "shaft": revolute(
                    "ground.origin", "crank.origin", spring={"stiffness": STIFFNESS, "rest": REST}
                ),
                "elbow": revolute("crank.end", "coupler.origin"),
                "wrist": revolute("coupler.end", "rocker.end"),
                "foot": revolute("ground.far", "rocker.origin"),
            },
            initial={"joints": {"shaft": 1.0}, "hints": {"elbow": -0.5, "foot": 1.5}},
        )
    )
    start = found.base.linearisation.system.start
    names = found.coordinates

    def angles(crank):
        """Of coupler and rocker, in the assembly mode of the model."""

        def gap(x):
            ends = [BARS[n] * np.exp(1j * a) for n, a in zip(BARS, (crank, x[0], x[1]))]
            miss = ends[0] + ends[1] - ends[2] - BASE
            return miss.real, miss.imag

        guess = start.q[names.index("shaft.angle")] + start.q[names.index("elbow.angle")]
        return fsolve(gap, [guess, 1.5], xtol=1e-12)

    def centres(crank):
        a = (crank, *angles(crank))
        first, second, third = (BARS[n] / 2 * np.exp(1j * x) for n, x in zip(BARS, a))
        return np.array([first, 2 * first + second, BASE + third]), np.array(a)

    def V(crank):
        return 0.5 * STIFFNESS * (crank - REST) ** 2 + 2 * G * centres(crank)[0].imag.sum()

    h = 1e-3

    def slope(crank):
        return (8 * (V(crank + h) - V(crank - h)) - (V(crank + 2 * h) - V(crank - 2 * h))) / (12 * h)

    rest = brentq(slope, 0.5, 1.6, xtol=1e-14)
    curvature = (8 * (slope(rest + h) - slope(rest - h)) - (slope(rest + 2 * h) - slope(rest - 2 * h))) / (
        12 * h
    )
    (right, a), (left, b) = centres(rest + h), centres(rest - h)
    speed, turning = np.abs(right - left) / (2 * h), (a - b) / (2 * h)
    inertia = sum(2 * (s**2 + w**2 * BARS[n] ** 2 / 12) for n, s, w in zip(BARS, speed, turning))
    assert_allclose(2 * np.pi * found.frequencies, [np.sqrt(curvature / inertia)], rtol=1e-6)


def test_a_table_on_three_cranks():
    """A redundant crank changes nothing: omega^2 = (k - m g l sin(angle)) / (m l^2 + 3 J)."""
    found = fmbd.modes(table_on_three_cranks())
    angle = brentq(lambda a: 40 * (a - 1.2) + 3 * G * 0.5 * np.cos(a), 0, 2)
    omega2 = (40 - 3 * G * 0.5 * np.sin(angle)) / (3 * 0.25 + 3 * 0.1)
    assert_allclose((2 * np.pi * found.frequencies) ** 2, [omega2], rtol=1e-9)


def test_a_motor_brakes_by_its_back_emf():
    """Free to turn: a pole 0; Km Ke / Ra J; with inductance the roots of L J s^2 + R J s + K^2; held: none."""
    changes = {"motors.motor.inductance": 0}
    motor = load("dc_motor.yaml").motors["motor"]
    K, R, J = motor.torque_constant, motor.resistance, 0.3
    simple = fmbd.modes(load("dc_motor.yaml", changes), about="start")
    assert_allclose(simple.poles, [0, -K * K / (R * J)], rtol=1e-9, atol=1e-12)
    whole = fmbd.modes(load("dc_motor.yaml"), about="start")
    exact = np.roots([motor.inductance * J, R * J, K * K])
    assert_allclose(whole.poles, [0, exact[exact.imag > 0][0]], rtol=1e-9, atol=1e-12)
    assert whole.decay_times[0] == np.inf
    assert fmbd.modes(load("dc_motor.yaml"), about="start", lock="all").poles.size == 0


@pytest.mark.parametrize("about", ["start", "equilibrium"])
def test_gravity_compensated_online_takes_gravity_out(about):
    """The arm obeys J a'' = kp (target - a) - kd a' alone, wherever it is: its derivative counts, too."""
    motor = {"type": "torque", "joint": "hinge", "torque": "hold"}
    law = {"type": "pd", "kp": 20, "kd": 1.2, "target": 0.5}
    law |= {"feedforward": {"type": "gravity_compensation", "computed": "online"}}
    found = fmbd.modes(
        model(
            gravity=[0, -G],
            bodies={"bob": bob(0.8, 1.5)},
            joints={"hinge": revolute("ground.origin", "bob.origin")},
            motors={"motor": motor},
            controllers={"hold": law},
            initial={"joints": {"hinge": -0.3}},
        ),
        about=about,
    )
    J = 1.5 * 0.64
    exact = np.roots([J, 1.2, 20])
    assert_allclose(found.poles, exact[exact.imag > 0], rtol=1e-8)


def test_a_state_of_a_run():
    """A pendulum swings through 0.4 rad: J s^2 = -m g l cos(0.4) there, whatever its speed."""
    swing = pendulum(-np.pi / 2 + 0.8).with_("simulation.duration", 2)
    run = fmbd.simulate(swing)
    k = int(np.abs(run["hinge.angle"] + np.pi / 2 - 0.4).argmin())
    found = fmbd.modes(swing, about=run, time=float(run.time[k]))
    omega2 = G / 0.8 * np.cos(run["hinge.angle"][k] + np.pi / 2)
    assert_allclose((2 * np.pi * found.frequencies) ** 2, [omega2], rtol=1e-9)
    assert found.base.place == f"the state of the run at t = {run.time[k]:g} s"
    assert any("in motion" in remark for remark in found.base.remarks)


def test_files_of_modes(tmp_path):
    from scipy.io import loadmat

    found = fmbd.modes(load("five_bar.yaml"))
    for suffix in ("json", "csv", "npz", "mat"):
        found.save(tmp_path / f"modes.{suffix}")
    with np.load(tmp_path / "modes.npz") as file:
        assert_allclose(file["shapes"], found.shapes, rtol=0)
        assert file["coordinates"].tolist() == found.coordinates
    mat = loadmat(tmp_path / "modes.mat", squeeze_me=True)
    assert_allclose(mat["poles"], found.poles, rtol=0)
    assert mat["coordinates"].tolist() == found.coordinates
    written = json.loads((tmp_path / "modes.json").read_text())
    assert_allclose(written["poles"], np.stack([found.poles.real, found.poles.imag], axis=-1), rtol=0)
    rows = list(csv.DictReader((tmp_path / "modes.csv").read_text().splitlines()))
    assert_allclose([float(row["frequency[Hz]"]) for row in rows], found.frequencies, rtol=0)
    assert_allclose([float(row["rod_left.w1.im"]) for row in rows], found.shapes[:, 8].imag, rtol=0)
