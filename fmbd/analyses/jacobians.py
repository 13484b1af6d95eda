"""Jacobians of distances and angles in a mechanism, without the round-off of what cancels in them.

An entry is the difference of two stations, whose Jacobians are themselves sums of levers along a chain of bodies:
where a coordinate moves both ends alike, or turns about the very point, round-off is all that is left. It would count
as a direction of its own.
"""

import numpy as np

from fmbd.planar.arrays import ANGLE
from fmbd.system import System

Array = np.ndarray

#: An entry below this share of what it is the difference of is round-off.
ROUND_OFF = 1e-9


def pathway_rows(system: System, q: Array, t: float) -> Array:
    """Derivatives of the pathways by the nodal coordinates q (nq,), shape (pathways, nq)."""
    planar = system.planar
    _, stations = system.reference.frames(q, t)
    rows = system.reference.lengths(stations)[:, 1:-1]
    terms = planar.terms
    angles = terms["kind"][:, None] == ANGLE
    sizes = np.where(angles, _ends(_turns(stations), terms), _ends(_moves(stations), terms))
    size = np.zeros_like(rows)
    owner = np.repeat(np.arange(len(rows)), planar.pathways["nterm"])
    np.add.at(size, owner, np.abs(terms["coefficient"])[:, None] * sizes)
    return _rounded(rows, size)


def displacement_rows(system: System, q: Array, t: float, terms: Array) -> Array:
    """Derivatives by q of the vectors from a to b of some terms, world axes, shape (2, terms, nq)."""
    _, stations = system.reference.frames(q, t)
    moved = stations[terms["b"], :2, 1:-1] - stations[terms["a"], :2, 1:-1]
    return _rounded(np.swapaxes(moved, 0, 1), _ends(_moves(stations), terms))


def _turns(stations: Array) -> Array:
    """How much each coordinate turns each station, shape (stations, nq)."""
    return np.abs(stations[:, 2, 1:-1])


def _moves(stations: Array) -> Array:
    """How much it moves it, or the points of the chain on the way to it, shape (stations, nq)."""
    extent = np.ptp(stations[:, :2, 0], axis=0).max()
    return np.hypot(stations[:, 0, 1:-1], stations[:, 1, 1:-1]) + extent * _turns(stations)


def _ends(size: Array, terms: Array) -> Array:
    return size[terms["a"]] + size[terms["b"]]


def _rounded(rows: Array, size: Array) -> Array:
    return np.where(np.abs(rows) > ROUND_OFF * size, rows, 0.0)
