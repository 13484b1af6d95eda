"""Inverse dynamics: closed forms, and the motion that comes back when the motors are fed with what was found."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline
from simulation import G, columns, load, model, revolute

import fmbd
from fmbd.analyses.prescribed import read_file

L, M, J = 0.6, 2.0, 0.1
ROD = {"type": "rigid", "mass": M, "inertia": J, "center_of_mass": [L, 0], "points": {"end": [L, 0]}}
#: From one end of the paper's move to the other, in a second.
ACROSS = [
    "{type: smooth_step, end: 1, from: 0.1, to: -0.1}",
    "{type: smooth_step, end: 1, from: 0.6, to: 0.7}",
]
TIGHT = {"simulation.rtol": 1e-10, "simulation.atol": 1e-10, "simulation.method": "dop853"}


def pendulum(motor, **joint):
    """A mass at the end of an arm, lifted by a motor."""
    return model(
        gravity=[0, -G],
        bodies={"rod": ROD},
        joints={"hinge": revolute("ground.origin", "rod.origin", **joint)},
        motors={"motor": {"joint": "hinge", **motor}},
        initial={"joints": {"hinge": 0.2}},
        simulation={"duration": 1, **{key.split(".")[1]: value for key, value in TIGHT.items()}},
    )


def lift(t):
    """Angle, rate, acceleration of 0.2 + 0.5 t^3."""
    return 0.2 + 0.5 * t**3, 1.5 * t**2, 3.0 * t


def rigid_five_bar():
    """The five-bar with rigid rods and gears, without dampers; its motors as they are."""
    rod = {
        "type": "rigid",
        "mass": 2712 * 9e-5 * 0.5,
        "inertia": 2712 * 9e-5 * 0.5**3 / 12,
        "center_of_mass": [0.25, 0],
        "points": {"start": [0, 0], "end": [0.5, 0]},
    }
    changes = {f"bodies.rod_{side}": rod for side in ("right", "left")}
    changes |= {f"motors.motor_{side}.transmission": "rigid" for side in ("right", "left")}
    return load("five_bar.yaml", {**changes, **TIGHT, "simulation.duration": 1})


def test_torque_of_a_pendulum():
    """tau = (J + m l^2) theta'' + m g l cos theta + friction theta'; a rotor adds r^2 Jr theta'' by its gear."""
    motor = {"type": "torque", "torque": 0, "gear_ratio": 5, "rotor_inertia": 0.01}
    found = fmbd.inverse(pendulum(motor, friction=0.3), joints={"hinge": "0.2 + 0.5*t**3"})
    angle, rate, acceleration = lift(found.time)
    at_joint = (J + M * L**2) * acceleration + M * G * L * np.cos(angle) + 0.3 * rate
    assert_allclose(found["hinge.angle"], angle, atol=1e-12)
    assert_allclose(found.torque[:, 0], at_joint / 5 + 0.01 * 5 * acceleration, rtol=1e-10)
    assert_allclose(found.power[:, 0], found.torque[:, 0] * 5 * rate, rtol=1e-10)


@pytest.mark.parametrize("inductance", [0, 0.02])
def test_voltage_of_a_motor(inductance):
    """u = Ra i + La i' + Ke r theta', i = tau / Km."""
    motor = {
        "type": "dc",
        "resistance": 2,
        "torque_constant": 0.5,
        "back_emf": 0.4,
        "gear_ratio": -8,
        "voltage": 0,
    }
    found = fmbd.inverse(pendulum(motor | {"inductance": inductance}), joints={"hinge": "0.2 + 0.5*t**3"})
    angle, rate, acceleration = lift(found.time)
    current = ((J + M * L**2) * acceleration + M * G * L * np.cos(angle)) / (-8 * 0.5)
    slope = ((J + M * L**2) * 3.0 - M * G * L * np.sin(angle) * rate) / (-8 * 0.5)
    assert_allclose(found["motor.current"], current, rtol=1e-9)
    voltage = 2 * current + inductance * slope - 0.4 * 8 * rate
    assert_allclose(found["motor.voltage"], voltage, rtol=1e-9 if inductance == 0 else 1e-6)
    assert len(found.remarks) == (inductance > 0), "a run starts without the current that holds the mass"


