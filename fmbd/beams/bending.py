"""Bending moment, shear force and stress of a beam: rows that give them from its elastic coordinates e.

They jump from element to element, and where the section does; there it is the mean of both sides. They are
derivatives of the deflection, so they converge more slowly than it does. With shear, w'' stands for the psi' of the
cross-sections, and the shear force is -kGA gamma, which in a uniform element is the same.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from fmbd.beams.floating import FloatingBeam
from fmbd.beams.hermite import Array, Side
from fmbd.beams.pieces import evaluate


def bending_moment(beam: FloatingBeam, x: ArrayLike) -> Array:
    """Rows of EI w'' [N m] at x [m] (points,), shape (points, nf)."""
    return _mean(lambda side: _column(beam, "bending_stiffness", x, 0, side) * beam.curvature(x, side))


def shear_force(beam: FloatingBeam, x: ArrayLike) -> Array:
    """Rows of (EI w'')' [N], or -kGA gamma, at x [m] (points,), shape (points, nf)."""
    if beam.shears:
        return _mean(lambda side: -_column(beam, "shear_stiffness", x, 0, side) * beam.shear_angle(x, side))
    return _mean(
        lambda side: (
            _column(beam, "bending_stiffness", x, 0, side) * beam.third_derivative(x, side)
            + _column(beam, "bending_stiffness", x, 1, side) * beam.curvature(x, side)
        )
    )


def upper_stress(beam: FloatingBeam, x: ArrayLike, youngs_modulus: float) -> Array:
    """Rows of the bending stress -E h/2 w'' [Pa] in the fibre y = h/2 at x [m] (points,), (points, nf)."""
    half = 0.5 * youngs_modulus
    return _mean(lambda side: -half * _column(beam, "height", x, 0, side) * beam.curvature(x, side))


def _mean(rows: Callable[[Side], Array]) -> Array:
    return 0.5 * (rows("left") + rows("right"))


def _column(beam: FloatingBeam, name: str, x: ArrayLike, derivative: int, side: Side) -> Array:
    return evaluate(beam.pieces, name, np.asarray(x, float), derivative, side)[:, None]
