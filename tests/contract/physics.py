"""What a mechanism does, free of the coordinates that describe it: motion of points, momentum, balance of energy."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from fmbd.model import Beam, load_model_text
from fmbd.solvers.integrate import Block, Statistics, integrate
from fmbd.system import System, assemble
from fmbd.system.duals import rotate

Array = np.ndarray
MODELS = Path(__file__).parents[2] / "models"
STEP = 1e-200  # of the complex derivative


def build(data: dict[str, Any] | str) -> System:
    """The system of a model given as YAML, text or plain data."""
    return assemble(load_model_text(data if isinstance(data, str) else yaml.safe_dump(data, sort_keys=False)))


def accelerations(system: System) -> Array:
    """q'' at the start."""
    return system.accelerations(system.start.q, system.start.v)[0]


def motion(system: System, points: Sequence[str], q: Array, v: Array, a: Array, t: float = 0.0) -> Array:
    """Position, velocity and acceleration of points `body.point` where q = q, q' = v, q'' = a.

    Shape (3, points, 3): the last axis is x, y, angle of the body's frame less its angle at q = 0, t = 0, so that
    frames that are turned against each other compare.
    """
    r = np.append(v, 1.0)
    stepped = _duals(system, points, q + 1j * STEP * v, t + 1j * STEP)
    place, gradient = stepped[..., 0], stepped[..., 1:]
    velocity = gradient @ r
    acceleration = velocity.imag / STEP + (gradient[..., :-1] @ a).real
    return np.stack([place.real, velocity.real, acceleration])


def _duals(system: System, points: Sequence[str], q: Array, t: complex) -> Array:
    """Duals of the points, shape (points, 3, nq + 2): value, derivatives by q and t."""
    frames = system.reference.frames(q, np.asarray(t))[0]
    nq = system.planar.nq
    out = np.zeros((len(points), 3, nq + 2), complex)
    for k, name in enumerate(points):
        body, point = name.split(".")
        index, part = system.lowered.body_index[body], system.model.bodies[body]
        local = np.zeros((2, nq + 2), complex)
        if isinstance(part, Beam):
            first = int(system.planar.bodies[index].first_q)
            shape = system.beams[index].shape(part.points[point])
            local[0, 0] = part.points[point]
            local[1, 0] = shape @ q[first : first + shape.size]
            local[1, 1 + first : 1 + first + shape.size] = shape
        else:
            local[:, 0] = part.points[point].at
        out[k, :2] = frames[index, :2] + rotate(frames[index, 2], local)
        out[k, 2] = frames[index, 2]
    return out


def run(system: System, times: Array) -> Block:
    """The whole run as one block; it must reach the end."""
    statistics = Statistics(system.model.simulation.method)
    blocks = list(integrate(system, times, statistics))
    assert not statistics.reason, statistics.reason
    assert sum(block.time.size for block in blocks) == times.size
    (block,) = blocks
    return block


def trajectory(system: System, points: Sequence[str], times: Array) -> Array:
    """`motion` at the given times of a run, shape (times, 3, points, 3)."""
    block = run(system, times)
    rows = zip(block.position, block.velocity, block.acceleration, block.time)
    return np.array([motion(system, points, q, v, a, t) for q, v, a, t in rows])
