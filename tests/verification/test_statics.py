"""Equilibria: the locked five-bar, closed forms, energies, rotating frames; what is said where there is none."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from simulation import G, load, model, revolute, table_on_three_cranks

import fmbd

ROD = {"type": "rigid", "mass": 2, "inertia": 0.1, "center_of_mass": [0.3, 0], "points": {"end": [0.6, 0]}}
MASS = {"type": "rigid", "mass": 2, "inertia": 0.1}


def pendulum(angle, **joint):
    """A rod hinged at the origin, from an angle to the horizontal."""
    hinge = revolute("ground.origin", "rod.origin", **joint)
    return model(
        gravity=[0, -G], bodies={"rod": ROD}, joints={"hinge": hinge}, initial={"joints": {"hinge": angle}}
    )


@pytest.mark.parametrize(
    ("elements", "right", "left"),
    [
        (1, [-9.878351061e-4, -4.064593425e-3], [1.0751284830e-3, 4.414918722e-3]),
        (4, [-9.881975895e-4, -4.065681382e-3], [1.0754278326e-3, 4.415817090e-3]),
    ],
)
def test_tips_of_the_locked_five_bar(elements, right, left):
    """Computed for this project by another program (minimal coordinates, exact loop closure)."""
    rest = fmbd.equilibrium(load("five_bar.yaml", {"bodies.*.elements": elements}), lock="all")
    for side, tip in (("right", right), ("left", left)):
        found = [rest[f"rod_{side}.w{elements}"], rest[f"rod_{side}.slope{elements}"]]
        assert_allclose(found, tip, rtol=1e-9)
    assert rest.verdict == "stable"
    assert rest.residual < 1e-11


def test_torques_that_hold_the_five_bar_are_the_slope_of_its_energy():
    """dV = sum of tau dphi, V by gravity and beams of equilibria whose rotors are held a little farther on.

    The weight of all links, 2 (3 + 0.12204 + 0.25) kg, is what the ground carries.
    """
    rest = fmbd.equilibrium(load("five_bar.yaml"), lock="all")
    h = 1e-3

    def energy(right, left):
        start = {"shoulder_right": float(right), "shoulder_left": float(left)}
        changes = {"initial.place": {}, "initial.joints": start}
        moved = fmbd.equilibrium(load("five_bar.yaml", changes), lock="all")
        return moved["energy.potential"] + moved["energy.elastic"]

    angles = [rest["motor_right.rotor"] / 10, rest["motor_left.rotor"] / 10]
    for k, side in enumerate(("right", "left")):
        step = np.eye(2)[k] * h
        slope = (energy(*(angles + step)) - energy(*(angles - step))) / (2 * h)
        assert_allclose(rest[f"motor_{side}.torque"] * 10, slope, rtol=1e-5)
        assert_allclose(rest[f"motor_{side}.voltage"], 3 * slope / 10, rtol=1e-5)
    carried = rest["shoulder_right.force"] + rest["shoulder_left.force"]
    weight = 2 * (3 + 2712 * 0.030 * 0.003 * 0.5 + 0.25) * G
    assert_allclose(-carried, [0, weight], rtol=0, atol=1e-10)


def test_motors_are_held_where_the_mechanism_could_move():
    """Without a controller the robot would fall, with one it goes to its target; a pendulum's motor holds it up."""
    idle = {"controllers": {}, "motors.*.voltage": 0}
    held = fmbd.equilibrium(load("five_bar.yaml", idle))
    assert held.locked == ("motor_right", "motor_left")
    assert_allclose(held["motor_right.rotor"], 9.812119840162299, rtol=1e-12)
    controlled = fmbd.equilibrium(load("five_bar.yaml"))
    assert controlled.locked == ()
    assert_allclose(controlled["effector.angle"], controlled.run["effector.angle"][0])
    assert_allclose(controlled["rod_right.end.position"], [-0.1, 0.7], atol=6e-4)  # and the links bend


def test_a_free_motor_lets_the_robot_fall():
    """Where the rotors end up, no torque is left in the transmissions."""
    rest = fmbd.equilibrium(load("five_bar.yaml", {"controllers": {}, "motors.*.voltage": 0}), lock="none")
    assert rest.verdict == "stable"
    assert_allclose([rest[f"motor_{side}.transmission_torque"] for side in ("right", "left")], 0, atol=1e-9)


