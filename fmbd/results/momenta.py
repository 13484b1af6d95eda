"""Momentum of a body, and angular momentum about the world's origin.

p = int r' dm,    L = int r x r' dm + int psi' dJ
psi the angle of a cross-section, dJ its rotary inertia and the moments of inertia of point masses
"""

import numpy as np
from numpy.typing import NDArray

from fmbd.beams import FloatingBeam
from fmbd.beams.pieces import degree, element_breaks, evaluate, gauss_points, has
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
    p, L = np.zeros(len(motion.time), complex), np.zeros(len(motion.time))
    for segment in motion.system.lowered.segmentation.beams[body]:
        x, mass, inertia = _masses(motion.system.beams[motion.system.lowered.body_index[segment.body]])
        place, velocity, _ = motion.segment_points(segment.body, x)
        along = mass * velocity
        p += along.sum(axis=1)
        L += _moment(place, along).sum(axis=1)
        L += motion.segment_angle(segment.body, x, 1) @ inertia
    return p, L


def _masses(beam: FloatingBeam) -> tuple[Array, Array, Array]:
    """Positions [m], masses [kg] and moments of inertia [kg m^2] to sum over, of a beam and its point masses."""
    # moments of the shortening, of degree 5 within an element, with itself
    along = 10 + degree(beam.pieces, "mass_per_length")
    x, dx = gauss_points(element_breaks(beam.pieces, beam.nodes), along)
    mass = dx * evaluate(beam.pieces, "mass_per_length", x)
    inertia = np.zeros_like(x)
    if has(beam.pieces, "rotary_inertia"):
        inertia = dx * evaluate(beam.pieces, "rotary_inertia", x)
    points, masses, inertias = beam.point_masses.T
    return (
        np.concatenate([x, points]),
        np.concatenate([mass, masses]),
        np.concatenate([inertia, inertias]),
    )


def _moment(place: Plane, momentum: Plane) -> Array:
    return np.asarray((np.conj(place) * momentum).imag)
