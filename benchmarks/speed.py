"""How fast the five-bar is: one evaluation, one simulation, and the command line, each beside its aim.

CPU time for what is computed in this process, wall time for whole commands; medians.
"""

import os
import subprocess
import sysconfig
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

from common import MODELS, cpu, number, table
from five_bar import by_fmbd, five_bar
from scaling import acceleration

from fmbd.solvers.integrate import output_times

TITLE = "The five-bar beside its aims"


def measure(quick: bool) -> dict[str, Any]:
    """All timings with their aims."""
    timings = []
    for what, unit, scale, aim, samples in _timings(quick):
        scaled = [scale * sample for sample in samples]
        timings.append({"what": what, "unit": unit, "aim": aim, "median": median(scaled), "samples": scaled})
    return {"timings": timings}


def _timings(quick: bool) -> Iterator[tuple[str, str, float, float, list[float]]]:
    """What is timed, its unit, units a second, the aim, and samples [s]."""
    repetitions = 3 if quick else 15
    for elements, aim in ((1, 2.0), (16, 3.0)):
        what = f"accelerations and multipliers, elements a rod: {elements}"
        yield what, "us", 1e6, aim, acceleration(five_bar(elements, 0.0), repetitions)
    for interval in (1e-2, 1e-3):
        times = output_times(3.0, interval)
        system = five_bar(1, 0.0, "dop853", 1e-6)
        by_fmbd(system, float("inf"), times)  # compiles, or loads what was compiled
        samples = [cpu(lambda: by_fmbd(system, float("inf"), times)) for _ in range(repetitions)]  # noqa: B023
        yield f"controlled move of 3 s, dop853, rtol 1e-6, outputs: {times.size}", "ms", 1e3, 30.0, samples
    with tempfile.TemporaryDirectory() as folder:
        command = "fmbd run models/five_bar.yaml (wall)"
        if quick:
            yield command, "s", 1.0, 1.5, [_run(folder, os.environ) for _ in range(3)]
            return
        environment = os.environ | {"NUMBA_CACHE_DIR": str(Path(folder) / "cache")}
        yield f"{command}, the first ever", "s", 1.0, 60.0, [_run(folder, environment)]
        yield command, "s", 1.0, 1.5, [_run(folder, environment) for _ in range(7)]


def _run(folder: str, environment: Any) -> float:
    """Seconds on the clock for a simulation from the shell."""
    command = [str(Path(sysconfig.get_path("scripts")) / "fmbd"), "run", str(MODELS / "five_bar.yaml")]
    start = time.perf_counter()
    subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
    return time.perf_counter() - start


def tables(data: dict[str, Any]) -> str:
    """Aims and medians."""
    rows = [
        [
            timing["what"],
            f"{number(timing['median'])} {timing['unit']}",
            f"{timing['aim']:g} {timing['unit']}",
            "met" if timing["median"] <= timing["aim"] else "MISSED",
        ]
        for timing in data["timings"]
    ]
    return table(["", "median", "aim", ""], rows)


summary = tables
