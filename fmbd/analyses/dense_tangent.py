"""The linearised equations of motion by differences of forces, where beams shorten: that is not in the exact tangent.

    r = f + A^T lambda - M q'' = 0,    c = Phi'' = 0,    s = z'
are differenced by q, q' and z, with q'' and lambda held. A difference of accelerations would lose what is soft in the
round-off of what is stiff: M^-1 magnifies it.

    M (ba x + a0) - dr - A^T dlambda = force,    A (ba x + a0) + dc = 0,    dz = per_z (ds + rates)
with dq = bq x, dv = bv x + v0, as in fmbd.planar.linearise. Coordinates are modal.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np

from fmbd.analyses.arrangement import Arrangement
from fmbd.analyses.structure import independent_rows
from fmbd.planar.residual import evaluate_residual

Array = np.ndarray

_STEP = 1e-4  # of an angle [rad] or a slope, of a place in extents of the mechanism
_COMPLEX_STEP = 1e-200


def by_differences(function: Callable[[Array], Array], x: Array, steps: Array) -> Array:
    """Changes (m, k) of a function (m,) at x (n,), per each of the steps (k, n): central differences, extrapolated."""
    columns = []
    for step in steps:
        near, far = (function(x + m * step) - function(x - m * step) for m in (1.0, 2.0))
        columns.append((8.0 * near - far) / 12.0)
    return np.array(columns).T


class DenseTangent:
    """About modal q, v (nq,) and z (nz,), with mass matrix M (nq, nq) and constraints A (nc, nq).

    inertial: as in Linearisation.
    """

    def __init__(
        self,
        arrangement: Arrangement,
        q: Array,
        v: Array,
        z: Array,
        M: Array,
        constraints: Array,
        inertial: bool,
    ) -> None:
        self._arrangement, self._state, self._inertial, self.M = arrangement, (q, v, z), inertial, M
        kept = independent_rows(np.linalg.solve(np.linalg.cholesky(M), constraints.T).T)
        self.A = constraints[kept]
        self._paths = arrangement.system.planar.constraints["pathway"][kept]

    def columns(
        self, weights: tuple[float, ...], v0: Array, a0: Array, force: Array, rates: Array
    ) -> tuple[Array, Array]:
        """x (nq, k) and dz (nz, k) for given parts v0, a0 and forces (nq, k), rates (nz, k); weights bq, bv, ba, per_z.

        numpy.linalg.LinAlgError where the position is singular.
        """
        bq, bv, ba, per_z = weights
        n, nz, m = len(self.M), len(rates), len(self.A)
        J = self._differences if any((bq, bv, per_z)) else np.zeros((n + nz + m, 2 * n + nz))
        by_x, given = bq * J[:, :n] + bv * J[:, n : 2 * n], J[:, n : 2 * n] @ v0
        r, s, c = slice(0, n), slice(n, n + nz), slice(n + nz, None)
        # unknowns x, dz, dlambda; equations r, s, c
        B, b = np.zeros((n + nz + m, n + nz + m)), np.empty((n + nz + m, force.shape[1]))
        B[r, r], B[r, s], B[r, c] = ba * self.M - by_x[r], -J[r, 2 * n :], -self.A.T
        B[s, r], B[s, s] = -per_z * by_x[s], np.eye(nz) - per_z * J[s, 2 * n :]
        B[c, r] = ba * self.A + by_x[c]
        b[r] = force - self.M @ a0 + given[r]
        b[s] = per_z * (rates + given[s])
        b[c] = -self.A @ a0 - given[c]
        # what is stiff and what is soft, metres and radians, on a par
        scale = np.ones(n + nz + m)
        scale[r] = 1.0 / np.sqrt(np.abs(B.diagonal()[r]))
        scale[c] = 1.0 / np.linalg.norm(self.A * scale[r], axis=1)
        solution = scale[:, None] * np.linalg.solve(scale[:, None] * B * scale, scale[:, None] * b)
        return solution[r], solution[s]

    @cached_property
    def _differences(self) -> Array:
        """Derivatives of (r, s, c) by (q, v, z), central differences extrapolated once."""
        q, v, z = self._state
        acceleration, _ = self._arrangement.rates(q, v, z)  # leaves its multipliers in `work`
        if not self._inertial:
            acceleration[:] = 0.0
        steps = np.concatenate([*np.tile(self._steps(q), (2, 1)), np.full(z.size, _STEP)])
        state = np.concatenate([q, v, z])
        return by_differences(lambda y: self._forces(y, acceleration), state, np.diag(steps)) / steps

    def _steps(self, q: Array) -> Array:
        """Of the modal coordinates, as what they move asks for: a thick beam's shape of little mass turns far."""
        system = self._arrangement.system
        shapes = np.abs(system.to_nodal(np.eye(q.size)))
        places = np.array([unit == "m" for _, unit in system.coordinates])
        extent = np.ptp(system.reference.stations(system.to_nodal(q), self._arrangement.t)[0], axis=0).max()
        shapes[:, places] /= extent or 1.0
        return np.asarray(_STEP / shapes.max(axis=1))

    def _forces(self, state: Array, acceleration: Array) -> Array:
        """r, s and c, what is prescribed by time alone left out of c."""
        system, t, n = self._arrangement.system, self._arrangement.t, len(self.M)
        q, v, z = state[:n], state[n : 2 * n], state[2 * n :]
        r, s = np.zeros(n), np.zeros(z.size)
        evaluate_residual(system.planar, system.work, t, q, v, z, s, acceleration, r)
        c = system.work.lengths["bias"][self._paths].copy()
        if c.size:
            towards = system.to_nodal(q) + 1j * _COMPLEX_STEP * system.to_nodal(acceleration)
            c += system.reference.pathways(towards, t)[0][self._paths].imag / _COMPLEX_STEP
        return np.concatenate([r, s, c])
