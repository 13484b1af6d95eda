"""Two parallelograms of equal bars: IFToMM library of multibody benchmarks, problem A02, N = 2.

One degree of freedom, phi'' = g r sin phi with r = ((N + 1)/2 + N) / ((N + 1)/3 + N), phi the angle of the
cranks from the vertical. When the bars lie flat, twice a turn, the constraints are dependent and the
mechanism could fold; the motion of the benchmark goes straight on.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from simulation import at, simulate

# t, x and y of the first knee, by the equation above
TABLE = np.array([
    [1, -0.1950203019, -0.9807992057],
    [2, 0.0578157958, 0.9983272679],
    [3, -0.5493397393, -0.8355990970],
    [4, 0.1176161024, 0.9930591385],
    [5, -0.8113104610, -0.5846155454],
    [10, 0.3284581115, 0.9445185382],
])  # fmt: skip
SPEED_AT_10 = [1.4230514702, -0.4948688455]


def test_ten_singular_positions_are_passed():
    run = simulate("four_bars.yaml")
    assert run.status == "complete"
    rows = at(run, TABLE[:, 0])
    assert_allclose(run["crank0.end.position"][rows], TABLE[:, 1:], rtol=0, atol=1e-6)
    assert_allclose(run["crank0.end.velocity"][rows[-1]], SPEED_AT_10, rtol=0, atol=1e-6)


def test_projection_passes_the_first_singular_position():
    changes = {"simulation.method": "dop853", "simulation.rtol": 1e-9, "simulation.duration": 1}
    run = simulate("four_bars.yaml", changes)
    assert_allclose(run["crank0.end.position"][-1], TABLE[0, 1:], rtol=0, atol=1e-8)
    assert run["constraint_error"].max() < 1e-9


@pytest.mark.parametrize("rtol", [1e-7, 1e-8, 1e-9, 1e-10])
def test_never_the_other_branch(rtol):
    """Ever closer to the flat positions, projection passes them or the run stops: what it has written is right."""
    run = simulate("four_bars.yaml", {"simulation.method": "dop853", "simulation.rtol": rtol})
    assert run.status == "complete" or "singular" in run.status
    known = TABLE[TABLE[:, 0] <= run.time[-1]]
    assert len(known) > 0
    assert_allclose(run["crank0.end.position"][at(run, known[:, 0])], known[:, 1:], rtol=0, atol=1e3 * rtol)
