"""A family of models, ever finer, and what it tells of the error of each: see convergence.py for the rules.

With several values to refine, each is refined while the others are at their finest: a star, not a grid, so that its
members are as many as there are values, and all share the finest.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.errors import ModelError, UnknownQuantity
from fmbd.model import Model, load_model
from fmbd.solvers.auto import TIGHT
from fmbd.studies.convergence import AGREEING, Convergence, Size, convergence
from fmbd.studies.measure import COMPLETE, Measured, columns_of, measure
from fmbd.studies.pool import Report, side_by_side

Array = np.ndarray

#: Finer means more of the one, less of the other; of other keys the values given tell.
_GROWING = ("elements", "segments", "modes", "stages")
_FALLING = ("rtol", "atol", "step", "max_step")
#: The run that shows the error of time has tolerances of this share, fixed steps of that.
TIGHTER, SHORTER = 0.1, 0.25
_TIGHTEST = 1e-13

#: Accuracies of which a verdict says what is enough.
ACCURACIES = (0.01, 0.001)


@dataclass(frozen=True)
class Axis:
    """A value of the model that is refined: from coarse to fine, of sizes h."""

    path: str
    values: tuple[Any, ...]
    sizes: tuple[float, ...]

    @property
    def key(self) -> str:
        """The last part of the path."""
        return self.path.rpartition(".")[2]

    @property
    def is_of_time(self) -> bool:
        """Whether it is the integration over time that is refined."""
        return self.path.startswith("simulation.")


@dataclass(frozen=True)
class Member:
    """A model of the family, by its changes, and what was measured; `problem` says why nothing was."""

    changes: Mapping[str, Any]
    measured: Measured | None
    problem: str = ""


@dataclass(frozen=True)
class Result:
    """A quantity along an axis: of those members that got to the end."""

    quantity: str
    unit: str
    axis: Axis
    members: tuple[int, ...]  #: their indices in the study
    values: tuple[Any, ...]  #: theirs on the axis
    found: Convergence
    time_error: Size | None  #: of the finest, where the axis is not that of time and it was measured
    is_over_time: bool

    @property
    def time_share(self) -> float | None:
        """Error of the time integration, in shares of the difference between the two finest."""
        last = self.found.steps[-1].mean
        return self.time_error.mean / last if self.time_error is not None and last > 0.0 else None

    @property
    def verdict(self) -> str:
        """How right the finest is, and what is enough, in one plain sentence."""
        key, finest, share = self.axis.key, self.values[-1], percent(self.found.shares()[-1])
        if self.found.is_exact:
            return f"{self.quantity}: the same with {key} = {self.values[-2]:g} and {finest:g}, to round-off"
        if self.found.is_settled:
            begin = f"{self.quantity} converges with order {self.found.order:.2g} in {key}"
            return f"{begin}: {finest:g} is right to {share}, {self._enough()}"
        begin = f"{self.quantity}: not in the asymptotic range of {key} ({self._reason})"
        return f"{begin}; {finest:g} is right to about {share}, {self._enough()}"

    def _enough(self) -> str:
        """What suffices for which accuracy."""
        enough: dict[str, list[str]] = {}
        for accuracy in ACCURACIES:
            values = [value for value, share in zip(self.values, self.found.shares()) if share <= accuracy]
            by = f"{values[0]:g} is enough" if values else "none is enough"
            enough.setdefault(by, []).append(percent(accuracy))
        return ", ".join(f"{by} for {' and '.join(accuracies)}" for by, accuracies in enough.items())

    @property
    def _reason(self) -> str:
        """Why no order is settled."""
        orders = self.found.orders
        if len(orders) < 2:
            return "it takes four members to tell"
        if self.time_share is not None and self.time_share > 0.1:
            return "the time integration disturbs it"
        if any(np.isnan(order.order) for order in orders[-2:]):
            return "differences do not shrink"
        if min(order.agreement for order in orders[-2:]) < AGREEING:
            return "differences change their course"
        return f"orders differ: {orders[-2].order:.2g}, then {orders[-1].order:.2g}"


@dataclass(frozen=True)
class Study:
    """What `refine` finds."""

    model: Model
    analysis: str
    quantities: tuple[str, ...]
    axes: tuple[Axis, ...]
    members: tuple[Member, ...]
    check: Member | None  #: the finest, integrated more tightly
    is_interrupted: bool = False

    def chain(self, axis: Axis) -> tuple[int, ...]:
        """The members along an axis, from coarse to fine: the others are at their finest."""
        changes = [dict(member.changes) for member in self.members]
        return tuple(changes.index(finest(self.axes) | {axis.path: value}) for value in axis.values)

    @cached_property
    def results(self) -> tuple[Result, ...]:
        """Each quantity along each axis that has two members or more."""
        return tuple(
            result for name in self.quantities for axis in self.axes for result in self._result(name, axis)
        )

    def result(self, quantity: str, path: str | None = None) -> Result:
        """A quantity along the axis of a path, default: the first; raises KeyError."""
        for result in self.results:
            if result.quantity == quantity and path in (None, result.axis.path):
                return result
        raise KeyError(f"{quantity} along {path or 'any axis'}")

    def _result(self, name: str, axis: Axis) -> Iterator[Result]:
        chain = self.chain(axis)
        done = [k for k, i in enumerate(chain) if self.members[i].measured is not None]
        if len(done) < 2:
            return
        measured = [self.members[chain[k]].measured for k in done]
        values = [found.values[name] for found in measured if found is not None]
        disturbance = None
        if not axis.is_of_time and self.check is not None and self.check.measured is not None:
            reference = self.members[self.chain(axis)[-1]].measured
            if reference is not None:
                disturbance = Size.of(reference.values[name] - self.check.measured.values[name])
        assert measured[-1] is not None
        yield Result(
            quantity=name,
            unit=measured[-1].units[name],
            axis=axis,
            members=tuple(chain[k] for k in done),
            values=tuple(axis.values[k] for k in done),
            found=convergence(values, [axis.sizes[k] for k in done], disturbance),
            time_error=disturbance,
            is_over_time=measured[-1].time is not None,
        )

    def save(self, path: str | Path) -> None:
        """Write an HDF5 file with all members, series and settings, see study_file.py."""
        from fmbd.studies.study_file import write_study

        write_study(self, Path(path))

    def plot(self, path: str | Path) -> None:
        """Draw values, differences over time, and errors against what is refined: svg, pdf or png."""
        from fmbd.studies.plot import draw

        draw(self, Path(path))


def refine(
    model: Model | str | Path,
    over: Mapping[str, Sequence[Any]],
    quantities: Sequence[str],
    analysis: str = "run",
    jobs: int = 1,
    check: bool = True,
    on_progress: Report | None = None,
) -> Study:
    """Refine a model and say how right it is.

    over: values from coarse to fine by path, such as {"bodies.*.elements": [1, 2, 4, 8]}; of several each is refined
    while the others are at their finest
    quantities: names of a Run, or `frequency.1` and so on with the analysis `modes`
    jobs: processes; a script that wants more than one needs `if __name__ == "__main__"`
    check: whether the finest is run once more, with a tighter tolerance, to measure the error of time

    A member that fails is reported in the study and left out of it; Ctrl-C leaves out what is not done. Raises
    ModelError and UnknownQuantity before anything is run.
    """
    if not isinstance(model, Model):
        model = load_model(model)
    axes = tuple(_axis(path, values) for path, values in over.items())
    family = _family(axes)
    models = [changed(model, changes) for changes in family]
    _comparable(models, quantities, analysis)
    check = check and analysis == "run" and not all(axis.is_of_time for axis in axes)
    queue = [(changes, member) for changes, member in zip(family, models)]
    if check:
        tight = tightened(models[-1])
        queue.append((finest(axes) | tight, changed(models[-1], tight)))
    # the coarsest first, it compiles for all; then those that take longest
    order = [0, *range(len(queue) - 1, 0, -1)]
    tasks = [partial(_measured, queue[k][1], tuple(quantities), analysis) for k in order]
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
        analysis=analysis,
        quantities=tuple(quantities),
        axes=axes,
        members=tuple(members[: len(family)]),
        check=members[-1] if check else None,
        is_interrupted=interrupted,
    )


def _measured(model: Model, names: Sequence[str], analysis: str, report: Report) -> Measured:
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


def finest(axes: Sequence[Axis]) -> dict[str, Any]:
    """The changes of the finest member."""
    return {axis.path: axis.values[-1] for axis in axes}


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
        return {
            "simulation.method": "radau",
            **tighter,
        }  # auto would be explicit there, also where beams are stiff
    return tighter


def _comparable(models: Sequence[Model], names: Sequence[str], analysis: str) -> None:
    """Raise UnknownQuantity or ModelError where members could not be compared."""
    first, last = (columns_of(model, names, analysis) for model in (models[0], models[-1]))
    for name in names:
        if first[name] != last[name]:
            raise UnknownQuantity(
                f"'{name}' has a column for each node, other ones in each member: ask for a point, such as "
                f"{name.rpartition('.')[0]}.end.{name.rpartition('.')[2]}"
            )
    times = {(model.simulation.duration, model.simulation.output_interval) for model in models}
    if analysis == "run" and len(times) > 1:
        raise ModelError(["members must have the same duration and output interval to be compared"])


def percent(share: float) -> str:
    """A share with two digits: 0.13 %."""
    return f"{100 * share:.2g} %"
