"""The method that suits the moment: `dop853` or `radau`, whichever covers more time with the same work. The default.

Which one that is depends on the model, the tolerance and what is ringing, so it is tried: the explicit method begins,
in a long run the implicit one gets a trial, the better goes on, and the other is tried again now and then. Work is
counted in evaluations of the equations, not in seconds, so that the same model always takes the same steps.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from fmbd.solvers.methods import Stepper, start_method
from fmbd.solvers.steps import (
    ACCEPTED,
    EVALUATIONS,
    FACTORISATIONS,
    FRESH,
    NOW,
    PROJECTIONS,
    REJECTED,
    RUNNING,
    Memory,
    Options,
)
from fmbd.system import System

Array = np.ndarray

EXPLICIT, IMPLICIT = "dop853", "radau"
#: Tried steps of a trial; after how many such spells the other method gets one again, at first and at most.
SPELL = 100
PATIENCE = (4, 64)
#: What an evaluation, a projection and a factorisation cost, in evaluations. Those of radau count its
#: back-substitutions, real and complex, with the evaluations.
COST = {EXPLICIT: (1.0, 2.0, 0.0), IMPLICIT: (2.2, 2.0, 3.0)}
#: A run of fewer steps to come is over before a trial pays (the trial may have to compile the method).
LONG = 5000


@dataclass
class _Choice:
    """Which method is at work, and what is known of both."""

    current: str
    end: float
    spells: int = 0
    patience: int = PATIENCE[0]
    time: float = 0.0
    counts: tuple[int, ...] = (0, 0, 0, 0)
    price: dict[str, float] = field(default_factory=dict)  # work per second of simulated time, as last seen
    covered: dict[str, float] = field(default_factory=dict)  # time that each method went through

    def mark(self, mem: Memory) -> tuple[float, float, int]:
        """Time covered, work and steps of the current method since the last mark."""
        time, counts = self.time, self.counts
        self.time = float(mem.clock[NOW])
        self.counts = tuple(
            int(mem.counters[k]) for k in (EVALUATIONS, PROJECTIONS, FACTORISATIONS, ACCEPTED)
        )
        *spent, steps = (now - then for now, then in zip(self.counts, counts, strict=True))
        work = sum(price * number for price, number in zip(COST[self.current], spent, strict=True))
        return self.time - time, work, steps

    def next(self, mem: Memory) -> str:
        """The method of the next spell, from what the last one cost."""
        current = self.current
        covered, spent, taken = self.mark(mem)
        if covered <= 0.0 or spent <= 0.0:
            return current
        self.covered[current] = self.covered.get(current, 0.0) + covered
        self.price[current] = spent / covered
        self.spells += 1
        other = IMPLICIT if current == EXPLICIT else EXPLICIT
        if other in self.price and self.price[other] < 0.8 * self.price[current]:
            if self.spells == 1:
                # a trial has failed: leave the other one in peace for longer
                self.patience = min(2 * self.patience, PATIENCE[1])
            self.spells = 0
            return other
        long = (self.end - self.time) * taken > LONG * covered
        if current == EXPLICIT and long and (other not in self.price or self.spells >= self.patience):
            self.spells = 0
            return other
        return current

    def describe(self, now: float) -> str:
        """What was picked, and why."""
        if self.price.get(IMPLICIT, math.inf) == math.inf:
            return EXPLICIT
        shares = self.covered | {self.current: self.covered.get(self.current, 0.0) + now - self.time}
        most = max(shares, key=lambda name: shares[name])
        less = IMPLICIT if most == EXPLICIT else EXPLICIT
        ratio = self.price[less] / self.price[most]
        return f"{most} for {shares[most] / now:.0%} of the time ({less}: {ratio:.2g} times the work)"


def start_auto(system: System, y0: Array, breaks: Array, options: Options) -> Stepper:
    """See the module."""
    first = start_method(EXPLICIT, system, y0, breaks, options)
    mem = first.mem
    choice = _Choice(EXPLICIT, float(breaks[-1]))
    steppers = {EXPLICIT: first}

    def tried() -> int:
        return int(mem.counters[ACCEPTED] + mem.counters[REJECTED])

    def take_back(before: tuple[int, Array, Array, Array]) -> int:
        filled, mem.y[:], mem.clock[:], mem.counters[:] = before
        mem.counters[FRESH] = 1
        choice.mark(mem)
        return filled

    def step(times: Array, out: Array, attempts: int) -> tuple[int, int]:
        last = tried() + attempts
        # the last step may reach into these times: only its own method can write them
        filled, status = steppers[choice.current].advance(times, out, 0)
        if filled == times.size:
            return filled, status
        while True:
            spell = min(SPELL, last - tried())
            before = filled, mem.y.copy(), mem.clock.copy(), mem.counters.copy()
            done, status = steppers[choice.current].advance(times[filled:], out[filled:], spell)
            filled += done
            if status != RUNNING and choice.current == IMPLICIT:
                # what stops it, a singular position for one, need not stop the other, from further back
                choice.price[IMPLICIT] = math.inf
                choice.current = EXPLICIT
                filled = take_back(before)
                continue
            # between two spells all output times that were passed are written
            if status != RUNNING or filled == times.size or tried() >= last:
                return filled, status
            chosen = choice.next(mem)
            if chosen != choice.current:
                if chosen == EXPLICIT:
                    # a spell that has cost too much is not kept: it may have crept up to a singular position
                    filled = take_back(before)
                if chosen not in steppers:
                    steppers[chosen] = start_method(chosen, system, y0, breaks, options, mem)
                choice.current = chosen
                mem.counters[FRESH] = 1

    return Stepper(mem, step, lambda: choice.describe(max(float(mem.clock[NOW]), 1e-300)))
