"""What a refinement finds: members, results along each axis, verdicts."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.model import Model
from fmbd.studies.convergence import AGREEING, Convergence, Size, convergence
from fmbd.studies.measure import Analysis, Measured

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
    def is_certain(self) -> bool:
        """Whether the error of the finest is known, not guessed."""
        return self.found.is_exact or self.found.is_settled

    @property
    def verdict(self) -> str:
        """How right the finest is, and what is enough, in one plain sentence."""
        key, finest, share = self.axis.key, self.values[-1], percent(self.found.shares()[-1])
        if self.found.is_exact:
            return f"{self.quantity}: the same with {key} = {self.values[-2]:g} and {finest:g}, to round-off"
        if self.found.is_settled:
            begin = f"{self.quantity} converges with order {self.found.order:.2g} in {key}"
            return f"{begin}: {finest:g} is right to {share}, {self._enough()}"
        if len(self.found.orders) < 2:
            begin = f"{self.quantity}: too few members to tell an order in {key} (it takes four)"
        else:
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
    analysis: Analysis
    quantities: tuple[str, ...]
    axes: tuple[Axis, ...]
    members: tuple[Member, ...]
    check: Member | None  #: the finest, integrated more tightly
    is_interrupted: bool = False
    attributes: Mapping[str, Any] = field(
        default_factory=dict
    )  #: where the file is from that it was read from

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
        from fmbd.results.plots.style import save
        from fmbd.studies.plot import draw

        save(draw(self), path)

    def report(self) -> str:
        """A page of HTML with verdicts, plots, tables and the model; raises ValueError for a study without results."""
        from fmbd.studies.report import report

        return report(self)


def finest(axes: Sequence[Axis]) -> dict[str, Any]:
    """The changes of the finest member."""
    return {axis.path: axis.values[-1] for axis in axes}


def percent(share: float) -> str:
    """A share with two digits: 0.13 %."""
    return f"{100 * share:.2g} %"
