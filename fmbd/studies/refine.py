"""A family of models, ever finer, and what it tells of the error of each: see convergence.py for the rules.

With several values to refine, each is refined while the others are at their finest: a star, not a grid, so that its
members are as many as there are values, and all share the finest.
"""

import re
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

from fmbd.errors import ModelError, UnknownQuantity
from fmbd.model import Beam, Model, load_model
from fmbd.solvers.auto import TIGHT
from fmbd.studies.measure import COMPLETE, Analysis, Kind, Measured, columns_of, measure
from fmbd.studies.pool import Report, side_by_side
from fmbd.studies.study import Axis, Member, Study, finest

#: Finer means more of the one, less of the other; of other keys the values given tell.
_GROWING = ("elements", "segments", "modes", "stages")
_FALLING = ("rtol", "atol", "step", "max_step")
#: The run that shows the error of time has tolerances of this share, fixed steps of that.
TIGHTER, SHORTER = 0.1, 0.25
_TIGHTEST = 1e-13


def refine(
    model: Model | str | Path,
    over: Mapping[str, Sequence[Any]],
    quantities: Sequence[str],
    analysis: Kind = "run",
    jobs: int = 1,
    check: bool = True,
    on_progress: Report | None = None,
    *,
    time: float | None = None,
    lock: str | Sequence[str] | None = None,
    moving: bool = False,
) -> Study:
    """Refine a model and say how right it is.

    over: values from coarse to fine by path, such as {"bodies.*.elements": [1, 2, 4, 8]}; of several each is refined
    while the others are at their finest
    quantities: names of a Run, or what other analyses have: see `measure.Analysis`
    analysis: `run`, `statics`, `modes` or `frequencies`
    jobs: processes; a script that wants more than one needs `if __name__ == "__main__"`
    check: whether the finest is run once more, with a tighter tolerance, to measure the error of time
    time, lock, moving: of statics and modes, as `fmbd.equilibrium` takes them

    A member that fails is reported in the study and left out of it; Ctrl-C leaves out what is not done. Raises
    ModelError and UnknownQuantity before anything is run.
    """
    if not isinstance(model, Model):
        model = load_model(model)
    asked = Analysis.of(analysis, time, lock, moving)
    axes = tuple(_axis(path, values) for path, values in over.items())
    family = _family(axes)
    models = [changed(model, changes) for changes in family]
    _comparable(models, quantities, asked)
    check = check and analysis == "run" and not all(axis.is_of_time for axis in axes)
    queue = [(changes, member) for changes, member in zip(family, models)]
    if check:
        tight = tightened(models[-1])
        queue.append((finest(axes) | tight, changed(models[-1], tight)))
    # the coarsest first, it compiles for all; then those that take longest
    order = [0, *range(len(queue) - 1, 0, -1)]
    tasks = [partial(_measured, queue[k][1], tuple(quantities), asked) for k in order]
    found: dict[int, Any] = {}
    interrupted = False
    try:
        for k, result in side_by_side(tasks, jobs, on_progress):
            found[order[k]] = result
    except KeyboardInterrupt:
        interrupted = True
    members = [_member(changes, found.get(k)) for k, (changes, _) in enumerate(queue)]
    return Study(
        model=model,
        analysis=asked,
        quantities=tuple(quantities),
        axes=axes,
        members=tuple(members[: len(family)]),
        check=members[-1] if check else None,
        is_interrupted=interrupted,
    )


def _measured(model: Model, names: Sequence[str], analysis: Analysis, report: Report) -> Measured:
    return measure(model, names, analysis, report)


def _member(changes: Mapping[str, Any], result: "Measured | Exception | None") -> Member:
    if result is None:
        return Member(changes, None, "interrupted")
    if isinstance(result, Exception):
        return Member(changes, None, f"{type(result).__name__}: {result}")
    return Member(changes, result) if result.status == COMPLETE else Member(changes, None, result.status)


