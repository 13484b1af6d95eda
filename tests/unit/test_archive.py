"""An archive gives back what was written, and survives whatever ends its writer.

Run as a program, this file is such a writer: `test_archive.py forever PATH` or `test_archive.py full PATH`.
"""

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
import pytest

import fmbd
from fmbd.results.archive import ArchiveError, ArchiveWriter
from fmbd.results.layout import ENERGIES, growing_datasets
from fmbd.results.reader import read_archive

NQ, BLOCK = 10, 7
MODEL = "fmbd: 1\nname: gelenkviereck, größer\n"
DISK = 3_000_000


def open_writer(path: Path, **changes: object) -> ArchiveWriter:
    given = {
        "model_text": MODEL,
        "coordinates": [(f"rod.w{i}", "m") for i in range(NQ - 1)] + [("elbow.angle", "rad")],
        "constraints": [("effector.x", "N"), ("effector.y", "N")],
        "states": [("motor.current", "A")],
        "extra": [("constraint_error", "m")],
    }
    return ArchiveWriter(path, **(given | changes))


def block(start: int, count: int = BLOCK, nq: int = NQ, nc: int = 2, nz: int = 1) -> dict:
    """Steps `start` to `start + count`; every number follows from its step, so any row can be checked."""
    steps = np.arange(start, start + count, dtype=float)
    column = steps[:, None]
    return {
        "time": 1e-3 * steps,
        "position": column + np.arange(nq),
        "velocity": 2 * column + np.arange(nq),
        "acceleration": 3 * column + np.arange(nq),
        "multipliers": 4 * column + np.arange(nc),
        "states": 5 * column + np.arange(nz),
        "energy": {name: steps + k for k, name in enumerate(ENERGIES)},
        "extra": {"constraint_error": 1e-9 * steps},
    }


def assert_holds_steps(path: Path, count: int) -> None:
    archive, expected = read_archive(path), block(0, count)
    assert len(archive) == count
    for name in ("time", "position", "velocity", "acceleration", "multipliers", "states"):
        np.testing.assert_array_equal(getattr(archive, name), expected[name], err_msg=name)
    for name in ENERGIES:
        np.testing.assert_array_equal(archive.energy[name], expected["energy"][name])
    np.testing.assert_array_equal(archive.result("constraint_error"), expected["extra"]["constraint_error"])


