"""`fmbd check`: what a model is, so that its author sees whether it is what was meant."""

import argparse
from collections.abc import Iterator
from math import degrees, tau
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import DONE, add_model, columns, facts, read_model, show, shown

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
    from fmbd.system import assemble

    model = read_model(args)
    system = assemble(model)
    show(f"{model.name}  ({args.model})", style="bold")
    if model.description:
        show(model.description.strip())
    show("", _bodies(system), "", facts([*_forces(system), *_freedom(system)]))
    if any(joint.coordinates for joint in model.joints.values()):
        show("", _start(system))
    show(
        "",
        facts(
            [
                *_remarks(system),
                *_truncations(system),
                *_frequencies(system),
                *_motors(system),
                *_simulation(system),
            ]
        ),
    )
    return DONE


def _bodies(system: "System") -> "Table":
    """The spanning tree: each body under the one that carries it, and by which joint."""
    table = columns("body", "carried by", "properties")
    links = system.lowered.whole.links
    for link, branch in zip(links[:ROWS], _branches(system), strict=False):
        if link.motor is not None:
            motor = system.model.motors[link.motor]
            by, what = (
                f"{link.motor} ({motor.type}, gear {motor.gear_ratio:g})",
                f"{motor.rotor_inertia:g} kg m^2",
            )
        else:
            by = f"{link.joint} ({system.model.joints[str(link.joint)].type})"
            what = _body(system, link.name)
        table.add_row(branch + link.name, by, what)
    if len(links) > ROWS:
        table.add_row(f"... {len(links) - ROWS} more")
    return table


def _body(system: "System", name: str) -> str:
    lowered, body = system.lowered, system.model.bodies[name]
    segments = lowered.segmentation.beams.get(name, ())
    parts = [lowered.body_index[segment.body] for segment in segments] or [lowered.body_index[name]]
    mass = f"{_g(system.planar.bodies['mass'][parts].sum())} kg"
    if not segments:
        return f"{mass}, {_g(body.inertia)} kg m^2"
    count = len(body.nodes) - 1
    elements = "1 element" if count == 1 else f"{count} elements"
    if len(parts) > 1:
        return f"{mass}, beam of {body.length:g} m, {elements} in {len(parts)} segments"
    first = f"first frequency {_g(lowered.omega2[parts[0]][0] ** 0.5 / tau, 4)} Hz ({body.frame})"
    return f"{mass}, beam of {body.length:g} m, {elements}, {first}"


def _branches(system: "System") -> Iterator[str]:
    """The lines of the tree before the name of each body."""
    links = system.lowered.whole.links
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

    for name in system.lowered.whole.cut[:ROWS]:
        joint = system.model.joints[name]
        ends = " and ".join(f"{ref.body}.{ref.point}" for ref in joint.between)
        yield "loop", f"closed by {name} ({joint.type}) of {ends}"
    elastic = int(system.elastic.sum())
    rotors = int(system.planar.bodies["rotor"].sum())
    parts = (system.planar.nq - elastic - rotors, "of joints"), (rotors, "of rotors"), (elastic, "elastic")
    yield "coordinates", ", ".join(f"{n} {what}" for n, what in parts if n) or "none"
    freedom = mobility(system)
    rigid = f"; {freedom.rigid} of the rigid mechanism" if elastic or rotors else ""
    yield (
        "degrees of freedom",
        f"{freedom.degrees_of_freedom} = {freedom.coordinates} coordinates "
        f"- {freedom.independent} independent constraints{rigid}",
    )
    for redundancy in freedom.redundant[:ROWS]:
        yield "redundant", f"{redundancy.constraint} {_why(redundancy.follows_from)}"


def _why(constraints: tuple[str, ...]) -> str:
    return f"follows from {shown(constraints)}" if constraints else "holds what cannot move"


def _start(system: "System") -> "Table":
    """Joint coordinates at the start, those of driven and cut joints included."""
    from fmbd.system.closure import RigidMechanism

    mechanism = RigidMechanism(system.lowered, system.reference)
    q, v = system.start.q, system.start.v
    own = {name: k for k, name in enumerate(system.coordinate_names)}
    table = columns("at the start", "[m, rad]", "[deg]", "rate [1/s]")
    names = [(name, d) for name, joint in system.model.joints.items() for d in joint.coordinates]
    for name, direction in names[:ROWS]:
        coordinate = f"{name}.{direction}"
        if coordinate in own:
            value, rate = q[own[coordinate]], v[own[coordinate]]
        else:  # of a cut or driven joint
            value, row = mechanism.coordinates(q, [(name, direction)])[0]
            rate = row[:-1] @ v + row[-1]
        angle = f"{degrees(value):.2f}" if direction == "angle" else ""
        table.add_row(coordinate, _g(value), angle, _g(rate))
    if len(names) > ROWS:
        table.add_row(f"... {len(names) - ROWS} more")
    return table


