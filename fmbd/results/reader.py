"""Read the archive of a run: finished, killed half-way, or still being written."""

import time as clock
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import TypeVar

import h5py
import numpy as np
from numpy.typing import NDArray

from fmbd.results import vtkhdf
from fmbd.results.archive import ArchiveError
from fmbd.results.layout import ENERGIES, Value, growing_datasets, is_gone, units_of

Array = NDArray[np.float64]
T = TypeVar("T")

# A running writer may be caught in the middle of a flush, which takes some milliseconds.
ATTEMPTS = 20
PAUSE = 0.01

#: Files of other commands, by a group that only they have.
OTHERS = {
    "members": "a study, not the archive of a run: `fmbd info`, `fmbd plot` and `fmbd report` read it",
    "derivatives": "derivatives of `fmbd sensitivity`, not the archive of a run: any reader of HDF5 opens it, such as "
    "h5py; they are in /derivatives",
}


class Archive:
    """A run read back from its file.

    What is listed here is read at once, the rest when asked for. All arrays have the same number of steps,
    `len(archive)`: those that were whole when the file was opened.

    status: `running`, `complete` or `stopped: reason`
    attributes: root attributes (versions, command, started [UTC], wall_time [s], model_sha256, ...)
    model_text: YAML text of the model as run
    model_file: name of the file that it came from, None when it is not known
    model_files: text of the tables that the model names, by name
    statistics: counters of the solver
    coordinates, constraints, state_names: names of the columns of position, multipliers and states
    units: unit of each dataset, or units of its columns, by its path in `/results`
    time: [s], shape (nt,)

    Raises ArchiveError when the file is not an archive, is damaged, or was replaced by another run meanwhile.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.attributes: dict[str, Value] = {}
        self._read(self._read_head)

    def __len__(self) -> int:
        return len(self.time)

    def _read_head(self, file: h5py.File) -> None:
        results = file["results"]
        datasets = growing_datasets(results)
        attributes = _plain(file.attrs)
        self.status = _status(attributes)
        self.model_text: str = file["model"].asstr()[()]
        self.model_files: dict[str, str] = {
            table.attrs["name"]: table.asstr()[()] for table in file["model_files"].values()
        }
        self.model_file = str(attributes["model_file"]) if "model_file" in attributes else None
        self.statistics = _plain(file["statistics"].attrs)
        self.coordinates, self.constraints, self.state_names = (
            tuple(results[scale].asstr()[:]) for scale in ("coordinate", "constraint", "state")
        )
        self.units = {name: units_of(results, name) for name in datasets}
        time = datasets["time"][: min(len(dataset) for dataset in datasets.values())]
        # Rows that were promised but never arrived hold the fill value.
        self.time: Array = time[: np.argmax(np.isnan(time))] if np.isnan(time).any() else time
        self.attributes = attributes

    @cached_property
    def position(self) -> Array:
        """Generalised coordinates, shape (nt, nq)."""
        return self.result("position")

    @cached_property
    def velocity(self) -> Array:
        """Rates of the coordinates, shape (nt, nq)."""
        return self.result("velocity")

    @cached_property
    def acceleration(self) -> Array:
        """Second rates of the coordinates, shape (nt, nq)."""
        return self.result("acceleration")

    @cached_property
    def multipliers(self) -> Array:
        """Lagrange multipliers of the constraints, shape (nt, nc)."""
        return self.result("multipliers")

    @cached_property
    def states(self) -> Array:
        """First-order states, shape (nt, nz)."""
        return self.result("states")

    @cached_property
    def energy(self) -> dict[str, Array]:
        """Energies [J] by name, each of shape (nt,)."""
        return {name: self.result(f"energy/{name}") for name in ENERGIES}

    def result(self, name: str) -> Array:
        """Return a dataset by its path in `/results`, such as `constraint_error`; shape (nt,) or (nt, n)."""
        if name not in self.units:
            raise KeyError(f"{self.path} has no results {name!r}; there are: {', '.join(sorted(self.units))}")
        return self._read(lambda file: file["results"][name][: len(self)])

    @cached_property
    def drawing(self) -> vtkhdf.Drawing | None:
        """What connects the points of a frame; None when the run was archived without a drawing."""
        return self._read(lambda file: vtkhdf.read_drawing(file) if "VTKHDF" in file else None)

    @cached_property
    def frames(self) -> tuple[Array, NDArray[np.float32]]:
        """Times [s], shape (k,), and points [m], shape (k, npoints, 3), of the drawing."""
        if self.drawing is None:
            raise ArchiveError(f"{self.path}: this run was archived without a drawing")
        return self._read(vtkhdf.read_frames)

    def _read(self, part: Callable[[h5py.File], T]) -> T:
        """Open the file, read a part, close it; try again, as a running writer may be amid a flush."""
        try:
            self.path.open("rb").close()
        except OSError as error:
            raise ArchiveError(f"{self.path}: {error.strerror}") from error
        if not h5py.is_hdf5(self.path):
            raise ArchiveError(f"{self.path}: not an fmbd archive (not an HDF5 file)")
        for attempt in range(ATTEMPTS):
            try:
                with h5py.File(self.path, "r", locking=False) as file:
                    self._check_identity(file)
                    return part(file)
            except (OSError, KeyError, RuntimeError) as error:
                failure = error
                clock.sleep(PAUSE if attempt < ATTEMPTS - 1 else 0)
        reason = str(failure).splitlines()[0]
        raise ArchiveError(f"{self.path}: damaged archive: {reason}") from failure

    def _check_identity(self, file: h5py.File) -> None:
        if "fmbd_version" not in file.attrs:
            raise ArchiveError(f"{self.path}: not an fmbd archive (it has no fmbd_version)")
        for group, what in OTHERS.items():
            if group in file:
                raise ArchiveError(f"{self.path}: {what}")
        if self.attributes and self.attributes["started"] != file.attrs["started"]:
            raise ArchiveError(f"{self.path}: replaced by another run since it was opened")


def read_archive(path: str | Path) -> Archive:
    """Open the archive of a run; raises ArchiveError when the file is not one."""
    return Archive(path)


def _plain(attributes: h5py.AttributeManager) -> dict[str, Value]:
    return {
        name: value.item() if isinstance(value, np.generic) else value for name, value in attributes.items()
    }


def _status(attributes: dict[str, Value]) -> str:
    """Return the status as recorded, except when a run calls itself running and its writer is gone."""
    if attributes["status"] == "running" and is_gone(str(attributes["writer"])):
        return "stopped: writer ended unexpectedly"
    return str(attributes["status"])
