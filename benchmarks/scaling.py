"""How cost grows: acceleration and step with the elements of a link; acceleration with bodies and loops."""

import time
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np
from common import EXUDYN_MISSING, HAS_EXUDYN, GaveUp, cpu, number, table
from five_bar import DAMPING, METHODS, five_bar
from matplotlib.figure import Figure
from mechanisms import chain, four_bars
from numba import njit

from fmbd.model import Model
from fmbd.planar.equations import evaluate_accelerations
from fmbd.results.plots.style import COLOURS, MARKERS, told_apart
from fmbd.solvers.integrate import Statistics, integrate
from fmbd.system import System, assemble

TITLE = "Scaling: elements of a link, bodies of a chain, loops"
FAMILIES: dict[str, Callable[[int], Model]] = {"chain": chain, "four-bars": four_bars}
ACCELERATION, EXUDYN = "acceleration", "Exudyn, a step"


# not cached: a cached loop would go on calling the kernels of the day it was compiled
@njit(_nrt=False)
def repeat(count, planar, work, t, q, v, z, dz, qdd):
    """Evaluate `count` times; compiled, since a call from Python costs more than the kernel."""
    for _ in range(count):
        evaluate_accelerations(planar, work, t, q, v, z, dz, qdd)


def acceleration(system: System, repetitions: int = 7) -> list[float]:
    """CPU seconds of one evaluation of accelerations and multipliers, for a moving mechanism; samples."""
    q, z = system.to_modal(system.start.q), system.start.z
    arguments = (system.planar, system.work, 0.1, q, np.full_like(q, 0.01), z, z.copy(), q.copy())
    repeat(1, *arguments)
    once = cpu(lambda: repeat(10, *arguments)) / 10
    count = max(1, int(0.03 / max(once, 1e-7)))
    return [cpu(lambda: repeat(count, *arguments)) / count for _ in range(repetitions)]


def step(system: System, seconds: float) -> float | None:
    """CPU seconds of a step, rejected ones included, over `seconds` of computing; None if no step succeeds."""
    statistics = Statistics(system.model.simulation.method)
    start = time.process_time()

    def watch(_: float) -> None:
        if time.process_time() - start > seconds:
            statistics.reason = "measured"

    for _ in integrate(system, np.array([0.0, 3.0]), statistics, watch):
        pass
    steps = statistics.steps + statistics.rejected_steps
    return (time.process_time() - start) / steps if steps else None


def measure(quick: bool) -> dict[str, Any]:
    """Costs [s] over elements; seconds an acceleration over bodies and loops, with a fitted line."""
    elements = [1, 4, 16, 64] if quick else [1, 2, 4, 8, 16, 32, 64, 128, 256, 512]
    numbers = [1, 10, 100] if quick else [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]
    patience = 5.0 if quick else 120.0
    families = {name: _family(build, numbers, patience) for name, build in FAMILIES.items()}
    return {"elements": elements, "costs": _refined(elements, 0.1 if quick else 0.5), "families": families}


def _refined(elements: list[int], seconds: float) -> dict[str, list[float | None]]:
    costs: dict[str, list[float | None]] = {}
    for method in METHODS:
        step(five_bar(1, DAMPING["damped"], method, 1e-4), 0.0)  # compiles
    for n in elements:
        costs.setdefault(ACCELERATION, []).append(median(acceleration(five_bar(n, DAMPING["damped"]))))
        for method in METHODS:
            system = five_bar(n, DAMPING["damped"], method, 1e-4)
            costs.setdefault(method, []).append(step(system, seconds))
        if HAS_EXUDYN:
            costs.setdefault(EXUDYN, []).append(_exudyn_step(n))
    return costs


def _exudyn_step(elements: int, steps: int = 300) -> float | None:
    """CPU seconds of a step of 1 ms."""
    from exudyn_five_bar import ExudynFiveBar

    peer = ExudynFiveBar(elements, DAMPING["damped"])
    try:
        return cpu(lambda: peer.solve(steps, 1e-5, 1e-3 * steps)) / steps
    except GaveUp:
        return None