def robot():
    """Two arms of 0.5 m, a motor for each."""
    arm = {
        "type": "rigid",
        "mass": 1,
        "inertia": 0.02,
        "center_of_mass": [0.25, 0],
        "points": {"end": [0.5, 0]},
    }
    return model(
        gravity=[0, -G],
        bodies={"upper": arm, "lower": arm},
        joints={
            "shoulder": revolute("ground.origin", "upper.origin"),
            "elbow": revolute("upper.end", "lower.origin", friction=0.1),
        },
        motors={
            "first": {"type": "torque", "joint": "shoulder", "torque": 0},
            "second": {"type": "torque", "joint": "elbow", "torque": 0},
        },
        initial={"joints": {"shoulder": -1.0, "elbow": 1.5}},
        simulation={"duration": 2, "rtol": 1e-11, "atol": 1e-11, "method": "dop853"},
    )


def test_double_pendulum_follows_a_circle():
    """Its end goes round at 1 rad/s, from a start that is not the model's; fed forward it does so again."""
    found = fmbd.inverse(robot(), point="lower.end", path=["0.5 + 0.2*cos(t)", "-0.4 + 0.2*sin(t)"])
    assert found.error.max() < 1e-9
    again = found.forward()
    t = again.time
    circle = np.stack([0.5 + 0.2 * np.cos(t), -0.4 + 0.2 * np.sin(t)], axis=-1)
    assert_allclose(again["lower.end.position"], circle, rtol=0, atol=1e-8)


def test_a_path_near_a_singular_position_is_remarked():
    """The arms stretch to 0.9995 m of 1 m at 1 s: cos(e/2) = 0.9995, and J has about the condition number 5/e."""
    short = robot().with_("simulation.output_interval", 0.05)
    found = fmbd.inverse(short, point="lower.end", path=["0.8995 - 0.1*cos(pi*t)", "0"])
    [remark] = found.remarks
    assert "lower.end comes near a singular position at t = 1 s: the condition number" in remark
    assert 5 / (2 * np.arccos(0.9995)) == pytest.approx(79, abs=0.1)
    assert "is 79" in remark


def test_rigid_five_bar_goes_where_it_is_sent():
    found = fmbd.inverse(rigid_five_bar(), point="effector", path=ACROSS)
    assert found.error.max() < 1e-9
    again = found.forward()
    assert_allclose(again["rod_right.end.position"], found.path, rtol=0, atol=1e-7)
    assert_allclose(again["rod_left.end.position"][-1], [-0.1, 0.7], rtol=0, atol=1e-7)


def test_torques_of_the_rigid_five_bar_do_the_work():
    """The power of the motors is the rate of kinetic and potential energy."""
    found = fmbd.inverse(rigid_five_bar(), point="effector", path=ACROSS)
    stored = found["energy.kinetic"] + found["energy.potential"]
    work = CubicSpline(found.time, found.power.sum(axis=1)).antiderivative()(found.time)
    assert_allclose(stored - stored[0], work, rtol=0, atol=1e-8)
    assert np.ptp(stored) > 1.0


def test_flexible_five_bar_repeats_its_motion():
    """Rods vibrate, transmissions twist: fed forward, all do the same again, the joints to 1e-7 rad.

    The end point is off the path by what gravity and inertia bend and twist.
    """
    found = fmbd.inverse(
        load("five_bar.yaml", {**TIGHT, "simulation.duration": 1}), point="effector", path=ACROSS
    )
    assert 4e-4 < found.error.max() < 2e-3
    again = found.forward()
    assert max(found.deviation(again).values()) < 1e-7
    names = ("motor_right.rotor", "shoulder_right.angle", "elbow_left.angle", "rod_right.end.deflection")
    assert_allclose(columns(again, *names), columns(found, *names), rtol=0, atol=1e-6)
    # at the motors the motion is exact
    rigid = fmbd.inverse(rigid_five_bar(), point="effector", path=ACROSS)
    assert_allclose(found["motor_right.rotor"] / 10, rigid["shoulder_right.angle"], rtol=0, atol=1e-9)


