"""The state that modes and state spaces are taken about: the start, an equilibrium, a state of a run."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fmbd.analyses.arrangement import Arrangement, arrange, motor_names
from fmbd.analyses.linearisation import Linearisation
from fmbd.analyses.statics import Equilibrium, equilibrium
from fmbd.analyses.stiffness import newton_step
from fmbd.errors import AnalysisError
from fmbd.model import Model, load_model
from fmbd.results.run import Run, open_run
from fmbd.system import System, assemble

Array = np.ndarray

#: An equilibrium that is farther away [rad, m], and rates that are greater, are worth a remark.
FAR = 1e-6


@dataclass(frozen=True, eq=False)
class Base:
    """A linearisation, and in words what it is about."""

    linearisation: Linearisation
    place: str
    locked: tuple[str, ...]  #: motors whose shafts are held
    chosen: bool  #: whether they were asked for
    constant: tuple[
        str, ...
    ]  #: motors that are free to turn at a constant input, in place of what held or controlled them
    remarks: tuple[str, ...]


def base(
    model: Model | str | Path,
    about: str | Path | Run = "equilibrium",
    time: float | None = None,
    lock: str | Iterable[str] | None = None,
    moving: bool = False,
    release: bool = False,
    open_loop: bool = False,
) -> Base:
    """The linearisation of a model about `start`, `equilibrium`, or the state of a run, or of its archive, at a time.

    time: [s]; default 0, of a run its end
    lock: motors whose shafts are held, by name, `all` or `none`; default: as `equilibrium` does, otherwise none
    moving: driven joints keep their speed at the equilibrium
    release: motors that were only held to find the equilibrium turn freely, at the constant input that held them
    open_loop: controllers do not act, their motors keep the input that they have

    Raises ModelError, ArchiveError, AnalysisError.
    """
    if not isinstance(model, Model):
        model = load_model(model)
    if about == "equilibrium":
        rest = equilibrium(model, time=time or 0.0, lock=lock, moving=moving)
        return _about_rest(rest, not moving, release and lock is None, open_loop)
    if about == "start":
        if time:
            raise AnalysisError(f"the start is at t = 0 s, not at {time:g} s")
        system = assemble(model)
        start = system.start
        return _about_state(system, start.q, start.v, start.z, 0.0, "the start", lock, open_loop)
    run = about if isinstance(about, Run) else open_run(about)
    system = assemble(model)
    if list(run.source.coordinates) != system.coordinate_names or not len(run.time):
        raise AnalysisError("the run has other coordinates than the model, or no output times")
    k = len(run.time) - 1 if time is None else int(np.abs(run.time - time).argmin())
    t = float(run.time[k])
    where = f"the state of the run at t = {t:g} s"
    return _about_state(system, run.position[k], run.velocity[k], run.states[k], t, where, lock, open_loop)


def _about_rest(rest: Equilibrium, standing: bool, release: bool, open_loop: bool) -> Base:
    lin = rest.linearisation
    arrangement, (q, v, z) = lin.arrangement, lin.state
    locked = () if release else rest.locked
    inputs = rest.inputs
    if open_loop:
        inputs |= {name: u for name, u in _inputs(lin).items() if name not in inputs}
    constant = [name for name in inputs if name not in locked]
    if constant:
        system = assemble(rest.run.model)
        arrangement = arrange(system, arrangement.t, locked, constant, standing)
        lin = _fed(arrangement, q, v, z, inputs)
    where = f"the equilibrium at t = {arrangement.t:g} s"
    remarks = rest.remarks if rest.verdict != "unstable" else (*rest.remarks, "the equilibrium is unstable")
    return Base(lin, where, tuple(locked), rest.chosen, tuple(constant), remarks)


def _about_state(
    system: System,
    q: Array,
    v: Array,
    z: Array,
    t: float,
    where: str,
    lock: str | Iterable[str] | None,
    open_loop: bool,
) -> Base:
    locked = motor_names(system, lock or "none")
    if locked:
        v = np.zeros_like(v)
        where += ", at rest"
    lin = Linearisation(arrange(system, t, locked), q, v, z)
    inputs = {name: u for name, u in _inputs(lin).items() if name not in locked} if open_loop else {}
    if inputs:
        lin = _fed(arrange(system, t, locked, list(inputs)), q, v, z, inputs)
    remarks = (*system.start.remarks, *_unrest(lin))
    return Base(lin, where, tuple(locked), True, tuple(inputs), remarks)


def _inputs(lin: Linearisation) -> dict[str, float]:
    """What controllers give to their motors."""
    system = lin.system
    lin.arrangement.rates(system.to_modal(lin.state[0]), system.to_modal(lin.state[1]), lin.state[2])
    names = zip(system.model.motors, system.planar.motors, system.work.drives, strict=True)
    return {name: float(drive.input) for name, motor, drive in names if motor.controller >= 0}


def _fed(arrangement: Arrangement, q: Array, v: Array, z: Array, inputs: dict[str, float]) -> Linearisation:
    """The linearisation with constant inputs; the current that they keep flowing flows."""
    motors = list(arrangement.system.model.motors)
    numbers = [motors.index(name) for name in inputs]
    arrangement.feed(numbers, inputs.values())
    z = np.array(z)
    if not v.any():
        for m, u in zip(numbers, inputs.values(), strict=True):
            record = arrangement.system.planar.motors[m]
            if record.state >= 0:
                z[record.state] = u / record.Ra
    return Linearisation(arrangement, q, v, z)


def _unrest(lin: Linearisation) -> Iterator[str]:
    """How far a state is from rest."""
    names = lin.system.coordinate_names
    fastest = int(np.abs(lin.state[1]).argmax()) if names else 0
    if names and abs(lin.state[1][fastest]) > FAR:
        yield (
            f"in motion ({names[fastest]} by {lin.state[1][fastest]:.3g} a second): the modes are those of this instant"
        )
        return
    step = newton_step(lin)
    k = int(np.abs(step).argmax()) if step.size else 0
    if step.size and not abs(step[k]) < FAR:
        acceleration = lin.basis @ lin.acceleration
        j = int(np.abs(acceleration).argmax())
        near = f"an equilibrium is about {abs(step[k]):.2g} away ({names[k]})"
        away = near if abs(step[k]) < 10.0 else "no equilibrium is near"
        yield f"not at rest: {names[j]} is accelerated by {acceleration[j]:.3g}; {away}"
