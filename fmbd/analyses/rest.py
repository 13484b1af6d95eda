"""The way of a mechanism to rest: Newton's method on the exact tangent, from the start.

    K y = F    K: tangent stiffness in independent coordinates (stiffness.py); F: unbalanced forces
Where K is not positive definite the mechanism is let down as if in a thick fluid, (K + sigma) y = F, sigma I > -K, in
steps that are bounded: it comes to rest where a real one would. Close to rest sigma is 0.
Source: C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation, SIAM Journal on Numerical
Analysis 35 (2), 1998, pp. 508-523.
"""

import numpy as np

from fmbd.analyses.arrangement import Arrangement, arrange
from fmbd.analyses.frequencies import stiffness_root
from fmbd.analyses.linearisation import Linearisation
from fmbd.analyses.motions import allowed_motions, to_nodal_basis
from fmbd.analyses.stiffness import INDIFFERENT, damped_step, dominant, tangent_stiffness
from fmbd.errors import AnalysisError
from fmbd.planar.equations import constraint_errors
from fmbd.system import System

Array = np.ndarray

ITERATIONS = 200
#: A turn [rad] of a joint or by beams that bend, and a share of the mechanism's size that a joint slides, in one step
#: at most.
LONGEST = 0.5
#: A step of this size [rad, m] has arrived: the next is the last.
SMALL = 1e-9
#: Share of a step below which it is taken as it is.
LEAST = 1e-3
#: So many of the longest steps from the start, and a coordinate has run away.
AWAY = 20.0
_CLOSED = 1e-11
_STANDING = 1e-8  # share of the rate of driven joints, at which loops open by round-off only
_STAGES = 50  # in which driven joints are brought to their places


def come_to_rest(arrangement: Arrangement, q: Array, z: Array) -> tuple[Linearisation, int]:
    """The linearisation at the equilibrium, and the steps that it took, from nodal q (nq,) and states z (nz,)."""
    lin = Linearisation(arrangement, q, np.zeros_like(q), z, inertial=False)
    last = False
    for taken in range(1, ITERATIONS + 1):
        stiffness, _ = tangent_stiffness(lin)
        lowest = stiffness[0] if stiffness.size else np.inf
        sigma = 0.0 if last or lowest > INDIFFERENT else max(-1.5 * lowest, 1.0)
        u = damped_step(lin, sigma, lin.unbalanced)
        size = float(np.abs(lin.directions(u[:, None])[0]).max(initial=0.0))
        if not np.isfinite(size):
            break
        lin = _step(lin, u, cautious=sigma == 0.0 and size > SMALL)
        if last or not lin.size:
            return lin, taken
        last = size < SMALL
    raise _failure(lin, q)


def _step(lin: Linearisation, u: Array, cautious: bool) -> Linearisation:
    """As much of a step u in x as is not too long, closes the loops and, if cautious, comes nearer to rest."""
    arrangement, (q, v, z) = lin.arrangement, lin.state
    dq, _, dz = (part[:, 0] for part in lin.directions(u[:, None]))
    share = min(1.0, 1.0 / max(_length(arrangement.system, q, dq), 1e-300))
    while True:
        try:
            closed = _closed(arrangement, q + share * dq, q)
            there = Linearisation(arrangement, closed, v, z + share * dz, inertial=False)
            if not cautious or share < LEAST or _nearer(lin, there, u, share):
                return there
        except AnalysisError:
            if share < LEAST:
                raise
        share *= 0.5


