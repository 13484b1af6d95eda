"""A run that is stopped, whatever stops it, leaves what was computed until then.

Run as a program, this file is such a run: `test_simulate.py ARCHIVE` simulates the five-bar for very long and
prints the status that `simulate` returns with.
"""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import fmbd

MODELS = Path(__file__).parents[2] / "models"
LONG = {"simulation.duration": 5000, "simulation.output_interval": 1e-3}


def start_a_long_run(path: Path) -> subprocess.Popen[str]:
    """A subprocess that simulates; returns once its archive holds results."""
    process = subprocess.Popen(
        [sys.executable, __file__, str(path)],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": str(MODELS.parent)},
    )
    deadline = time.monotonic() + 120
    while not (path.exists() and len(fmbd.open_run(path).time)):
        assert process.poll() is None, "the run ended by itself"
        assert time.monotonic() < deadline, "no results after two minutes"
        time.sleep(0.02)
    return process


def assert_has_what_was_computed(path: Path) -> fmbd.Run:
    """Output times without a gap, and all that is asked for by name."""
    run = fmbd.open_run(path)
    np.testing.assert_allclose(run.time, 1e-3 * np.arange(len(run.time)), atol=1e-9)
    assert run["rod_right.end.position"].shape == (len(run.time), 2)
    assert run["constraint_error"].max() < 1e-8
    return run


def test_ctrl_c_ends_a_run_in_good_order(tmp_path: Path) -> None:
    """`simulate` returns, the status says why and when, and the last output time is the one before that."""
    path = tmp_path / "run.vtkhdf"
    process = start_a_long_run(path)
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    run = assert_has_what_was_computed(path)
    assert run.status.startswith("stopped: interrupted by the user at t = ")
    assert output.strip() == run.status
    reached = float(run.status.split("=")[1].removesuffix(" s"))
    assert run.statistics["time_reached"] == pytest.approx(reached, rel=1e-5)
    assert 0.0 <= run.statistics["time_reached"] - run.time[-1] < 1e-3 + 1e-9


def test_sigterm_ends_a_run_in_good_order_and_then_the_process(tmp_path: Path) -> None:
    path = tmp_path / "run.vtkhdf"
    process = start_a_long_run(path)
    process.terminate()
    output, _ = process.communicate(timeout=60)
    assert process.returncode == -signal.SIGTERM
    assert output == ""
    assert assert_has_what_was_computed(path).status.startswith("stopped: terminated by a signal at t = ")


def test_a_killed_run_leaves_a_readable_archive(tmp_path: Path) -> None:
    path = tmp_path / "run.vtkhdf"
    process = start_a_long_run(path)
    assert fmbd.open_run(path).status == "running"
    process.kill()
    process.communicate(timeout=60)
    assert assert_has_what_was_computed(path).status == "stopped: writer ended unexpectedly"


def test_an_interrupted_run_in_memory_is_still_a_run() -> None:
    """The signal comes while the callback is called; the handler of before is back afterwards."""
    before = signal.getsignal(signal.SIGINT)
    times: list[float] = []

    def on_progress(reached: float) -> None:
        times.append(reached)
        if len(times) == 3:
            signal.raise_signal(signal.SIGINT)

    run = fmbd.simulate(fmbd.load_model(MODELS / "five_bar.yaml", LONG), on_progress=on_progress)
    assert run.status.startswith("stopped: interrupted by the user")
    assert run.time[-1] <= times[-1] == run.statistics["time_reached"]
    assert np.abs(run["energy.balance"]).max() < 1e-6
    assert signal.getsignal(signal.SIGINT) is before


def test_an_error_in_the_callback_is_raised_and_written_down(tmp_path: Path) -> None:
    def on_progress(reached: float) -> None:
        raise RuntimeError("no progress, please")

    with pytest.raises(RuntimeError):
        fmbd.simulate(MODELS / "pendulum.yaml", tmp_path / "run.vtkhdf", on_progress)
    assert fmbd.open_run(tmp_path / "run.vtkhdf").status == "stopped: no progress, please"


def test_progress_is_told_up_to_the_end() -> None:
    reached: list[float] = []
    run = fmbd.simulate(
        fmbd.load_model(MODELS / "pendulum.yaml", {"simulation.duration": 2}), None, reached.append
    )
    assert run.status == "complete"
    assert reached == sorted(reached)
    assert reached[-1] == 2.0


def test_an_archive_that_cannot_be_written_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"cannot write .*nowhere.*run\.vtkhdf: No such file or directory"):
        fmbd.simulate(MODELS / "pendulum.yaml", tmp_path / "nowhere" / "run.vtkhdf")


if __name__ == "__main__":
    print(fmbd.simulate(fmbd.load_model(MODELS / "five_bar.yaml", LONG), sys.argv[1]).status)