def _family(build: Callable[[int], Model], numbers: list[int], patience: float) -> dict[str, Any]:
    """Time an acceleration for every number that can be assembled in `patience` seconds."""
    found: dict[str, Any] = {"N": [], "acceleration": [], "assembly": []}
    for n in numbers:
        model = build(n)
        start = time.process_time()
        system = assemble(model)
        assembly = time.process_time() - start
        found["N"].append(n)
        found["acceleration"].append(median(acceleration(system)))
        found["assembly"].append(assembly)
        # the next would take four times as long, or much more
        if 4.0 * assembly > patience:
            break
    # all sizes count alike: relative deviations
    b, a = np.polyfit(found["N"], found["acceleration"], 1, w=1.0 / np.array(found["acceleration"]))
    deviation = (a + b * np.array(found["N"])) / found["acceleration"] - 1.0
    return found | {"a": float(a), "b": float(b), "deviation": float(np.abs(deviation).max())}


def tables(data: dict[str, Any]) -> str:
    """Microseconds over elements; over bodies and loops, with the fitted lines."""
    costs = data["costs"]
    rows = [
        [str(n), *(number(values[k] and 1e6 * values[k]) for values in costs.values())]
        for k, n in enumerate(data["elements"])
    ]
    parts = [table(["five-bar: elements a link, us", *costs], rows)]
    for name, family in data["families"].items():
        rows = [
            [str(n), number(1e6 * t, 3), number(1e6 * (family["a"] + family["b"] * n), 3), number(assembly)]
            for n, t, assembly in zip(family["N"], family["acceleration"], family["assembly"])
        ]
        parts.append(table([f"{name}: N", "acceleration [us]", "a + b N [us]", "assembling [s]"], rows))
    return "\n\n".join([*parts, summary(data)])


def summary(data: dict[str, Any]) -> str:
    """The fitted lines, and how much more a step costs when the mesh is refined."""
    lines = []
    for name, family in data["families"].items():
        fit = f"{1e6 * family['a']:.2f} us + {1e6 * family['b']:.3f} us N"
        lines.append(
            f"- {name}, N up to {family['N'][-1]}: an acceleration takes {fit}, within {family['deviation']:.0%}."
        )
    few, many = (data["elements"].index(n) for n in (4, min(256, data["elements"][-1])))
    ratios = [
        f"{name} {values[many] / values[few]:.1f}"
        for name, values in data["costs"].items()
        if values[few] and values[many]
    ]
    elements = f"{data['elements'][many]} elements a link over 4"
    lines.append(
        f"- five-bar, {elements}, a step (or acceleration) costs times as much: {', '.join(ratios)}."
    )
    if EXUDYN not in data["costs"]:
        lines.append(f"- {EXUDYN_MISSING}")
    return "\n".join(lines)


def draw(data: dict[str, Any]) -> Figure:
    """Costs over elements, and accelerations over bodies and loops with their lines."""
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    for k, (name, values) in enumerate(data["costs"].items()):
        method = told_apart(k - 1) | {"marker": MARKERS[k - 1]}
        other = {"color": "0.2", "linestyle": ":" if name == ACCELERATION else "--", "marker": "."}
        micro = [np.nan if value is None else 1e6 * value for value in values]
        left.loglog(
            data["elements"], micro, label=name, **(other if name in (ACCELERATION, EXUDYN) else method)
        )
    left.set(xlabel="elements a link", ylabel="CPU time [µs]", title="five-bar: a step, an acceleration")
    left.margins(x=0.03)
    # room for the names above the curves
    left.set_ylim(top=300.0 * left.get_ylim()[1])
    left.legend(loc="upper left", ncols=2)
    for k, (name, family) in enumerate(data["families"].items()):
        N, measured = np.array(family["N"]), 1e6 * np.array(family["acceleration"])
        a, b = 1e6 * family["a"], 1e6 * family["b"]
        right.loglog(N, a + b * N, color=COLOURS[k], label=f"{name}: {a:.1f} + {b:.2f} N µs")
        right.loglog(N, measured, MARKERS[k], color=COLOURS[k])
    right.set(xlabel="N links of 4 elements, N loops", ylabel="CPU time [µs]", title="an acceleration")
    right.margins(x=0.03)
    right.legend()
    return figure