@contextmanager
def other_process(what: str, path: Path) -> Iterator[subprocess.Popen[str]]:
    environment = os.environ | {"PYTHONPATH": str(Path(fmbd.__file__).parents[1])}
    command = [sys.executable, __file__, what, str(path)]
    with subprocess.Popen(command, env=environment, text=True, stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout is not None
            process.stdout.readline()
            yield process
        finally:
            process.kill()


def test_everything_written_comes_back(tmp_path: Path) -> None:
    path = tmp_path / "run.vtkhdf"
    with open_writer(path, attributes={"command": "fmbd run"}) as writer:
        for start in range(0, 300, 100):
            writer.write(**block(start, 100))
        writer.finish("complete", {"steps": 412, "rejected": 3, "method": "rodas5p"})

    assert_holds_steps(path, 300)
    archive = read_archive(path)
    assert archive.status == "complete"
    assert archive.model_text == MODEL
    assert archive.statistics == {"steps": 412, "rejected": 3, "method": "rodas5p"}
    assert archive.coordinates[-1] == "elbow.angle"
    assert archive.constraints == ("effector.x", "effector.y")
    assert archive.state_names == ("motor.current",)
    assert archive.units["velocity"][0] == "m/s"
    assert archive.units["acceleration"][-1] == "rad/s^2"
    assert archive.units["energy/kinetic"] == "J"
    assert archive.attributes["command"] == "fmbd run"
    assert archive.attributes["numpy_version"] == np.__version__
    assert archive.attributes["wall_time"] > 0
    with pytest.raises(KeyError, match=r"has no results 'constraint_eror'; there are: .*constraint_error"):
        archive.result("constraint_eror")


def test_a_stranger_finds_names_units_and_dimensions(tmp_path: Path) -> None:
    """Plain h5py sees labelled data; the scales are what lets xarray open the group."""
    path = tmp_path / "run.vtkhdf"
    with open_writer(path) as writer:
        writer.write(**block(0))
        writer.finish("complete", {})
    with h5py.File(path) as file:
        results = file["results"]
        velocity = results["velocity"]
        assert velocity.dims[0][0] == results["time"]
        assert list(velocity.dims[1][0].asstr()) == list(velocity.attrs["names"])
        assert velocity.attrs["units"][-1] == "rad/s"
        for dataset in growing_datasets(results).values():
            assert {"names", "units"} <= dataset.attrs.keys()


@pytest.mark.parametrize("nq", [0, 5000])
def test_a_system_may_have_no_columns_or_thousands(tmp_path: Path, nq: int) -> None:
    """5000 names do not fit into the 64 KiB that HDF5 gives an ordinary attribute."""
    path = tmp_path / "run.vtkhdf"
    names = [(f"link{i}.angle", "rad") for i in range(nq)]
    with open_writer(path, coordinates=names, constraints=[], states=[]) as writer:
        writer.write(**block(0, nq=nq, nc=0, nz=0))
        writer.finish("complete", {})
    archive = read_archive(path)
    assert archive.coordinates == tuple(name for name, _ in names)
    assert archive.multipliers.shape == (BLOCK, 0)
    np.testing.assert_array_equal(archive.position, block(0, nq=nq)["position"])
    assert archive.units["velocity"] == ("rad/s",) * nq


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"position": np.zeros((BLOCK, NQ + 1))}, r"position has shape \(7, 11\), expected \(7, 10\)"),
        ({"extra": {}}, "missing or unknown in this block: constraint_error"),
        ({"energy": {"heat": np.zeros(BLOCK)}}, "energy/balance, .*energy/heat"),
    ],
)
def test_a_wrong_block_is_refused_whole(tmp_path: Path, change: dict, message: str) -> None:
    path = tmp_path / "run.vtkhdf"
    with open_writer(path) as writer:
        writer.write(**block(0))
        with pytest.raises(ValueError, match=message):
            writer.write(**(block(BLOCK) | change))
        writer.write(**block(BLOCK))
        writer.finish("complete", {})
    assert_holds_steps(path, 2 * BLOCK)


def test_a_running_simulation_can_be_watched(tmp_path: Path) -> None:
    path = tmp_path / "run.vtkhdf"
    with other_process("forever", path):
        early = read_archive(path)
        deadline = time.monotonic() + 30
        while len(read_archive(path)) < len(early) + 10 * BLOCK:
            assert time.monotonic() < deadline
        assert read_archive(path).status == early.status == "running"
        # What was opened early keeps its length, so that its arrays fit together.
        assert len(early.velocity) == len(early.time) == len(early)
    assert read_archive(path).status == "stopped: writer ended unexpectedly"


def test_a_killed_writer_leaves_whole_blocks(tmp_path: Path) -> None:
    chance = random.Random(2022)
    lengths = []
    for trial in range(12):
        path = tmp_path / f"{trial}.vtkhdf"
        with other_process("forever", path) as process:
            time.sleep(chance.uniform(0.0, 0.3))
            process.send_signal(signal.SIGKILL)
            process.wait()
        archive = read_archive(path)
        lengths.append(len(archive))
        assert archive.status == "stopped: writer ended unexpectedly"
        assert len(archive) % BLOCK == 0
        assert_holds_steps(path, len(archive))
    assert max(lengths) > 0


@pytest.mark.skipif(not hasattr(os, "posix_fallocate"), reason="the platform cannot claim disk space")
def test_a_full_disk_stops_the_run_and_keeps_what_was_written(tmp_path: Path) -> None:
    """A limit on the size of a file stands for the full disk; the writer prints how many steps it wrote."""
    path = tmp_path / "run.vtkhdf"
    with other_process("full", path) as process:
        printed, _ = process.communicate(timeout=60)
    written, message = printed.split(maxsplit=1)
    assert process.returncode == 0
    assert message.strip() == f"cannot write {path}: File too large"
    assert int(written) > 1000
    assert path.stat().st_size <= DISK
    assert_holds_steps(path, int(written))
    assert read_archive(path).status == f"stopped: {message.strip()}"


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (KeyboardInterrupt(), "stopped: interrupted by the user"),
        (RuntimeError("step size\n below 1e-12 s"), "stopped: step size below 1e-12 s"),
        (ZeroDivisionError(), "stopped: ZeroDivisionError"),
    ],
)
def test_an_exception_is_recorded_and_passed_on(tmp_path: Path, error: BaseException, status: str) -> None:
    path = tmp_path / "run.vtkhdf"
    with pytest.raises(type(error)), open_writer(path) as writer:
        writer.write(**block(0))
        raise error
    assert read_archive(path).status == status
    assert_holds_steps(path, BLOCK)


