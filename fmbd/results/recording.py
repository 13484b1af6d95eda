"""A run kept in memory: written like an archive, read like an archive."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmbd.results.layout import MATRICES, Columns, Value

Array = NDArray[np.float64]


class Source(Protocol):
    """What a run is read from: a `Recording`, or a `reader.Archive`.

    status: `running`, `complete` or `stopped: reason`
    statistics: counters of the solver, remarks
    coordinates, constraints, state_names: names of the columns of position, multipliers and states
    units: unit of each result, or units of its columns, by its name
    time: [s], shape (nt,)
    """

    status: str
    statistics: dict[str, Value]
    coordinates: tuple[str, ...]
    constraints: tuple[str, ...]
    state_names: tuple[str, ...]
    units: dict[str, str | tuple[str, ...]]

    @property
    def time(self) -> Array: ...

    def result(self, name: str) -> Array:
        """Return results by their name, `position` or `energy/kinetic`; shape (nt,) or (nt, n)."""


class Recording:
    """Collects blocks of results; columns and units as for `archive.ArchiveWriter`."""

    def __init__(
        self, coordinates: Columns, constraints: Columns, states: Columns, scalars: Columns
    ) -> None:
        self.status = "running"
        self.statistics: dict[str, Value] = {}
        columns = {"coordinate": coordinates, "constraint": constraints, "state": states}
        self.coordinates, self.constraints, self.state_names = (
            tuple(name for name, _ in columns[scale]) for scale in columns
        )
        self.units: dict[str, str | tuple[str, ...]] = dict([("time", "s"), *scalars])
        for name, (scale, per) in MATRICES.items():
            self.units[name] = tuple(unit + per for _, unit in columns[scale])
        self._blocks: dict[str, list[Array]] = {
            name: [np.empty((0,) if isinstance(unit, str) else (0, len(unit)))]
            for name, unit in self.units.items()
        }

    def write(self, results: Mapping[str, ArrayLike]) -> None:
        """Append a block of steps: all results by name."""
        for name, blocks in self._blocks.items():
            blocks.append(np.asarray(results[name], np.float64))

    @property
    def time(self) -> Array:
        """[s], shape (nt,)."""
        return self.result("time")

    def result(self, name: str) -> Array:
        """Return results by their name, shape (nt,) or (nt, n)."""
        blocks = self._blocks[name]
        if len(blocks) > 1:
            blocks[:] = [np.concatenate(blocks)]
        return blocks[0]
