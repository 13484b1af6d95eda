"""Write a run into one HDF5 file, block by block, so that it can be read at any moment.

What the file holds is described in layout.py.
"""

import io
import os
import textwrap
import time as clock
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Self

import h5py
import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmbd.results import blocks, vtkhdf
from fmbd.results.layout import Columns, Value, create_results, describe_run, growing_datasets


class ArchiveError(Exception):
    """A file cannot be read as an archive; the message is one line that names the file and the reason."""


class ArchiveWriter:
    """The archive of a run that is being computed; a context manager.

    path: the file, best with the suffix `.vtkhdf`; an existing file is replaced once the new one is open
    model_text: the model as run, YAML
    model_files: text of the tables that the model names, by name
    coordinates, constraints, states: (name, unit) of every column
    extra: (name, unit) of further values that come with every step, such as `constraint_error`
    attributes: further root attributes; they override those recorded by default
    drawing: what connects the points given to `write_frames`

    Leaving the context before `finish` records `stopped: <reason>`. OSError, here and in every method, names
    the file and the reason in one line; what was written before it stays readable.
    """

    def __init__(
        self,
        path: str | Path,
        *,
        model_text: str,
        coordinates: Columns,
        constraints: Columns = (),
        states: Columns = (),
        extra: Columns = (),
        model_files: Mapping[str, str] | None = None,
        attributes: Mapping[str, Value] | None = None,
        drawing: vtkhdf.Drawing | None = None,
    ) -> None:
        self.path = Path(path)
        self._begun = clock.perf_counter()
        # HDF5 dies of a full disk while it creates a file, so the beginning is made in memory.
        image = io.BytesIO()
        with h5py.File(image, "w", libver=blocks.LIBVER) as file:
            describe_run(file, model_text, model_files or {}, attributes or {})
            create_results(file, coordinates, constraints, states, extra)
            if drawing is not None:
                vtkhdf.create_drawing(file, drawing)
        target = self.path.resolve()
        with self._naming_the_file():
            _replace(target, image.getvalue() + bytes(blocks.HEADROOM))
            self._file = h5py.File(target, "r+", libver=blocks.LIBVER, locking=False)
        self._datasets = growing_datasets(self._file["results"])

    def write(
        self,
        time: ArrayLike,
        position: ArrayLike,
        velocity: ArrayLike,
        acceleration: ArrayLike,
        multipliers: ArrayLike,
        states: ArrayLike,
        energy: Mapping[str, ArrayLike],
        extra: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        """Append a block of k steps and flush it.

        time [s] (k,); position, velocity, acceleration (k, nq); multipliers (k, nc); states (k, nz);
        energy: every name of layout.ENERGIES, each [J] (k,); extra: every name declared, each (k,)

        Raises ValueError when a name is missing or a shape does not fit, and then writes nothing.
        """
        steps = np.asarray(time, np.float64)
        given: dict[str, ArrayLike] = {
            "position": position,
            "velocity": velocity,
            "acceleration": acceleration,
            "multipliers": multipliers,
            "states": states,
            **{f"energy/{name}": values for name, values in energy.items()},
            **(extra or {}),
        }
        rows = self._checked_rows(given, len(steps))
        with self._naming_the_file():
            blocks.append(rows)
            # Time comes last: a reader takes as many steps as every dataset has.
            blocks.append([(self._datasets["time"], steps)])

    def write_frames(
        self, times: ArrayLike, points: ArrayLike, fields: Mapping[str, ArrayLike] | None = None
    ) -> None:
        """Append frames of the drawing: times [s], shape (k,); points [m], shape (k, npoints, 3).

        fields: every field of the drawing, each (k, npoints) or (k, npoints, 3)
        """
        values = {name: np.asarray(value, np.float32) for name, value in (fields or {}).items()}
        with self._naming_the_file():
            vtkhdf.append_frames(
                self._file, np.asarray(times, np.float64), np.asarray(points, np.float32), values
            )

    def finish(self, status: str, statistics: Mapping[str, Value]) -> None:
        """Record how the run ended, `complete` or `stopped: reason`, and close the file."""
        with self._naming_the_file():
            try:
                self._file["statistics"].attrs.update(statistics)
                self._file.attrs["status"] = status
                self._file.attrs["wall_time"] = clock.perf_counter() - self._begun
                blocks.trim(self._file)
            finally:
                self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if not self._file:
            return
        if error is None:
            self.finish("stopped: the archive was closed before the run had finished", {})
            return
        with suppress(OSError):
            self.finish(f"stopped: {_reason(error)}", {})

    def _checked_rows(
        self, given: Mapping[str, ArrayLike], count: int
    ) -> list[tuple[h5py.Dataset, NDArray[np.float64]]]:
        """Return each dataset but time with its block, checked for names and shapes."""
        wrong = (given.keys() | {"time"}) ^ self._datasets.keys()
        if wrong:
            raise ValueError(f"missing or unknown in this block: {', '.join(sorted(wrong))}")
        rows = []
        for name, values in given.items():
            block, expected = np.asarray(values, np.float64), (count, *self._datasets[name].shape[1:])
            if block.shape != expected:
                raise ValueError(f"{name} has shape {block.shape}, expected {expected}")
            rows.append((self._datasets[name], block))
        return rows

    @contextmanager
    def _naming_the_file(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            reason = os.strerror(error.errno) if error.errno else error
            raise OSError(f"cannot write {self.path}: {reason}") from error


def _replace(path: Path, content: bytes) -> None:
    """Put a file in the place of an older one, which stays if that fails."""
    if path.is_dir():
        raise OSError("it is a directory")
    if path.exists() and not path.is_file():
        raise OSError("it is not a regular file")
    if path.exists() and not os.access(path, os.W_OK):
        raise OSError("it is write-protected")
    beginning = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        beginning.write_bytes(content)
        beginning.replace(path)
    finally:
        beginning.unlink(missing_ok=True)


def _reason(error: BaseException) -> str:
    if isinstance(error, KeyboardInterrupt):
        return "interrupted by the user"
    return textwrap.shorten(str(error), 500) or type(error).__name__
