"""Piecewise polynomial properties along a beam, and Gauss quadrature that is exact for them."""

from collections.abc import Sequence
from dataclasses import Field
from functools import cache
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from fmbd.beams.hermite import Array, Side


class BeamPiece(Protocol):
    """A stretch of a beam: its properties are polynomials in the distance from `start`, ascending powers.

    A dataclass; what a beam leaves out is None.
    """

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    @property
    def start(self) -> float:
        """Position along the beam [m]."""

    @property
    def end(self) -> float:
        """Position along the beam [m]."""

    @property
    def mass_per_length(self) -> Sequence[float]:
        """Coefficients [kg/m, kg/m^2, ...]."""

    @property
    def bending_stiffness(self) -> Sequence[float]:
        """Coefficients [N m^2, N m, ...]."""

    @property
    def rotary_inertia(self) -> Sequence[float] | None:
        """Moment of inertia of the cross-sections rho I, by length, coefficients [kg m, kg, ...]."""

    @property
    def shear_stiffness(self) -> Sequence[float] | None:
        """kappa G A, coefficients [N, N/m, ...]; None: rigid in shear."""


def evaluate(
    pieces: Sequence[BeamPiece], name: str, x: Array, derivative: int = 0, side: Side = "right"
) -> Array:
    """The property `name`, or a derivative, at positions x [m], shaped as x.

    A boundary belongs to the piece on its `side`.
    """
    piece_at = np.searchsorted([piece.start for piece in pieces[1:]], x, side=side)
    value = np.empty(x.shape)
    for number, piece in enumerate(pieces):
        inside = piece_at == number
        coefficients = polyder(getattr(piece, name), derivative)
        value[inside] = polyval(x[inside] - piece.start, coefficients)
    return value


def has(pieces: Sequence[BeamPiece], name: str) -> bool:
    """Whether all pieces have the property `name`, or none; ValueError for some."""
    known = {getattr(piece, name) is not None for piece in pieces}
    if len(known) > 1:
        raise ValueError(f"all pieces of a beam must have {name.replace('_', ' ')}, or none")
    return known == {True}


def degree(pieces: Sequence[BeamPiece], name: str) -> int:
    """The highest polynomial degree of the property `name`."""
    return max(len(getattr(piece, name)) for piece in pieces) - 1


def element_breaks(pieces: Sequence[BeamPiece], nodes: Array) -> Array:
    """Nodes and boundaries of pieces [m], between which properties and shape functions are polynomials."""
    return np.unique(np.concatenate((nodes, [piece.start for piece in pieces[1:]])))


def gauss_points(breaks: Array, degree: int) -> tuple[Array, Array]:
    """Positions and weights [m], shape (points,), exact for polynomials of `degree` between the breaks."""
    t, weight = _gauss_rule(degree // 2 + 1)
    half = np.diff(breaks)[:, None] / 2
    middle = (breaks[1:] + breaks[:-1])[:, None] / 2
    return (middle + half * t).ravel(), (half * weight).ravel()


@cache
def _gauss_rule(points: int) -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(points)
