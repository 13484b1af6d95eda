"""Checks across the parts of a model."""

from collections.abc import Mapping
from typing import Any

from fmbd.model.beam import Beam
from fmbd.model.controllers import Controller, PDController
from fmbd.model.joints import Joint
from fmbd.model.motors import ControllerRef, Motor
from fmbd.model.points import GROUND
from fmbd.model.problems import Problems


def check_model(fields: Mapping[str, Any], problems: Problems) -> None:
    """Add what is wrong with the model as a whole; parts that failed are None."""
    if all(fields["bodies"].values()) and all(fields["joints"].values()):
        _check_held(fields["bodies"], fields["joints"], problems)
    if all(fields["motors"].values()):
        _check_controllers(fields["controllers"], fields["motors"], problems)


def _check_held(bodies: Mapping[str, Any], joints: Mapping[str, Joint], problems: Problems) -> None:
    """Every body must be joined to the ground, if only by a `free` joint."""
    neighbours: dict[str, list[str]] = {name: [] for name in (GROUND, *bodies)}
    for joint in joints.values():
        first, second = (point.body for point in joint.between)
        neighbours[first].append(second)
        neighbours[second].append(first)
    held, waiting = {GROUND}, [GROUND]
    while waiting:
        reached = [name for name in neighbours[waiting.pop()] if name not in held]
        held.update(reached)
        waiting.extend(reached)
    for name in bodies:
        if name not in held:
            point = "start" if isinstance(bodies[name], Beam) else "origin"
            hint = f"{{type: free, between: [ground.origin, {name}.{point}]}}"
            problems.add(
                ("bodies", name), f"no joint holds this body; if it is to move freely, add a joint {hint}"
            )


def _check_controllers(
    controllers: Mapping[str, Controller | None], motors: Mapping[str, Motor], problems: Problems
) -> None:
    """Each controller drives a motor, and knows a target for each."""
    driven: dict[str, list[str]] = {name: [] for name in controllers}
    for motor in motors.values():
        if isinstance(motor.input, ControllerRef):
            driven[motor.input.name].append(motor.joint)
    for name, controller in controllers.items():
        path = ("controllers", name)
        if not driven[name]:
            problems.add(path, "no motor uses this controller: name it as the voltage or torque of a motor")
        elif isinstance(controller, PDController) and isinstance(controller.target, dict):
            for joint in driven[name]:
                if joint not in controller.target:
                    problems.add(
                        (*path, "target"), f"has no target for '{joint}', whose motor uses this controller"
                    )
            for joint in controller.target:
                if joint not in driven[name]:
                    problems.add((*path, "target", joint), f"no motor on '{joint}' uses this controller")
