"""What a run can be asked for: names of quantities, their units, how they follow from the results.

    <coordinate>, .rate, .acceleration      generalised coordinates, `elbow.angle`, `rod.w1`, `motor.rotor`; of a
                                            beam in segments `rod.segment2.w3`, of node 3 in the segment's frame
    <joint>.<x|y|angle>, .rate, ...         all other joint coordinates, too: in closed loops, or driven
    <body>.<point>.position, .velocity, .acceleration       in the world; columns x and y
    <body>.<point>.angle, .angular_velocity, .angular_acceleration      of its axes; a beam's follow the slope
    <body>.angle, ...                       the same of the body's frame
    <beam>.frame.position, ...              all six of the floating frame; of a beam in segments, those of the
                                            tangent at its start, or of the chord if its frame is one
    <joint>.force, .moment                  what the joint's constraints put on the body of its first point,
                                            in the world's axes and about that point
    <joint>.<x|y>.driving_force, .angle.driving_moment      what moves a driven coordinate, positive along it
    <joint>.<x|y>.spring_force, .friction_force, .stop_force, .angle.spring_moment, ...     the same of these
    <beam>.deflection, .slope               w and the angle of the cross-sections, w' unless the beam shears, in that
                                            frame; columns are the nodes
    <beam>.bending_moment, .shear_force     EI w'' and (EI w'')'; columns are the nodes (see beams.bending). Rotary
                                            inertia takes rho I times the angular acceleration off the latter
    <beam>.axial_force                      tension, by Newton's law on what lies beyond (see axial.py)
    <beam>.stress                           bending stress -E h/2 w'' in the fibre y = h/2
    <beam>.<point>.deflection, ...          the same six at a point
    <motor>.voltage, .current, .torque      input, armature current, torque on the rotor
    <motor>.transmission_torque             what gear or elastic shaft put on the joint
    <spring>.length, .rate, .force          tension, k (l - rest) + d l' if linear
    <spring>.angle, .rate, .moment          k (angle - rest) + d angle' if linear, on the body of the first point
    energy.<name>, multipliers.<constraint>, constraint_error, velocity_constraint_error, time
    <motor>.error_integral                  and other first-order states

A column of a quantity is a quantity, too: `rod.end.position.x`, `rod.deflection.node2`.
Springs, friction and motors in a joint are not in its force and moment; what drives a driven coordinate is.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fmbd.beams.bending import bending_moment, shear_force, upper_stress
from fmbd.beams.pieces import evaluate
from fmbd.errors import UnknownQuantity
from fmbd.model import Beam, Model
from fmbd.model.names import closest
from fmbd.results.layout import MATRICES
from fmbd.results.recording import Source

if TYPE_CHECKING:
    from fmbd.results.motion import Track
    from fmbd.results.run import Run

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Quantity:
    """Unit, rule, and what the columns are of a quantity of shape (nt, n); none for shape (nt,)."""

    unit: str
    compute: "Callable[[Run], Array]"
    columns: tuple[str, ...] = ()


Named = Iterator[tuple[str, Quantity]]


def quantities(model: Model, source: Source) -> dict[str, Quantity]:
    """All quantities of a run by name; what is archived is not computed again."""
    found = dict(_archived(source))
    for name, quantity in _computed(model):
        found.setdefault(name, quantity)
    return found


def column(whole: Quantity, part: str) -> Quantity:
    """One column of a quantity that has several."""
    k = whole.columns.index(part)
    return Quantity(whole.unit, lambda run: whole.compute(run)[:, k])


def unknown_quantity(name: str, known: Mapping[str, Quantity], model: Model) -> UnknownQuantity:
    """The error for a name that is not among the known ones, with the nearest that is."""
    part, _, rest = name.partition(".")
    beam = model.bodies.get(part)
    if rest.endswith("stress") and isinstance(beam, Beam) and f"{part}.stress" not in known:
        return UnknownQuantity(f"no quantity '{name}': beam '{part}' has no section with a height")
    own = [candidate for candidate in known if candidate.startswith(f"{part}.")]
    near = closest(name, own or known)
    hint = f", did you mean '{near}'?" if near else " (run.names lists all names)"
    return UnknownQuantity(f"no quantity '{name}'{hint}")


def _archived(source: Source) -> Named:
    yield "time", Quantity("s", lambda run: run.time.copy())
    for k, name in enumerate(source.coordinates):
        for matrix, suffix in (("position", ""), ("velocity", ".rate"), ("acceleration", ".acceleration")):
            yield name + suffix, Quantity(source.units[matrix][k], partial(_column, matrix, k))
    for k, name in enumerate(source.state_names):
        yield name, Quantity(source.units["states"][k], partial(_column, "states", k))
    for k, name in enumerate(source.constraints):
        yield (
            f"multipliers.{name}",
            Quantity(source.units["multipliers"][k], partial(_column, "multipliers", k)),
        )
    for name in sorted(source.units.keys() - MATRICES.keys() - {"time"}):
        yield name.replace("/", "."), Quantity(str(source.units[name]), partial(_scalar, name))


def _column(matrix: str, k: int, run: "Run") -> Array:
    return getattr(run, matrix)[:, k].copy()


def _scalar(name: str, run: "Run") -> Array:
    return run.source.result(name).copy()


def _computed(model: Model) -> Named:
    for name in model.joints:
        yield from _joint(model, name)
    for point in model.ground.points:
        yield from _track(f"ground.{point}", partial(_point, "ground", point))
    for name, body in model.bodies.items():
        for point in body.points:
            yield from _track(f"{name}.{point}", partial(_point, name, point))
        frame = partial(_frame, name)
        yield from _angles(name, frame)
        if isinstance(body, Beam):
            yield from _track(f"{name}.frame", frame)
            yield from _beam(name, body)
    for name in model.motors:
        yield from _motor(model, name)
    for name in model.springs:
        yield from _spring(model, name)


TrackOf = Callable[["Run"], "Track"]
Along = Callable[["Run", Array], Array]


def _point(body: str, point: str, run: "Run") -> "Track":
    return run.motion.point(body, point)


def _frame(body: str, run: "Run") -> "Track":
    return run.motion.frame(body)


def _track(name: str, track: TrackOf) -> Named:
    for k, (quantity, unit) in enumerate((("position", "m"), ("velocity", "m/s"), ("acceleration", "m/s^2"))):
        yield f"{name}.{quantity}", Quantity(unit, partial(_place, track, k), ("x", "y"))
    yield from _angles(name, track)


def _angles(name: str, track: TrackOf) -> Named:
    turning = (("angle", "rad"), ("angular_velocity", "rad/s"), ("angular_acceleration", "rad/s^2"))
    for k, (quantity, unit) in enumerate(turning):
        yield f"{name}.{quantity}", Quantity(unit, partial(_turning, track, k))


def _place(track: TrackOf, k: int, run: "Run") -> Array:
    return vectors(track(run).place[k])


def _turning(track: TrackOf, k: int, run: "Run") -> Array:
    return track(run).angle[k]


def vectors(plane: NDArray[np.complex128]) -> Array:
    """x and y of complex numbers (nt,), shape (nt, 2)."""
    return np.stack([plane.real, plane.imag], axis=-1)


def _joint(model: Model, name: str) -> Named:
    joint = model.joints[name]
    for direction in joint.coordinates:
        unit = "rad" if direction == "angle" else "m"
        for k, (suffix, per) in enumerate((("", ""), (".rate", "/s"), (".acceleration", "/s^2"))):
            yield (
                f"{name}.{direction}{suffix}",
                Quantity(unit + per, partial(_joint_motion, name, direction, k)),
            )
    yield f"{name}.force", Quantity("N", lambda run: vectors(run.forces.joint(name)[0]), ("x", "y"))
    yield f"{name}.moment", Quantity("N m", lambda run: run.forces.joint(name)[1])
    for direction in joint.driven:
        kind, unit = ("moment", "N m") if direction == "angle" else ("force", "N")
        effort = partial(_driving, name, direction)
        yield f"{name}.{direction}.driving_{kind}", Quantity(unit, effort)
    for law, parts in (("spring", joint.spring), ("friction", joint.friction), ("stop", joint.limits)):
        for direction in parts:
            kind, unit = ("moment", "N m") if direction == "angle" else ("force", "N")
            effort = partial(_law_in_joint, f"{name}.{direction}.{law}")
            yield f"{name}.{direction}.{law}_{kind}", Quantity(unit, effort)


def _joint_motion(name: str, direction: str, k: int, run: "Run") -> Array:
    seen = run.motion.joint(name)
    if direction == "angle":
        return seen.angle[k]
    return seen.place[k].real if direction == "x" else seen.place[k].imag


def _driving(name: str, direction: str, run: "Run") -> Array:
    return run.forces.driving(name, direction)


def _law_in_joint(name: str, run: "Run") -> Array:
    return -run.forces.spring(name)[2]


def _beam(name: str, beam: Beam) -> Named:
    """Along a beam, at its nodes and at its points."""
    nodes = tuple(f"node{k}" for k in range(len(beam.nodes)))
    places = {name: (np.array(beam.nodes), nodes)}
    places |= {f"{name}.{point}": (np.array([x]), ()) for point, x in beam.points.items()}
    along: dict[str, tuple[str, Along]] = {
        "deflection": ("m", lambda run, x: run.motion.deflection(name, x)),
        "slope": ("rad", lambda run, x: run.motion.slope(name, x)),
        "bending_moment": ("N m", lambda run, x: run.motion.along(name, x, bending_moment)),
        "shear_force": ("N", partial(_shear_force, name, beam)),
        "axial_force": ("N", partial(_axial_force, name)),
    }
    if beam.youngs_modulus is not None and all(piece.height is not None for piece in beam.pieces):
        stress = partial(upper_stress, youngs_modulus=beam.youngs_modulus)
        along["stress"] = ("Pa", lambda run, x: run.motion.along(name, x, stress))
    for place, (x, columns) in places.items():
        for quantity, (unit, values) in along.items():
            yield f"{place}.{quantity}", Quantity(unit, partial(_along, values, x, bool(columns)), columns)


def _shear_force(name: str, beam: Beam, run: "Run", x: Array) -> Array:
    shear = run.motion.along(name, x, shear_force)
    if beam.rotary_inertia and not beam.shear and beam.mass == "consistent":
        both = [evaluate(beam.pieces, "rotary_inertia", x, side=side) for side in ("left", "right")]
        shear -= np.mean(both, axis=0) * run.motion.section_acceleration(name, x)
    return shear


def _axial_force(name: str, run: "Run", x: Array) -> Array:
    from fmbd.results.axial import axial_force  # compiles what evaluates the forces

    return axial_force(run.forces, name, x)


def _along(values: Along, x: Array, many: bool, run: "Run") -> Array:
    """Values at x [m]: shape (nt, points), or (nt,) for one point."""
    found = values(run, x)
    return found if many else found[:, 0]


def _motor(model: Model, name: str) -> Named:
    motor = model.motors[name]
    if motor.type == "dc":
        constant = motor.torque_constant
        yield f"{name}.voltage", Quantity("V", lambda run: run.forces.motor(name)[0])
        yield f"{name}.current", Quantity("A", lambda run: run.forces.motor(name)[1] / constant)
    yield f"{name}.torque", Quantity("N m", lambda run: run.forces.motor(name)[1])
    unit = "N m" if model.joints[motor.joint].motor_coordinate == "angle" else "N"
    yield f"{name}.transmission_torque", Quantity(unit, lambda run: run.forces.transmission(name))


def _spring(model: Model, name: str) -> Named:
    if model.springs[name].type == "torsional":
        named = (("angle", "rad"), ("rate", "rad/s"), ("moment", "N m"))
    else:
        named = (("length", "m"), ("rate", "m/s"), ("force", "N"))
    for k, (quantity, unit) in enumerate(named):
        yield f"{name}.{quantity}", Quantity(unit, partial(_spring_state, name, k))


def _spring_state(name: str, k: int, run: "Run") -> Array:
    return run.forces.spring(name)[k]
