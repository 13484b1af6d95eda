"""What all benchmarks share: one thread on one core, CPU time, tables. Import it before NumPy."""

import json
import os
import platform
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
os.environ.update(dict.fromkeys(THREADS, "1"))

#: Processors this program may use, as far as the system tells.
CORES: list[int] = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
MODELS = Path(__file__).parents[1] / "models"
HAS_EXUDYN = find_spec("exudyn") is not None
EXUDYN_MISSING = "Exudyn is left out, for it is not installed: pip install -e '.[bench]' brings it."


class GaveUp(Exception):
    """A run that could not be finished; the message says why."""


class OutOfTime(GaveUp):
    """A run that took too long."""


def pin() -> None:
    """Stay on one processor, where the system can do that."""
    if CORES:
        os.sched_setaffinity(0, CORES[-1:])


def unpin() -> None:
    """Use all processors that were there at the start."""
    if CORES:
        os.sched_setaffinity(0, CORES)


def cpu(work: Callable[[], Any]) -> float:
    """CPU seconds that `work` takes."""
    start = time.process_time()
    work()
    return time.process_time() - start


@dataclass
class Timed:
    """A run, what it gave, and its CPU times [s]."""

    run: Callable[[], Any]
    result: Any
    samples: list[float]

    @property
    def cpu(self) -> float:
        """Median CPU time [s]."""
        return median(self.samples)


def interleaved(
    ladders: Mapping[Any, Sequence[Callable[[], Any]]], rounds: int, patience: float
) -> dict[Any, list[Timed]]:
    """Time all runs, in turn, so that a busy moment hits every competitor.

    Runs that give up are left out. Each ladder is ordered from cheap to dear: it ends where a run is out of time. Runs
    that have taken `patience` seconds are not repeated.
    """
    timed: dict[Any, list[Timed]] = {key: [] for key in ladders}
    for key, ladder in ladders.items():
        for run in ladder:
            start = time.process_time()
            try:
                result = run()
            except OutOfTime:
                break
            except GaveUp:
                continue
            timed[key].append(Timed(run, result, [time.process_time() - start]))
    for _ in range(rounds - 1):
        for entry in (entry for entries in timed.values() for entry in entries):
            if sum(entry.samples) < patience:
                entry.samples.append(cpu(entry.run))
    return timed


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table that also reads well on a terminal; the first column is text, the others are numbers."""
    lines = [list(head), *map(list, rows)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]

    def row(cells: Sequence[str]) -> str:
        aligned = [
            cell.rjust(width) if k else cell.ljust(width)
            for k, (cell, width) in enumerate(zip(cells, widths))
        ]
        return f"| {' | '.join(aligned)} |"

    rule = ["-" * width if k == 0 else "-" * (width - 1) + ":" for k, width in enumerate(widths)]
    return "\n".join([row(lines[0]), row(rule), *map(row, lines[1:])])


def number(value: float | None, digits: int = 2) -> str:
    """`value` to a few significant digits, without an exponent where that is readable; a dash for None."""
    if value is None:
        return "-"
    if value == 0 or not 1e-3 <= abs(value) < 1e6:
        return f"{value:.{digits - 1}e}" if value else "0"
    text = f"{float(f'{value:.{digits}g}'):f}".rstrip("0").rstrip(".")
    return text


def where() -> dict[str, Any]:
    """On what the numbers were measured."""
    packages = {}
    for name in ("fmbd", "numpy", "scipy", "numba", "exudyn"):
        try:
            packages[name] = version(name)
        except PackageNotFoundError:
            continue
    machine = {"processor": _processor(), "cores": len(CORES) or os.cpu_count()}
    return {"date": time.strftime("%Y-%m-%d"), "python": platform.python_version(), **machine, **packages}


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Write data, with where it was measured."""
    path.write_text(json.dumps({"where": where(), **data}, indent=1) + "\n")
