"""`fmbd statics`: where a mechanism is at rest, and with which forces."""

import argparse
from collections.abc import Iterator
from math import degrees, sqrt, tau
from typing import TYPE_CHECKING, Any

from fmbd.cli.common import (
    DONE,
    add_model,
    add_output,
    add_rest,
    columns,
    compiling_announced,
    facts,
    number,
    read_model,
    show,
    shown,
    write_output,
)

if TYPE_CHECKING:
    from rich.table import Table

    from fmbd.analyses.statics import Equilibrium

#: Rows of a table.
ROWS = 30
KINDS = (".h5", ".json", ".csv")


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "statics",
        help="find the equilibrium: positions, deflections, forces in joints and motors",
        description="Find where a mechanism is at rest under gravity, loads, springs, beams and motors: by Newton's "
        "method from the start, let down gently where it would fall. Beams bend linearly in their floating frames.",
    )
    add_model(parser)
    add_rest(parser)
    parser.add_argument(
        "--quantities",
        metavar="NAME",
        nargs="+",
        help="print these alone: names as `fmbd info ARCHIVE --names` lists them",
    )
    add_output(parser, "all quantities, with their units", KINDS)
    parser.set_defaults(command=_statics)


def _statics(args: argparse.Namespace) -> int:
    from fmbd.analyses.statics import equilibrium

    model = read_model(args)
    with compiling_announced():
        rest = equilibrium(model, time=args.time or 0.0, lock=args.lock, moving=args.moving)
    if args.quantities:
        show(_quantities(rest, args.quantities))
    else:
        show(f"{model.name}: {_TITLES[rest.verdict]} at t = {rest.run.time[0]:g} s", style="bold")
        show(facts(_found(rest)))
        for table in (
            _coordinates(rest),
            _points(rest),
            _beams(rest),
            _joints(rest),
            _motors(rest),
            _springs(rest),
        ):
            if table.row_count:
                show("", table)
    write_output(args.output, rest.data(), rest.table())
    return DONE


_TITLES = {
    "stable": "stable equilibrium",
    "unstable": "UNSTABLE equilibrium",
    "indifferent": "indifferent equilibrium",
}


def held(locked: tuple[str, ...], chosen: bool) -> str:
    """What is done with the motors that are held."""
    why = "" if chosen else "; free, they would let the mechanism move (--lock none)"
    return f"{shown(locked)} at the start angle{'s' if len(locked) > 1 else ''}{why}"


def _found(rest: "Equilibrium") -> Iterator[tuple[str, str]]:
    if rest.locked:
        yield "motors held", held(rest.locked, rest.chosen)
    steps = "1 step" if rest.iterations == 1 else f"{rest.iterations} steps"
    yield "found", f"in {steps}; {rest.residual:.1e} N or N m left"
    moving = shown(rest.softest, most=2)
    if not rest.softest:
        yield "stability", "nothing can move"
    elif rest.verdict == "indifferent":
        yield "stability", f"nothing opposes a motion of {moving}"
    elif rest.verdict == "stable":
        frequency = sqrt(rest.stiffness) / tau
        yield "stability", f"least stiff against a motion of {moving}: as at {number(frequency, 4)} Hz"
    else:
        time = 1.0 / sqrt(-rest.stiffness)
        yield "stability", f"a motion of {moving} would grow, by e in {number(time, 3)} s if nothing damps it"
    yield (
        "energy",
        f"{number(rest['energy.potential'])} J of gravity, {number(rest['energy.elastic'])} J elastic",
    )
    for remark in rest.remarks:
        yield "remark", remark


def _quantities(rest: "Equilibrium", names: list[str]) -> "Table":
    table = columns("quantity", "value [unit]", "unit")
    for name in names:
        values = rest[name]
        for part, value in zip(rest.run.columns(name) or ("",), values.ravel(), strict=True):
            table.add_row(f"{name}.{part}".rstrip("."), number(value, 10), rest.run.units(name))
    return table


