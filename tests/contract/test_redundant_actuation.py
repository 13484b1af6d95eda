"""More motors than degrees of freedom: gravity compensation is the least of all torques that hold the mechanism.

A bar on parallel cranks, each with its motor. By virtual work the torques of the cranks, which all turn by the same
angle phi, need only add up to V'(phi); the least share it equally.
"""

from typing import Any

import numpy as np
import pytest
from mechanisms import cut_at
from numpy.testing import assert_allclose
from physics import build

ANGLE = 0.5
LENGTH = 0.4
CUTS = [["head1"], ["foot0"], ["head1", "head2"], ["head0", "foot2"], ["foot0", "foot1"]]


def bar_on_cranks(count: int, computed: str) -> dict[str, Any]:
    """The bar's mass is nearer to the first crank; so a share by multipliers, too, would not be an equal one."""
    points = {"points": {"e": [LENGTH, 0]}}
    crank = {"type": "rigid", "mass": 1, "inertia": 0.1, "center_of_mass": [0.2, 0]} | points
    heads = {"points": {f"e{k}": [k, 0] for k in range(count)}}
    bar = {"type": "rigid", "mass": 3, "inertia": 0.1, "center_of_mass": [0.2, 0]} | heads
    compensation = {"type": "gravity_compensation", "computed": computed}
    data: dict[str, Any] = {
        "fmbd": 1,
        "gravity": [0, -9.81],
        "ground": {"points": {f"B{k}": [k, 0] for k in range(count)}},
        "bodies": {"bar": bar},
        "joints": {},
        "motors": {},
        "controllers": {"law": {"type": "pd", "kp": 0, "target": ANGLE, "feedforward": compensation}},
        "initial": {"joints": {"foot0": ANGLE}, "hints": {"head0": -ANGLE}},
    }
    for k in range(count):
        data["bodies"][f"c{k}"] = crank
        data["joints"][f"foot{k}"] = {"type": "revolute", "between": [f"ground.B{k}", f"c{k}.origin"]}
        data["joints"][f"head{k}"] = {"type": "revolute", "between": [f"c{k}.e", f"bar.e{k}"]}
        data["motors"][f"m{k}"] = {"type": "torque", "joint": f"foot{k}", "torque": "law"}
        if k > 0:
            data["initial"]["hints"][f"foot{k}"] = ANGLE
    return data


@pytest.mark.parametrize("computed", ["target", "online"])
@pytest.mark.parametrize("cut", CUTS)
def test_the_least_torques_hold_the_bar(cut, computed):
    """V' = (m l + sum m_k s_k) g cos(phi), wherever the loops are cut; a third crank is a redundant constraint, too."""
    count = len(cut) + 1
    system = build(cut_at(bar_on_cranks(count, computed), cut))
    assert set(system.tree.cut) == set(cut)
    share = 9.81 * (3 * LENGTH + count * 0.2) * np.cos(ANGLE) / count
    assert_allclose(system.matrices().u, share, rtol=1e-12)
    acceleration, _ = system.accelerations(system.start.q, system.start.v)
    assert_allclose(system.work.drives["input"], share, rtol=1e-12)
    assert_allclose(acceleration, 0, atol=1e-11)
