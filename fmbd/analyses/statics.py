"""Equilibrium of a mechanism: Newton's method on the exact tangent, from the start.

    K y = F    K: tangent stiffness in independent coordinates, of all forces (linearisation.py); F: unbalanced forces
Where K is not positive definite the mechanism is let down as if in a thick fluid, (K + sigma) y = F, sigma I > -K, in
steps that are bounded: it comes to rest where a real one would. Close to rest sigma is 0. Both in the metric of the
mass matrix, in which K has the unit 1/s^2: its eigenvalues are squares of frequencies.
Source: C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation, SIAM Journal on Numerical
Analysis 35 (2), 1998, pp. 508-523.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.analyses.arrangement import Arrangement, arrange, motor_names
from fmbd.analyses.frequencies import ROUND_OFF, stiffness_root
from fmbd.analyses.jacobians import pathway_rows
from fmbd.analyses.linearisation import SHIFT, Linearisation
from fmbd.analyses.motions import allowed_motions, to_nodal_basis
from fmbd.errors import AnalysisError
from fmbd.model import Model, load_model
from fmbd.planar.equations import energies
from fmbd.results.files import save_data
from fmbd.results.layout import ENERGIES
from fmbd.results.recording import Recording
from fmbd.results.run import Run
from fmbd.system import System, assemble

Array = np.ndarray

ITERATIONS = 200
#: A turn [rad] of a joint, and a share of the mechanism's size that it slides, in one step at most.
LONGEST = 0.5
#: A step of this size [rad, m] has arrived: the next is the last.
SMALL = 1e-9
#: Stiffness [1/s^2] below which nothing opposes a motion.
INDIFFERENT = 1e-8
#: Share of a step below which it is taken as it is.
LEAST = 1e-3
#: Files that an equilibrium can be written to.
KINDS = (".h5", ".json", ".csv")
_RATES = ("rate", "velocity", "acceleration", "angular_velocity", "angular_acceleration")
_OF_RUNS = ("time", "energy.kinetic", "energy.dissipated", "energy.work", "energy.balance")
_OFFSET = 0.9137  # [1/s^2], so that the stiffness of free motions, 0, can be inverted
_CLOSED = 1e-11
_STAGES = 50  # in which driven joints are brought to their places


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
        return [name for name in self.run.names if name.rpartition(".")[2] not in _RATES and name not in _OF_RUNS]

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

    Raises ModelError for the model, AnalysisError where there is no equilibrium, or none is found.
    """
    if not isinstance(model, Model):
        model = load_model(model)
    system = assemble(model)
    names = loose_motors(system) if lock is None else motor_names(system, lock)
    arrangement = arrange(system, time, names, standing=not moving)
    q, z = _brought_to(system, names, time), np.array(system.start.z)
    lin, iterations = _rest(arrangement, q, z)
    stiffness, shape = tangent_stiffness(lin)
    force = lin.motions.N.T @ lin.motions.M @ lin.acceleration
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


def tangent_stiffness(lin: Linearisation) -> tuple[Array, Array]:
    """Eigenvalues [1/s^2] of the stiffness at rest, ascending, and their motions y as columns."""
    f = lin.freedom
    compliance = _damped(lin, _OFFSET, np.eye(lin.size)[:, f : 2 * f])[:f]
    given, shapes = np.linalg.eig(compliance)
    seen = np.abs(given) > 1e-13 * np.abs(given).max(initial=0.0)  # integral control is infinitely stiff
    stiffness = (1.0 / given[seen]).real - _OFFSET
    order = np.argsort(stiffness)
    return stiffness[order], shapes[:, seen][:, order].real


def dominant(lin: Linearisation, motions: Array) -> tuple[str, ...]:
    """Coordinates and beams with more than a twentieth of the kinetic energy of motions y (f,) or (f, k)."""
    return tuple(name for name, share in shares(lin, motions).items() if share > 0.05)


def shares(lin: Linearisation, motions: Array) -> dict[str, float]:
    """Shares of coordinates, and of beams as a whole, in the kinetic energy of motions y, greatest first."""
    system = lin.system
    moved = np.abs(lin.motions.N @ motions.reshape(lin.freedom, -1)) ** 2
    weight = lin.motions.M.diagonal() * moved.sum(axis=1)
    found = dict(zip(system.coordinate_names, weight, strict=True))
    for i in system.beams:
        own = system.reference.inertia.elastic[i]
        for name in system.coordinate_names[own]:
            del found[name]
        found[f"{system.tree.links[i].name} bending"] = weight[own].sum()
    total = max(weight.sum(), 1e-300)
    return dict(sorted(((name, float(w / total)) for name, w in found.items()), key=lambda item: -item[1]))


def newton_step(lin: Linearisation) -> Array:
    """Newton's step towards an equilibrium, nodal coordinates (nq,); infinite where motions are free."""
    try:
        return lin.directions(_damped(lin, 0.0, lin.unbalanced)[:, None])[0][:, 0]
    except np.linalg.LinAlgError:
        return np.full(lin.system.planar.nq, np.inf)


def _damped(lin: Linearisation, sigma: float, b: Array) -> Array:
    """u of (Sigma - A) u = b: Newton's step if sigma is 0, else against a resistance sigma to all motions."""
    f = lin.freedom
    W = lin.resolvent()
    resisted = np.zeros_like(W)
    resisted[f : 2 * f, :f] = sigma * np.eye(f)
    return np.linalg.solve(np.eye(lin.size) + W @ resisted - SHIFT * W, W @ b)