def _coordinates(rest: "Equilibrium") -> "Table":
    """Joint coordinates, and rotors; how far from the start."""
    from fmbd.system.closure import RigidMechanism

    system = rest.run.system
    mechanism = RigidMechanism(system.lowered, system.reference)
    start = dict(zip(system.coordinate_names, system.start.q, strict=True))
    table = columns("coordinate", "[m, rad]", "[deg]", "from the start [m, rad]")
    names = [(n, d) for n, joint in system.model.joints.items() for d in joint.coordinates]
    rotors = [link.name for link in system.tree.links if link.motor is not None]
    before = [value for value, _ in mechanism.coordinates(system.start.q, names)]
    labels = [*(".".join(name) for name in names), *rotors]
    for name, old in list(zip(labels, [*before, *(start[name] for name in rotors)], strict=True))[:ROWS]:
        value = float(rest[name])
        angle = "" if name.endswith((".x", ".y")) else number(degrees(value))
        table.add_row(name, number(value), angle, number(value - old, 4))
    return _cut(table, len(names) + len(rotors))


def _points(rest: "Equilibrium") -> "Table":
    table = columns("point", "x [m]", "y [m]")
    bodies = rest.run.model.bodies.items()
    names = [f"{name}.{point}" for name, body in bodies for point in body.points if not _is_given(point)]
    for name in names[:ROWS]:
        table.add_row(name, *(number(value) for value in rest[f"{name}.position"]))
    return _cut(table, len(names))


def _is_given(point: str) -> bool:
    """A point that every body has, and nobody named."""
    return point in ("origin", "center_of_mass", "start") or point.removeprefix("node").isdecimal()


def _beams(rest: "Equilibrium") -> "Table":
    system = rest.run.system
    table = columns("beam", "deflection [m]", "at", "bending moment [N m]", "at")
    names = list(system.lowered.segmentation.beams)
    for name in names[:ROWS]:
        row = [name]
        for quantity in ("deflection", "bending_moment"):
            values = rest[f"{name}.{quantity}"]
            k = int(abs(values).argmax())
            row += [number(values[k]), rest.run.columns(f"{name}.{quantity}")[k]]
        table.add_row(*row)
    return _cut(table, len(names))


def _joints(rest: "Equilibrium") -> "Table":
    """What the constraints of each joint put on the body of its first point."""
    from math import hypot

    table = columns("joint", "force x [N]", "y [N]", "size [N]", "moment [N m]", "on")
    joints = list(rest.run.model.joints.items())
    for name, joint in joints[:ROWS]:
        x, y = rest[f"{name}.force"]
        on = f"{joint.between[0].body}.{joint.between[0].point}"
        table.add_row(name, number(x), number(y), number(hypot(x, y)), number(rest[f"{name}.moment"]), on)
    return _cut(table, len(joints))


def _motors(rest: "Equilibrium") -> "Table":
    table = columns("motor", "input [V, N m]", "torque on the rotor [N m]", "on the joint [N m, N]")
    motors = list(rest.run.model.motors.items())
    for name, motor in motors[:ROWS]:
        torque = rest[f"{name}.torque"]
        given = rest[f"{name}.voltage"] if motor.type == "dc" else torque
        table.add_row(name, number(given), number(torque), number(rest[f"{name}.transmission_torque"]))
    return _cut(table, len(motors))


def _springs(rest: "Equilibrium") -> "Table":
    table = columns("spring", "length or angle [m, rad]", "force or moment [N, N m]")
    springs = list(rest.run.model.springs.items())
    for name, spring in springs[:ROWS]:
        pair = ("angle", "moment") if spring.type == "torsional" else ("length", "force")
        table.add_row(name, *(number(rest[f"{name}.{quantity}"]) for quantity in pair))
    return _cut(table, len(springs))


def _cut(table: "Table", count: int) -> "Table":
    if count > ROWS:
        table.add_row(f"... {count - ROWS} more")
    return table
