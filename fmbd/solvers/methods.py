"""The integrators by name, behind one face: a stepper that fills output times and keeps its state in a Memory."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fmbd.planar.arrays import allocate
from fmbd.planar.signals import CONSTANT, PULSE, STEP
from fmbd.solvers.steps import Memory, Options, memory
from fmbd.solvers.tableau import Tableau
from fmbd.system import System

Array = np.ndarray


@dataclass
class Stepper:
    """A method at work: `advance(times, out, attempts)` returns how many rows of `out` it filled, and a status.

    `choice` says what `auto` picked and why; empty for the others.
    """

    mem: Memory
    advance: Callable[[Array, Array, int], tuple[int, int]]
    choice: Callable[[], str] = str


def explicit_tableau(name: str) -> Tableau | None:
    """The tableau behind a method's name, None if it is not an explicit one."""
    if name == "rk45":
        from fmbd.solvers.rk45 import RK45

        return RK45
    if name == "baumgarte":
        from fmbd.solvers.baumgarte import BAUMGARTE

        return BAUMGARTE
    if name in ("dop853", "auto"):
        from fmbd.solvers.dop853 import DOP853

        return DOP853
    return None


def start_method(
    name: str, system: System, y0: Array, breaks: Array, options: Options, shared: Memory | None = None
) -> Stepper:
    """A method by name, ready at y0 and time 0, or at the state of another one's Memory."""
    if name == "auto":
        from fmbd.solvers.auto import start_auto

        return start_auto(system, y0, breaks, options)
    tableau = explicit_tableau(name)
    if tableau is not None:
        return _explicit(tableau, system, y0, breaks, options, shared)
    if name == "generalized_alpha":
        return _generalized_alpha(system, y0, breaks, options, shared)
    if name == "radau":
        return _collocation(system, y0, breaks, options, shared)
    return _rosenbrock(system, y0, breaks, options, shared)


def _memory(shared: Memory | None, y0: Array, nq: int, rows: int, interpolant_rows: int) -> Memory:
    mem = memory(y0, nq, rows, interpolant_rows)
    return mem if shared is None else shared._replace(k=mem.k, F=mem.F)


def _explicit(
    tableau: Tableau,
    system: System,
    y0: Array,
    breaks: Array,
    options: Options,
    shared: Memory | None,
) -> Stepper:
    from fmbd.solvers.explicit import advance

    mem = _memory(shared, y0, system.planar.nq, tableau.c.size, 3 + tableau.d.shape[0])

    def step(times: Array, out: Array, attempts: int) -> tuple[int, int]:
        filled, status = advance(
            system.planar, system.work, tableau, mem, breaks, options, times, out, attempts
        )
        return int(filled), int(status)

    return Stepper(mem, step)


def _rosenbrock(system: System, y0: Array, breaks: Array, options: Options, shared: Memory | None) -> Stepper:
    from fmbd.planar.tangent_arrays import allocate_tangent
    from fmbd.solvers.rodas5p import RODAS5P
    from fmbd.solvers.rosenbrock import SCRATCH, advance_rosenbrock
    from fmbd.system.couplings import couplings

    planar = system.planar
    coupled = couplings(planar)
    tangent = allocate_tangent(planar, coupled)
    base = allocate(planar)
    kinds = planar.signals["kind"]
    steady = bool(np.all((kinds == CONSTANT) | (kinds == STEP) | (kinds == PULSE)))
    mem = _memory(shared, y0, planar.nq, RODAS5P.alpha.size + SCRATCH, 4)

    def step(times: Array, out: Array, attempts: int) -> tuple[int, int]:
        filled, status = advance_rosenbrock(
            planar,
            system.work,
            base,
            coupled,
            tangent,
            RODAS5P,
            steady,
            mem,
            breaks,
            options,
            times,
            out,
            attempts,
        )
        return int(filled), int(status)

    return Stepper(mem, step)


def _generalized_alpha(
    system: System, y0: Array, breaks: Array, options: Options, shared: Memory | None
) -> Stepper:
    from fmbd.planar.tangent_arrays import allocate_tangent
    from fmbd.solvers.generalized_alpha import ROWS, advance_generalized_alpha, generalized_alpha
    from fmbd.system.couplings import couplings

    planar, chosen = system.planar, system.model.simulation.generalized_alpha
    stabilised = chosen.formulation == "stabilised"
    method = generalized_alpha(chosen.spectral_radius, chosen.step, stabilised)
    coupled = couplings(planar)
    tangent = allocate_tangent(planar, coupled, level=1 if stabilised else 0)
    work = allocate(planar)
    mem = _memory(shared, y0, planar.nq, ROWS, 3)

    def step(times: Array, out: Array, attempts: int) -> tuple[int, int]:
        filled, status = advance_generalized_alpha(
            planar, work, coupled, tangent, method, mem, breaks, options, times, out, attempts
        )
        return int(filled), int(status)

    return Stepper(mem, step)


def _collocation(
    system: System, y0: Array, breaks: Array, options: Options, shared: Memory | None
) -> Stepper:
    from fmbd.planar.tangent_arrays import allocate_tangent
    from fmbd.solvers.collocation import SCRATCH, Shifted, advance_collocation
    from fmbd.solvers.radau import radau
    from fmbd.system.couplings import couplings

    planar = system.planar
    s = system.model.simulation.radau.stages
    method = radau(s)
    coupled = couplings(planar)
    base = allocate(planar)

    def shifted(scalar: str) -> Shifted:
        return Shifted(allocate_tangent(planar, coupled, 2, scalar), *np.zeros((4, y0.size), scalar))

    real, pairs = shifted("f8"), tuple(shifted("c16") for _ in method.mus)
    mem = _memory(shared, y0, planar.nq, 2 * s + SCRATCH, s)
    # the estimate is of order s, the solution of order 2 s - 1
    rtol = 0.1 * options.rtol ** ((s + 1) / (2 * s))
    own = options._replace(rtol=rtol, atol=options.atol / options.rtol * rtol)

    def step(times: Array, out: Array, attempts: int) -> tuple[int, int]:
        filled, status = advance_collocation(
            planar, system.work, base, coupled, real, pairs, method, mem, breaks, own, times, out, attempts
        )
        return int(filled), int(status)

    return Stepper(mem, step)
