"""The cubic Hermite element and the interpolation over a mesh of such elements.

On an element of length h, with s = xi/h in [0, 1], the deflection is

    w = N1 w_i + N2 slope_i + N3 w_j + N4 slope_j
    N1 = 1 - 3s^2 + 2s^3    N2 = h(s - 2s^2 + s^3)    N3 = 3s^2 - 2s^3    N4 = h(-s^2 + s^3)

A mesh of n elements has the 2(n+1) coordinates (w0, slope0, w1, slope1, ..., wn, slopen).
"""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Side = Literal["left", "right"]

# Rows: powers s^0 .. s^3; columns: N1, N2/h, N3, N4/h. One table for each derivative with respect to s.
_VALUE = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [-3, -2, 3, -1], [2, 1, -2, 1]])
_DERIVATIVES = [_VALUE]
for _ in range(3):
    _DERIVATIVES.append(np.polynomial.polynomial.polyder(_DERIVATIVES[-1]))


def shape_functions(s: ArrayLike, h: ArrayLike, derivative: int = 0) -> Array:
    """Element shape functions, or a derivative of them with respect to the position x.

    s: position in the element divided by its length, in [0, 1], shape (...).
    h: element length [m], broadcast against s.
    derivative: 0 to 3.
    Returns shape (..., 4): the factors of w_i, w_j [m^-derivative] and slope_i, slope_j [m^(1-derivative)],
    in the order (w_i, slope_i, w_j, slope_j).
    """
    s, h = np.broadcast_arrays(np.asarray(s, float), np.asarray(h, float))
    table = _DERIVATIVES[derivative]
    N: Array = s[..., None] ** np.arange(len(table)) @ table
    N[..., 1::2] *= h[..., None]
    N /= h[..., None] ** derivative
    return N


def interpolation(nodes: Array, x: ArrayLike, derivative: int = 0, side: Side = "right") -> Array:
    """Matrix from the mesh coordinates to the deflection, or a derivative of it, at positions x.

    nodes: increasing node positions [m], shape (n+1,).
    x: positions [m], shape (points,); an interior node belongs to the element on its `side`.
    Returns shape (points, 2(n+1)).
    """
    x = np.asarray(x, float)
    element = np.searchsorted(nodes[1:-1], x, side=side)
    h = nodes[element + 1] - nodes[element]
    matrix = np.zeros((x.size, 2 * len(nodes)))
    columns = 2 * element[:, None] + np.arange(4)
    matrix[np.arange(x.size)[:, None], columns] = shape_functions((x - nodes[element]) / h, h, derivative)
    return matrix
