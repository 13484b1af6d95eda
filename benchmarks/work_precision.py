"""Error against CPU time on the five-bar: every method of fmbd, SciPy on the same equations, Exudyn.

Each code is measured against its own converged run: fmbd and SciPy solve the same equations, Exudyn's beams follow
another theory. How far the two converged runs lie apart is recorded too, and so is the uncertainty of each, below
which no error is counted.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from common import EXUDYN_MISSING, HAS_EXUDYN, interleaved, number, table
from five_bar import DAMPING, METHODS, Observed, by_fmbd, by_scipy, errors, five_bar, observe
from matplotlib.figure import Figure

from fmbd.results.plots.style import MARKERS, told_apart

TITLE = "Five-bar, 3 s: error against CPU time"
SCIPY = ("LSODA", "Radau", "BDF", "DOP853")
TIP, END = (1e-2, 1e-3, 1e-4), (1e-5, 1e-6, 1e-7)
Points = list[dict[str, Any]]
Run = Callable[[], Observed]


def measure(quick: bool) -> dict[str, Any]:
    """All cases: points of error and CPU time by competitor."""
    cases = []
    for elements in (1, 4) if quick else (1, 4, 16):
        for damping in ("damped",) if quick else DAMPING:
            print(f"  {elements} element(s) a link, {damping}", flush=True)
            cases.append(
                {"elements": elements, "damping": damping, **_case(elements, DAMPING[damping], quick)}
            )
    return {"cases": cases}


def _case(elements: int, damping: float, quick: bool) -> dict[str, Any]:
    limit = 0.5 if quick else 10.0
    reference, nearly = (_converged(elements, damping, rtol) for rtol in (1e-12, 1e-10))
    references = {"fmbd": reference}
    uncertainty = {"fmbd": errors(nearly, reference)}
    ladders = _fmbd_ladders(elements, damping, limit, quick) | _scipy_ladders(elements, damping, limit, quick)
    physics = {}
    if HAS_EXUDYN:
        from exudyn_five_bar import ExudynFiveBar

        peer = ExudynFiveBar(elements, damping)
        finest = 38_400 if quick else 768_000
        fine, coarse = (peer.solve(steps, 1e-8) for steps in (finest, finest // 2))
        # second order: a third of the last difference is left
        references["exudyn"] = Observed(*(f + (f - c) / 3.0 for f, c in zip(fine, coarse)))
        uncertainty["exudyn"] = errors(fine, references["exudyn"])
        physics = errors(references["exudyn"], reference)
        steps = 300 * 2 ** np.arange(0, 8 if quick else 10, 2 if quick else 1)
        for tolerance in (1e-5, 1e-6):
            runs = [partial(peer.solve, int(k), tolerance) for k in steps]
            ladders["exudyn", f"generalised-alpha, Newton {tolerance:g}"] = runs
    contest = interleaved(ladders, rounds=1 if quick else 5, patience=1.0)
    points = []
    for (code, method), results in contest.items():
        basis = "exudyn" if code == "exudyn" else "fmbd"
        for timed in results:
            counted = errors(timed.result, references[basis])
            counted = {norm: max(error, uncertainty[basis][norm]) for norm, error in counted.items()}
            points.append({"code": code, "method": method, "cpu": timed.cpu, **counted})
    return {"points": points, "uncertainty": uncertainty, "exudyn_from_fmbd": physics}


def _converged(elements: int, damping: float, rtol: float) -> Observed:
    system = five_bar(elements, damping, "dop853", rtol)
    return observe(system, by_fmbd(system, np.inf)[0])


def _fmbd_ladders(elements: int, damping: float, limit: float, quick: bool) -> dict[Any, Sequence[Run]]:
    """Every method that fmbd offers, compiled before it is timed."""

    def run(system: Any) -> Observed:
        return observe(system, by_fmbd(system, limit)[0])

    ladders: dict[Any, Sequence[Run]] = {}
    for method in METHODS:
        five = [five_bar(elements, damping, method, 10.0**-k) for k in range(2, 10, 2 if quick else 1)]
        by_fmbd(five[0], np.inf, np.array([0.0, 1e-4]))
        ladders["fmbd", method] = [partial(run, system) for system in five]
    return ladders


def _scipy_ladders(elements: int, damping: float, limit: float, quick: bool) -> dict[Any, Sequence[Run]]:
    system = five_bar(elements, damping)

    def run(method: str, rtol: float) -> Observed:
        return observe(system, by_scipy(system, method, rtol, limit))

    tolerances = (1e-4, 1e-6, 1e-8) if quick else (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
    return {("scipy", method): [partial(run, method, rtol) for rtol in tolerances] for method in SCIPY}


def front(points: Points, error: str) -> tuple[np.ndarray, np.ndarray]:
    """CPU times and errors of the points that no cheaper point beats."""
    kept: list[tuple[float, float]] = []
    for point in sorted(points, key=lambda p: p["cpu"]):
        if not kept or point[error] < kept[-1][1]:
            kept.append((point["cpu"], point[error]))
    cpu, err = np.array(kept).reshape(-1, 2).T
    return cpu, err


def time_to(points: Points, error: str, target: float) -> float | None:
    """CPU time [s] at which the error falls to the target, between measured points; None if it never does."""
    cpu, err = front(points, error)
    if not err.size or err[-1] > target:
        return None
    return float(np.exp(np.interp(-np.log(target), -np.log(err), np.log(cpu))))


def _chosen(case: dict[str, Any], code: str, method: str | None = None) -> Points:
    return [p for p in case["points"] if p["code"] == code and method in (None, p["method"])]


def _best(case: dict[str, Any], code: str, error: str, target: float) -> tuple[float | None, str]:
    """The fastest method of a code, and its CPU time."""
    times = {
        method: time_to(_chosen(case, code, method), error, target)
        for method in dict.fromkeys(p["method"] for p in _chosen(case, code))
    }
    reached = {method: t for method, t in times.items() if t is not None}
    if not reached:
        return None, ""
    method = min(reached, key=reached.__getitem__)
    return reached[method], method


def tables(data: dict[str, Any]) -> str:
    """Milliseconds to every target, one table a case."""
    head = ["CPU ms to", *(f"tip {t:.0e}" for t in TIP), *(f"end {t:.0e} m" for t in END)]
    parts = []
    for case in data["cases"]:
        rows = []
        for code, method in dict.fromkeys((p["code"], p["method"]) for p in case["points"]):
            points = _chosen(case, code, method)
            found = [time_to(points, "tip_max", t) for t in TIP] + [
                time_to(points, "end_rms", t) for t in END
            ]
            rows.append([f"{code} {method}", *map(_ms, found)])
        title = f"{case['elements']} element(s) a link, {case['damping']}"
        notes = [
            f"{c} to {u['tip_max']:.0e} (tip), {u['end_rms']:.0e} m" for c, u in case["uncertainty"].items()
        ]
        if apart := case["exudyn_from_fmbd"]:
            notes.append(f"Exudyn from fmbd: {apart['tip_max']:.2g} (tip), {apart['end_rms']:.1e} m")
        parts.append(f"{title}\n\n{table(head, rows)}\n\nReferences: {'; '.join(notes)}.")
    return "\n\n".join(parts)


def summary(data: dict[str, Any]) -> str:
    """The fastest method of every code at two errors of the tips, and where fmbd is not the fastest."""
    rows, slower = [], []
    for case in data["cases"]:
        what = f"{case['elements']} element{'s' * (case['elements'] > 1)}, {case['damping']}"
        for error, target in [("tip_max", t) for t in TIP[:2]] + [("end_rms", t) for t in END[:2]]:
            (ours, method), (scipy, rival), (exudyn, _) = (
                _best(case, code, error, target) for code in ("fmbd", "scipy", "exudyn")
            )
            others = [t for t in (scipy, exudyn) if t is not None]
            if others and (ours is None or min(others) < ours):
                goal = f"tips to {target:.1%}" if error == "tip_max" else f"end point to {target:.0e} m"
                slower.append(f"{what}, {goal}")
            if error == "tip_max":
                times = [f"{method} {_ms(ours)}", f"{rival} {_ms(scipy)}", _ms(exudyn)]
                rows.append([f"{what}, {target:.1%}", *times, number(exudyn and ours and exudyn / ours)])
    lines = [table(["CPU ms to an error of the tips", "fmbd", "SciPy", "Exudyn", "Exudyn / fmbd"], rows)]
    lines.append(
        f"fmbd is not the fastest: {'; '.join(slower)}." if slower else "fmbd is the fastest in all of them."
    )
    if not any(case["exudyn_from_fmbd"] for case in data["cases"]):
        lines.append(EXUDYN_MISSING)
    return "\n\n".join(lines)


def _ms(seconds: float | None) -> str:
    return number(seconds and 1e3 * seconds)


def draw(data: dict[str, Any]) -> Figure:
    """CPU time over the error of the tips, a panel a case."""
    cases = data["cases"]
    columns = list(dict.fromkeys(case["elements"] for case in cases))
    rows = list(dict.fromkeys(case["damping"] for case in cases))
    figure = Figure(figsize=(8.0, 0.9 + 2.4 * len(rows)), layout="constrained")
    panels = figure.subplots(len(rows), len(columns), sharex=True, sharey=True, squeeze=False)
    for case in cases:
        axes = panels[rows.index(case["damping"])][columns.index(case["elements"])]
        for k, method in enumerate(METHODS):
            cpu, err = front(_chosen(case, "fmbd", method), "tip_max")
            if len(err):
                axes.loglog(err, cpu, marker=MARKERS[k], label=f"fmbd {method}", **told_apart(k))
        for code, label, style in (("scipy", "SciPy, best of four", ":"), ("exudyn", "Exudyn", "--")):
            cpu, err = front(_chosen(case, code), "tip_max")
            axes.loglog(err, cpu, style, color="0.2", marker=".", label=label)
        axes.set_title(f"{case['elements']} element{'s' * (case['elements'] > 1)} a link, {case['damping']}")
        axes.set_xlim(1e-8, 1.0)
    for axes in panels[-1]:
        axes.set_xlabel("error of the tips / peak")
    for axes in panels[:, 0]:
        axes.set_ylabel("CPU time [s]")
    curves = {line.get_label(): line for axes in panels.flat for line in axes.lines}
    figure.legend(curves.values(), curves.keys(), loc="outside lower center", ncols=5)
    return figure
