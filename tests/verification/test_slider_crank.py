"""Haug's slider-crank with spring, damper and force: SUNDIALS, examples/ida/serial/idaSlCrank_dns."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from simulation import at, columns, simulate

# t, crank angle, position of the slider, rod angle; recomputed to 1e-13, the program's output has five digits
TABLE = np.array([
    [1, 1.3154205709, 1.0014918072, -0.5049734706],
    [2, 0.5790388120, 1.3803352720, -0.2771440957],
    [3, -0.4471130529, 1.4272025983, 0.2179023887],
    [4, -1.2064316477, 1.0623426558, 0.4860931634],
    [5, -1.4299969676, 0.9390306136, 0.5178947565],
    [7.5, 0.1804184667, 1.4878513158, -0.0898414420],
    [10, 1.2756758487, 1.0235785590, -0.4988130492],
])  # fmt: skip


@pytest.mark.parametrize("method", ["dop853", "rk45", "baumgarte"])
def test_slider_crank(method):
    """Every method gives all the digits of the table."""
    run = simulate("slider_crank.yaml", {"simulation.rtol": 1e-12, "simulation.method": method})
    found = columns(run, "pivot.angle", "slider.x", "slider.angle")
    assert_allclose(found[at(run, TABLE[:, 0])], TABLE[:, 1:], rtol=0, atol=1e-10)
    assert np.abs(run["energy.balance"]).max() < 1e-10
