"""Tangent stiffness of a mechanism at rest, of all forces, in independent coordinates.

Stiffness is measured in the metric of the mass matrix, y^T K y with N^T M N = I: it has the unit 1/s^2, and its
eigenvalues are squares of frequencies. It is found from the compliance, which the resolvent W gives (linearisation.py):
first-order states, such as currents, follow at once.
"""

import numpy as np

from fmbd.analyses.linearisation import SHIFT, Linearisation

Array = np.ndarray

#: Stiffness [1/s^2] below which nothing opposes a motion.
INDIFFERENT = 1e-8
_OFFSET = 0.9137  # [1/s^2], so that the stiffness of free motions, 0, can be inverted


def tangent_stiffness(lin: Linearisation) -> tuple[Array, Array]:
    """Eigenvalues [1/s^2] of the stiffness at rest, ascending, and their motions y as columns."""
    f = lin.freedom
    compliance = damped_step(lin, _OFFSET, np.eye(lin.size)[:, f : 2 * f])[:f]
    given, shapes = np.linalg.eig(compliance)
    seen = np.abs(given) > 1e-13 * np.abs(given).max(initial=0.0)  # integral control is infinitely stiff
    stiffness = (1.0 / given[seen]).real - _OFFSET
    order = np.argsort(stiffness)
    return stiffness[order], shapes[:, seen][:, order].real


def dominant(lin: Linearisation, motions: Array) -> tuple[str, ...]:
    """Coordinates and beams with more than a twentieth of the kinetic energy of motions y (f,) or (f, k)."""
    return tuple(name for name, share in shares(lin, motions).items() if share > 0.05)


def shares(lin: Linearisation, motions: Array) -> dict[str, float]:
    """Shares of coordinates, and of beams as a whole, in the kinetic energy of motions y, greatest first."""
    system = lin.system
    moved = np.abs(lin.motions.N @ motions) ** 2
    weight = lin.motions.M.diagonal() * (moved.sum(axis=1) if moved.ndim == 2 else moved)
    found = dict(zip(system.coordinate_names, weight, strict=True))
    for beam, segments in system.lowered.segmentation.beams.items():
        found[f"{beam} bending"] = 0.0
        for segment in segments:
            own = system.reference.inertia.elastic[system.lowered.body_index[segment.body]]
            for name in system.coordinate_names[own]:
                del found[name]
            found[f"{beam} bending"] += weight[own].sum()
    total = max(weight.sum(), 1e-300)
    return dict(sorted(((name, float(w / total)) for name, w in found.items()), key=lambda item: -item[1]))


def newton_step(lin: Linearisation) -> Array:
    """Newton's step towards an equilibrium, nodal coordinates (nq,)."""
    return lin.directions(damped_step(lin, 0.0, lin.unbalanced)[:, None])[0][:, 0]


def damped_step(lin: Linearisation, sigma: float, b: Array) -> Array:
    """u of (Sigma - A) u = b: Newton's step if sigma is 0, else against a resistance sigma to all motions.

    Of many, as there are where a motion is free or an integral does nothing, the least.
    """
    f = lin.freedom
    W = lin.resolvent
    resisted = np.zeros_like(W)
    resisted[f : 2 * f, :f] = sigma * np.eye(f)
    both = np.eye(lin.size) + W @ resisted - SHIFT * W, W @ b
    try:
        return np.linalg.solve(*both)
    except np.linalg.LinAlgError:
        return np.linalg.lstsq(*both, rcond=None)[0]
