"""Singular positions of a rigid mechanism with as many inputs as degrees of freedom, and a point that they move.

    Phi_x dx = 0,  A dx = d theta,  P dx = dp        loops, inputs, point; x all joint coordinates
    parallel   det [Phi_x; A] = 0    the inputs do not hold the mechanism (type 2)
    serial     det [Phi_x; P] = 0    the point cannot move in some direction (type 1); of two inputs
               |J| = 0               the point does not move (dead centre, cusp); of one input
    J = dp / d theta,  of two inputs det J = serial / parallel (but for the sign)

Of the five-bar they are l2^2 sin(angle between the rods), and the product of l1 l2 sin(elbow's angle) of both arms.
Source: C. Gosselin, J. Angeles, Singularity analysis of closed-loop kinematic chains, IEEE Transactions on Robotics and
Automation 6 (3), 1990, pp. 281-290.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from fmbd.analyses.guide import Guide

Array = np.ndarray

_CLOSED = 1e-8
#: Condition numbers of J above this are worth a remark.
NEAR = 50.0


@dataclass(frozen=True)
class Singularity:
    """A singular position: of which kind, where the point is [m], the inputs [rad, m], how far the point is off [m]."""

    kind: str
    place: Array
    inputs: Array
    distance: float


def parallel(guide: Guide, q: Array, t: float) -> float:
    """det [Phi_x; A] at nodal coordinates q (nq,)."""
    loops, inputs, _ = guide.rows(q, t)
    return float(np.linalg.det(np.vstack([loops, inputs])))


def serial(guide: Guide, q: Array, t: float) -> float:
    """det [Phi_x; P] of two inputs, |J| of one, NaN of more."""
    loops, inputs, point = guide.rows(q, t)
    if len(inputs) == 1:
        return float(np.linalg.norm(jacobian(guide, q, t)))
    return float(np.linalg.det(np.vstack([loops, point]))) if len(inputs) == 2 else np.nan


def jacobian(guide: Guide, q: Array, t: float) -> Array:
    """J = dp / d theta, shape (2, inputs); infinite where the inputs do not hold the mechanism."""
    loops, inputs, point = guide.rows(q, t)
    given = np.vstack([np.zeros((len(loops), len(inputs))), np.eye(len(inputs))])
    try:
        return np.asarray(point @ np.linalg.solve(np.vstack([loops, inputs]), given))
    except np.linalg.LinAlgError:
        return np.full((2, len(inputs)), np.inf)


def remarks_on_path(guide: Guide, times: Array, qs: Array) -> Iterator[str]:
    """What is to be said of a path (nt, nq) of a point moved by two inputs: singular positions on it, or near."""
    loops, inputs, _ = guide.rows(qs[0], float(times[0]))
    if len(inputs) != 2 or len(loops) + 2 != loops.shape[1]:
        return
    at = list(zip(qs, times.tolist(), strict=True))
    sign = np.sign([serial(guide, q, t) for q, t in at])
    passed = np.flatnonzero(sign[:-1] * sign[1:] <= 0.0)
    condition = np.array([np.linalg.cond(jacobian(guide, q, t)) for q, t in at])
    k = int(condition.argmax())
    if passed.size:
        yield (
            f"{guide.point} passes a serial singular position at t = {times[passed[0] + 1]:.6g} s: "
            "it cannot move in some direction there"
        )
    elif condition[k] > NEAR:
        yield (
            f"{guide.point} comes near a singular position at t = {times[k]:.6g} s: the condition number of "
            f"dp/d(inputs) is {condition[k]:.3g} (fmbd kinematics tells which)"
        )


def nearest(guide: Guide, q: Array, t: float, kind: str) -> Singularity | None:
    """The singular position of a kind, `parallel` or `serial`, whose point is nearest to that at q; None if not found.

    A local minimum of the distance: where there are several singular curves, that of the one which q leads to.
    """
    size: Callable[[Guide, Array, float], float] = {"parallel": parallel, "serial": serial}[kind]
    place = guide.place(q, t)
    there = guide.closest(q, place, t, lambda near: size(guide, near, t))
    if max(np.abs(guide.miss(there, t)).max(initial=0.0), abs(size(guide, there, t))) > _CLOSED:
        return None
    found = guide.place(there, t)
    return Singularity(kind, found, guide.values(there, t), float(np.linalg.norm(found - place)))
