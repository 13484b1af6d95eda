"""The start: a position that closes the loops, rates that keep them closed, and what follows from it.

With the start known, the numbers that a model may leave to it are set: rest lengths and angles of springs that are
relaxed at the start, the branch of angles in cut joints, set points of controllers that name a place.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fmbd.model import ControllerRef, GravityCompensation, Placement
from fmbd.model.controllers import Controller
from fmbd.planar.laws import STOP
from fmbd.system.closure import CLOSED, Closure, RigidMechanism, turns
from fmbd.system.lowered import Lowered
from fmbd.system.matrices import gravity_compensation
from fmbd.system.motors import motor_coordinate

Array = np.ndarray

#: A loop that given joint values miss by less than this share of the mechanism's size is closed by moving them.
ROUNDING = 1e-2


@dataclass(frozen=True)
class Start:
    """Nodal coordinates q and rates v (nq,), first-order states z (nz,), and remarks for the user."""

    q: Array
    v: Array
    z: Array
    remarks: tuple[str, ...]


def solve_start(lowered: Lowered, reference: Any) -> Start:
    """Solve the start and complete the records of `lowered` with it.

    Raises ModelError if the loops cannot be closed, a place is out of reach, or given rates contradict each other.
    """
    _check_drivers(lowered, reference)
    mechanism = RigidMechanism(lowered, reference)
    remarks: list[str] = []
    q = _position(lowered, mechanism, remarks)
    _set_branches(lowered, mechanism, reference, q)
    q = relax_rotors(lowered, mechanism, q)
    v = _rates(lowered, mechanism, reference, q)
    if lowered.planar.pathways.size:
        _relax_pathways(lowered, reference, q)
        _remark_stops(lowered, reference, q, remarks)
    return Start(q, v, np.zeros(len(lowered.states)), tuple(remarks))


def _check_drivers(lowered: Lowered, reference: Any) -> None:
    """A prescribed motion needs a value, a rate and a second derivative at the start."""
    for name, joint in lowered.model.joints.items():
        for signal in joint.driven.values():
            if not np.all(np.isfinite(reference.signal(lowered.signals.add(signal), 0.0))):
                text = "the prescribed motion has no finite value, rate and second derivative at t = 0"
                raise lowered.model.error(("joints", name, "driven"), text)


def _relax_pathways(lowered: Lowered, reference: Any, q: Array) -> None:
    """Transmissions and springs whose rest is left out carry nothing at the start; some are near their rest."""
    values, _ = reference.pathways(q, 0.0)
    for index in lowered.rest_nearby:
        spring = lowered.planar.springs[index]
        lowered.planar.pathways[spring.pathway].offset = -turns(values[spring.pathway] - spring.rest)
    for index in lowered.relaxed:
        lowered.planar.pathways[index].offset -= values[index]
    for index in lowered.rest_at_start:
        spring = lowered.planar.springs[index]
        spring.rest = values[spring.pathway]


def _remark_stops(lowered: Lowered, reference: Any, q: Array, remarks: list[str]) -> None:
    values, _ = reference.pathways(q, 0.0)
    for name, stop in zip(lowered.springs.names, lowered.planar.springs, strict=True):
        lower, upper = stop.p[:2]
        value = values[stop.pathway]
        if stop.kind == STOP and not lower <= value <= upper:
            remarks.append(f"{name.removesuffix('.stop')} starts behind its stop, at {value:.6g}")


def _by_coordinate(values: Mapping[str, Mapping[Any, float]]) -> dict[tuple[str, str], float]:
    """{(joint, coordinate): value} from {joint: {coordinate: value}}."""
    return {(joint, name): number for joint, numbers in values.items() for name, number in numbers.items()}


def _guess(lowered: Lowered, values: dict[tuple[str, str], float]) -> Array:
    q = np.zeros(lowered.planar.nq)
    for k, (name, _) in enumerate(lowered.coordinates):
        joint, _, direction = name.partition(".")
        q[k] = values.get((joint, direction), 0.0)
    return q


def _position(lowered: Lowered, mechanism: RigidMechanism, remarks: list[str]) -> Array:
    initial = lowered.model.initial
    joints = _by_coordinate(initial.joints)
    hints = _by_coordinate(initial.hints)
    guess = _guess(lowered, hints | joints)
    if not initial.consistent:
        miss = mechanism.equations(guess, {}, {})[0]
        remarks.append(
            f"start as given (consistent: false); the loops are open by {np.abs(miss).max(initial=0.0):.3g} m"
        )
        return guess
    near = hints | joints
    known = all(tuple(lowered.coordinates[k][0].split(".")) in near for k in mechanism.unknowns)
    closure = mechanism.search(guess, joints, initial.place, hinted=known, near=near)
    if closure.residual < CLOSED:
        if not hints:
            _remark_closure(lowered, closure, remarks)
        return closure.q
    closed = mechanism.solve(guess, {}, initial.place)
    moved = closed.q - guess
    if closed.residual < CLOSED and joints and np.abs(moved).max() < ROUNDING:
        name = lowered.coordinates[int(np.abs(moved).argmax())][0]
        miss = np.abs(mechanism.equations(guess, {}, initial.place)[0]).max()
        remarks.append(
            f"the joint values given miss the closed loop by {miss:.3g} m; moved onto it, "
            f"at most {np.abs(moved).max():.3g} ({name})"
        )
        return closed.q
    raise _unreachable(lowered, closure, bool(joints), bool(initial.place))


def _remark_closure(lowered: Lowered, closure: Closure, remarks: list[str]) -> None:
    if closure.others:
        modes = (
            "another assembly mode exists"
            if closure.others == 1
            else f"{closure.others} other assembly modes exist"
        )
        remarks.append(f"{modes}; the one nearest to zero joint values was taken (initial.hints chooses)")


def _unreachable(lowered: Lowered, closure: Closure, joints: bool, places: bool) -> Exception:
    where: tuple[str, ...] = (
        ("initial", "place") if places else ("initial", "joints") if joints else ("joints",)
    )
    if places:
        names = " and ".join(lowered.model.initial.place)
        text = f"{names} cannot reach the place given: the nearest position found misses by {closure.residual:.3g} m"
    elif joints:
        text = (
            f"the joint values do not close the loop (nearest position found misses by {closure.residual:.3g} m): "
            "leave some of them out, or give them as initial.hints"
        )
    else:
        cut = ", ".join(lowered.tree.cut)
        text = f"the loop closed by {cut} cannot be closed: it stays open by {closure.residual:.3g} m"
    error: Exception = lowered.model.error(where, text)
    return error


def _set_branches(lowered: Lowered, mechanism: RigidMechanism, reference: Any, q: Array) -> None:
    """Count the angle of a cut joint from the turn nearest to what drives it, is given or hinted, or 0."""
    initial = lowered.model.initial
    given = _by_coordinate(initial.hints) | _by_coordinate(initial.joints)
    angles = mechanism.coordinates(q, [(joint, "angle") for joint in lowered.tree.cut])
    for joint, (angle, _) in zip(lowered.tree.cut, angles, strict=True):
        drive = lowered.model.joints[joint].driven.get("angle")
        near = given.get((joint, "angle"), 0.0)
        if drive is not None:
            near = reference.signal(lowered.signals.add(drive), 0.0)[0]
        lowered.turns[joint] = float(turns(angle - near))
    for index, joint in lowered.cut_angles:
        path = lowered.planar.pathways[index]
        path.offset = -lowered.planar.terms[path.term0].coefficient * lowered.turns[joint]


def _rotors(lowered: Lowered) -> list[tuple[int, float, str, str]]:
    """(coordinate index, gear ratio, joint, direction) of each rotor."""
    names = [name for name, _ in lowered.coordinates]
    found = []
    for link in lowered.tree.links:
        if link.motor is not None:
            motor = lowered.model.motors[link.motor]
            found.append(
                (
                    names.index(link.name),
                    motor.gear_ratio,
                    motor.joint,
                    motor_coordinate(lowered.model, motor),
                )
            )
    return found


def relax_rotors(lowered: Lowered, mechanism: RigidMechanism, q: Array) -> Array:
    """Rotors start where their transmissions are relaxed: phi = r theta."""
    q = q.copy()
    rotors = _rotors(lowered)
    at_joints = mechanism.coordinates(q, [(joint, direction) for _, _, joint, direction in rotors])
    for (index, ratio, _, _), (value, _) in zip(rotors, at_joints, strict=True):
        q[index] = ratio * value
    return q


def _rates(lowered: Lowered, mechanism: RigidMechanism, reference: Any, q: Array) -> Array:
    """Rates that satisfy the constraints and the given rates; what they leave open is as small as possible."""
    nq = lowered.planar.nq
    planar = lowered.planar
    given = _by_coordinate(lowered.model.initial.rates)
    rows, wanted = [], []
    if lowered.model.initial.consistent and len(planar.held):
        _, gradients = reference.pathways(q, 0.0)
        for c in planar.held:
            constraint = planar.constraints[c]
            drive = reference.signal(constraint["driver"], 0.0)[1] if constraint["driver"] >= 0 else 0.0
            row = gradients[constraint["pathway"]]
            rows.append(row[:nq])
            wanted.append(-row[nq] - drive)
    for rate, (_, row) in zip(given.values(), mechanism.coordinates(q, list(given)), strict=True):
        rows.append(row[:nq])
        wanted.append(rate - row[nq])
    v = np.zeros(nq)
    if rows:
        A, b = np.array(rows)[:, mechanism.unknowns], np.array(wanted)
        v[mechanism.unknowns] = np.linalg.lstsq(A, b, rcond=1e-12)[0]
        miss = np.abs(A @ v[mechanism.unknowns] - b).max()
        if miss > 1e-9 * max(1.0, np.abs(b).max()):
            raise lowered.model.error(
                ("initial", "rates"),
                f"the rates given contradict the closed loops (by {miss:.3g}): leave some out",
            )
    rotors = _rotors(lowered)
    at_joints = mechanism.coordinates(q, [(joint, direction) for _, _, joint, direction in rotors])
    for (index, ratio, _, _), (_, row) in zip(rotors, at_joints, strict=True):
        v[index] = ratio * (row[:nq] @ v + row[nq])
    return v


def set_targets(system: Any, mechanism: RigidMechanism) -> None:
    """Set points of controllers whose target is a place, and feed-forward computed at the target.

    The mechanism is moved from the start to the targets in small steps, so that it stays in its assembly mode.
    """
    lowered = system.lowered
    model = lowered.model
    controlled = {
        name: model.controllers[motor.input.name]
        for name, motor in model.motors.items()
        if isinstance(motor.input, ControllerRef)
    }
    at_target = {
        name: law
        for name, law in controlled.items()
        if isinstance(law.target, Placement) or _compensates_at_target(law)
    }
    if not at_target:
        return
    held: dict[tuple[str, str], float] = {}
    places: dict[str, tuple[float, float]] = {}
    for name, law in controlled.items():
        motor = model.motors[name]
        if isinstance(law.target, Placement):
            places |= law.target.places
            continue
        signal = law.target[motor.joint] if isinstance(law.target, dict) else law.target
        if signal.type == "constant":
            held[motor.joint, motor_coordinate(model, motor)] = float(signal.value)
        else:
            # a joint that follows a varying target is left where the places put it
            _check_nothing_compensates(system, at_target, name)
    q = _move(system, mechanism, held, places)
    _fill_targets(system, mechanism, q, at_target)


def _check_nothing_compensates(system: Any, at_target: dict[str, Any], varying: str) -> None:
    """Gravity compensation at the target needs one position of the whole mechanism."""
    model = system.lowered.model
    for name, law in at_target.items():
        if _compensates_at_target(law):
            raise model.error(
                ("controllers", model.motors[name].input.name, "feedforward"),
                f"gravity compensation at the target needs constant targets, that of motor {varying} varies; "
                "write {type: gravity_compensation, computed: online}",
            )


def _move(
    system: Any,
    mechanism: RigidMechanism,
    held: dict[tuple[str, str], float],
    places: dict[str, tuple[float, float]],
) -> Array:
    """Follow the targets from the start position."""
    model = system.lowered.model
    q = system.start.q * ~system.elastic
    from_held = dict(zip(held, (value for value, _ in mechanism.coordinates(q, list(held))), strict=True))
    position = system.reference.stations(q, 0.0)[0]
    points = {name: position[system.station_of_place(name)] for name in places}
    for share in np.linspace(0.0, 1.0, 21)[1:]:
        between = {key: from_held[key] + share * (value - from_held[key]) for key, value in held.items()}
        on_way = {
            name: tuple(points[name] + share * (np.asarray(place) - points[name]))
            for name, place in places.items()
        }
        closure = mechanism.solve(q, between, on_way)
        if closure.residual > CLOSED:
            closure = mechanism.search(q, held, places, hinted=False)
            if closure.residual > CLOSED:
                law = next(
                    name for name, c in model.controllers.items() if places.keys() <= _places_of(c) or held
                )
                raise model.error(
                    ("controllers", law, "target"),
                    f"the target is out of reach: the nearest position found misses by {closure.residual:.3g} m",
                )
            return closure.q
        q = closure.q
    return q


def _places_of(law: Controller) -> set[str]:
    return set(law.target.places) if isinstance(law.target, Placement) else set()


def _compensates_at_target(law: Controller) -> bool:
    return isinstance(law.feedforward, GravityCompensation) and law.feedforward.computed == "target"


def _fill_targets(system: Any, mechanism: RigidMechanism, q: Array, at_target: dict[str, Any]) -> None:
    lowered = system.lowered
    planar = lowered.planar
    values, _ = system.reference.pathways(q, 0.0)
    torques = None
    names = list(lowered.model.motors)
    for name, law in at_target.items():
        record = planar.motors[names.index(name)]
        control = planar.controllers[record.controller]
        if isinstance(law.target, Placement):
            control.shift = control.scale * values[record.joint_pathway]
        if _compensates_at_target(law):
            if torques is None:
                torques = gravity_compensation(system, q, 0.0)
            control.bias = control.gravity_gain * torques[names.index(name)]
