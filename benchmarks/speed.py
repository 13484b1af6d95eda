"""How fast the five-bar is: one evaluation, one simulation, and the command line, each beside its aim.

    python benchmarks/speed.py [speed.json]

Medians; CPU time for what is computed in this process, wall time for whole commands.
"""

import json
import os
import platform
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from statistics import median

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
os.environ.update(dict.fromkeys(THREADS, "1"))  # before NumPy is imported

import numpy as np  # noqa: E402
from numba import njit  # noqa: E402

import fmbd  # noqa: E402
from fmbd.model import load_model  # noqa: E402
from fmbd.planar.equations import evaluate_accelerations  # noqa: E402
from fmbd.solvers.integrate import Statistics, integrate, output_times  # noqa: E402
from fmbd.system import assemble  # noqa: E402

FIVE_BAR = Path(__file__).parents[1] / "models" / "five_bar.yaml"


@dataclass(frozen=True)
class Timing:
    """One line of the table."""

    what: str
    unit: str
    aim: float
    samples: list[float]

    def __str__(self) -> str:
        value = median(self.samples)
        verdict = "met" if value <= self.aim else "MISSED"
        return f"{self.what:58}{value:10.3g} {self.unit:3}{self.aim:8g} {self.unit:3}  {verdict}"


# not cached: a cached loop would go on calling the kernels of the day it was compiled
@njit(_nrt=False)
def repeat(count, planar, work, t, q, v, z, dz, qdd):
    """Evaluate `count` times; compiled, since a call from Python costs more than the kernel."""
    for _ in range(count):
        evaluate_accelerations(planar, work, t, q, v, z, dz, qdd)


def accelerations(elements: int, aim: float) -> Timing:
    """Accelerations and multipliers of the moving five-bar, `elements` a rod."""
    system = assemble(load_model(FIVE_BAR).with_("bodies.*.elements", elements))
    q, z = system.to_modal(system.start.q), system.start.z
    arguments = (system.planar, system.work, 0.1, q, np.full_like(q, 0.01), z, z.copy(), q.copy())
    count = 20_000
    repeat(1, *arguments)
    samples = [1e6 / count * cpu(lambda: repeat(count, *arguments)) for _ in range(15)]
    return Timing(f"accelerations, {elements} element(s) a rod", "us", aim, samples)


def simulation(interval: float, aim: float) -> Timing:
    """The controlled move over 3 s, rtol 1e-6; states, accelerations, multipliers, energies every `interval` [s]."""
    system = assemble(load_model(FIVE_BAR, {"simulation.rtol": 1e-6}))
    times = output_times(3.0, interval)

    def run() -> None:
        for _ in integrate(system, times, Statistics(system.model.simulation.method)):
            pass

    run()  # compiles, or loads what was compiled
    samples = [1e3 * cpu(run) for _ in range(15)]
    return Timing(f"simulation of 3 s, rtol 1e-6, {times.size} outputs", "ms", aim, samples)


def command_line(first_aim: float, warm_aim: float) -> Iterator[Timing]:
    """`fmbd run models/five_bar.yaml` from the shell: compiling everything, then from the cache."""
    command = [str(Path(sysconfig.get_path("scripts")) / "fmbd"), "run", str(FIVE_BAR)]
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"NUMBA_CACHE_DIR": str(Path(folder) / "cache")}

        def run() -> float:
            start = time.perf_counter()
            subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)
            return time.perf_counter() - start

        yield Timing("fmbd run models/five_bar.yaml, the first ever (wall)", "s", first_aim, [run()])
        warm = [run() for _ in range(7)]
        yield Timing("fmbd run models/five_bar.yaml, warm (wall)", "s", warm_aim, warm)


def cpu(work: Callable[[], None]) -> float:
    """CPU seconds that `work` takes."""
    start = time.process_time()
    work()
    return time.process_time() - start


def measure() -> Iterator[Timing]:
    """All timings with their aims."""
    yield accelerations(1, 2.0)
    yield accelerations(16, 3.0)
    yield simulation(1e-2, 30.0)
    yield simulation(1e-3, 30.0)
    yield from command_line(60.0, 1.5)


def main() -> None:
    """Print the table; write it as JSON if a file is named."""
    timings = []
    print(f"{'':58}{'median':>13}{'aim':>11}")
    for timing in measure():
        print(timing, flush=True)
        timings.append(timing)
    if len(sys.argv) > 1:
        packages = {name: version(name) for name in ("numpy", "numba", "scipy", "h5py")}
        where = {"python": platform.python_version(), "machine": platform.machine(), "cores": os.cpu_count()}
        report = {
            "where": where | {"fmbd": fmbd.__version__} | packages,
            "timings": [asdict(timing) | {"median": median(timing.samples)} for timing in timings],
        }
        Path(sys.argv[1]).write_text(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()
