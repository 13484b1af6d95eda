"""Duals: a number with its gradient, in one array.

The last axis has length d = 1 + nq + 1: the value, its derivatives by the coordinates q, its partial
derivative by the time t. Sums of duals are sums of arrays. The functions are analytic: complex values
(complex step) give one more derivative, exact to round-off.
"""

import numpy as np

Array = np.ndarray


def rotate(angle: Array, vector: Array) -> Array:
    """A vector (..., 2, d) turned by an angle (..., d)."""
    c, s = np.cos(angle[..., :1]), np.sin(angle[..., :1])
    out = np.empty_like(vector)
    x, y = vector[..., 0, :], vector[..., 1, :]
    out[..., 0, :] = c * x - s * y
    out[..., 1, :] = s * x + c * y
    out[..., 0, 1:] -= out[..., 1, :1] * angle[..., 1:]
    out[..., 1, 1:] += out[..., 0, :1] * angle[..., 1:]
    return out


def norm(vector: Array) -> Array:
    """The length (..., d) of a vector (..., 2, d); one without length counts as lying along x."""
    x, y = vector[..., 0, :1], vector[..., 1, :1]
    length = np.sqrt(x * x + y * y)
    none = length == 0.0
    divisor = np.where(none, 1.0, length)
    out: Array = np.where(none, 1.0, x / divisor) * vector[..., 0, :] + y / divisor * vector[..., 1, :]
    out[..., :1] = length
    return out
