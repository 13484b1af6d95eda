"""All modes of a beam: the change of coordinates e = Psi eta that makes M the identity and K diagonal.

M    mass matrix (nf, nf)                          d    Jacobi scaling, 1/sqrt(diag M)
G    square root of the stiffness, K = G^T G       L    Cholesky factor of d M d
Psi  modes (nf, nf), one a column                  V    right singular vectors of G d L^-T, V^T V = I

An eigensolver applied to K loses the low frequencies: its error is the machine precision times the highest
omega^2, which grows as n^4. The singular values of G are the omega themselves, so the loss grows as n^2 only.
Scaling keeps L well conditioned on any mesh.
"""

import numpy as np

from fmbd.beams.hermite import Array


def modal_basis(M: Array, G: Array) -> tuple[Array, Array]:
    """Modes Psi, shape (nf, nf), and omega2 [rad^2/s^2], shape (nf,), ascending.

    Psi^T M Psi = I and Psi^T G^T G Psi = diag(omega2). The first of a mode's scaled coordinates that comes
    near the largest in magnitude is positive: the sign does not hang on round-off, symmetric beams included.
    """
    d = 1 / np.sqrt(np.diag(M))
    L = np.linalg.cholesky(M * np.outer(d, d))
    _, omega, Vt = np.linalg.svd(np.linalg.solve(L, (G * d).T).T, full_matrices=False)
    scaled = np.linalg.solve(L.T, Vt[::-1].T)
    magnitude = np.abs(scaled)
    leading = np.argmax(magnitude > 0.9 * magnitude.max(axis=0), axis=0)
    scaled *= np.sign(scaled[leading, np.arange(len(d))])
    return d[:, None] * scaled, omega[::-1] ** 2
