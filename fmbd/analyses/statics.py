"""Equilibrium of a mechanism: where it is at rest, and with which forces."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.analyses.arrangement import arrange, motor_names
from fmbd.analyses.frequencies import ROUND_OFF, stiffness_root
from fmbd.analyses.jacobians import pathway_rows
from fmbd.analyses.linearisation import Linearisation
from fmbd.analyses.motions import allowed_motions, to_nodal_basis
from fmbd.analyses.rest import brought_to, check_standing, come_to_rest
from fmbd.analyses.stiffness import INDIFFERENT, dominant, tangent_stiffness
from fmbd.model import Model, load_model
from fmbd.planar.equations import energies
from fmbd.results.files import save_data
from fmbd.results.layout import ENERGIES
from fmbd.results.recording import Recording
from fmbd.results.run import Run
from fmbd.system import System, assemble

Array = np.ndarray

#: Files that an equilibrium can be written to.
KINDS = (".h5", ".json", ".csv")
#: What the names of quantities end in that are zero at rest, and quantities that only a run has.
RATES = frozenset(
    {
        "rate",
        "velocity",
        "acceleration",
        "angular_velocity",
        "angular_acceleration",
        "momentum",
        "angular_momentum",
    }
)
OF_RUNS = frozenset({"time", "energy.kinetic", "energy.dissipated", "energy.work", "energy.balance"})


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A position at rest. `equilibrium["rod.end.position"]` gives any quantity of a run that is not a rate."""

    run: Run  #: the equilibrium as a run of one output time
    linearisation: Linearisation  #: there
    residual: float  #: largest unbalanced generalised force [N or N m]
    iterations: int
    stiffness: float  #: lowest eigenvalue of the tangent stiffness, in the metric of the mass matrix [1/s^2]
    softest: tuple[str, ...]  #: coordinates that move most in it
    locked: tuple[str, ...]  #: motors whose shafts are held
    chosen: bool  #: whether they were asked for, and not found necessary
    remarks: tuple[str, ...]  #: for the user

    def __getitem__(self, name: str) -> Array:
        """A quantity by its name, in SI units: a number, or its columns `run.columns(name)`; UnknownQuantity."""
        return np.asarray(self.run[name][0])

    def save(self, path: str | Path) -> None:
        """Write all quantities with their units: .h5, .json, .csv. Raises ValueError for another kind of file."""
        save_data(path, self.data(), self.table(), KINDS)

    def data(self) -> dict[str, Any]:
        """What is written: the verdict, and all quantities that are not rates, with their units."""
        names = self.names
        return {
            "model": self.run.model.name,
            "time": float(self.run.time[0]),
            "verdict": self.verdict,
            "lowest_stiffness": self.stiffness,
            "residual": self.residual,
            "quantities": {name: self[name] for name in names},
            "units": {name: self.run.units(name) for name in names},
        }

    def table(self) -> Iterator[tuple[str, str, str | float]]:
        """Rows (quantity or quantity.column, unit, value)."""
        yield "quantity", "unit", "value"
        for name in self.names:
            columns = self.run.columns(name)
            for column, value in zip(columns or ("",), np.atleast_1d(self[name]), strict=True):
                yield f"{name}.{column}".rstrip("."), self.run.units(name), float(value)

    @property
    def names(self) -> list[str]:
        """Quantities that are not rates."""
        return [
            name for name in self.run.names if name.rpartition(".")[2] not in RATES and name not in OF_RUNS
        ]

    @property
    def verdict(self) -> str:
        """stable, unstable, or indifferent: free to move."""
        if abs(self.stiffness) < INDIFFERENT:
            return "indifferent"
        return "stable" if self.stiffness > 0.0 else "unstable"

    @property
    def position(self) -> Array:
        """Generalised coordinates, the elastic ones nodal, shape (nq,)."""
        return self.run.position[0]

    @property
    def states(self) -> Array:
        """First-order states, shape (nz,)."""
        return self.run.states[0]

    @property
    def inputs(self) -> dict[str, float]:
        """Voltages or torques that hold the locked motors."""
        arrangement = self.linearisation.arrangement
        names = list(arrangement.system.model.motors)
        return {names[m]: float(u) for m, u in zip(arrangement.constant, arrangement.inputs(), strict=True)}