def _rest(arrangement: Arrangement, q: Array, z: Array) -> tuple[Linearisation, int]:
    """The linearisation at the equilibrium, and the iterations that it took."""
    system = arrangement.system
    v = np.zeros_like(q)
    lin = Linearisation(arrangement, q, v, z)
    last = False
    for taken in range(ITERATIONS):
        stiffness, _ = tangent_stiffness(lin)
        lowest = stiffness[0] if stiffness.size else np.inf
        sigma = 0.0 if last or lowest > INDIFFERENT else max(-1.5 * lowest, 1.0)
        u = _damped(lin, sigma, lin.unbalanced)
        if not np.all(np.isfinite(u)):
            break
        dq, _, dz = (part[:, 0] for part in lin.directions(u[:, None]))
        share = min(1.0, 1.0 / max(_length(system, q, dq), 1e-300))
        small = np.abs(dq).max(initial=0.0) < SMALL
        while True:
            try:
                trial = _closed(arrangement, q + share * dq, q)
                there = Linearisation(arrangement, trial, v, z + share * dz)
                if sigma > 0.0 or small or share < LEAST or _nearer(lin, there, u, share):
                    break
            except AnalysisError:
                if share < LEAST:
                    raise
            share *= 0.5
        lin, q, z = there, trial, z + share * dz
        if last or not lin.size:
            return lin, taken + 1
        last = small
    stiffness, shapes = tangent_stiffness(lin)
    free = shapes[:, np.abs(stiffness) < 1e3 * INDIFFERENT]
    if free.size:
        pull = lin.unbalanced[lin.freedom : 2 * lin.freedom]
        where = dominant(lin, free @ np.linalg.lstsq(free, pull, rcond=None)[0])
        raise AnalysisError(f"no equilibrium: nothing stops {_listed(where)}, which can move freely")
    pulled = np.abs(lin.basis @ lin.acceleration)
    name = system.coordinate_names[int(pulled.argmax())]
    raise AnalysisError(
        f"no equilibrium found in {ITERATIONS} steps: {name} = {q[int(pulled.argmax())]:.6g} is still accelerated most"
    )


def _listed(names: tuple[str, ...]) -> str:
    return " with ".join([names[0], ", ".join(names[1:])] if len(names) > 1 else names)


def _nearer(lin: Linearisation, there: Linearisation, u: Array, share: float) -> bool:
    """Whether the step that would follow, by the same tangent, is shorter (Deuflhard's natural monotonicity)."""
    f = lin.freedom
    pull = lin.motions.N.T @ lin.motions.M @ there.acceleration
    b = np.concatenate([np.zeros(f), pull, there.state_rates[there.states]])
    return bool(np.linalg.norm(_damped(lin, 0.0, b)) <= (1.0 - 0.25 * share) * np.linalg.norm(u))


def _length(system: System, q: Array, dq: Array) -> float:
    """A step in units of the longest that is taken; of joints, not of beams and rotors."""
    bodies = system.planar.bodies[system.planar.bodies["rotor"] == 0]["coordinate"]
    turning, sliding = bodies[:, 2], bodies[:, :2].ravel()
    turn = np.abs(dq[turning[turning >= 0]]).max(initial=0.0) / LONGEST
    reach = float(np.ptp(system.reference.stations(q, 0.0)[0], axis=0).max()) or 1.0
    return max(turn, np.abs(dq[sliding[sliding >= 0]]).max(initial=0.0) / (LONGEST * reach))


def _brought_to(system: System, held: list[str], time: float) -> Array:
    """The start, its driven joints moved to where they are at a time; in stages, to stay in the assembly mode."""
    q = system.start.q
    driven = (system.planar.constraints["driver"] >= 0).any() or (system.planar.bodies["driver"] >= 0).any()
    moves = driven and time != 0.0 and system.planar.constraints.size
    for t in np.linspace(0.0, time, _STAGES + 1)[1:] if moves else (time,):
        q = _closed(arrange(system, float(t), held, standing=True), q, system.start.q)
    return q


def _closed(arrangement: Arrangement, q: Array, at: Array) -> Array:
    """Nodal coordinates near q that close the loops, with the held shafts where they are at the coordinates `at`."""
    system, t = arrangement.system, arrangement.t
    paths, drivers = system.planar.constraints["pathway"], system.planar.constraints["driver"]
    drive = np.zeros(paths.size)
    drive[drivers >= 0] = system.reference.signals(t)[drivers[drivers >= 0], 0]
    if not paths.size and not arrangement.locked:
        return q
    shafts = system.reference.pathways(at, t)[0][arrangement.held]
    basis = to_nodal_basis(system)
    before = np.inf
    for _ in range(30):
        values = system.reference.pathways(q, t)[0]
        miss = np.concatenate([values[paths] + drive, values[arrangement.held] - shafts])
        worst = np.abs(miss).max()
        if worst == 0.0 or (worst < _CLOSED and worst > 0.5 * before):
            return q
        before = worst
        motions, G = allowed_motions(system, q, t, arrangement.held), stiffness_root(system, q, t)
        q = q - basis @ motions.least(miss[motions.kept][:, None], G.T @ G)[:, 0]
    if worst < 1e-9:
        return q
    raise AnalysisError(f"the loops cannot be closed at t = {t:g} s: they stay open by {worst:.3g} m or rad")


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