@pytest.mark.parametrize("start", [0.0, 1.5, 3.0])
def test_a_pendulum_comes_to_hang(start):
    """From wherever it is let go, not to the upright position; stiffness m g s / J, J = 0.1 + 2 x 0.09 kg m^2."""
    rest = fmbd.equilibrium(pendulum(start))
    assert_allclose(np.cos(rest["hinge.angle"]), 0, atol=1e-12)
    assert_allclose(rest["rod.end.position"], [0, -0.6], atol=1e-12)
    assert_allclose(rest.stiffness, 2 * G * 0.3 / 0.28, rtol=1e-9)
    assert_allclose(rest["hinge.force"], [0, -2 * G], atol=1e-12)  # on the ground


def test_the_upright_pendulum_is_called_unstable():
    rest = fmbd.equilibrium(pendulum(np.pi / 2))
    assert rest.verdict == "unstable"
    assert_allclose(rest["hinge.angle"], np.pi / 2, rtol=1e-14)
    assert_allclose(rest.stiffness, -2 * G * 0.3 / 0.28, rtol=1e-9)


def test_a_pendulum_on_a_spring():
    """k (angle - rest) + m g s cos(angle) = 0."""
    rest = fmbd.equilibrium(pendulum(1.0, spring={"stiffness": 7, "rest": 0.4}))
    exact = brentq(lambda a: 7 * (a - 0.4) + 2 * G * 0.3 * np.cos(a), -1, 1)
    assert_allclose(rest["hinge.angle"], exact, rtol=1e-12)
    assert_allclose(rest["hinge.angle.spring_moment"], -7 * (exact - 0.4), rtol=1e-12)


def test_a_table_on_three_cranks():
    """One crank is redundant: k (angle - rest) + m g l cos(angle) = 0."""
    rest = fmbd.equilibrium(table_on_three_cranks())
    exact = brentq(lambda a: 40 * (a - 1.2) + 3 * G * 0.5 * np.cos(a), 0, 2)
    assert_allclose([rest[f"foot{k}.angle"] for k in range(3)], exact, rtol=1e-10)
    carried = sum(rest[f"foot{k}.force"] for k in range(3))
    assert_allclose(carried, [0, -6 * G], atol=1e-9)  # table and three cranks


@pytest.mark.parametrize("elements", [1, 5])
def test_cantilever_under_a_tip_force(elements):
    """F l^3 / 3EI, and the clamp carries the force and its moment."""
    F, EI, length = 3.0, 2.1e11 * 0.030 * 0.002**3 / 12, 0.5
    load_ = {"type": "force", "at": "ruler.end", "force": [0, F]}
    changes = {"loads": {"tip": load_}, "signals": {}, "bodies.ruler.elements": elements}
    rest = fmbd.equilibrium(load("cantilever.yaml", changes))
    assert_allclose(rest["ruler.end.deflection"], F * length**3 / (3 * EI), rtol=1e-11)
    [clamp] = rest.run.model.joints
    assert_allclose(rest[f"{clamp}.force"], [0, F], atol=1e-9)
    assert_allclose(rest[f"{clamp}.moment"], F * length, rtol=1e-9)


def test_a_load_is_taken_at_its_time():
    """The cantilever's force grows with time: at half of it half the deflection."""
    load_ = {"type": "force", "at": "ruler.end", "force": [0, "2*t"]}
    changes = {"loads": {"tip": load_}, "signals": {}}
    early, late = (fmbd.equilibrium(load("cantilever.yaml", changes), time=t) for t in (0.5, 1.0))
    assert_allclose(2 * early["ruler.end.deflection"], late["ruler.end.deflection"], rtol=1e-12)


def slot(rate):
    """A mass in a slot that turns, on a spring whose rest is at 0.2 m."""
    hub = {"type": "rigid", "mass": 1, "inertia": 1}
    slide = {"type": "prismatic", "between": ["hub.origin", "ball.origin"]}
    return model(
        bodies={"hub": hub, "ball": MASS},
        joints={
            "spin": revolute("ground.origin", "hub.origin", driven=f"{rate}*t"),
            "slide": slide | {"spring": {"stiffness": 50, "rest": 0.2}},
        },
    )


