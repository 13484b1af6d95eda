"""`fmbd check`: what a model is, so that its author sees whether it is what was meant."""

import argparse
from collections.abc import Iterator
from math import degrees, tau
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    DONE,
    add_model,
    columns,
    compiling_announced,
    facts,
    read_model,
    show,
    shown,
)

if TYPE_CHECKING:
    from rich.table import Table

    from fmbd.system import System

#: Rows of a table; coordinates up to which frequencies are computed (some seconds).
ROWS = 30
COORDINATES = 2000
FREQUENCIES = 6


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "check",
        help="say what a model is: bodies, joints, degrees of freedom, start, frequencies",
        description="Read and assemble a model, solve its start, and say what it is. Nothing is simulated.",
    )
    add_model(parser)
    parser.set_defaults(command=_check)


def _check(args: argparse.Namespace) -> int:
    with compiling_announced():
        from fmbd.system import assemble

        model = read_model(args)
        system = assemble(model)
        show(f"{model.name}  ({args.model})", style="bold")
        if model.description:
            show(model.description.strip())
        show("", _bodies(system), "", facts([*_forces(system), *_freedom(system)]))
        if any(joint.coordinates for joint in model.joints.values()):
            show("", _start(system))
        show("", facts([*_remarks(system), *_frequencies(system), *_simulation(system)]))
        if model.motors:
            show("", _motors(system))
    return DONE


def _bodies(system: "System") -> "Table":
    """The spanning tree: each body under the one that carries it, and by which joint."""
    rigid = ["mass [kg]", "inertia [kg m^2]"]
    flexible = ["length [m]", "elements", "f1 alone [Hz]"] if system.beams else []
    table = columns("body", "carried by", *rigid, *flexible)
    links = system.tree.links
    for i, (link, branch) in enumerate(zip(links[:ROWS], _branches(system), strict=False)):
        mass = _g(system.planar.bodies["mass"][i])
        if link.motor is not None:
            motor = system.model.motors[link.motor]
            by, row = f"{link.motor} ({motor.type}, gear {motor.gear_ratio:g})", ["", _g(motor.rotor_inertia)]
        else:
            by = f"{link.joint} ({system.model.joints[str(link.joint)].type})"
            row = [mass, _g(getattr(system.model.bodies[link.name], "inertia", 0.0))]
        if i in system.beams:
            beam, omega2 = system.beams[i], system.lowered.omega2[i]
            row = [mass, "", _g(beam.length), str(len(beam.nodes) - 1), _g(omega2[0] ** 0.5 / tau)]
        table.add_row(branch + link.name, by, *row)
    if len(links) > ROWS:
        table.add_row(f"... {len(links) - ROWS} more")
    return table


def _branches(system: "System") -> Iterator[str]:
    """The lines of the tree before the name of each body."""
    links = system.tree.links
    last = {link.parent: link.name for link in links}
    stem = {"ground": ""}
    for link in links:
        is_last = last[link.parent] == link.name
        stem[link.name] = stem[link.parent] + ("  " if is_last else "│ ")
        yield stem[link.parent] + ("└ " if is_last else "├ ")


def _forces(system: "System") -> Iterator[tuple[str, str]]:
    model = system.model
    moving = system.planar.bodies["mass"].sum()
    yield "total mass", f"{moving:.6g} kg, gravity ({model.gravity[0]:g}, {model.gravity[1]:g}) m/s^2"
    for family in ("springs", "loads"):
        if parts := getattr(model, family):
            yield family, shown(f"{name} ({part.type})" for name, part in parts.items())
    if times := list(system.lowered.signals.breakpoints(model.simulation.duration)):
        yield "inputs", f"jump or kink at t = {shown(f'{t:g}' for t in times)} s"


def _freedom(system: "System") -> Iterator[tuple[str, str]]:
    """Loops, coordinates, degrees of freedom and what holds them twice."""
    from fmbd.analyses import mobility

    for name in system.tree.cut:
        joint = system.model.joints[name]
        ends = " and ".join(f"{ref.body}.{ref.point}" for ref in joint.between)
        yield "loop", f"closed by {name} ({joint.type}) of {ends}"
    elastic = int(system.elastic.sum())
    rotors = int(system.planar.bodies["rotor"].sum())
    parts = (system.planar.nq - elastic - rotors, "of joints"), (rotors, "of rotors"), (elastic, "elastic")
    yield "coordinates", f"{system.planar.nq}: " + ", ".join(f"{n} {what}" for n, what in parts if n)
    freedom = mobility(system)
    rigid = f"; {freedom.rigid} of the rigid mechanism" if elastic or rotors else ""
    yield (
        "degrees of freedom",
        f"{freedom.degrees_of_freedom} = {freedom.coordinates} coordinates "
        f"- {freedom.independent} independent constraints{rigid}",
    )
    for redundancy in freedom.redundant[:ROWS]:
        yield "redundant", f"{redundancy.constraint} follows from {shown(redundancy.follows_from)}"


