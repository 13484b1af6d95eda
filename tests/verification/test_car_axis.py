"""A car on a driven axle: Test Set for IVP Solvers (F. Mazzia, C. Magherini), problem CARAXIS.

There it is an index-3 problem in Cartesian coordinates, with two constraints. As two joints, one of them
driven, it has no constraint left; with the other cut, the constraint that moves with the axle is back.
"""

import pytest
from numpy.testing import assert_allclose
from simulation import at, simulate

LEFT, RIGHT = [0.0493455784275402809, 0.496989460230171154], [1.04174252488542152, 0.373911027265361257]
LEFT_RATE = [-0.0770583684040972358, 0.00744686658723778553]
RIGHT_RATE = [0.0175568157537232222, 0.770341043779251976]

ROAD = {"type": "revolute", "between": ["ground.origin", "axle.origin"], "driven": "asin(0.1*sin(10*t))"}
CUT = {
    "joints": {
        "road": ROAD,
        "rod": {"type": "pin_in_slot", "between": ["axle.origin", "car.left"], "axis": [0, 1], "cut": True},
        "free": {"type": "free", "between": ["ground.origin", "car.left"]},
    },
    "initial": {
        "joints": {"free": {"x": 0, "y": 0.5, "angle": 0}},
        "rates": {"free": {"x": -0.5, "y": 0, "angle": 0}},
    },
}


@pytest.mark.parametrize("changes", [{}, CUT], ids=["tree", "cut"])
def test_car_after_three_seconds(changes):
    run = simulate("verification/car_axis.yaml", {"simulation.rtol": 1e-12} | changes)
    row = at(run, 3)
    assert_allclose(run["car.left.position"][row], LEFT, rtol=0, atol=1e-11)
    assert_allclose(run["car.right.position"][row], RIGHT, rtol=0, atol=1e-11)
    assert_allclose(run["car.left.velocity"][row], LEFT_RATE, rtol=0, atol=1e-9)
    assert_allclose(run["car.right.velocity"][row], RIGHT_RATE, rtol=0, atol=1e-9)
    assert abs(run["energy.balance"]).max() < 1e-13
