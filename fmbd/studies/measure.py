"""What a study asks of a model: quantities by name, over the time of a run or once, by one of the analyses."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from fmbd.errors import ModelError, UnknownQuantity
from fmbd.model import Model
from fmbd.model.names import unknown
from fmbd.results.layout import Value
from fmbd.results.simulate import not_run, simulate
from fmbd.system import System, assemble

if TYPE_CHECKING:
    from fmbd.analyses.vibrations import Modes

Array = np.ndarray
Progress = Callable[[float], None]
Kind = Literal["run", "statics", "modes", "frequencies"]

COMPLETE = "complete"
INTERRUPTED = "stopped: interrupted"


@dataclass(frozen=True)
class Analysis:
    """What is computed of a model.

    kind: `run` simulates; `statics` has the quantities of a run at the equilibrium, but for rates; `modes` has, about
    it, `frequency.k` [Hz], k from 1, of the motions that swing, `damping_ratio.k`, and `mode.k.QUANTITY`: how a
    quantity changes with a unit of the mode, of modal mass 1, a velocity or a momentum with a unit of its rate;
    `frequencies` has `frequency.k` of beams and springs alone, about the start and undamped, as `fmbd check` shows them
    time, lock, moving: of statics and modes, as `fmbd.equilibrium` takes them

    Raises ModelError for another kind, and for options that the kind does not have.
    """

    kind: Kind = "run"
    time: float | None = None
    lock: str | tuple[str, ...] | None = None
    moving: bool = False

    def __post_init__(self) -> None:
        if self.kind not in get_args(Kind):
            raise ModelError([unknown("analysis", self.kind, get_args(Kind))])
        given = [name for name in ("time", "lock", "moving") if getattr(self, name) not in (None, False)]
        if given and self.kind not in ("statics", "modes"):
            raise ModelError([f"{given[0]}: is for the analyses statics and modes, not for {self.kind}"])

    @classmethod
    def of(cls, kind: Kind, time: float | None, lock: str | Sequence[str] | None, moving: bool) -> "Analysis":
        """An analysis with its motors in any sequence."""
        return cls(kind, time, lock if lock is None or isinstance(lock, str) else tuple(lock), moving)

    def __str__(self) -> str:
        """The kind and its options, as the command line has them."""
        lock = self.lock if self.lock is None or isinstance(self.lock, str) else ",".join(self.lock)
        options = {"time": self.time, "lock": lock}
        given = [f"--{name} {value}" for name, value in options.items() if value is not None]
        return " ".join([self.kind, *given, *(["--moving"] if self.moving else [])])

    @property
    def at(self) -> dict[str, Any]:
        """The arguments of `equilibrium`."""
        return {"time": self.time or 0.0, "lock": self.lock, "moving": self.moving}


RUN = Analysis()


@dataclass(frozen=True)
class Measured:
    """Quantities of a model, in SI units.

    values: shape (nt,) or (nt, columns) over the output times of a run, () or (1, columns) of what has no time
    time: output times [s], shape (nt,); None of what has no time
    status: `complete`, or `stopped: reason` of a run that ended early
    """

    values: Mapping[str, Array]
    units: Mapping[str, str]
    time: Array | None = None
    status: str = COMPLETE
    statistics: Mapping[str, Value] = field(default_factory=dict)


def measure(
    model: Model, names: Sequence[str], analysis: Analysis = RUN, on_progress: Progress | None = None
) -> Measured:
    """The quantities `names` of a model; `on_progress` is called with the share that is done, 0 to 1.

    Raises UnknownQuantity, of a run before anything is computed, and AnalysisError.
    """
    return _ANALYSES[analysis.kind](assemble(model), names, analysis, on_progress)


def columns_of(model: Model, names: Sequence[str], analysis: Analysis = RUN) -> dict[str, tuple[str, ...]]:
    """What the columns of quantities are, () of those that have none; raises UnknownQuantity."""
    run = not_run(assemble(model))
    if analysis.kind == "run":
        return {name: run.columns(name) for name in names}
    if analysis.kind == "statics":
        return {name: run.columns(_at_rest(name)) for name in names}
    parts = {name: _part(name, analysis.kind) for name in names}
    return {name: run.columns(quantity) if quantity else () for name, (_, _, quantity) in parts.items()}


def _run(system: System, names: Sequence[str], _: Analysis, on_progress: Progress | None) -> Measured:
    before = not_run(system)
    units = {name: before.units(name) for name in names}
    duration = system.model.simulation.duration
    run = simulate(system.model, None, on_progress and (lambda reached: on_progress(reached / duration)))
    if run.status.startswith(INTERRUPTED):
        raise KeyboardInterrupt
    values = {name: run[name] for name in names}
    return Measured(values, units, run.time, run.status, run.statistics)


def _statics(system: System, names: Sequence[str], analysis: Analysis, _: Progress | None) -> Measured:
    from fmbd.analyses.statics import equilibrium

    before = not_run(system)
    units = {name: before.units(_at_rest(name)) for name in names}
    rest = equilibrium(system.model, **analysis.at)
    return Measured({name: _once(rest[name]) for name in names}, units)


def _at_rest(name: str) -> str:
    """The name, if it is no rate."""
    from fmbd.analyses.statics import OF_RUNS, RATES

    if name in OF_RUNS or not RATES.isdisjoint(name.split(".")[1:]):
        raise UnknownQuantity(f"no quantity '{name}': nothing moves at an equilibrium")
    return name


def _once(values: Array) -> Array:
    """A number (), or its columns as a row (1, columns)."""
    return values[None] if values.ndim else values


def _modes(system: System, names: Sequence[str], analysis: Analysis, _: Progress | None) -> Measured:
    from fmbd.analyses.vibrations import UNDAMPED, modes

    parts = {name: _part(name, "modes") for name in names}
    before = not_run(system)
    units = {
        name: _unit(what, quantity and before.units(quantity)) for name, (what, _, quantity) in parts.items()
    }
    found = modes(system.model, **analysis.at)
    swinging = np.flatnonzero(found.frequencies > 0.0)
    _enough(parts.values(), swinging.size)
    damping = np.where(np.abs(found.damping_ratios) > UNDAMPED, found.damping_ratios, 0.0)
    values: dict[str, Array] = {}
    for name, (what, k, quantity) in parts.items():
        i = int(swinging[k - 1])
        if quantity:
            values[name] = _by_mode(found, i, quantity, bool(before.columns(quantity)))
        else:
            values[name] = (found.frequencies if what == "frequency" else damping)[i]
    return Measured(values, units)


def _by_mode(found: "Modes", k: int, quantity: str, has_columns: bool) -> Array:
    """The change of a quantity by a unit of a mode of modal mass 1, of a velocity or momentum by a unit of its rate."""
    from fmbd.analyses.probe import Probe

    lin = found.base.linearisation
    y = lin.motions.N.T @ lin.motions.M @ lin.system.to_modal(found.shapes[k].real)
    y /= np.linalg.norm(y)
    still = np.zeros(lin.size - 2 * lin.freedom)
    moves = not {"rate", "velocity", "momentum", "angular_momentum"}.isdisjoint(quantity.split("."))
    x = np.concatenate([0.0 * y, y, still] if moves else [y, 0.0 * y, still])
    change = Probe(lin, [], [quantity]).by_state() @ x
    return _once(change if has_columns else change[0])


def _frequencies(system: System, names: Sequence[str], _: Analysis, __: Progress | None) -> Measured:
    from fmbd.analyses import natural_frequencies

    parts = {name: _part(name, "frequencies") for name in names}
    found = natural_frequencies(system)
    found = found[found > 0.0]
    _enough(parts.values(), found.size)
    return Measured({name: found[k - 1] for name, (_, k, _) in parts.items()}, dict.fromkeys(names, "Hz"))


def _part(name: str, kind: str) -> tuple[str, int, str]:
    """What, number and quantity, which may be empty, of `frequency.k`, `frequency[k]`, `mode.k.QUANTITY`."""
    match = re.fullmatch(r"(frequency|damping_ratio|mode)(?:\.|\[)([1-9][0-9]*)\]?(?:\.(.+))?", name)
    if kind == "frequencies":
        known, valid = "frequency.1, frequency.2, ...", match is not None and match[1] == "frequency"
    else:
        known, valid = "frequency.1, damping_ratio.1, mode.1.QUANTITY, ...", match is not None
    if match is None or not valid or (match[1] == "mode") != bool(match[3]):
        raise UnknownQuantity(f"no quantity '{name}': {kind} have {known}")
    return match[1], int(match[2]), match[3] or ""


def _unit(what: str, of_quantity: str) -> str:
    return {"frequency": "Hz", "damping_ratio": "1"}.get(what, of_quantity)


def _enough(parts: Any, count: int) -> None:
    """Raise UnknownQuantity where there are fewer modes than are asked for."""
    for what, k, _ in parts:
        if k > count:
            raise UnknownQuantity(f"no quantity '{what}.{k}': the last is {what}.{count}")


#: Each takes a system, names, what is asked for and the progress; the names of its quantities are its own.
_ANALYSES: dict[str, Callable[[System, Sequence[str], Analysis, Progress | None], Measured]] = {
    "run": _run,
    "statics": _statics,
    "modes": _modes,
    "frequencies": _frequencies,
}
