"""What thick beams have beyond slender ones: cross-sections that resist turning, and that shear.

Lord Rayleigh, The Theory of Sound, 1877, section 186; S. P. Timoshenko, On the correction for shear of the differential
equation for transverse vibrations of prismatic bars, Philosophical Magazine 41 (1921), pp. 744-746.
"""

from collections.abc import Sequence

import numpy as np

from fmbd.beams.hermite import Array
from fmbd.beams.pieces import BeamPiece, degree, element_breaks, evaluate, gauss_points, has


def rotary_inertia(pieces: Sequence[BeamPiece], nodes: Array) -> tuple[Array, Array]:
    """Gauss points [m] and rho I dx at them [kg m^2], each of shape (points,); none if it is left out."""
    if not has(pieces, "rotary_inertia"):
        return np.zeros(0), np.zeros(0)
    x, weight = gauss_points(element_breaks(pieces, nodes), 4 + degree(pieces, "rotary_inertia"))
    return x, weight * evaluate(pieces, "rotary_inertia", x)


def shear_parameters(pieces: Sequence[BeamPiece], nodes: Array) -> Array:
    """Phi = 12 EI / (kGA h^2) of each element, by the means of 1 / EI and 1 / kGA where these vary, shape (n,).

    Zeros if the pieces are rigid in shear. Raises ValueError for stiffnesses that are not positive.
    """
    h = np.diff(nodes)
    if not has(pieces, "shear_stiffness"):
        return np.zeros(len(h))
    x, weight = gauss_points(element_breaks(pieces, nodes), 8)
    EI, kGA = (evaluate(pieces, name, x) for name in ("bending_stiffness", "shear_stiffness"))
    if min(EI.min(), kGA.min()) <= 0:
        raise ValueError("a beam's bending and shear stiffness must be positive")
    element = np.searchsorted(nodes, x) - 1
    return 12.0 * np.bincount(element, weight / kGA) / np.bincount(element, weight / EI) / h**2
