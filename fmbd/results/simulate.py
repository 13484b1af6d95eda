"""Compute a run: assemble the model, integrate it, record block by block."""

import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numba.core.event import TimingListener, install_listener

from fmbd.model import Model, load_model
from fmbd.results.archive import ArchiveWriter
from fmbd.results.frames import Frames
from fmbd.results.interruption import Interruption
from fmbd.results.layout import Value
from fmbd.results.reader import Archive
from fmbd.results.recording import Recording
from fmbd.results.run import Run
from fmbd.results.watch import Watch
from fmbd.solvers.integrate import Block, Statistics, integrate, output_times
from fmbd.system import System, assemble

FRAMES = 300
#: Output times at which the forces in beams are looked at.
WATCHED = 300

Array = np.ndarray


def simulate(
    model: Model | str | Path,
    output: str | Path | None = None,
    on_progress: Callable[[float], None] | None = None,
    frames: int = FRAMES,
) -> Run:
    """Run a model, or the model in a file, over its `simulation.duration`.

    output: the archive to write, suffix `.vtkhdf`; without it the results stay in memory
    on_progress: called with the time reached [s], often
    frames: pictures of the drawing in the archive, at most, taken from the output times; 0 for no drawing

    A run that cannot go on, or that Ctrl-C ends, has the status `stopped: reason` and what was computed until
    then. Raises ModelError, and OSError when the archive cannot be written.
    """
    if not isinstance(model, Model):
        model = load_model(model)
    system = assemble(model)
    if output is None:
        return simulate_system(system, on_progress)
    times = output_times(model.simulation.duration, model.simulation.output_interval)
    watch = Watch(system, _spread(times, WATCHED))
    pictures = Frames(system) if frames else None
    writer = ArchiveWriter(
        output,
        model_text=model.yaml(),
        model_files=model.files,
        attributes={"model_file": str(model.path or f"{model.name}.yaml")},
        drawing=pictures.drawing if pictures else None,
        **_columns(system),
    )
    at = set(_spread(times, pictures.most(frames))) if pictures else set()
    with writer:
        _compute(
            system,
            times,
            writer,
            watch,
            lambda block: _draw(pictures, writer, block, at),
            on_progress,
        )
    return Run(Archive(output), lambda: model, lambda: system)


def simulate_system(system: System, on_progress: Callable[[float], None] | None = None) -> Run:
    """Run an assembled system; the results stay in memory."""
    simulation = system.model.simulation
    times = output_times(simulation.duration, simulation.output_interval)
    recording = Recording(**_columns(system))
    watch = Watch(system, _spread(times, WATCHED))
    _compute(system, times, recording, watch, lambda block: None, on_progress)
    return Run(recording, lambda: system.model, lambda: system)


def not_run(system: System) -> Run:
    """The run of a system before it is run: without output times, but it knows the names of all quantities."""
    return Run(Recording(**_columns(system)), lambda: system.model, lambda: system)


def _spread(times: Array, most: int) -> Array:
    """So many of the output times, the first and the last among them."""
    return times[np.linspace(0, times.size - 1, min(most, times.size)).round().astype(int)]


def _columns(system: System) -> dict[str, list[tuple[str, str]]]:
    """Names and units of what is recorded."""
    lengths = {"m" if unit == "N" else "rad" for _, unit in system.constraints}
    error = " or ".join(sorted(lengths)) or "m"
    return {
        "coordinates": system.coordinates,
        "constraints": system.constraints,
        "states": system.states,
        "extra": [("constraint_error", error), ("velocity_constraint_error", f"({error})/s")],
    }


def _draw(pictures: Frames | None, writer: ArchiveWriter, block: Block, at: set[float]) -> None:
    """Write the frames that lie in a block."""
    rows = [k for k, time in enumerate(block.time) if time in at]
    if pictures is not None and rows:
        results = (block.time, block.position, block.velocity, block.acceleration, block.states)
        for frames in pictures.draw(*(values[rows] for values in results)):
            writer.write_frames(*frames)


def _compute(
    system: System,
    times: Array,
    record: ArchiveWriter | Recording,
    watch: Watch,
    on_block: Callable[[Block], None],
    on_progress: Callable[[float], None] | None,
) -> None:
    """Integrate and record until the end, or until something stops the run."""
    wall, cpu = clock.perf_counter(), clock.process_time()
    statistics = Statistics(system.model.simulation.method)
    largest = dict.fromkeys(("constraint_error", "velocity_constraint_error", "energy_balance"), 0.0)
    written = 0
    compiling = TimingListener()
    with Interruption() as interruption, install_listener("numba:compile", compiling):

        def progress(reached: float) -> None:
            interruption.watch()
            if on_progress is not None:
                on_progress(reached)
            if interruption.reason:
                statistics.reason = f"{interruption.reason} at t = {reached:.6g} s"

        for block in integrate(system, times, statistics, progress):
            position, velocity = block.constraint_error.T
            errors = {"constraint_error": position, "velocity_constraint_error": velocity}
            record.write(
                block.time,
                block.position,
                block.velocity,
                block.acceleration,
                block.multipliers,
                block.states,
                block.energy,
                errors,
            )
            on_block(block)
            watch.see(block)
            written += len(block.time)
            for name, values in (*errors.items(), ("energy_balance", block.energy["balance"])):
                largest[name] = float(np.maximum(largest[name], np.abs(values).max()))
        complete = written == len(times)
        record.finish(
            "complete" if complete else f"stopped: {statistics.reason}",
            _summary(system, statistics)
            | {"warnings": "\n".join(watch.warnings())}
            | {f"largest_{name}": value for name, value in largest.items()}
            | {"compile_time": compiling.duration if compiling.done else 0.0}
            | {"wall_time": clock.perf_counter() - wall, "cpu_time": clock.process_time() - cpu},
        )


def _summary(system: System, statistics: Statistics) -> dict[str, Value]:
    """How the run went: the solver's counters, the time reached [s], remarks on the start, one a line."""
    counters: dict[str, Any] = {name: value for name, value in vars(statistics).items() if name != "warnings"}
    return counters | {"remarks": "\n".join([*system.start.remarks, *statistics.warnings])}
