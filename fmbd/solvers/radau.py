"""Radau IIA: implicit collocation methods for stiff equations, of order 5 (3 stages) and 9 (5 stages).

L-stable and stiffly accurate; the stages are found by Newton's method with the exact tangent near the middle of the
step. Use it for beams that vibrate undamped, for tight tolerances, and where the tangent misses something (a force law
with corners, online gravity compensation): Newton's method only gets slower by that, while a linearly implicit method
loses its order. Five stages, the default, are the faster choice but where beams are fine and damped and the tolerance
is loose: there three stages, or `rodas5p`, do with less work.

E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.8 (RADAU5), and: Stiff differential
equations solved by Radau methods, J. Comput. Appl. Math. 111 (1999) 93-111. The coefficients are computed here.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

Array = np.ndarray


class Collocation(NamedTuple):
    """Coefficients of a collocation method; A^-1 = V diag(mu) V^-1 with one real mu and pairs of complex ones.

    Of each pair one is kept, and 2 V for it: the sum over both is the real part of that.
    """

    c: Array  # (s,) nodes, the last one 1
    A: Array  # (s, s)
    interpolation: Array  # (s, s): rows of steps.interpolate from the stages
    error: Array  # (s,) the estimate is f0 + sum error_i Z_i / h, filtered
    mu: float
    left: Array  # (s,) row of V^-1
    right: Array  # (s,) column of V
    mus: Array  # (pairs,)
    lefts: Array  # (pairs, s)
    rights: Array  # (pairs, s)


def radau(s: int) -> Collocation:
    """Radau IIA with s stages, s odd: order 2 s - 1."""
    # on (-1, 1), in Legendre polynomials P_k: the nodes are the roots of P_s - P_(s-1)
    x = np.sort(legendre.legroots([0.0] * (s - 1) + [-1.0, 1.0]).real)
    x[-1] = 1.0
    values = legendre.legvander(x, s - 1)
    integrals = np.stack([legendre.legval(x, legendre.legint(p, lbnd=-1)) for p in np.eye(s)], axis=1)
    A = 0.5 * integrals @ np.linalg.inv(values)
    c = 0.5 * (x + 1.0)
    mu, V = np.linalg.eig(np.linalg.inv(A))
    W = np.linalg.inv(V)
    real, pairs = int(np.argmin(abs(mu.imag))), mu.imag > 0.1
    # a quadrature of order s that uses f0, too, with weight 1 / mu, less that of the method
    difference = -np.linalg.solve(np.vander(c, increasing=True).T, np.eye(s)[0])
    basis = np.stack([c ** ((r + 2) // 2) * (1.0 - c) ** ((r + 1) // 2) for r in range(s)], axis=1)
    return Collocation(
        c=c,
        A=A,
        interpolation=np.linalg.inv(basis),
        error=difference @ np.linalg.inv(A),
        mu=float(mu[real].real),
        left=W[real].real.copy(),
        right=V[:, real].real.copy(),
        mus=mu[pairs],
        lefts=W[pairs],
        rights=2.0 * V[:, pairs].T.copy(),
    )
