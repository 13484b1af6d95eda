"""Natural frequencies of an assembled mechanism, and the steps that they ask of explicit methods.

Small undamped motions about a position at rest, with the stiffness of beams and springs alone: gravity, preloads and
controllers are left out, and so is what they add to the stiffness (geometric stiffness). A spring whose rest length is
zero pulls with k times the vector between its points: it is as stiff across as along, also where they coincide.
Springs with backlash or a table, and stops, count with their tangent at rest there, none if it falls.

    M    mass matrix, Cholesky factor L          A    Phi_q L^-T: constraints on x = L^T q
    G    square root of the stiffness, K = G^T G R    orthonormal basis of the motions x that A allows

Elastic coordinates are modal here, so that G is exact: the singular values of G L^-T R are the frequencies
themselves, and low ones are not lost beside high ones, as they would be in the eigenvalues of K.
"""

import numpy as np

from fmbd.analyses.jacobians import displacement_rows, pathway_rows
from fmbd.analyses.structure import independent_rows
from fmbd.planar.arrays import DISTANCE
from fmbd.planar.laws import LINEAR, evaluate_law
from fmbd.solvers.tableau import Tableau
from fmbd.system import System

Array = np.ndarray

#: A frequency below this share of what the springs could do to the masses alone is zero to round-off.
_ROUND_OFF = 1e-9


def natural_frequencies(system: System, q: Array | None = None, t: float = 0.0) -> Array:
    """Natural frequencies [Hz], ascending, shape (degrees of freedom,).

    q: nodal coordinates (nq,), default: the start. Motions that no spring opposes have the frequency 0.
    Raises numpy.linalg.LinAlgError if a coordinate moves no mass.
    """
    q = system.start.q if q is None else np.asarray(q, float)
    planar, reference = system.planar, system.reference
    basis = system.to_nodal(np.eye(planar.nq)).T  # columns: modal coordinates in nodal ones
    bodies, _ = reference.frames(q, t)
    Phi_q = pathway_rows(system, q, t)[planar.constraints["pathway"]] @ basis
    M = basis.T @ reference.inertia.mass_matrix(bodies, np.append(q, t))[:-1, :-1] @ basis
    G = np.vstack([_of_beams(system), _of_springs(system, q, t) @ basis])

    L = np.linalg.cholesky(M)
    A = np.linalg.solve(L, Phi_q.T)
    kept = A[:, independent_rows(A.T)]
    R = np.linalg.qr(kept, mode="complete")[0][:, kept.shape[1] :]
    G = np.linalg.solve(L, G.T).T
    omega = np.linalg.svd(G @ R, compute_uv=False)[::-1]
    omega[omega < _ROUND_OFF * np.linalg.norm(G)] = 0.0
    return np.concatenate([np.zeros(R.shape[1] - omega.size), omega]) / (2.0 * np.pi)


def longest_step(tableau: Tableau, frequency: float, damping: float = 0.0) -> float:
    """Step [s] at which an explicit method begins to blow up an undamped vibration of `frequency` [Hz], or a creeping
    motion that dies out at the rate `damping` [1/s]; the shorter one."""
    vibrating = _stable(tableau, 1j) / (2.0 * np.pi * frequency)
    return min(vibrating, _stable(tableau, -1.0) / damping) if damping > 0.0 else vibrating


def _stable(tableau: Tableau, direction: complex) -> float:
    """How far along a direction of the complex plane h lambda may go."""
    s = tableau.b.size
    z = direction * np.linspace(0.0, 10.0, 2001)
    stages = np.eye(s) - z[:, None, None] * tableau.a[:s, :s]
    growth = np.abs(1.0 + z * (np.linalg.solve(stages, np.ones((z.size, s, 1)))[..., 0] @ tableau.b))
    return float(abs(z[np.argmax(growth > 1.0 + 1e-6)]))


def _of_beams(system: System) -> Array:
    """Rows of G for the modes of the beams: their own frequencies [rad/s]."""
    omega = np.zeros(system.planar.nq)
    for i, omega2 in system.lowered.omega2.items():
        omega[system.reference.inertia.elastic[i]] = np.sqrt(omega2)
    return np.diag(omega)[system.elastic]


def _of_springs(system: System, q: Array, t: float) -> Array:
    """Rows of G for the springs, by nodal coordinates; two for a spring that pulls on a point from all sides."""
    springs = system.planar.springs
    terms = system.planar.terms[system.planar.pathways["term0"][springs["pathway"]]]
    around = (terms["kind"] == DISTANCE) & (springs["rest"] == 0.0) & (springs["kind"] == LINEAR)
    along = pathway_rows(system, q, t)[springs["pathway"][~around]]
    rows = np.vstack([along, *displacement_rows(system, q, t, terms[around])])
    stiffness = _tangents(system, q, t)
    k = np.concatenate([stiffness[~around], *[stiffness[around]] * 2])
    return np.sqrt(k)[:, None] * rows


def _tangents(system: System, q: Array, t: float) -> Array:
    """Stiffness of the springs at rest, shape (springs,)."""
    planar = system.planar
    lengths = system.reference.pathways(q, t)[0][planar.springs["pathway"], None]
    values = np.zeros((planar.springs.size, 1, 5))
    for k, length in enumerate(lengths):
        evaluate_law(planar.springs, planar.curves, k, length, np.zeros(1), values[k])
    return np.maximum(values[:, 0, 1], 0.0)