def test_a_mass_in_a_rotating_slot():
    """k (x - rest) = m x w^2 as it turns; where it stands still the spring is slack, and that is remarked."""
    turning = fmbd.equilibrium(slot(3), moving=True)
    assert_allclose(turning["slide.x"], 50 * 0.2 / (50 - 2 * 9), rtol=1e-12)
    standing = fmbd.equilibrium(slot(3), time=1.0)
    assert_allclose(standing["slide.x"], 0.2, rtol=1e-12)
    assert_allclose(standing["ball.origin.position"], [0.2 * np.cos(3), 0.2 * np.sin(3)], rtol=1e-12)
    assert any("spin.angle stands still" in remark for remark in standing.remarks)


def driven_slider_crank():
    crank = {"type": "rigid", "mass": 1, "inertia": 0.1, "points": {"pin": [0.2, 0]}}
    rod = {"type": "rigid", "mass": 1, "inertia": 0.1, "points": {"end": [0.5, 0]}}
    return model(
        gravity=[0, -G],
        bodies={"crank": crank, "rod": rod},
        joints={
            "shaft": revolute("ground.origin", "crank.origin", driven="2*t"),
            "pin": revolute("crank.pin", "rod.origin"),
            "slider": {"type": "pin_in_slot", "between": ["ground.origin", "rod.end"]},
        },
        initial={"hints": {"pin": 0.1, "slider": {"x": 0.7}}},
    )


def test_a_crank_is_brought_to_its_place():
    """A driven crank in a closed loop: the slider is at r cos(a) + sqrt(l^2 - r^2 sin(a)^2)."""
    rest = fmbd.equilibrium(driven_slider_crank(), time=1.3)
    a = 2.6
    assert_allclose(rest["slider.x"], 0.2 * np.cos(a) + np.sqrt(0.25 - 0.04 * np.sin(a) ** 2), rtol=1e-11)
    # virtual work: the rod's weight is at the pin
    assert_allclose(rest["shaft.angle.driving_moment"], G * 0.2 * np.cos(a), rtol=1e-9)


def test_a_loop_does_not_stand_still_beside_its_crank():
    """While the crank turns pin and slider must move: no equilibrium, even without anything that is free to move."""
    with pytest.raises(fmbd.AnalysisError, match=r"shaft\.angle moves by 2 a second .* loop at pin\.y"):
        fmbd.equilibrium(driven_slider_crank(), moving=True)


def test_what_falls_for_ever_is_named():
    loose = {"type": "free", "between": ["ground.origin", "ball.origin"]}
    with pytest.raises(fmbd.AnalysisError, match=r"nothing stops loose\.y, which can move freely"):
        fmbd.equilibrium(model(gravity=[0, -G], bodies={"ball": MASS}, joints={"loose": loose}))
    motor = {"motor": {"type": "torque", "joint": "hinge", "torque": 9}}
    spun = {
        "gravity": [0, -G],
        "bodies": {"rod": ROD},
        "joints": {"hinge": revolute("ground.origin", "rod.origin")},
    }
    with pytest.raises(fmbd.AnalysisError, match=r"nothing stops hinge\.angle; from 0 it went to"):
        fmbd.equilibrium(model(**spun, motors=motor), lock="none")  # m g s is 5.9 N m
    still = fmbd.equilibrium(model(bodies={"ball": MASS}, joints={"loose": loose}))
    assert still.verdict == "indifferent"
    assert set(still.softest) == {"loose.x", "loose.y", "loose.angle"}


def test_files_of_an_equilibrium(tmp_path):
    import csv
    import json

    import h5py

    rest = fmbd.equilibrium(pendulum(1.0))
    for suffix in ("h5", "json", "csv"):
        rest.save(tmp_path / f"rest.{suffix}")
    place = rest["rod.end.position"].tolist()
    with h5py.File(tmp_path / "rest.h5") as file:
        assert file["quantities/rod.end.position"][:].tolist() == place
    written = json.loads((tmp_path / "rest.json").read_text())
    assert written["quantities"]["rod.end.position"] == place
    assert written["units"]["rod.end.position"] == "m"
    rows = {
        name: float(value)
        for name, _, value in list(csv.reader((tmp_path / "rest.csv").read_text().splitlines()))[1:]
    }
    assert [rows["rod.end.position.x"], rows["rod.end.position.y"]] == place
    with pytest.raises(ValueError, match=r"does not end in \.h5, \.json, \.csv"):
        rest.save("rest.txt")
