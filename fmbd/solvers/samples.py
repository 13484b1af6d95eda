"""What is recorded at the output times: accelerations, multipliers, energies, constraint errors, motor values."""

from typing import Any

import numpy as np

from fmbd.planar.compile import compiled
from fmbd.planar.equations import accelerations, constraint, energies


@compiled
def sample(
    sys: Any,
    work: Any,
    times: np.ndarray,
    y: np.ndarray,
    drag: float,
    pull: float,
    qdd: np.ndarray,
    multipliers: np.ndarray,
    energy: np.ndarray,
    errors: np.ndarray,
    dz: np.ndarray,
) -> None:
    """Fill qdd (k, nq), multipliers (k, nc), energy (k, 3: kinetic potential elastic), errors (k, 2: max |Phi|, |Phi'|)
    for the states y (k, ny) at `times` (k,); dz (nz,) is scratch."""
    n = sys.nq
    for k in range(times.size):
        q, v, z = y[k, :n], y[k, n : 2 * n], y[k, 2 * n : 2 * n + dz.size]
        accelerations(sys, work, times[k], q, v, z, dz, qdd[k], drag, pull)
        energy[k, 0], energy[k, 1], energy[k, 2] = energies(sys, work, q, v, z)
        for c in range(sys.constraints.size):
            value, rate, _ = constraint(sys.constraints[c], work.lengths, work.signal)
            multipliers[k, c] = work.reactions[c].multiplier
            errors[k, 0] = max(errors[k, 0], abs(value))
            errors[k, 1] = max(errors[k, 1], abs(rate))
