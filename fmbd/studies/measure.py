"""What a study asks of a model: quantities by name, over the time of a run or once, by one of the analyses."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from fmbd.errors import UnknownQuantity
from fmbd.model import Model
from fmbd.results.layout import Value
from fmbd.results.simulate import not_run, simulate
from fmbd.system import System, assemble

Array = np.ndarray
Progress = Callable[[float], None]

COMPLETE = "complete"
INTERRUPTED = "stopped: interrupted"


@dataclass(frozen=True)
class Measured:
    """Quantities of a model, in SI units.

    values: shape (nt,) or (nt, columns) over the output times of a run, () of what has no time
    time: output times [s], shape (nt,); None of what has no time
    status: `complete`, or `stopped: reason` of a run that ended early
    """

    values: Mapping[str, Array]
    units: Mapping[str, str]
    time: Array | None = None
    status: str = COMPLETE
    statistics: Mapping[str, Value] = field(default_factory=dict)


def measure(
    model: Model, names: Sequence[str], analysis: str = "run", on_progress: Progress | None = None
) -> Measured:
    """The quantities `names` of a model; `on_progress` is called with the share that is done, 0 to 1.

    analysis: `run` simulates, quantities are those of a Run; `modes` has `frequency.k` or `frequency[k]`, k from 1,
    the natural frequencies [Hz] about the start that are not zero. Raises UnknownQuantity before anything is computed.
    """
    return ANALYSES[analysis](assemble(model), names, on_progress)


def columns_of(model: Model, names: Sequence[str], analysis: str = "run") -> dict[str, tuple[str, ...]]:
    """What the columns of quantities are, () of those that have none; raises UnknownQuantity."""
    if analysis == "run":
        run = not_run(assemble(model))
        return {name: run.columns(name) for name in names}
    return {name: () for name in names if _number(name)}


def _run(system: System, names: Sequence[str], on_progress: Progress | None) -> Measured:
    before = not_run(system)
    units = {name: before.units(name) for name in names}
    duration = system.model.simulation.duration
    run = simulate(system.model, None, on_progress and (lambda reached: on_progress(reached / duration)))
    if run.status.startswith(INTERRUPTED):
        raise KeyboardInterrupt
    values = {name: run[name] for name in names}
    return Measured(values, units, run.time, run.status, run.statistics)


def _modes(system: System, names: Sequence[str], on_progress: Progress | None) -> Measured:
    from fmbd.analyses import natural_frequencies

    numbers = {name: _number(name) for name in names}
    found = natural_frequencies(system)
    found = found[found > 0.0]
    if numbers and max(numbers.values()) > found.size:
        raise UnknownQuantity(
            f"no quantity 'frequency.{max(numbers.values())}': the last is frequency.{found.size}"
        )
    return Measured({name: found[k - 1] for name, k in numbers.items()}, dict.fromkeys(names, "Hz"))


def _number(name: str) -> int:
    """k of `frequency.k` or `frequency[k]`."""
    match = re.fullmatch(r"frequency(\.|\[)([1-9][0-9]*)\]?", name)
    if match is None:
        raise UnknownQuantity(f"no quantity '{name}': modes have frequency.1, frequency.2, ...")
    return int(match[2])


#: Each takes a system, names and the progress; the names of its quantities are its own.
ANALYSES: dict[str, Callable[[System, Sequence[str], Progress | None], Measured]] = {
    "run": _run,
    "modes": _modes,
}
