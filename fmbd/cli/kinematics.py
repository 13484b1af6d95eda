"""`fmbd kinematics`: where a point goes, and how far the mechanism is from singular positions."""

import argparse
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Never

from fmbd.cli.common import (
    DONE,
    add_model,
    add_output,
    compiling_announced,
    facts,
    number,
    read_model,
    show,
    write_output,
)
from fmbd.cli.inverse import add_motion

if TYPE_CHECKING:
    from fmbd.analyses.kinematics import Kinematics

KINDS = (".csv", ".h5", ".json", ".npz", ".mat")


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "kinematics",
        help="where a point goes, its workspace, singular positions",
        description="Kinematics of the rigid mechanism, beams straight: where a point goes when joints move, which "
        "joints take it along a path, what it reaches over a grid of joint values; how well conditioned that is, and "
        "the nearest singular positions: parallel (type 2), where the joints do not hold the mechanism, and serial "
        "(type 1), where the point cannot move in some direction, or moved by one joint does not move at all.",
    )
    add_model(parser)
    add_motion(parser)
    parser.add_argument(
        "--sweep",
        metavar="JOINT=FIRST:LAST:COUNT",
        action="append",
        type=_range,
        help="a grid of joint values [rad or m], for the workspace; once for each input",
    )
    add_output(parser, "all positions, Jacobians and determinants", KINDS)
    parser.set_defaults(command=lambda args: _kinematics(args, parser.error))


def _range(text: str) -> tuple[str, list[float]]:
    name, _, numbers = text.partition("=")
    try:
        first, last, count = numbers.split(":")
        low, high, n = float(first), float(last), int(count)
        if n < 2:
            raise ValueError
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"'{text}' is not of the form JOINT=FIRST:LAST:COUNT, COUNT from 2 on"
        ) from None
    return name, [low + (high - low) * k / (n - 1) for k in range(n)]


def _kinematics(args: argparse.Namespace, refuse: Callable[[str], Never]) -> int:
    from fmbd.analyses.kinematics import kinematics

    ways = {"joints": args.joints, "path": args.path, "file": args.file, "sweep": args.sweep}
    if args.point is None or sum(value is not None for value in ways.values()) != 1:
        refuse("give a --point, and one of --joint, --path, --file and --sweep")
    for name in ("joints", "sweep"):
        ways[name] = dict(ways[name]) if ways[name] else None
    model = read_model(args)
    with compiling_announced():
        found = kinematics(model, args.point, **ways)
    show(f"{model.name}: kinematics of {found.point}", style="bold")
    show(facts(_facts(found)))
    write_output(args.output, found.data(), found.table())
    return DONE


def _facts(found: "Kinematics") -> Iterator[tuple[str, str]]:
    n = len(found.position)
    yield "positions", f"{n}" if n == found.wanted else f"{n} of {found.wanted} on the grid can be reached"
    for name, values in zip(found.inputs, found.values.T, strict=True):
        yield name, f"from {number(values.min(), 5)} to {number(values.max(), 5)}"
    (x0, y0), (x1, y1) = found.place.min(axis=0), found.place.max(axis=0)
    yield (
        "point",
        f"x from {number(x0, 5)} to {number(x1, 5)} m, y from {number(y0, 5)} to {number(y1, 5)} m",
    )
    if len(found.inputs) > 1:
        worst = int(found.condition.argmax())
        yield (
            "condition",
            f"of dp/d(inputs): from {number(found.condition.min(), 4)} to {number(found.condition[worst], 4)}, "
            f"{_position(found, found.values[worst], found.place[worst])}",
        )
    for kind in ("parallel", "serial"):
        yield kind, "; ".join(_singular(found, kind))


def _singular(found: "Kinematics", kind: str) -> Iterator[str]:
    """Measures of a kind: their size, what is passed, what is near."""
    values, single = getattr(found, kind), kind == "serial" and len(found.inputs) == 1
    if values[0] != values[0]:
        yield "- (of one or two inputs only)"
        return
    measure = f"|dp/d({found.inputs[0]})|" if single else "determinant"
    yield f"{measure} from {number(values.min(), 4)} to {number(values.max(), 4)}"
    on_a_way = found.time[-1] > 0.0
    passed = found.crossings(kind) if on_a_way or single else []
    if passed:
        shown = ", ".join(_passed(found, k) for k in passed[:5])
        yield f"PASSED at {shown}{' ...' if len(passed) > 5 else ''}"
    elif single:
        k = int(values.argmin())
        yield f"least {_position(found, found.values[k], found.place[k])}"
    elif near := found.nearest(kind):
        yield f"nearest {number(near.distance, 4)} m away, {_position(found, near.inputs, near.place)}"
    else:
        yield "no singular position found"


def _passed(found: "Kinematics", k: int) -> str:
    """When, or on a grid of one input where, a singular position is passed."""
    if found.time[-1] > 0.0:
        return f"{found.time[k]:.4g} s"
    return f"{found.inputs[0]} {number(found.values[k, 0], 4)}"


def _position(found: "Kinematics", inputs: Any, place: Any) -> str:
    joints = ", ".join(f"{name} {number(value, 4)}" for name, value in zip(found.inputs, inputs, strict=True))
    return f"at ({number(place[0], 4)}, {number(place[1], 4)}) m with {joints}"
