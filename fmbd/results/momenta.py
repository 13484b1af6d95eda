"""Momentum of a body, and angular momentum about the world's origin.

p = int r' dm,    L = int r x r' dm,    a point mass of inertia J adds J times the rate of its cross-section's angle
"""

import numpy as np
from numpy.typing import NDArray

from fmbd.beams.pieces import degree, evaluate, gauss_points
from fmbd.model import Beam
from fmbd.results.motion import Motion

Array = NDArray[np.float64]
Plane = NDArray[np.complex128]


def momentum(motion: Motion, body: str) -> tuple[Plane, Array]:
    """Momentum x + iy [kg m/s] and angular momentum [kg m^2/s] of a body with its point masses, each of shape (nt,)."""
    part = motion.system.model.bodies[body]
    if not isinstance(part, Beam):
        center = motion.point(body, "center_of_mass")
        p = part.mass * center.place[1]
        return p, _moment(center.place[0], p) + part.inertia * center.angle[1]
    breaks = np.unique([*part.nodes, *(piece.start for piece in part.pieces)])
    # moments of the shortening, of degree 5 within an element, with itself
    points, weights = gauss_points(breaks, 10 + degree(part.pieces, "mass_per_length"))
    axis = motion.beam_jets(body, points)
    along = weights * evaluate(part.pieces, "mass_per_length", points) * axis[1]
    p, L = along.sum(axis=1), _moment(axis[0], along).sum(axis=1)
    for point, mass in part.point_masses.items():
        at = motion.point(body, point)
        p = p + mass.mass * at.place[1]
        L = L + _moment(at.place[0], mass.mass * at.place[1]) + mass.inertia * at.angle[1]
    return p, L


def _moment(place: Plane, momentum: Plane) -> Array:
    return np.asarray((np.conj(place) * momentum).imag)
