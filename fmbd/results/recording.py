"""A run kept in memory: written like an archive, read like an archive."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fmbd.results.layout import ENERGIES, MATRICES, Columns, Value

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
    """Collects the blocks of a run; arguments as for `archive.ArchiveWriter`."""

    def __init__(self, coordinates: Columns, constraints: Columns, states: Columns, extra: Columns) -> None:
        self.status = "running"
        self.statistics: dict[str, Value] = {}
        columns = {"coordinate": coordinates, "constraint": constraints, "state": states}
        self.coordinates, self.constraints, self.state_names = (
            tuple(name for name, _ in given) for given in columns.values()
        )
        self.units: dict[str, str | tuple[str, ...]] = {
            name: tuple(unit + per for _, unit in columns[scale]) for name, (scale, per) in MATRICES.items()
        }
        self.units |= {"time": "s", **{f"energy/{name}": "J" for name in ENERGIES}, **dict(extra)}
        self._blocks: dict[str, list[Array]] = {
            name: [np.empty(0 if isinstance(unit, str) else (0, len(unit)))]
            for name, unit in self.units.items()
        }

    def write(
        self,
        time: Array,
        position: Array,
        velocity: Array,
        acceleration: Array,
        multipliers: Array,
        states: Array,
        energy: Mapping[str, Array],
        extra: Mapping[str, Array],
    ) -> None:
        """Append a block of k steps; shapes (k,) or (k, n)."""
        matrices = (position, velocity, acceleration, multipliers, states)
        given = {"time": time, **dict(zip(MATRICES, matrices, strict=True)), **extra}
        given |= {f"energy/{name}": values for name, values in energy.items()}
        for name, values in given.items():
            self._blocks[name].append(values)

    def finish(self, status: str, statistics: Mapping[str, Value]) -> None:
        """Record how the run ended."""
        self.status, self.statistics = status, dict(statistics)

    @property
    def time(self) -> Array:
        """[s], shape (nt,)."""
        return self.result("time")

    def result(self, name: str) -> Array:
        """Return results by their name, `position` or `energy/kinetic`; shape (nt,) or (nt, n)."""
        blocks = self._blocks[name]
        if len(blocks) > 1:
            blocks[:] = [np.concatenate(blocks)]
        return blocks[0]
