"""Where a point must be sent so that it is on its path with beams and transmissions bent as at rest.

p*  +=  p - p(equilibrium with the motors held where the rigid mechanism has its point at p*)
"""

import numpy as np

from fmbd.analyses.arrangement import arrange
from fmbd.analyses.guide import Guide
from fmbd.analyses.rest import come_to_rest
from fmbd.errors import AnalysisError
from fmbd.system import System
from fmbd.system.start import relax_rotors

Array = np.ndarray

#: Places of the path at which equilibria are found.
PLACES = 31
#: A miss [m] that is small enough.
SMALL = 1e-8
_ITERATIONS = 20


def compensated(system: System, guide: Guide, times: Array, path: Array, span: float) -> Array:
    """A path (nt, 2) that takes up the static deflection of a given one, bit by bit over a time [s] from the start.

    Raises AnalysisError where there is no equilibrium near.
    """
    from scipy.interpolate import make_interp_spline

    rows = np.unique(np.linspace(0, times.size - 1, PLACES).round().astype(int))
    qs = guide.follow_path(times, path)[rows]
    offsets = np.zeros((rows.size, 2))
    for n, (q, k) in enumerate(zip(qs, rows, strict=True)):
        near = offsets[max(n - 1, 0)]
        offsets[n] = _offset(system, guide, q, path[k], near, float(times[k]))
    offset = make_interp_spline(times[rows], offsets, k=min(5, rows.size - 1))(times)
    x = np.clip(times / max(span, times[1]), 0.0, 1.0)
    share = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    return np.asarray(path + share[:, None] * offset)


def _offset(system: System, guide: Guide, q: Array, place: Array, near: Array, t: float) -> Array:
    """How far beyond a place (2,) the rigid mechanism must be sent so that the point comes to rest there."""
    target = place + near
    arrangement = arrange(system, t, list(system.model.motors), standing=True)
    for _ in range(_ITERATIONS):
        q = guide.at_point(q, target, t)
        held = relax_rotors(system.lowered, guide.mechanism, q)
        rest, _ = come_to_rest(arrangement, held, np.array(system.start.z))
        miss = place - guide.place(rest.state[0], t)
        target += miss
        if np.abs(miss).max() < SMALL:
            return target - place
    raise AnalysisError(f"at t = {t:.6g} s the mechanism bends too much for its deflection to be compensated")
