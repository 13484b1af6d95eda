"""Two parallelograms of equal bars, four_bars.case.yaml: what becomes of them at singular positions.

When the bars lie flat, twice a turn, the constraints are dependent and the mechanism could fold; the motion of the
benchmark goes straight on.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from simulation import MODELS, at, simulate

from fmbd.studies.cases import load_case

# t, x and y of the first knee
PLACES = load_case(MODELS / "verification" / "four_bars.case.yaml").file.expect[0].at
TABLE = np.array([[t, *place] for t, place in PLACES.items()])


def test_the_model_as_it_is_passes_ten_singular_positions():
    run = simulate("four_bars.yaml")
    assert run.status == "complete"
    rows = at(run, TABLE[:, 0])
    assert_allclose(run["crank0.end.position"][rows], TABLE[:, 1:], rtol=0, atol=1e-6)


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
