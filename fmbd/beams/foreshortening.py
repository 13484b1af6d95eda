"""Foreshortening: a beam that bends draws its points towards its start, to second order.

u(x) = -1/2 e^T H(x) e,    H(x) = int_0^x S'^T S' dx

Without it a tension along a beam seems to soften it, and a beam that rotates fast loses its stiffness; with it both
stiffen as they should (geometric stiffening). H(x) is kept for the lowest modes only, e = Psi eta: it is dense in them,
and the higher ones take no part in what shortens the beam.

A beam that shears keeps its length across the cross-sections (Reissner's axial strain is zero), and shearing stretches
the axis itself: H(x) = int_0^x (S'^T S' - gamma^T gamma) dx, gamma the shear angles.

A. A. Shabana, Dynamics of Multibody Systems, section on geometric stiffening; T. R. Kane, R. R. Ryan,
A. K. Banerjee, Dynamics of a cantilever beam attached to a moving base, J. Guidance 10 (1987) 139-151.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.polynomial import Polynomial

from fmbd.beams.floating import FloatingBeam
from fmbd.beams.hermite import Array
from fmbd.beams.pieces import degree, gauss_points

# Modes that shorten a beam: those of a dozen elements.
_MOST_MODES = 24


@dataclass(frozen=True, eq=False)
class Foreshortening:
    """H(x) of a beam in the n lowest of its modes."""

    beam: FloatingBeam
    psi: Array  #: these modes, one a column, shape (nf, n)

    @classmethod
    def of(cls, beam: FloatingBeam, psi: Array) -> "Foreshortening":
        """The lowest of all modes psi, shape (nf, nf)."""
        return cls(beam, psi[:, :_MOST_MODES])

    @property
    def count(self) -> int:
        """Number of modes that count."""
        return self.psi.shape[1]

    def at(self, x: float) -> Array:
        """H(x), at a position [m]; shape (n, n) [1/(kg m)]."""
        if x <= 0.0:
            return np.zeros((self.count, self.count))
        return self._integral(0.0, x, np.ones_like)

    def by_mass(self) -> Array:
        """int H dm, shape (n, n) [1/m]."""
        return self._integral(0.0, self.beam.length, partial(self._beyond, power=0))

    def by_moment(self) -> Array:
        """int x H dm, shape (n, n)."""
        return self._integral(0.0, self.beam.length, partial(self._beyond, power=1))

    def by_length(self, x0: float, x1: float) -> Array:
        """int H dx over [x0, x1], where a uniform load acts, shape (n, n) [1/kg]."""
        before = (x1 - x0) * self.at(x0)
        return before + self._integral(x0, x1, lambda x: x1 - x)

    def amplitudes(self, e: Array) -> Array:
        """Of these modes in elastic coordinates e, shape (..., nf)."""
        return e @ (self.beam.M @ self.psi)

    def nodal(self, H: Array) -> Array:
        """A matrix in these modes, in nodal coordinates, shape (nf, nf)."""
        left = self.beam.M @ self.psi
        return left @ H @ left.T

    def _integral(self, x0: float, x1: float, weight: Callable[[Array], Array]) -> Array:
        """int (S'^T S' - gamma^T gamma) weight dx over [x0, x1], in modes."""
        beam = self.beam
        kinks = np.concatenate([beam.nodes, [p.start for p in beam.pieces], beam.point_masses[:, 0]])
        x, dx = gauss_points(
            np.concatenate([[x0], np.unique(kinks[(kinks > x0) & (kinks < x1)]), [x1]]),
            # slopes squared, times the mass beyond or its moment
            4 + degree(beam.pieces, "mass_per_length") + 2,
        )
        dm = (dx * weight(x))[:, None]
        slopes = beam.tangent(x) @ self.psi
        total = (slopes * dm).T @ slopes
        if beam.shears:
            sheared = beam.shear_angle(x) @ self.psi
            total -= (sheared * dm).T @ sheared
        return total

    def _beyond(self, x: Array, power: int) -> Array:
        """int_x^L s^power dm(s), shaped as x."""
        total = np.zeros(x.shape)
        for piece in self.beam.pieces:
            integrand = Polynomial(piece.mass_per_length) * Polynomial([piece.start, 1.0]) ** power
            integral = integrand.integ()
            total += integral(piece.end - piece.start) - integral(
                np.clip(x, piece.start, piece.end) - piece.start
            )
        for position, mass in self.beam.point_masses:
            total += mass * position**power * (x <= position)
        return total
