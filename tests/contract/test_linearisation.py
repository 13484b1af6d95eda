"""The linearisation in independent coordinates against finite differences of the nonlinear right-hand side.

x' of states a little beside the base state, as the compiled accelerations give it, differenced and extrapolated; what
is differenced knows of no derivative. At the start, in motion, with loops closed and cut, controllers and currents.
"""

import mechanisms
import numpy as np
import pytest
from parts import SAMPLES, model
from physics import build

from fmbd.analyses.arrangement import arrange
from fmbd.analyses.linearisation import Linearisation

LONE = [name for name in SAMPLES if "table" not in name]  # the file of a table is not there


def nearby(system, seed):
    """A state beside the start, in motion; loops are closed to first order."""
    random = np.random.default_rng(seed)
    start = system.start
    motions = Linearisation(arrange(system, 0.0, []), start.q, start.v, start.z).motions
    size = np.where(system.elastic, 0.01, 0.1)
    dq, dv = (
        system.to_nodal(
            motions.N @ (motions.N.T @ motions.M @ system.to_modal(random.normal(size=size.size) * size))
        )
        for _ in range(2)
    )
    return start.q + 0.1 * dq, start.v + dv, start.z + 0.1 * random.normal(size=start.z.size)


def differences(lin, step):
    """x' differenced by x, shape (nx, nx)."""
    system, arrangement = lin.system, lin.arrangement
    q, v, z = lin.state
    to_y = lin.motions.N.T @ lin.motions.M

    def rate(x):
        dq, dv, dz = (part[:, 0] for part in lin.directions(x[:, None]))
        moved = system.to_modal(q + dq), system.to_modal(v + dv), z + dz
        a, zdot = arrangement.rates(*moved)
        return np.concatenate([to_y @ moved[1], to_y @ a, zdot[lin.states]])

    columns = []
    for k in range(lin.size):
        e = np.eye(lin.size)[k]
        # in steps that turn or shift nothing by more than `step`
        e *= step / max(np.abs(part).max(initial=0.0) for part in lin.directions(e[:, None]))
        near, far = rate(e) - rate(-e), rate(2 * e) - rate(-2 * e)
        columns.append((8 * near - far) / (12 * e[k]))
    return np.array(columns).T


def mismatch(system, seed=None):
    start, t = system.start, 0.05
    state = (start.q, start.v, start.z) if seed is None else nearby(system, seed)
    lin = Linearisation(arrange(system, t, []), *state)
    if not lin.size:
        return 0.0
    expected = differences(lin, 1e-5)
    return np.abs(lin.matrix - expected).max() / np.abs(expected).max()


@pytest.mark.parametrize("name", mechanisms.MECHANISMS)
@pytest.mark.parametrize("seed", [None, 0, 1])
def test_mechanisms(name, seed):
    assert mismatch(build(mechanisms.MECHANISMS[name]()), seed) < 1e-6


@pytest.mark.parametrize("name", LONE)
def test_every_kind_of_part(name):
    """Compensation of gravity computed online among them, which the tangent of the kernels leaves out."""
    assert mismatch(build(model(SAMPLES[name])), 2) < 1e-6