def _remarks(system: "System") -> Iterator[tuple[str, str]]:
    import numpy as np

    from fmbd.results.looks import visuals
    from fmbd.results.watch import start_warnings
    from fmbd.system.closure import RigidMechanism

    position = system.reference.stations(system.start.q)[0]
    for name in system.model.initial.place:
        x, y = position[system.station_of_place(name)]
        yield "place", f"{name} at ({x:.6g}, {y:.6g}) m"
    if system.planar.held.size:
        mechanism = RigidMechanism(system.lowered, system.reference)
        miss = np.abs(mechanism.equations(system.start.q, {}, {})[0]).max()
        yield "loops", f"closed to {miss:.1e} m or rad"
    for remark in system.start.remarks:
        yield "remark", remark
    for warning in start_warnings(system):
        yield "warning", warning
    yield from visuals(system)


def _truncations(system: "System") -> Iterator[tuple[str, str]]:
    """What beams with some of their modes have left."""
    for name, kept in list(system.lowered.truncations.items())[:ROWS]:
        where = "at its end" if kept.beam.frame == "clamped" else "in its middle"
        yield (
            "modes",
            f"{name} keeps {len(kept.beam.K)} of {kept.modes}: {kept.effective_mass:.2%} of their effective mass, "
            f"{kept.compliance:.3%} of the static compliance {where}; the next is at {_g(kept.next_frequency, 4)} Hz",
        )


def _frequencies(system: "System") -> Iterator[tuple[str, str]]:
    """Natural frequencies of the mechanism at the start, and the steps they ask for."""
    from fmbd.analyses import longest_step, natural_frequencies
    from fmbd.errors import AnalysisError
    from fmbd.solvers.methods import explicit_tableau

    label = "frequencies"
    if system.planar.nq > COORDINATES:
        yield label, f"not computed for more than {COORDINATES} coordinates"
        return
    try:
        found = natural_frequencies(system)
    except AnalysisError:
        yield label, "none: a coordinate moves no mass"
        return
    some = found[found > 0.0]
    if not some.size:
        yield label, "none: no spring or beam opposes a motion"
        return
    free = f"; {found.size - some.size} motions are free" if some.size < found.size else ""
    most = f", ... {_g(some[-1], 4)}" if some.size > FREQUENCIES else ""
    yield label, f"{', '.join(_g(f, 4) for f in some[:FREQUENCIES])}{most} Hz{free}"
    motors = "motors free, " if system.model.motors else ""
    yield (
        "",
        f"at the start, {motors}undamped; stiffness of beams and springs only (`fmbd modes`: all forces)",
    )
    simulation = system.model.simulation
    tableau = explicit_tableau(simulation.method)
    if tableau is None:
        return
    step = longest_step(tableau, float(some[-1]), float(system.planar.modal_damping.max(initial=0.0)))
    if step < simulation.duration / 100.0:
        count = float(f"{simulation.duration / step:.2g}")
        automatic = simulation.method == "auto"
        explicit = "dop853" if automatic else simulation.method
        instead = "; auto tries rodas5p" if automatic else ""
        yield (
            "steps",
            f"the fastest mode keeps {explicit} below {step:.1e} s: {count:,.0f} steps or more{instead}",
        )


def _simulation(system: "System") -> Iterator[tuple[str, str]]:
    s = system.model.simulation
    yield (
        "simulation",
        f"{s.duration:g} s by {s.method}, rtol {s.rtol:g}, atol {s.atol:g}, outputs every {s.output_interval:g} s",
    )


def _motors(system: "System") -> Iterator[tuple[str, str]]:
    """What each motor moves, and what it is fed with."""
    from fmbd.model import ControllerRef

    for k, (name, motor) in enumerate(list(system.model.motors.items())[:ROWS]):
        shaft = f" through {motor.transmission.stiffness:g} N m/rad" if motor.transmission else ""
        quantity, unit = ("voltage", "V") if motor.type == "dc" else ("torque", "N m")
        by = _law(system, k, unit) if isinstance(motor.input, ControllerRef) else _signal(motor.input, unit)
        yield name, f"moves {motor.joint}{shaft}; {quantity}: {by}"
    if len(system.model.motors) > ROWS:
        yield "motors", f"... {len(system.model.motors) - ROWS} more"


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
    measure = "rad" if system.model.joints[motor.joint].motor_coordinate == "angle" else "m"
    if isinstance(target, Placement):
        to = f"{_g(control.shift)} {measure}"
    elif target.type == "constant":
        to = f"{_g(control.scale * target.value)} {measure}"
    else:
        to = f"a {target.type} over time"
    measured = "joint" if control.pathway == record.joint_pathway else "rotor"
    text = f"{motor.input.name} ({law.type}) takes the {measured} to {to}"
    if not isinstance(law.feedforward, GravityCompensation):
        text += f", plus {_signal(law.feedforward, unit)}" * (law.feedforward != Constant(value=0.0))
    elif law.feedforward.computed == "online":
        text += ", plus gravity compensation online"
    else:
        text += f", plus {_g(control.bias)} {unit} against gravity"
    return text + (f", within {law.limit[0]:g} to {law.limit[1]:g} {unit}" if law.limit else "")


def _g(value: float, digits: int = 6) -> str:
    return f"{value:.{digits}g}"
