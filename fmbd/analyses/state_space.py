"""State space of a mechanism: x' = A x + B u, y = C x + D u, with names, about a state.

x    deviations of independent generalised coordinates, of their rates, of first-order states; minimal, so that every
     dependent coordinate follows. The coordinates are chosen by a pivoted QR decomposition of the motions that the
     constraints allow, in the metric of the mass matrix: those that tell most of them apart.
u    deviations of inputs;    y    deviations of outputs
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.analyses.about import Base, base
from fmbd.analyses.linearisation import Linearisation
from fmbd.analyses.probe import Probe, chosen_inputs, forces_of
from fmbd.model import Model
from fmbd.results.files import save_data
from fmbd.results.run import Run

Array = np.ndarray

#: Files that a state space can be written to.
KINDS = (".npz", ".mat", ".json", ".csv", ".h5")

Named = tuple[tuple[str, str], ...]


@dataclass(frozen=True, eq=False)
class StateSpace:
    """x' = A x + B u, y = C x + D u; states, inputs and outputs are (name, unit), in SI units."""

    base: Base = field(repr=False)
    A: Array  #: shape (nx, nx)
    B: Array  #: shape (nx, nu)
    C: Array  #: shape (ny, nx)
    D: Array  #: shape (ny, nu)
    states: Named
    inputs: Named
    outputs: Named

    def poles(self) -> Array:
        """Eigenvalues of A [1/s], those with the greatest real part first, shape (nx,)."""
        poles = np.linalg.eigvals(self.A)
        return poles[np.argsort(-poles.real)]

    def frequency_response(self, frequencies: Array) -> Array:
        """C (i w - A)^-1 B + D at frequencies [Hz] (n,), complex, shape (n, ny, nu)."""
        w = 2.0 * np.pi * np.asarray(frequencies, float)[:, None, None]
        return self.C @ np.linalg.solve(1j * w * np.eye(len(self.A)) - self.A, self.B[None]) + self.D

    def gain(self) -> Array:
        """D - C A^-1 B, what constant inputs lead to, shape (ny, nu); nan where a motion is free."""
        if np.linalg.matrix_rank(self.A) < len(self.A):
            return np.full(self.D.shape, np.nan)
        return self.D - self.C @ np.linalg.solve(self.A, self.B)

    def save(self, path: str | Path, frequencies: Array | None = None) -> None:
        """Write the matrices with their names, and the response at frequencies [Hz]: .npz, .mat, .json, .csv, .h5.

        Raises ValueError for another kind of file.
        """
        save_data(path, self.data(frequencies), self.table(), KINDS)

    def plot(self, path: str | Path, frequencies: Array) -> None:
        """Draw gain and phase from the lowest to the highest of the frequencies [Hz]: .svg, .pdf or .png."""
        from fmbd.analyses.bode import draw
        from fmbd.results.plots.style import save

        save(draw(self, frequencies), path)

    def data(self, frequencies: Array | None = None) -> dict[str, Any]:
        """What is written."""
        named = {"states": self.states, "inputs": self.inputs, "outputs": self.outputs}
        data: dict[str, Any] = {"A": self.A, "B": self.B, "C": self.C, "D": self.D}
        for kind, pairs in named.items():
            data[kind] = [name for name, _ in pairs]
            data[f"{kind[:-1]}_units"] = [unit for _, unit in pairs]
        if frequencies is not None:
            data |= {"frequencies": frequencies, "response": self.frequency_response(frequencies)}
        return data

    def table(self) -> Iterator[list[Any]]:
        """Rows of a CSV file: [A B; C D], names in the first row and column."""
        yield ["", *(name for name, _ in (*self.states, *self.inputs))]
        whole = np.block([[self.A, self.B], [self.C, self.D]])
        for k, (name, _) in enumerate((*self.states, *self.outputs)):
            yield [f"{name}'" if k < len(self.states) else name, *whole[k].tolist()]


def linearize(
    model: Model | str | Path,
    *,
    about: str | Path | Run = "equilibrium",
    time: float | None = None,
    inputs: Iterable[str] | None = None,
    outputs: Iterable[str] | None = None,
    lock: str | Iterable[str] | None = None,
    moving: bool = False,
    open_loop: bool = False,
) -> StateSpace:
    """The state space about `equilibrium`, `start`, or the state of a run or archive at a time.

    inputs: `motor.voltage` or `motor.torque`, what is added to the motor's input, its controller's included;
        `load.force.x`, `load.force.y`, `load.moment`; signals of the model by name. Default: those of all motors, of
        all loads if there is none.
    outputs: quantities of a run by name. Default: the coordinates of joints and rotors.
    lock, moving, open_loop: as for `modes`; motors that are only held to find the equilibrium are let go.

    Raises ModelError, ArchiveError, AnalysisError, UnknownQuantity.
    """
    about_ = base(model, about, time, lock, moving, release=True, open_loop=open_loop)
    lin = about_.linearisation
    system = lin.system
    if outputs is None:
        named = zip(system.coordinate_names, system.elastic, strict=True)
        outputs = [name for name, elastic in named if not elastic]
    given = chosen_inputs(lin, inputs)
    probe = Probe(lin, given, outputs)
    B, torques = lin.forced(*forces_of(lin, given))
    C, D = probe.by_state(), probe.by_input()
    if lin.arrangement.locked:
        per_torque = probe.by_held() / [lin.arrangement.gain(m) for m in lin.arrangement.locked]
        C, D = C + per_torque @ lin.holding, D + per_torque @ torques
    to_states, names = _independent(lin)
    back = np.linalg.inv(to_states)
    return StateSpace(
        about_,
        to_states @ lin.matrix @ back,
        to_states @ B,
        C @ back,
        D,
        names,
        tuple((entry.name, entry.unit) for entry in given),
        tuple(zip(probe.names, probe.units, strict=True)),
    )


def _independent(lin: Linearisation) -> tuple[Array, Named]:
    """The states by x, shape (nx, nx), and their names and units."""
    from scipy.linalg import qr

    system, f = lin.system, lin.freedom
    N = lin.basis @ lin.motions.N
    weight = np.sqrt(np.linalg.inv(lin.basis @ np.linalg.inv(lin.motions.M) @ lin.basis.T).diagonal())
    chosen = np.sort(qr((N * weight[:, None]).T, mode="r", pivoting=True)[1][:f]) if f else np.zeros(0, int)
    to_states = np.eye(lin.size)
    to_states[:f, :f] = to_states[f : 2 * f, f : 2 * f] = N[chosen]
    coordinates = [system.coordinates[k] for k in chosen]
    rates = [(f"{name}.rate", f"{unit}/s") for name, unit in coordinates]
    return to_states, (*coordinates, *rates, *(system.states[k] for k in lin.states))