def test_motors_without_a_motion_keep_their_inputs():
    """One arm moves, the controller of the other holds it against that."""
    changes = {**TIGHT, "simulation.duration": 0.5, "controllers.position_control.feedforward": 0}
    changes |= {"controllers.position_control.target": 1.2, "controllers.position_control.kp": 40}
    five_bar = load("five_bar.yaml", changes)
    begin = fmbd.assemble(five_bar).start.q[1]
    motion = {"type": "smooth_step", "end": 0.5, "from": float(begin), "to": float(begin) + 0.2}
    found = fmbd.inverse(five_bar, joints={"shoulder_right": motion})
    assert found.motors == ("motor_right",)
    kept = (
        "no motion of shoulder_left is prescribed: motor_left keeps its controller position_control meanwhile"
    )
    assert kept in found.remarks
    control = 40 * (12 - found["motor_left.rotor"]) - 1.2 * found["motor_left.rotor.rate"]
    assert_allclose(found["motor_left.voltage"], control, rtol=1e-9)
    assert max(found.deviation(found.forward()).values()) < 1e-7


def test_a_start_at_another_place_and_in_motion():
    """The model that is fed starts where the path does, at its speed, in the same assembly mode."""
    path = ["-0.05 + 0.2*t", "0.65 - 0.1*t"]
    found = fmbd.inverse(rigid_five_bar().with_("simulation.duration", 0.3), point="rod_left.end", path=path)
    start = fmbd.assemble(found.model).start
    assert_allclose(found["rod_left.end.velocity"][0], [0.2, -0.1], atol=1e-9)
    assert start.q[2] > 0.0  # the right elbow bends as in the model
    assert_allclose(found.forward()["rod_left.end.position"][-1], [0.01, 0.62], rtol=0, atol=1e-7)


def test_files(tmp_path):
    """A path from a table; the model that is fed, read again from its file, does the same."""
    t = np.linspace(0, 1, 101)
    rise = t**3 * (10 - 15 * t + 6 * t**2)
    table = np.stack([t, 0.1 - 0.2 * rise, 0.6 + 0.1 * rise], axis=-1)
    np.savetxt(tmp_path / "path.csv", table, delimiter=",", header="time,x,y", comments="")
    found = fmbd.inverse(rigid_five_bar(), point="effector", file=tmp_path / "path.csv")
    smooth = fmbd.inverse(rigid_five_bar(), point="effector", path=ACROSS)
    assert_allclose(found.path, smooth.path, atol=1e-7)
    found.save_model(tmp_path / "fed.yaml")
    again = fmbd.simulate(tmp_path / "fed.yaml")
    assert_allclose(again["rod_right.end.position"], found.path, rtol=0, atol=1e-6)
    found.save(tmp_path / "inputs.csv")
    heads, rows = columns_of(tmp_path / "inputs.csv")
    assert heads[:3] == ["time[s]", "shoulder_right.angle[rad]", "shoulder_left.angle[rad]"]
    assert heads[-2:] == ["rod_right.end.position.x[m]", "rod_right.end.position.y[m]"]
    assert_allclose(rows[:, heads.index("motor_right.voltage[V]")], found["motor_right.voltage"], rtol=1e-15)


def columns_of(path):
    return path.read_text().splitlines()[0].split(","), np.loadtxt(path, delimiter=",", skiprows=1)


