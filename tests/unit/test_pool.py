"""Jobs side by side: results, failures, and a process that dies."""

import os
from functools import partial

import pytest

from fmbd.studies.pool import side_by_side


def doubled(x, report):
    report(0.5)
    return 2 * x


def failing(report):
    raise ValueError("no")


def dying(report):
    os._exit(1)


@pytest.mark.parametrize("workers", [1, 2])
def test_each_job_gives_its_result_or_its_exception(workers):
    shares = []
    jobs = [partial(doubled, 1), failing, partial(doubled, 3)]
    found = dict(side_by_side(jobs, workers, shares.append))
    assert (found[0], found[2]) == (2, 6)
    assert isinstance(found[1], ValueError)
    assert 0 < max(shares) <= 1


def test_a_process_that_dies_takes_no_other_job_with_it():
    jobs = [partial(doubled, 1), dying, partial(doubled, 3), partial(doubled, 4)]
    found = dict(side_by_side(jobs, 2))
    assert [found[k] for k in (0, 2, 3)] == [2, 6, 8]
    assert isinstance(found[1], MemoryError)
