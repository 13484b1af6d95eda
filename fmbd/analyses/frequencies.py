"""Natural frequencies of an assembled mechanism, and the steps that they ask of explicit methods.

Small undamped motions about a position at rest, with the stiffness of beams and springs alone: gravity, preloads and
controllers are left out, and so is what they add to the stiffness (geometric stiffness). A spring whose rest length is
zero pulls with k times the vector between its points: it is as stiff across as along, also where they coincide.
Springs with backlash or a table, and stops, count with their tangent at rest there, none if it falls.

    G    square root of the stiffness, K = G^T G       N    motions that the constraints allow (motions.py)

Elastic coordinates are modal here, so that G is exact: the singular values of G N are the frequencies themselves, and
low ones are not lost beside high ones, as they would be in the eigenvalues of K. No kernel is compiled for it. All
that is left out here is in the modes of modes.py.
"""

import numpy as np

from fmbd.analyses.jacobians import displacement_rows, pathway_rows
from fmbd.analyses.motions import allowed_motions, to_nodal_basis
from fmbd.planar.arrays import DISTANCE
from fmbd.planar.laws import LINEAR, evaluate_law
from fmbd.solvers.tableau import Tableau
from fmbd.system import System

Array = np.ndarray

#: A frequency below this share of what the springs could do to the masses alone is zero to round-off.
ROUND_OFF = 1e-9


def natural_frequencies(system: System, q: Array | None = None, t: float = 0.0) -> Array:
    """Natural frequencies [Hz], ascending, shape (degrees of freedom,).

    q: nodal coordinates (nq,), default: the start. Motions that no spring opposes have the frequency 0.
    Raises numpy.linalg.LinAlgError if a coordinate moves no mass.
    """
    q = system.start.q if q is None else np.asarray(q, float)
    motions = allowed_motions(system, q, t)
    G = stiffness_root(system, q, t)
    omega = np.linalg.svd(G @ motions.N, compute_uv=False)[::-1]
    omega[omega < ROUND_OFF * np.linalg.norm(np.linalg.solve(motions.L, G.T))] = 0.0
    return np.concatenate([np.zeros(motions.N.shape[1] - omega.size), omega]) / (2.0 * np.pi)


def stiffness_root(system: System, q: Array, t: float) -> Array:
    """G by modal coordinates at nodal q (nq,): a row for each mode of a beam and each spring."""
    return np.vstack([_of_beams(system), _of_springs(system, q, t) @ to_nodal_basis(system)])


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