def _start(system: "System") -> "Table":
    """Joint coordinates at the start, those of driven and cut joints included."""
    from fmbd.system.closure import RigidMechanism

    mechanism = RigidMechanism(system.lowered, system.reference)
    q, v = system.start.q, system.start.v
    table = columns("at the start", "[m, rad]", "[deg]", "rate [1/s]", "")
    names = [(name, d) for name, joint in system.model.joints.items() for d in joint.coordinates]
    for name, direction in names[:ROWS]:
        value, row = mechanism.coordinate(q, name, direction)
        driven = "driven" if direction in system.model.joints[name].driven else ""
        angle = f"{degrees(value):.2f}" if direction == "angle" else ""
        table.add_row(f"{name}.{direction}", _g(value), angle, _g(row[:-1] @ v + row[-1]), driven)
    if len(names) > ROWS:
        table.add_row(f"... {len(names) - ROWS} more")
    return table


def _remarks(system: "System") -> Iterator[tuple[str, str]]:
    from numpy import abs as size

    from fmbd.system.closure import RigidMechanism

    position = system.reference.stations(system.start.q)[0]
    for name in system.model.initial.place:
        x, y = position[system.station_of_place(name)]
        yield "place", f"{name} at ({x:.6g}, {y:.6g}) m"
    if system.constraints:
        mechanism = RigidMechanism(system.lowered, system.reference)
        miss = size(mechanism.equations(system.start.q, {}, {})[0]).max(initial=0.0)
        yield "loops", f"closed to {miss:.1e} m"
    for remark in system.start.remarks:
        yield "remark", remark


def _frequencies(system: "System") -> Iterator[tuple[str, str]]:
    """Natural frequencies of the mechanism at the start, and the steps they ask for."""
    from numpy.linalg import LinAlgError

    from fmbd.analyses import longest_step, natural_frequencies
    from fmbd.solvers.integrate import method

    label = "frequencies"
    if system.planar.nq > COORDINATES:
        yield label, f"not computed for more than {COORDINATES} coordinates"
        return
    try:
        found = natural_frequencies(system)
    except LinAlgError:
        yield label, "none: a coordinate moves no mass"
        return
    some = found[found > 0.0]
    if not some.size:
        yield label, "none: nothing is elastic"
        return
    free = f"; {found.size - some.size} motions are free" if some.size < found.size else ""
    most = f", ... {_g(some[-1], 4)}" if some.size > FREQUENCIES else ""
    yield label, f"{', '.join(_g(f, 4) for f in some[:FREQUENCIES])}{most} Hz{free}"
    yield "", "at the start, motors free, undamped; stiffness of beams and springs only, no gravity, no preload"
    simulation = system.model.simulation
    step = longest_step(method(simulation.method), float(some[-1]))
    if step < simulation.duration / 100.0:
        count = float(f"{simulation.duration / step:.2g}")
        yield "steps", f"the highest frequency keeps {simulation.method} below {step:.1e} s: {count:,.0f} steps or more"


def _simulation(system: "System") -> Iterator[tuple[str, str]]:
    s = system.model.simulation
    yield (
        "simulation",
        f"{s.duration:g} s by {s.method}, rtol {s.rtol:g}, atol {s.atol:g}, outputs every {s.output_interval:g} s",
    )


def _motors(system: "System") -> "Table":
    """What each motor moves, and what it is fed with."""
    from fmbd.model import ControllerRef

    table = columns("motor", "on joint", "input", "by")
    for k, (name, motor) in enumerate(list(system.model.motors.items())[:ROWS]):
        joint = f"{motor.joint}, gear {motor.gear_ratio:g}"
        if motor.transmission is not None:
            joint += f", elastic ({motor.transmission.stiffness:g} N m/rad)"
        unit = "V" if motor.type == "dc" else "N m"
        by = _law(system, k, unit) if isinstance(motor.input, ControllerRef) else _signal(motor.input, unit)
        table.add_row(name, joint, "voltage" if motor.type == "dc" else "torque", by)
    if len(system.model.motors) > ROWS:
        table.add_row(f"... {len(system.model.motors) - ROWS} more")
    return table


def _signal(signal: Any, unit: str) -> str:
    return f"{signal.value:g} {unit}" if signal.type == "constant" else f"{signal.type} over time"


def _law(system: "System", k: int, unit: str) -> str:
    """A motor's controller with its set point and feed-forward, as solved."""
    from fmbd.model import Constant, GravityCompensation, Placement

    motor = list(system.model.motors.values())[k]
    law = system.model.controllers[motor.input.name]
    record = system.planar.motors[k]
    control = system.planar.controllers[record.controller]
    target = law.target[motor.joint] if isinstance(law.target, dict) else law.target
    if isinstance(target, Placement):
        to = _g(control.shift)
    else:
        to = _g(control.scale * target.value) if target.type == "constant" else f"a {target.type} over time"
    measured = "joint" if control.pathway == record.joint_pathway else "rotor"
    text = f"{motor.input.name} ({law.type}), {measured} to {to}"
    if not isinstance(law.feedforward, GravityCompensation):
        text += f", plus {_signal(law.feedforward, unit)}" * (law.feedforward != Constant(value=0.0))
    elif law.feedforward.computed == "online":
        text += ", plus gravity compensation online"
    else:
        text += f", plus {_g(control.bias)} {unit} against gravity"
    return text + (f", within {law.limit[0]:g} to {law.limit[1]:g} {unit}" if law.limit else "")


def _g(value: float, digits: int = 6) -> str:
    return f"{value:.{digits}g}"
