"""Many short runs: variants of the five-bar a second, in one process and in one process a core.

Every run has another gain of the controller: 3 s, one element a link, damped, each method at the loosest tolerance
whose error of the tips stays below 1 % of their peak. A run begins with the changed model, so that reading, assembling
and integrating are in it; what integrating takes alone is told beside it. Exudyn builds its model anew as well.
"""

import multiprocessing
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np
from common import CORES, EXUDYN_MISSING, HAS_EXUDYN, GaveUp, cpu, number, pin, table, unpin
from five_bar import DAMPING, METHODS, Observed, by_fmbd, errors, five_bar, observe
from matplotlib.figure import Figure

from fmbd.results.plots.style import COLOURS

TITLE = "Sweeps: runs of the five-bar a second"
DAMPED = DAMPING["damped"]
WORKERS = max(1, len(CORES))
ACCEPTED = 1e-2
KP = 4.0


def fmbd_run(method: str, rtol: float, kp: float) -> Observed:
    """One variant, from its model."""
    system = five_bar(1, DAMPED, method, rtol, {"controllers.position_control.kp": kp})
    return observe(system, by_fmbd(system, np.inf)[0])


def exudyn_run(steps: int, kp: float) -> Observed:
    """One variant in Exudyn."""
    from exudyn_five_bar import ExudynFiveBar

    return ExudynFiveBar(1, DAMPED, kp=kp).solve(steps, 1e-6)


def measure(quick: bool) -> dict[str, Any]:
    """Runs a second by competitor."""
    count = 8 if quick else 128
    reference = fmbd_run("dop853", 1e-12, KP)
    competitors: list[dict[str, Any]] = []
    for method in METHODS:
        tries = [partial(fmbd_run, method, 10.0**-k) for k in range(2, 11)]
        if found := _loosest(tries, reference):
            task, error = found
            system = five_bar(1, DAMPED, *task.args)
            alone = cpu(lambda system=system: [by_fmbd(system, np.inf) for _ in range(5)]) / 5
            competitors.append({"name": f"fmbd {method}", "error": error, "integrating": alone, "task": task})
    if HAS_EXUDYN:
        converged = exudyn_run(96_000, KP)
        if found := _loosest([partial(exudyn_run, 300 * k) for k in (10, 15, 20, 30, 40, 60)], converged):
            task, error = found
            competitors.append({"name": "Exudyn", "error": error, "integrating": None, "task": task})
    with _pool() as pool:
        for competitor in competitors:
            print(f"  {competitor['name']}", flush=True)
            competitor |= _rates(pool, competitor.pop("task"), count)
    return {"runs": count, "workers": WORKERS, "competitors": competitors}


def _loosest(tries: list[partial[Observed]], reference: Observed) -> tuple[partial[Observed], float] | None:
    for task in tries:
        try:
            error = errors(task(KP), reference)["tip_max"]
        except GaveUp:
            continue
        if error <= ACCEPTED:
            return task, error
    return None


def _rates(pool: ProcessPoolExecutor, task: Callable[[float], Observed], count: int) -> dict[str, float]:
    """Runs a CPU second in this process, runs a second of the clock in the pool."""
    gains = list(np.linspace(0.9 * KP, 1.1 * KP, count))
    alone = gains[: max(4, count // 4)]
    one = len(alone) / cpu(lambda: [task(kp) for kp in alone])
    list(pool.map(task, gains[:WORKERS] * 4))  # loads the compiled kernels
    start = time.perf_counter()
    list(pool.map(task, gains, chunksize=2))
    return {"one_process": one, "pool": count / (time.perf_counter() - start)}


@contextmanager
def _pool() -> Iterator[ProcessPoolExecutor]:
    """One process a core, all of them ready."""
    context = multiprocessing.get_context("spawn")
    barrier = context.Barrier(WORKERS + 1, timeout=60)
    with ProcessPoolExecutor(WORKERS, context, barrier.wait) as pool:
        unpin()
        for _ in range(WORKERS):
            pool.submit(int)  # starts a process, which may use all cores, for none is idle yet
        barrier.wait()
        pin()
        yield pool


def tables(data: dict[str, Any]) -> str:
    """Runs a second."""
    head = ["", "one process", f"{data['workers']} processes", "integrating alone [ms]", "error of the tips"]
    rows = [
        [
            c["name"],
            number(c["one_process"], 3),
            number(c["pool"], 3),
            number(c["integrating"] and 1e3 * c["integrating"]),
            f"{c['error']:.1%}",
        ]
        for c in data["competitors"]
    ]
    missing = [] if any(c["name"] == "Exudyn" for c in data["competitors"]) else [EXUDYN_MISSING]
    return "\n\n".join([table(head, rows), *missing])


summary = tables


def draw(data: dict[str, Any]) -> Figure:
    """Bars."""
    competitors = data["competitors"][::-1]
    places = np.arange(len(competitors))
    figure = Figure(figsize=(6.0, 0.8 + 0.4 * len(competitors)), layout="constrained")
    axes = figure.subplots()
    bars = (("one_process", "one process", COLOURS[0]), ("pool", f"{data['workers']} processes", COLOURS[1]))
    for k, (key, label, colour) in enumerate(bars):
        axes.barh(places + 0.18 - 0.36 * k, [c[key] for c in competitors], 0.36, color=colour, label=label)
    axes.set_yticks(places, [c["name"] for c in competitors])
    axes.set_xlabel("runs a second")
    axes.legend()
    return figure