def test_a_run_that_never_finished_does_not_count_as_complete(tmp_path: Path) -> None:
    with open_writer(tmp_path / "run.vtkhdf") as writer:
        writer.write(**block(0))
    assert read_archive(tmp_path / "run.vtkhdf").status.startswith("stopped: ")


def test_an_existing_file_goes_only_when_the_new_one_is_there(tmp_path: Path) -> None:
    path = tmp_path / "run.vtkhdf"
    with open_writer(path) as writer:
        writer.write(**block(0))
        writer.finish("complete", {})
    with pytest.raises(ValueError, match="name already exists"):
        open_writer(path, extra=[("time", "s")])
    assert_holds_steps(path, BLOCK)

    old = read_archive(path)
    with open_writer(path) as writer:
        assert len(read_archive(path)) == 0
        writer.finish("complete", {})
    with pytest.raises(ArchiveError, match="replaced by another run"):
        old.result("position")
    assert list(tmp_path.iterdir()) == [path]


def test_a_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(OSError, match=f"^cannot write {tmp_path}: it is a directory$"):
        open_writer(tmp_path)
    with pytest.raises(OSError, match=r"^cannot write .*/nowhere/run.vtkhdf: No such file or directory$"):
        open_writer(tmp_path / "nowhere" / "run.vtkhdf")
    with pytest.raises(OSError, match=r"^cannot write /dev/null: it is not a regular file$"):
        open_writer(Path(os.devnull))
    assert not list(tmp_path.iterdir())


def test_other_files_are_not_taken_for_archives(tmp_path: Path) -> None:
    text, foreign, cut = tmp_path / "notes.txt", tmp_path / "foreign.h5", tmp_path / "cut.vtkhdf"
    text.write_text("no HDF5 here")
    h5py.File(foreign, "w").close()
    with open_writer(cut) as writer:
        writer.write(**block(0))
        writer.finish("complete", {})
    os.truncate(cut, cut.stat().st_size // 2)
    for path, reason in (
        (tmp_path / "missing.vtkhdf", "No such file or directory"),
        (tmp_path, "Is a directory"),
        (text, r"not an fmbd archive \(not an HDF5 file\)"),
        (foreign, r"not an fmbd archive \(it has no fmbd_version\)"),
        (cut, "damaged archive: .*truncated file"),
    ):
        with pytest.raises(ArchiveError, match=f"^{path}: {reason}") as raised:
            read_archive(path)
        assert "\n" not in str(raised.value)


def test_a_run_on_another_host_is_left_running(tmp_path: Path) -> None:
    """Whether a process of another machine still lives cannot be told from here."""
    path = tmp_path / "run.vtkhdf"
    open_writer(path, attributes={"writer": "elsewhere 1 2"})
    assert read_archive(path).status == "running"


def test_reading_needs_no_numerics(tmp_path: Path) -> None:
    code = "import sys, fmbd.results.reader; sys.exit(bool({'scipy', 'numba', 'vtk'} & sys.modules.keys()))"
    environment = os.environ | {"PYTHONPATH": str(Path(fmbd.__file__).parents[1])}
    assert subprocess.run([sys.executable, "-c", code], env=environment, check=False).returncode == 0


def write_without_end(path: Path) -> None:
    written = 0
    try:
        with open_writer(path) as writer:
            print("begun", flush=True)
            while True:
                writer.write(**block(written))
                written += BLOCK
    except OSError as error:
        print(written, error)


if __name__ == "__main__":
    if sys.argv[1] == "full":
        import resource

        resource.setrlimit(resource.RLIMIT_FSIZE, (DISK, DISK))
    write_without_end(Path(sys.argv[2]))
