"""Frequencies at which a response is seen as it is, and its phases, followed along them."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fmbd.analyses.state_space import StateSpace

Array = np.ndarray

POINTS = 600
#: Around a resonance: so many points on each side, to this share of its frequency; closest to one that nothing damps.
NEAR, REACH, CLOSEST = 30, 0.03, 1e-4


def sampled(space: "StateSpace", low: float, high: float) -> Array:
    """Frequencies [Hz] from low to high that show every resonance at its height, ascending."""
    parts = [np.geomspace(low, high, POINTS)]
    for pole in space.poles():
        if pole.imag > 0.0:
            damping = -pole.real / abs(pole)
            closest = CLOSEST if abs(damping) < 1e-10 else min(0.02 * abs(damping), 0.1 * REACH)
            away = np.geomspace(closest, REACH, NEAR)
            parts.append(abs(pole) / (2.0 * np.pi) * (1.0 + np.concatenate([-away, away])))
    every = np.unique(np.concatenate(parts))
    return every[(every >= low) & (every <= high)]


def phases(space: "StateSpace", frequencies: Array) -> Array:
    """Phases [deg] at frequencies [Hz] (n,), ascending, continuous from the lowest on, shape (n, ny, nu)."""
    fine = sampled(space, float(frequencies[0]), float(frequencies[-1]))
    every = np.union1d(fine, frequencies)
    followed = np.unwrap(np.angle(space.frequency_response(every)), axis=0)
    return np.degrees(followed[np.searchsorted(every, frequencies)])
