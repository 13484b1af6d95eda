"""Lower motors, their transmissions and controllers."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fmbd.model import ControllerRef, GravityCompensation, Model, Placement
from fmbd.model.motors import Motor
from fmbd.planar.arrays import ANGLE
from fmbd.system.lowered import Lowered, Term


def motor_coordinate(model: Model, motor: Motor) -> str:
    """The coordinate of its joint that a motor moves."""
    return str(model.joints[motor.joint].motor_coordinate)


def has_rotor(motor: Motor) -> bool:
    """A motor with inertia of its own has a rotor coordinate."""
    return bool(motor.rotor_inertia > 0.0)


def lower_motors(out: Lowered) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Motor and controller records as dictionaries; transmissions become springs (rigid ones: constraints)."""
    motors: list[dict[str, Any]] = []
    controllers: list[dict[str, Any]] = []
    for name, motor in out.model.motors.items():
        direction = motor_coordinate(out.model, motor)
        ratio = motor.gear_ratio
        joint_path = out.joint_pathway(motor.joint, direction)
        if not has_rotor(motor):
            shaft = out.joint_pathway(motor.joint, direction, ratio)
        else:
            rotor = rotor_term(out, name, motor)
            shaft = out.pathway([rotor])
            if motor.transmission is not None:
                twist = [(*rotor[:4], 1.0 / ratio), out.joint_term(motor.joint, direction, -1.0)]
                out.relaxed.append(out.pathway(twist))
                out.springs.add_spring(f"{name}.transmission", out.relaxed[-1], motor.transmission)
        record: dict[str, Any] = {
            "pathway": shaft,
            "joint_pathway": joint_path,
            "state": -1,
            "signal": -1,
            "controller": -1,
        }
        if motor.type == "dc":
            inductance = motor.inductance or 0.0
            record |= {
                "electric": 1,
                "Km": motor.torque_constant,
                "Ke": motor.back_emf,
                "Ra": motor.resistance,
                "La": inductance,
            }
            if inductance > 0.0:
                record["state"] = len(out.states)
                out.states.append((f"{name}.current", "A"))
        if isinstance(motor.input, ControllerRef):
            record["controller"] = len(controllers)
            controllers.append(_controller(out, name, motor, shaft, joint_path))
        else:
            record["signal"] = out.signals.add(motor.input)
        motors.append(record)
    return motors, controllers


def rotor_term(out: Lowered, name: str, motor: Motor) -> Term:
    """The angle of a rotor, seen from the stator."""
    stator = out.model.joints[motor.joint].between[0]
    a = out.station(stator.body, stator.point)
    return ANGLE, a, out.station(f"{name}.rotor", "axis"), (1.0, 0.0), 1.0


def lower_shafts(out: Lowered, shafts: Mapping[str, Any]) -> list[tuple[int, int]]:
    """(pathway, driver) of a constraint for each motor whose motion is prescribed: signal - rotor / ratio = 0.

    Its multiplier is -ratio times the torque that it puts on the rotor.
    """
    constraints = []
    for name, signal in shafts.items():
        motor = out.model.motors[name]
        direction = motor_coordinate(out.model, motor)
        if has_rotor(motor):
            rotor = rotor_term(out, name, motor)
            path = out.own_pathway([(*rotor[:4], -1.0 / motor.gear_ratio)])
        else:
            path = out.own_pathway([out.joint_term(motor.joint, direction, -1.0)])
            if motor.joint in out.tree.cut and direction == "angle":
                out.cut_angles.append((path, motor.joint))
        constraints.append((path, out.signals.add(signal)))
        out.constraints.append((f"{name}.shaft", "N m" if direction == "angle" else "N"))
    return constraints


def _controller(out: Lowered, name: str, motor: Any, shaft: int, joint_path: int) -> dict[str, Any]:
    """One motor's own instance of its controller; a target given as a place is set by `system.start`."""
    law = out.model.controllers[motor.input.name]
    at_rotor = law.measure == "rotor" or (law.measure is None and has_rotor(motor))
    record: dict[str, Any] = {
        "pathway": shaft if at_rotor else joint_path,
        "kp": law.kp,
        "kd": law.kd,
        "ki": law.ki if law.type == "pid" else 0.0,
        "scale": motor.gear_ratio if at_rotor else 1.0,
        "target": -1,
        "shift": 0.0,
        "feedforward": -1,
        "online": -1,
        "low": law.limit[0] if law.limit else -np.inf,
        "high": law.limit[1] if law.limit else np.inf,
        "state": -1,
        "gravity_gain": gravity_gain(motor),
    }
    if law.type == "pid":
        record["state"] = len(out.states)
        out.states.append((f"{name}.error_integral", "rad s"))
    if isinstance(law.target, dict):
        if motor.joint not in law.target:
            raise out.model.error(
                ("controllers", motor.input.name, "target"),
                f"gives no target for joint '{motor.joint}' of motor '{name}'",
            )
        record["target"] = out.signals.add(law.target[motor.joint])
    elif not isinstance(law.target, Placement):
        record["target"] = out.signals.add(law.target)
    if not isinstance(law.feedforward, GravityCompensation):
        record["feedforward"] = out.signals.add(law.feedforward)
    elif law.feedforward.computed == "online":
        record["online"] = list(out.model.motors).index(name)
    return record


def gravity_gain(motor: Motor) -> float:
    """Motor input (voltage or torque) that holds a unit torque at the joint: Ra / (Km r), or 1 / r."""
    if motor.type == "dc":
        return float(motor.resistance / (motor.torque_constant * motor.gear_ratio))
    return float(1.0 / motor.gear_ratio)
