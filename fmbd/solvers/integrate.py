"""Integrate a system over time, block by block of output times.

A simulation is four independent choices: the equations (a System), the method (one file each), step control
(rtol, atol, max_step) and what to save (the output times).
"""

import time as clock
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from fmbd.planar.equations import close_at_start
from fmbd.solvers.methods import Stepper, start_method
from fmbd.solvers.samples import sample
from fmbd.solvers.steps import (
    ACCEPTED,
    BODY,
    EVALUATIONS,
    FACTORISATIONS,
    NO_INERTIA,
    NOT_A_NUMBER,
    NOW,
    OFF_CONSTRAINTS,
    PROJECTIONS,
    REJECTED,
    RUNNING,
    Memory,
    Options,
)
from fmbd.system import System

Array = np.ndarray

#: Tried steps between two returns to Python: progress and Ctrl-C come through within about a hundredth of a second.
ATTEMPTS = 1000
#: Output times computed together, and the time [s] after which fewer are handed over.
BLOCK = 512
PATIENCE = 1.0


@dataclass(frozen=True)
class Block:
    """States at consecutive output times, nodal coordinates: rows are times."""

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    multipliers: Array
    states: Array
    energy: dict[str, Array]
    constraint_error: Array  #: max |Phi| and max |Phi'|, shape (k, 2)


@dataclass
class Statistics:
    """Counts of a run and how it ended; `reason` is empty for a complete run."""

    method: str
    steps: int = 0
    rejected_steps: int = 0
    evaluations: int = 0
    projections: int = 0
    factorisations: int = 0
    choice: str = ""  #: what `auto` picked, and why
    time_reached: float = 0.0
    reason: str = ""
    warnings: list[str] = field(default_factory=list)

    def update(self, stepper: Stepper) -> None:
        """Copy the counters of the compiled loop."""
        mem = stepper.mem
        self.steps, self.rejected_steps = int(mem.counters[ACCEPTED]), int(mem.counters[REJECTED])
        self.evaluations, self.projections = int(mem.counters[EVALUATIONS]), int(mem.counters[PROJECTIONS])
        self.factorisations = int(mem.counters[FACTORISATIONS])
        self.choice = stepper.choice()
        self.time_reached = float(mem.clock[NOW])


def output_times(duration: float, interval: float) -> Array:
    """0, interval, 2 interval, ..., and the duration itself."""
    count = int(np.floor(duration / interval * (1.0 + 1e-12)))
    times = interval * np.arange(count + 1)
    if duration - times[-1] > 1e-9 * interval:
        return np.append(times, duration)
    times[-1] = duration
    return times


def integrate(
    system: System,
    times: Array,
    statistics: Statistics,
    on_progress: Callable[[float], None] | None = None,
) -> Iterator[Block]:
    """Yield blocks of results at `times` (ascending, from 0); the last time is the end of the run.

    Method and tolerances are those of the model's `simulation`. If the run cannot go on, the blocks stop early and
    `statistics.reason` says why. `on_progress` is called with the time reached, often; it may end the run by giving
    a `statistics.reason` itself.
    """
    simulation = system.model.simulation
    start = system.start
    y0 = np.concatenate([system.to_modal(start.q), system.to_modal(start.v), start.z, [0.0, 0.0]])
    options = solver_options(system)
    if options.projecting and not system.model.initial.consistent:
        # a start left inconsistent is moved onto its constraints at once, whatever the length of the first step
        close_at_start(system.planar, system.work, y0, np.zeros(system.planar.nq), options.closed)
    end = float(times[-1])
    breaks = np.append(system.lowered.signals.breakpoints(end), end)
    stepper = start_method(simulation.method, system, y0, breaks, options)
    mem = stepper.mem
    initial_energy: float | None = None
    first = 0
    while first < times.size:
        chunk = times[first : first + BLOCK]
        out = np.zeros((chunk.size, y0.size))
        filled, status, ended = 0, RUNNING, False
        since = clock.perf_counter()
        while filled < chunk.size and status == RUNNING and not ended:
            # a run that is ended from outside still writes the output times that it has passed
            ended = bool(statistics.reason)
            attempts = 0 if ended else ATTEMPTS
            done, status = stepper.advance(chunk[filled:], out[filled:], attempts)
            filled += done
            statistics.update(stepper)
            if on_progress is not None:
                on_progress(statistics.time_reached)
            if filled and clock.perf_counter() - since > PATIENCE:
                break
        if filled:
            block = _block(system, chunk[:filled], out[:filled], options)
            if initial_energy is None:
                initial_energy = block.energy["balance"][0]
            block.energy["balance"] -= initial_energy
            yield block
        if status != RUNNING:
            statistics.reason = _reason(system, mem, status)
        if status != RUNNING or (ended and filled < chunk.size):
            return
        first += filled


