"""A run: its states at the output times, and every quantity that follows from them, by name."""

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fmbd.results.layout import ENERGIES, Value
from fmbd.results.recording import Source

if TYPE_CHECKING:
    from fmbd.model import Model
    from fmbd.results.forces import Forces
    from fmbd.results.motion import Motion
    from fmbd.results.quantities import Quantity
    from fmbd.system import System

Array = NDArray[np.float64]


class Run:
    """Results by name: `run["rod.end.position"]`; what the names mean stands in quantities.py.

    nt output times, nq coordinates, nc constraints, nz first-order states. A run that was stopped has
    the output times that it reached. `source` is what it is read from, a `recording.Recording` or a
    `reader.Archive`.
    """

    def __init__(
        self, source: Source, model: "Callable[[], Model]", system: "Callable[[], System] | None" = None
    ) -> None:
        self.source = source
        self._model = model
        self._system = system

    def __getitem__(self, name: str) -> Array:
        """A quantity at all output times, in SI units: (nt,), or (nt, n) with the columns `columns(name)`.

        `rod.end.position.x` is a column of `rod.end.position`. Raises UnknownQuantity, a KeyError, for a name that
        the run does not have.
        """
        return self.quantity(name).compute(self)

    def __contains__(self, name: str) -> bool:
        return name in self._quantities

    def __iter__(self) -> Iterator[str]:
        return iter(self._quantities)

    def __repr__(self) -> str:
        return f"<Run: {len(self.time)} output times, {self.status}>"

    @property
    def status(self) -> str:
        """`complete`, `stopped: reason`, or `running` for the archive of a run that goes on."""
        return self.source.status

    @property
    def statistics(self) -> Mapping[str, Value]:
        """Counters of the solver and how the run went (see simulate.py)."""
        return self.source.statistics

    @property
    def time(self) -> Array:
        """Output times [s], shape (nt,)."""
        return self.source.time

    @cached_property
    def position(self) -> Array:
        """Generalised coordinates, the elastic ones nodal, shape (nt, nq)."""
        return self.source.result("position")

    @cached_property
    def velocity(self) -> Array:
        """Rates of the coordinates, shape (nt, nq)."""
        return self.source.result("velocity")

    @cached_property
    def acceleration(self) -> Array:
        """Second rates of the coordinates, shape (nt, nq)."""
        return self.source.result("acceleration")

    @cached_property
    def multipliers(self) -> Array:
        """Lagrange multipliers of the constraints, shape (nt, nc)."""
        return self.source.result("multipliers")

    @cached_property
    def states(self) -> Array:
        """First-order states, shape (nt, nz)."""
        return self.source.result("states")

    @cached_property
    def energy(self) -> dict[str, Array]:
        """Energies [J] by name, each of shape (nt,); `balance` is zero when none is lost."""
        return {name: self.source.result(f"energy/{name}") for name in ENERGIES}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all quantities."""
        return tuple(self._quantities)

    def units(self, name: str) -> str:
        """Unit of a quantity; raises UnknownQuantity."""
        return self.quantity(name).unit

    def columns(self, name: str) -> tuple[str, ...]:
        """What the columns of a quantity of shape (nt, n) are, such as ('x', 'y'); () for shape (nt,)."""
        return self.quantity(name).columns

    def quantity(self, name: str) -> "Quantity":
        """Unit, columns and rule of a quantity, or of one of its columns; raises UnknownQuantity."""
        if name in self._quantities:
            return self._quantities[name]
        from fmbd.results.quantities import column, unknown_quantity

        whole, _, part = name.rpartition(".")
        if whole in self._quantities and part in self._quantities[whole].columns:
            return column(self._quantities[whole], part)
        raise unknown_quantity(name, self._quantities, self.model)

    @cached_property
    def model(self) -> "Model":
        """The model as run."""
        return self._model()

    @cached_property
    def system(self) -> "System":
        """The model, assembled."""
        if self._system is not None:
            return self._system()
        from fmbd.system import assemble

        return assemble(self.model)

    @cached_property
    def motion(self) -> "Motion":
        """Where all bodies and points are, and how they move."""
        from fmbd.results.motion import Motion

        return Motion(self.system, self.time, self.position, self.velocity, self.acceleration)

    @cached_property
    def forces(self) -> "Forces":
        """Forces in joints, springs and motors."""
        from fmbd.results.forces import Forces

        return Forces(self.motion, self.position, self.velocity, self.states)

    @cached_property
    def _quantities(self) -> "dict[str, Quantity]":
        from fmbd.results.quantities import quantities

        return quantities(self.model, self.source)


def open_run(path: str | Path) -> Run:
    """Open the archive of a run: complete, stopped, or still being written.

    Raises ArchiveError when the file is not one.
    """
    from fmbd.results.reader import Archive

    archive = Archive(path)

    def model() -> "Model":
        from fmbd.model import load_model_text

        return load_model_text(archive.model_text, archive.model_file, files=archive.model_files)

    return Run(archive, model)
