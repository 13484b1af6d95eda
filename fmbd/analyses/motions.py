"""Motions that the constraints of a mechanism allow at a position, orthonormal in its mass matrix.

    M    mass matrix, Cholesky factor L          A    rows L^-T: constraints on x = L^T q
    Q R  orthonormal bases of the motions x that A forbids and allows, P = L^-T Q, N = L^-T R: N^T M N = I, P^T M N = 0
Elastic coordinates are modal here, as in the kernels.
"""

from dataclasses import dataclass

import numpy as np

from fmbd.analyses.jacobians import pathway_rows
from fmbd.analyses.structure import independent_rows
from fmbd.system import System

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Motions:
    """What can move, f motions of nq modal coordinates."""

    M: Array  #: mass matrix, shape (nq, nq)
    L: Array  #: its Cholesky factor
    N: Array  #: the motions as columns, shape (nq, f)
    P: Array  #: those that are not allowed, shape (nq, r)
    rows: Array  #: independent constraints, shape (r, nq)
    kept: list[int]  #: which of all they are

    def least(self, values: Array, stiffness: Array | None = None) -> Array:
        """The motions (nq, k) of least kinetic energy that give the independent rows these values (r, k).

        stiffness: a metric (nq, nq) to add, so that what is stiff keeps its place.
        """
        L = self.L if stiffness is None else np.linalg.cholesky(self.M + stiffness)
        A = np.linalg.solve(L, self.rows.T)
        return np.linalg.solve(L.T, np.linalg.pinv(A.T) @ values)


def to_nodal_basis(system: System) -> Array:
    """Columns: modal coordinates in nodal ones, shape (nq, nq)."""
    return system.to_nodal(np.eye(system.planar.nq)).T


def allowed_motions(system: System, q: Array, t: float, held: Array | None = None) -> Motions:
    """Motions at nodal coordinates q (nq,) with the pathways numbered in `held` at rest, too.

    Raises numpy.linalg.LinAlgError if a coordinate moves no mass.
    """
    basis = to_nodal_basis(system)
    bodies, _ = system.reference.frames(q, t)
    M = basis.T @ system.reference.inertia.mass_matrix(bodies, np.append(q, t))[:-1, :-1] @ basis
    paths = system.planar.constraints["pathway"]
    paths = paths if held is None else np.concatenate([paths, held])
    rows = pathway_rows(system, q, t)[paths] @ basis
    L = np.linalg.cholesky(M)
    A = np.linalg.solve(L, rows.T)
    kept = independent_rows(A.T)
    QR = np.linalg.solve(L.T, np.linalg.qr(A[:, kept], mode="complete")[0])
    return Motions(M, L, QR[:, len(kept) :], QR[:, : len(kept)], rows[kept], kept)