def _axis(path: str, values: Sequence[Any]) -> Axis:
    """Checks that values are numbers, two or more, from coarse to fine."""
    if any(isinstance(value, bool) or not isinstance(value, int | float) for value in values):
        raise ModelError([f"{path}: what is refined must be numbers, not {', '.join(map(str, values))}"])
    grows = all(a < b for a, b in pairwise(values))
    falls = all(a > b for a, b in pairwise(values))
    key = path.rpartition(".")[2]
    if len(values) < 2 or not (grows or falls) or min(values) <= 0:
        raise ModelError([f"{path}: give two positive values or more, from coarse to fine, such as 1,2,4,8"])
    if (key in _GROWING and falls) or (key in _FALLING and grows):
        backwards = ",".join(f"{value:g}" for value in reversed(values))
        raise ModelError([f"{path}: give the values from coarse to fine: {backwards}"])
    return Axis(path, tuple(values), tuple(1.0 / value if grows else float(value) for value in values))


def _family(axes: Sequence[Axis]) -> list[dict[str, Any]]:
    """Changes of all members, the finest last."""
    coarser = [finest(axes) | {axis.path: value} for axis in axes for value in axis.values[:-1]]
    return [*coarser, finest(axes)]


def changed(model: Model, changes: Mapping[str, Any]) -> Model:
    """A copy of a model with all changes; raises ModelError."""
    for path, value in changes.items():
        model = model.with_(path, value)
    return model


def tightened(model: Model) -> dict[str, Any]:
    """Changes that make the error of time a small part of what it is."""
    simulation = model.simulation
    step = simulation.generalized_alpha.step
    if simulation.method == "generalized_alpha" and step is not None:
        return {"simulation.generalized_alpha.step": SHORTER * step}
    rtol, atol = (float(f"{max(TIGHTER * x, _TIGHTEST):.6g}") for x in (simulation.rtol, simulation.atol))
    tighter = {"simulation.rtol": rtol, "simulation.atol": atol}
    if simulation.method == "auto" and rtol < TIGHT <= simulation.rtol:
        # auto would be explicit there, also where beams are stiff
        return {"simulation.method": "radau"} | tighter
    return tighter


def _comparable(models: Sequence[Model], names: Sequence[str], analysis: Analysis) -> None:
    """Raise UnknownQuantity or ModelError where members could not be compared."""
    for name in names:
        _at_one_place(models, name)
    first, last = (columns_of(model, names, analysis) for model in (models[0], models[-1]))
    for name in names:
        if first[name] != last[name]:
            raise UnknownQuantity(
                f"'{name}' has a column for each node, other ones in each member: ask for a point, such as "
                f"{name.rpartition('.')[0]}.end.{name.rpartition('.')[2]}"
            )
    times = {(model.simulation.duration, model.simulation.output_interval) for model in models}
    if analysis.kind == "run" and len(times) > 1:
        raise ModelError(["members must have the same duration and output interval to be compared"])


def _at_one_place(models: Sequence[Model], name: str) -> None:
    """Raise UnknownQuantity for a quantity at a node that is elsewhere in other members, or not there."""
    body, *parts = re.sub(r"^mode\.\d+\.", "", name).split(".")
    for part in parts:
        number = re.fullmatch(r"(node|w|slope)(\d+)", part)
        beams = [beam for model in models if isinstance(beam := model.bodies.get(body), Beam)]
        if number is None or not beams:
            continue
        ends = [(beam.points.get(f"node{number[2]}"), beam.length) for beam in beams]
        places = {None if x is None else round(x / length, 9) for x, length in ends}
        if len(places) > 1:
            x = next(x for x, _ in ends if x is not None)
            quantity = {"w": "deflection", "slope": "slope"}.get(
                number[1], next((other for other in parts if other != part), "deflection")
            )
            raise UnknownQuantity(
                f"'{name}' is at another place in each member: give the place a name, such as "
                f"--set bodies.{body}.points.here={x:g}, and ask for {body}.here.{quantity}"
            )
