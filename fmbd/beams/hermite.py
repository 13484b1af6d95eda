"""The cubic Hermite element, its form that shears, and the interpolation over a mesh of such elements.

On an element of length h, with s = xi/h in [0, 1], the deflection is

    w = N1 w_i + N2 slope_i + N3 w_j + N4 slope_j
    N1 = 1 - 3s^2 + 2s^3    N2 = h(s - 2s^2 + s^3)    N3 = 3s^2 - 2s^3    N4 = h(-s^2 + s^3)

A mesh of n elements has the 2(n+1) coordinates (w0, slope0, w1, slope1, ..., wn, slopen).

An element that shears has the slopes of its cross-sections, psi = w' - gamma, and the functions that statics gives an
unloaded uniform one: with Phi = 12 EI / (kGA h^2), its bending over its shearing flexibility,

    N = (N of above + Phi N of below) / (1 + Phi)
    gamma = Phi / (1 + Phi) ((w_j - w_i) / h - (slope_i + slope_j) / 2)
    N1 = 1 - s              N2 = h(s - s^2) / 2       N3 = s              N4 = h(-s + s^2) / 2

gamma is constant within it, so that psi' = w''. J. S. Przemieniecki, Theory of Matrix Structural Analysis, 1968;
Z. Friedman, J. B. Kosmatka, An improved two-node Timoshenko beam finite element, Computers and Structures 47 (1993).
"""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Side = Literal["left", "right"]

# Rows: powers s^0 .. s^3; columns: N1, N2/h, N3, N4/h. One table for each derivative with respect to s.
# Of the element that is rigid in shear, and of the one that only shears.
_BENDING = np.array([[1.0, 0, 0, 0], [0, 1, 0, 0], [-3, -2, 3, -1], [2, 1, -2, 1]])
_SHEARING = np.array([[1.0, 0, 0, 0], [-1, 0.5, 1, -0.5], [0, -0.5, 0, 0.5], [0, 0, 0, 0]])
_DERIVATIVES = [
    tuple(np.polynomial.polynomial.polyder(table, order) for table in (_BENDING, _SHEARING))
    for order in range(4)
]


def shape_functions(s: ArrayLike, h: ArrayLike, derivative: int = 0, shear: ArrayLike = 0.0) -> Array:
    """Element shape functions, or a derivative of them with respect to the position x.

    s: position in the element divided by its length, in [0, 1], shape (...).
    h: element length [m], broadcast against s.
    derivative: 0 to 3.
    shear: Phi = 12 EI / (kGA h^2), broadcast against s; 0 for an element that is rigid in shear.
    Returns shape (..., 4): the factors of w_i, w_j [m^-derivative] and slope_i, slope_j [m^(1-derivative)],
    in the order (w_i, slope_i, w_j, slope_j).
    """
    s, h, shear = np.broadcast_arrays(*(np.asarray(part, float) for part in (s, h, shear)))
    bending, shearing = _DERIVATIVES[derivative]
    powers = s[..., None] ** np.arange(len(bending))
    N: Array = (powers @ bending + shear[..., None] * (powers @ shearing)) / (1.0 + shear[..., None])
    N[..., 1::2] *= h[..., None]
    N /= h[..., None] ** derivative
    return N


def interpolation(
    nodes: Array, x: ArrayLike, derivative: int = 0, side: Side = "right", shear: ArrayLike = 0.0
) -> Array:
    """Matrix from the mesh coordinates to the deflection, or a derivative of it, at positions x.

    nodes: increasing node positions [m], shape (n+1,).
    x: positions [m], shape (points,); an interior node belongs to the element on its `side`.
    shear: Phi of each element, shape (n,).
    Returns shape (points, 2(n+1)).
    """
    x, element, h, Phi = _elements(nodes, x, side, shear)
    return _over_mesh(nodes, element, shape_functions((x - nodes[element]) / h, h, derivative, Phi))


def shear_angles(nodes: Array, x: ArrayLike, side: Side, shear: ArrayLike) -> Array:
    """Matrix from the mesh coordinates to the shear angle w' - psi [rad] at positions x, as `interpolation`."""
    _, element, h, Phi = _elements(nodes, x, side, shear)
    half = np.full(h.shape, 0.5)
    return _over_mesh(
        nodes, element, (Phi / (1.0 + Phi))[:, None] * np.stack([-1.0 / h, -half, 1.0 / h, -half], axis=-1)
    )


def _elements(
    nodes: Array, x: ArrayLike, side: Side, shear: ArrayLike
) -> tuple[Array, NDArray[np.intp], Array, Array]:
    """Positions, and the elements that they are in: which, their lengths, their Phi."""
    x = np.asarray(x, float)
    element = np.searchsorted(nodes[1:-1], x, side=side)
    Phi = np.broadcast_to(np.asarray(shear, float), len(nodes) - 1)
    return x, element, nodes[element + 1] - nodes[element], Phi[element]


def _over_mesh(nodes: Array, element: NDArray[np.intp], functions: Array) -> Array:
    """Functions of the four coordinates of elements, shape (points, 4), as those of all coordinates."""
    matrix = np.zeros((len(element), 2 * len(nodes)))
    matrix[np.arange(len(element))[:, None], 2 * element[:, None] + np.arange(4)] = functions
    return matrix
