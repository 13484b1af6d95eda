"""Inertia and weight of the bodies in nodal coordinates, in plain NumPy (see system.reference).

x, r    coordinates (q, t) and their rates (q', 1), shape (..., nq+1)
J       Jacobians of the bodies' frames by x, shape (..., nb, 3, nq+1)
H, G    inertia of a body for the twist (vx, vy, w) of its frame, world axes, (..., nb, 3, 3), and the
        coupling of the twist with the elastic rates, (..., nb, 3, nq+1)
s, p, M, M_w   integrals of the shape functions (fmbd.beams.floating)

T = sum 1/2 twist^T H twist + twist^T G q' + 1/2 q'^T M q',    twist = J r
H = [m, 0, -S_y; 0, m, S_x; -S_y, S_x, J0 + e^T M_w e],   S = R(angle) (mx, my + s e)
With foreshortening, u = -1/2 e^T H(x) e along the beam: mx has int u dm beside it, J0 has 2 int x u dm.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fmbd.beams import FloatingBeam, Foreshortening
from fmbd.planar.arrays import Planar
from fmbd.system.duals import rotate

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Moments:
    """Integrals of (1, x, S) over n bodies or stretches of beams, by mass or by length."""

    total: Array  #: shape (n,)
    first: Array  #: in body axes, undeformed, shape (n, 2)
    shape: Array  #: int S, shape (n, nq+1)
    bent: Sequence[tuple[int, slice, Array]] = ()  #: of some bodies: own elastic coordinates e, int H

    def shortening(self, x: Array) -> tuple[Array, Array]:
        """Integrals of u, shape (..., n), and their derivatives by x, (..., n, nq+1)."""
        drawn = np.zeros((*x.shape[:-1], len(self.total)), x.dtype)
        pull = np.zeros((*drawn.shape, x.shape[-1]), x.dtype)
        for k, own, H in self.bent:
            pull[..., k, own] = -x[..., own] @ H
            drawn[..., k] = 0.5 * (pull[..., k, own] * x[..., own]).sum(axis=-1)
        return drawn, pull

    def sums(self, frames: Array, x: Array) -> Array:
        """Duals of the integrals of position, shape (..., n, 2, d), in world axes; frames (..., n, 3, d)."""
        arm = np.zeros_like(frames[..., :2, :])
        arm[..., 0] = self.first
        arm[..., 1, 0] += x @ self.shape.T
        arm[..., 1, 1:] = self.shape
        drawn, pull = self.shortening(x)
        arm[..., 0, 0] += drawn
        arm[..., 0, 1:] += pull
        return self.total[:, None, None] * frames[..., :2, :] + rotate(frames[..., 2, :], arm)


class Inertia:
    """Masses of all bodies; `beams` gives the beam of each flexible one, `shortenings` the foreshortening of some."""

    def __init__(
        self, planar: Planar, beams: Mapping[int, FloatingBeam], shortenings: Mapping[int, Foreshortening]
    ) -> None:
        bodies = planar.bodies
        size = planar.nq + 1
        self.elastic: dict[int, slice] = {}  #: elastic coordinates of each flexible body
        self.K = np.zeros((planar.nq, planar.nq))  #: stiffness of the beams, shape (nq, nq)
        self._rotary = np.array(bodies["J"])
        self._owned = np.zeros((bodies.size, size))
        self._M, self._M_w = np.zeros((size, size)), np.zeros((size, size))
        s, self._p = np.zeros((bodies.size, size)), np.zeros((bodies.size, size))
        for i, beam in beams.items():
            own = slice(bodies["first_q"][i], bodies["first_q"][i] + bodies["nf"][i])
            self.elastic[i] = own
            self._owned[i, own] = 1.0
            s[i, own], self._p[i, own] = beam.s, beam.p
            self._M[own, own], self._M_w[own, own], self.K[own, own] = beam.M, beam.M_w, beam.K
        first = np.stack([bodies["mx"], bodies["my"]], axis=-1)
        bent = [(i, self.elastic[i], part.nodal(part.by_mass())) for i, part in shortenings.items()]
        self.mass = Moments(np.array(bodies["mass"]), first, s, bent)
        for i, part in shortenings.items():
            # x^2 becomes (x + u)^2
            own = self.elastic[i]
            self._M_w[own, own] -= part.nodal(part.by_moment())

    def mass_matrix(self, frames: Array, x: Array) -> Array:
        """Mass matrix in the extended coordinates, shape (..., nq+1, nq+1)."""
        H, G = self._of_bodies(frames, x)
        J = frames[..., 1:]
        J_all, G_all, P_all = (_stack(part) for part in (J, G, H @ J + G))
        return np.swapaxes(J_all, -1, -2) @ P_all + np.swapaxes(G_all, -1, -2) @ J_all + self._M

    def momenta(self, frames: Array, x: Array, r: Array) -> Array:
        """Mass matrix times rates, shape (..., nq+1), without forming it."""
        H, G = self._of_bodies(frames, x)
        J = frames[..., 1:]
        twist = (J @ r)[..., None]
        P = H @ twist + (G @ r)[..., None]
        sums = np.swapaxes(_stack(J), -1, -2) @ _stack(P) + np.swapaxes(_stack(G), -1, -2) @ _stack(twist)
        return sums[..., 0] + self._M @ r

    def weight(self, frames: Array, x: Array, gravity: Array) -> Array:
        """Gradient of the potential energy of gravity, shape (nq+1,)."""
        return -np.einsum("ikd,k->d", self.mass.sums(frames, x)[..., 1:], gravity)

    def _of_bodies(self, frames: Array, x: Array) -> tuple[Array, Array]:
        c, s = np.cos(frames[..., 2, 0]), np.sin(frames[..., 2, 0])
        drawn, pull = self.mass.shortening(x)
        mx, my = self.mass.first[:, 0] + drawn, self.mass.first[:, 1] + x @ self.mass.shape.T
        S_x, S_y = c * mx - s * my, s * mx + c * my
        H = np.zeros((*c.shape, 3, 3), c.dtype)
        H[..., 0, 0] = H[..., 1, 1] = self.mass.total
        H[..., 0, 2] = H[..., 2, 0] = -S_y
        H[..., 1, 2] = H[..., 2, 1] = S_x
        H[..., 2, 2] = self._rotary + (x @ self._M_w * x) @ self._owned.T
        G = np.empty((*c.shape, 3, x.shape[-1]), c.dtype)
        G[..., 0, :] = c[..., None] * pull - s[..., None] * self.mass.shape
        G[..., 1, :] = s[..., None] * pull + c[..., None] * self.mass.shape
        G[..., 2, :] = self._p
        return H, G


def _stack(parts: Array) -> Array:
    """(..., nb, 3, k) as (..., 3 nb, k)."""
    return parts.reshape(*parts.shape[:-3], -1, parts.shape[-1])
