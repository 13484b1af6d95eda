"""A Runge-Kutta method is data: its tableau, error weights and dense output."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np


class Tableau(NamedTuple):
    """Explicit Runge-Kutta method of s stages with m more for the dense output; column s is f at the step's end.

    c (s+1+m,), a (s+1+m, s+1+m), b (s,), errors (1 or 2, s), d (rows, s+1+m).
    The interpolant is y0 + x (F0 + (1-x) (F1 + x (F2 + (1-x) (F3 + ...)))) with F0 = y1 - y0, F1 = h f0 - F0,
    F2 = 2 F0 - h (f0 + f1) (the cubic of Hermite) and further rows F = h d k.
    """

    order: int
    c: np.ndarray
    a: np.ndarray
    b: np.ndarray
    errors: np.ndarray
    d: np.ndarray


def tableau(
    order: int,
    c: Sequence[float],
    a: Sequence[Sequence[float]],
    b: Sequence[float],
    errors: Sequence[Sequence[float]],
    a_dense: Sequence[Sequence[float]],
    d: Sequence[Sequence[float]],
) -> Tableau:
    """Pack coefficient rows into rectangular arrays."""
    s = len(b)
    total = s + 1 + len(a_dense)
    full = np.zeros((total, total))
    for k, row in [*enumerate(a), (s, b), *enumerate(a_dense, s + 1)]:
        full[k, : len(row)] = row
    nodes = np.ones(total)
    nodes[:s] = c[:s]
    nodes[s + 1 :] = c[s + 1 :]
    rows = np.array([[*row, *[0.0] * (total - len(row))] for row in d])
    return Tableau(order, nodes, full, np.array(b), np.array(errors), rows)