def test_what_was_written_is_read_again(tmp_path):
    """With units in its header or without, the joints among its columns, or the point."""
    arm = {"type": "torque", "torque": 0}
    found = fmbd.inverse(pendulum(arm), joints={"hinge": "0.2 + 0.5*t**3"})
    found.save(tmp_path / "inputs.csv")
    assert read_file(pendulum(arm), tmp_path / "inputs.csv").keys() == {"hinge"}
    heads = (tmp_path / "inputs.csv").read_text().partition("\n")[0]
    assert heads == "time[s],hinge.angle[rad],motor.torque[N m]"
    again = fmbd.inverse(pendulum(arm), file=tmp_path / "inputs.csv")
    assert_allclose(again.torque, found.torque, atol=1e-4)
    (tmp_path / "plain.csv").write_text("time [s], hinge\n0, 0.2\n1, 0.2\n2, 0.3\n3, 0.4\n")
    assert read_file(pendulum(arm), tmp_path / "plain.csv")["hinge"].values == (0.2, 0.2, 0.3, 0.4)
    (tmp_path / "point.csv").write_text(
        "time[s],rod.end.position.x[m],rod.end.position.y[m]\n0,0.6,0\n1,0.6,0\n"
    )
    assert read_file(pendulum(arm), tmp_path / "point.csv", "rod.end").keys() == {"x", "y"}
    (tmp_path / "degrees.csv").write_text("time,hinge[deg]\n0,1\n1,2\n")
    with pytest.raises(fmbd.ModelError, match="hinge is in deg: it is read in s, rad or m"):
        read_file(pendulum(arm), tmp_path / "degrees.csv")


def test_deflection_at_rest_is_compensated():
    """Gravity bends the rods and twists the shafts by 0.4 mm: in the end, all vibrations damped, that is taken up."""
    damped = {"bodies.*.damping.stiffness_proportional": 5e-3, "simulation.output_interval": 0.02}
    five_bar = load("five_bar.yaml", damped | {"simulation.duration": 2, "simulation.rtol": 1e-8})
    plain = fmbd.inverse(five_bar, point="effector", path=ACROSS)
    found = fmbd.inverse(five_bar, point="effector", path=ACROSS, compensate=0.3)
    assert plain.error[-1] > 3e-4
    assert found.error[-1] < 1e-7


def test_what_cannot_be_followed_is_said():
    five_bar = rigid_five_bar()
    with pytest.raises(fmbd.AnalysisError, match=r"passes a position at t = .* where the motors do not hold"):
        fmbd.inverse(five_bar, point="effector", path=["0.1*(1 - t)", "0.6 - 0.5*t"])
    one_motor = five_bar.with_("motors", {"motor_right": five_bar.document.data["motors"]["motor_right"]})
    with pytest.raises(fmbd.AnalysisError, match="2 degrees of freedom, and 1 joint with a motor"):
        fmbd.inverse(one_motor, point="effector", path=ACROSS)
    with pytest.raises(fmbd.ModelError, match="motion of y: its rate jumps at t = 1 s"):
        path = ["0.1", {"type": "ramp", "end": 1, "from": 0.6, "to": 0.65}]
        fmbd.inverse(five_bar.with_("simulation.duration", 2), point="effector", path=path)
    with pytest.raises(fmbd.UnknownQuantity, match="unknown joint with a motor 'elbow_right'"):
        fmbd.inverse(five_bar, joints={"elbow_right": "0"})
    with pytest.raises(ValueError, match="give joints, or a point"):
        fmbd.inverse(five_bar, point="effector")


def test_torques_do_not_depend_on_which_joint_is_cut():
    """Motors without rotors, one of them on the joint that closes the loop, against both on joints of the tree."""
    bare = {f"motors.motor_{side}.rotor_inertia": 0 for side in ("right", "left")}
    tree = rigid_five_bar()
    for path, value in bare.items():
        tree = tree.with_(path, value)
    cut = tree.with_("joints.effector.cut", False).with_("joints.shoulder_left.cut", True)
    found = [fmbd.inverse(robot, point="effector", path=ACROSS) for robot in (tree, cut)]
    assert_allclose(found[1].torque, found[0].torque, rtol=0, atol=1e-7)
    assert max(found[1].deviation(found[1].forward()).values()) < 1e-7