def equilibrium(
    model: Model | str | Path,
    *,
    time: float = 0.0,
    lock: str | Iterable[str] | None = None,
    moving: bool = False,
) -> Equilibrium:
    """Where a mechanism is at rest under gravity, loads, springs, beams and motors, as they are at a time [s].

    lock: motors whose shafts are held at their start angles, by name, or `all` or `none`. Default: those without
    which the mechanism could move freely, as far as no controller holds them.
    moving: driven joints keep the speed that they have at that time, and the rest is at rest beside them, as in a
    rotating frame; otherwise they stand still where they are then.

    Raises ModelError for the model, AnalysisError where there is no equilibrium, or none is found, and where loops
    cannot stand still beside joints that move.
    """
    if not isinstance(model, Model):
        model = load_model(model)
    system = assemble(model)
    names = loose_motors(system) if lock is None else motor_names(system, lock)
    arrangement = arrange(system, time, names, standing=not moving)
    q, z = brought_to(system, names, time), np.array(system.start.z)
    check_standing(arrangement, q)
    lin, iterations = come_to_rest(arrangement, q, z)
    stiffness, shape = tangent_stiffness(lin)
    force = lin.motions.N.T @ lin.force
    lowest = float(stiffness[0]) if stiffness.size else np.inf
    first = np.abs(stiffness - lowest) <= INDIFFERENT
    return Equilibrium(
        run=_as_run(lin),
        linearisation=lin,
        residual=float(np.abs(lin.motions.M @ lin.motions.N @ force).max(initial=0.0)),
        iterations=iterations,
        stiffness=lowest,
        softest=dominant(lin, shape[:, first]),
        locked=tuple(names),
        chosen=lock is not None,
        remarks=tuple(_remarks(system, time, moving)),
    )


def _remarks(system: System, time: float, moving: bool) -> Iterator[str]:
    yield from system.start.remarks
    for name, joint in system.model.joints.items():
        for direction, signal in joint.driven.items():
            rate = system.reference.signal(system.lowered.signals.add(signal), time)[1]
            if rate and not moving:
                yield f"{name}.{direction} stands still; it moves by {rate:g} a second then (--moving keeps that)"
        if any(friction.coulomb > 0.0 for friction in joint.friction.values()):
            yield f"the dry friction of {name} holds nothing at rest, as it grows from zero with the speed"


def loose_motors(system: System) -> list[str]:
    """Motors that take part in motions which neither beams, springs nor controllers oppose."""
    q, planar = system.start.q, system.planar
    motions = allowed_motions(system, q, 0.0)
    rows = pathway_rows(system, q, 0.0) @ to_nodal_basis(system)
    laws = planar.controllers[(planar.controllers["kp"] > 0.0) | (planar.controllers["ki"] > 0.0)]
    G = np.vstack([stiffness_root(system, q, 0.0), rows[laws["pathway"]]]) @ motions.N
    _, size, V = np.linalg.svd(G)
    free = motions.N @ V[np.count_nonzero(size > ROUND_OFF * size.max(initial=0.0)) :].T
    shafts = rows[planar.motors["pathway"]]
    share = np.linalg.norm(shafts @ free, axis=1)
    moves = share > 1e-6 * np.linalg.norm(shafts @ motions.N, axis=1)
    return [name for name, k in zip(system.model.motors, moves, strict=True) if k]


def _as_run(lin: Linearisation) -> Run:
    """A run of one output time, at rest."""
    system, (q, _, z), t = lin.system, lin.state, lin.arrangement.t
    recording = Recording(system.coordinates, system.constraints, system.states, [])
    still = np.zeros(system.planar.nq)
    lin.arrangement.rates(system.to_modal(q), still, z)
    kinetic, potential, elastic = energies(system.planar, system.work, system.to_modal(q), still, z)
    stored = {"kinetic": kinetic, "potential": potential, "elastic": elastic}
    recording.write(
        time=np.array([t]),
        position=q[None],
        velocity=still[None],
        acceleration=still[None],
        multipliers=np.array(system.work.reactions["multiplier"])[None],
        states=z[None],
        energy={name: np.array([stored.get(name, 0.0)]) for name in ENERGIES},
        extra={},
    )
    recording.finish("complete", {})
    return Run(recording, lambda: system.model, lambda: system)