def _failure(lin: Linearisation, start: Array) -> AnalysisError:
    """Why there is no equilibrium, or none was found."""
    q, names = lin.state[0], lin.system.coordinate_names
    stiffness, shapes = tangent_stiffness(lin)
    free = shapes[:, np.abs(stiffness) < 1e3 * INDIFFERENT]
    if free.size:
        pull = lin.unbalanced[lin.freedom : 2 * lin.freedom]
        where = dominant(lin, free @ np.linalg.lstsq(free, pull, rcond=None)[0])
        return AnalysisError(f"no equilibrium: nothing stops {_listed(where)}, which can move freely")
    gone = int(np.abs(q - start).argmax())
    if _length(lin.system, start, np.eye(q.size)[gone] * (q[gone] - start[gone])) > AWAY:
        way = f"from {start[gone]:.4g} it went to {q[gone]:.4g} in {ITERATIONS} steps"
        return AnalysisError(f"no equilibrium found: nothing stops {names[gone]}; {way}")
    k = int(np.abs(lin.basis @ lin.acceleration).argmax())
    text = f"{names[k]} is accelerated most, where it is {q[k]:.6g}"
    return AnalysisError(f"no equilibrium found in {ITERATIONS} steps: {text}")


def _listed(names: tuple[str, ...]) -> str:
    return " with ".join([names[0], ", ".join(names[1:])] if len(names) > 1 else names)


def _nearer(lin: Linearisation, there: Linearisation, u: Array, share: float) -> bool:
    """Whether the step that would follow, by the same tangent, is shorter (Deuflhard's natural monotonicity)."""
    f = lin.freedom
    pull = lin.motions.N.T @ there.force
    b = np.concatenate([np.zeros(f), pull, there.state_rates[there.states]])
    return bool(np.linalg.norm(damped_step(lin, 0.0, b)) <= (1.0 - 0.25 * share) * np.linalg.norm(u))


def _length(system: System, q: Array, dq: Array) -> float:
    """A step in units of the longest that is taken, of joints, and of how far beams bend; rotors may turn."""
    bodies = system.planar.bodies[system.planar.bodies["rotor"] == 0]["coordinate"]
    turning, sliding = bodies[:, 2], bodies[:, :2].ravel()
    turn = np.abs(dq[turning[turning >= 0]]).max(initial=0.0)
    places, _, moved = system.reference.stations(q, 0.0)
    bent = np.abs(moved[:, 2, :-1] @ (dq * system.elastic)).max(initial=0.0)
    reach = float(np.ptp(places, axis=0).max()) or 1.0
    slid = np.abs(dq[sliding[sliding >= 0]]).max(initial=0.0) / reach
    return float(max(turn, bent, slid)) / LONGEST


def brought_to(system: System, held: list[str], time: float) -> Array:
    """The start, its driven joints moved to where they are at a time; in stages, to stay in the assembly mode."""
    q = system.start.q
    driven = (system.planar.constraints["driver"] >= 0).any() or (system.planar.bodies["driver"] >= 0).any()
    moves = driven and time != 0.0 and system.planar.constraints.size
    for t in np.linspace(0.0, time, _STAGES + 1)[1:] if moves else (time,):
        q = _closed(arrange(system, float(t), held, standing=True), q, system.start.q)
    return q


def check_standing(arrangement: Arrangement, q: Array) -> None:
    """Raise AnalysisError if driven joints that move at nodal coordinates q open a loop whose other joints stand."""
    system, t = arrangement.system, arrangement.t
    planar, still = system.planar, np.zeros_like(q)
    constraint_errors(planar, system.work, t, system.to_modal(q), still)
    drivers, signal = planar.constraints["driver"], np.asarray(system.work.signal)
    opening = np.array(system.work.lengths["rate"])[planar.constraints["pathway"]]
    opening[drivers >= 0] += signal[drivers[drivers >= 0], 1]
    moved = {
        f"{name}.{direction}": signal[system.lowered.signals.add(law), 1]
        for name, joint in system.model.joints.items()
        for direction, law in joint.driven.items()
    }
    moved = {name: rate for name, rate in moved.items() if rate}
    if not moved or np.abs(opening).max(initial=0.0) <= _STANDING * max(map(abs, moved.values())):
        return
    name, rate = max(moved.items(), key=lambda item: abs(item[1]))
    loop = system.constraint_names[int(np.abs(opening).argmax())]
    raise AnalysisError(
        f"no equilibrium beside moving joints: {name} moves by {rate:g} a second at t = {t:g} s, and the loop "
        f"at {loop} cannot stand still beside it (without `moving` the joint stands, too)"
    )


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