def solver_options(system: System) -> Options:
    """Tolerances of the model's simulation, and Baumgarte's parameters where they apply."""
    s = system.model.simulation
    stabilised = s.method == "baumgarte"
    delta, omega = (s.baumgarte.delta, s.baumgarte.omega) if stabilised else (0.0, 0.0)
    return Options(
        rtol=s.rtol,
        atol=s.atol,
        max_step=s.max_step or np.inf,
        projecting=not stabilised,
        closed=1e-12,
        drag=2.0 * delta * omega,
        pull=omega**2,
    )


def _block(system: System, times: Array, y: Array, options: Options) -> Block:
    planar = system.planar
    nq, nc = planar.nq, len(system.constraints)
    qdd = np.zeros((times.size, nq))
    multipliers = np.zeros((times.size, nc))
    energy = np.zeros((times.size, 3))
    errors = np.zeros((times.size, 2))
    dz = np.zeros(len(system.states))
    sample(planar, system.work, times, y, options.drag, options.pull, qdd, multipliers, energy, errors, dz)
    kinetic, potential, elastic = energy.T
    dissipated, work = y[:, -2], y[:, -1]
    return Block(
        time=times,
        position=system.to_nodal(y[:, :nq]),
        velocity=system.to_nodal(y[:, nq : 2 * nq]),
        acceleration=system.to_nodal(qdd),
        multipliers=multipliers,
        states=y[:, 2 * nq : -2],
        energy={
            "kinetic": kinetic,
            "potential": potential,
            "elastic": elastic,
            "dissipated": dissipated,
            "work": work,
            "balance": kinetic + potential + elastic + dissipated - work,
        },
        constraint_error=errors,
    )


def _reason(system: System, mem: Memory, status: int) -> str:
    """One line: what happened, when, and what to try."""
    t = f"t = {mem.clock[NOW]:.6g} s"
    if status == NO_INERTIA:
        link = system.tree.links[int(mem.counters[BODY])]
        return f"at {t} joint {link.joint or link.motor} has no inertia to move: give body {link.name} a mass"
    if status == NOT_A_NUMBER:
        return f"at {t} the accelerations are not numbers: a signal or an expression has no value there"
    if status == OFF_CONSTRAINTS:
        return (
            f"at {t} the loops could not be closed again: the mechanism is at a singular configuration "
            "(a larger rtol, or method baumgarte, may pass it)"
        )
    body = _fastest(system, mem)
    return f"at {t} the step size fell to round-off; {body} changes fastest (a larger rtol or more damping may help)"


def _fastest(system: System, mem: Memory) -> str:
    nq = system.planar.nq
    q, v, z = np.split(mem.y[:-2], [nq, 2 * nq])
    accelerations, _ = system.accelerations(system.to_nodal(q), system.to_nodal(v), float(mem.clock[NOW]), z)
    rates = np.abs(accelerations)
    if not np.all(np.isfinite(rates)):
        rates = np.where(np.isfinite(rates), 0.0, np.inf)
    return system.coordinate_names[int(np.argmax(rates))] if nq else "nothing"
