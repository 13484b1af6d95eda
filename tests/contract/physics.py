"""What a mechanism does, free of the coordinates that describe it: motion of points, momentum, balance of energy."""

from collections.abc import Sequence
from dataclasses import fields
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


def motion(system: System, points: Sequence[str], q: Array, v: Array, a: Array, t: float = 0.0) -> Array:
    """Position, velocity and acceleration of points `body.point` where q' = v, q'' = a; shape (3, points, 2)."""
    stepped = _duals(system, points, q + 1j * STEP * v, t + 1j * STEP)
    velocity = stepped[..., 1:] @ np.append(v, 1.0)
    acceleration = velocity.imag / STEP + (stepped[..., 1:-1] @ a).real
    return np.stack([stepped[..., 0].real, velocity.real, acceleration])


def _duals(system: System, points: Sequence[str], q: Array, t: complex) -> Array:
    """Positions with their derivatives by q and t (fmbd.system.duals), shape (points, 2, nq + 2)."""
    frames = system.reference.frames(q, np.asarray(t))[0]
    out = []
    for name in points:
        body, point = system.lowered.segmentation.place(*name.split("."))
        index, part = system.lowered.body_index[body], system.lowered.model.bodies[body]
        local = np.zeros((2, q.size + 2), complex)
        if isinstance(part, Beam):
            own = system.reference.inertia.elastic[index]
            shape = system.beams[index].shape(part.points[point])
            local[:, 0] = part.points[point], shape @ q[own]
            local[1, 1:-1][own] = shape
        else:
            local[:, 0] = part.points[point].at
        out.append(frames[index, :2] + rotate(frames[index, 2], local))
    return np.array(out)


def run(system: System, times: Array) -> Block:
    """The whole run as one block; it must reach the end."""
    statistics = Statistics(system.model.simulation.method)
    blocks = list(integrate(system, times, statistics))
    assert not statistics.reason, statistics.reason
    whole = {
        field.name: np.concatenate([getattr(block, field.name) for block in blocks])
        for field in fields(Block)
        if field.name != "energy"
    }
    energy = {name: np.concatenate([block.energy[name] for block in blocks]) for name in blocks[0].energy}
    assert whole["time"].size == times.size
    return Block(**whole, energy=energy)


def start(system: System, points: Sequence[str]) -> Array:
    """`motion` at the start, shape (1, 3, points, 2)."""
    q, v = system.start.q, system.start.v
    return motion(system, points, q, v, system.accelerations(q, v)[0])[None]


def trajectory(system: System, points: Sequence[str], times: Array) -> Array:
    """`motion` at the given times of a run, shape (times, 3, points, 2)."""
    block = run(system, times)
    rows = zip(block.position, block.velocity, block.acceleration, block.time)
    return np.array([motion(system, points, q, v, a, t) for q, v, a, t in rows])


def assert_same(one: Array, other: Array, tolerance: float = 1e-9) -> None:
    """Two motions agree: positions, velocities and accelerations each to this share of the largest."""
    for kind, name in zip(range(one.shape[1]), ("position", "velocity", "acceleration")):
        size = np.abs(one[:, kind]).max()
        np.testing.assert_allclose(other[:, kind], one[:, kind], rtol=0, atol=tolerance * size, err_msg=name)
