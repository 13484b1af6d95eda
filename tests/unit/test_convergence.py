"""Orders and error bars of values whose error is known: Q + C h^p."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fmbd.studies.convergence import Size, convergence

T = np.linspace(0, 1, 101)
EXACT, COURSE = np.sin(9 * T), 0.3 * np.cos(5 * T)


def family(sizes, order, beyond=0.0):
    """A signal with an error of this order, and of one order more."""
    return [EXACT + COURSE * h**order + beyond * np.sin(3 * T) * h ** (order + 1) for h in sizes]


@pytest.mark.parametrize("sizes", [[1, 1 / 2, 1 / 4, 1 / 8], [1, 1 / 2, 1 / 3, 1 / 5]])
@pytest.mark.parametrize("order", [1, 2, 4])
def test_an_order_is_found_whatever_the_ratio_of_sizes(order, sizes):
    found = convergence(family(sizes, order), sizes)
    assert found.is_settled
    assert_allclose([one.order for one in found.orders], order, rtol=1e-9)
    assert_allclose([one.agreement for one in found.orders], 1)
    assert_allclose(found.extrapolated, EXACT, rtol=0, atol=1e-12)


def test_the_error_bar_holds_the_error_with_a_factor_of_safety():
    sizes = [1, 0.5, 0.25, 0.125]
    values = family(sizes, 2)
    found = convergence(values, sizes)
    error = Size.of(values[-1] - EXACT)
    assert_allclose(found.bar.largest, 1.25 * error.largest)
    assert_allclose(found.bar.mean, 1.25 * error.mean)
    for bound, value in zip(found.errors, values):
        assert bound.largest >= np.abs(value - EXACT).max()


def test_it_holds_also_where_the_error_has_further_terms():
    sizes = [1, 0.5, 0.25, 0.125, 0.0625]
    values = family(sizes, 2, beyond=0.2)
    found = convergence(values, sizes)
    assert found.is_settled
    assert found.bar.largest >= np.abs(values[-1] - EXACT).max()


def test_numbers_and_vectors_converge_as_signals_do():
    sizes = [1, 0.5, 0.25, 0.125]
    number = convergence([np.float64(3 - h**4) for h in sizes], sizes)
    assert number.is_settled
    assert_allclose([number.order, number.extrapolated], [4, 3])
    vector = convergence([np.column_stack([value, 2 * value]) for value in family(sizes, 3)], sizes)
    assert_allclose(vector.order, 3)
    assert_allclose(vector.size.largest, np.sqrt(5) * Size.of(family(sizes, 3)[-1]).largest)


@pytest.mark.parametrize(
    ("errors", "guess"),
    [
        ([1, 0.25], 0.75),  # two members: their difference
        ([1, 0.5, 0.25], 0.25),  # three confirm no order; the last difference, as for order 1
        ([1, 0.1, 0.05], 0.05),  # no more is believed
        ([1, 0.9, 0.5, 0.25], 0.25 / 0.6),  # r^p = 0.4 / 0.25
        ([1, 0.7, 0.4, 0.15], 0.25 / (2**0.5 - 1)),  # slow: by order 1/2 the error is 2.4 last differences
        ([1, 0.5, 0.25, 0.25], 0.25),  # no longer shrinks, by chance perhaps: the range of the last three
        ([1, -0.5, 0.25, -0.125], 0.75),  # swings about the limit
        ([1, 0.5, 0.4, 0.1], 0.4),  # now slow, now fast
    ],
)
def test_what_is_not_in_the_asymptotic_range_gets_a_cautious_bar(errors, guess):
    sizes = 0.5 ** np.arange(len(errors))
    found = convergence([EXACT + COURSE * error for error in errors], sizes)
    assert not found.is_settled
    assert found.extrapolated is None
    assert_allclose(found.bar.mean, 3 * guess * Size.of(COURSE).mean)
    assert_allclose(found.bar.largest, 3 * guess * Size.of(COURSE).largest)
    assert found.bar.mean > abs(errors[-1]) * Size.of(COURSE).mean


def test_sizes_far_apart_do_not_make_a_guess_bold():
    """Tolerances a hundred times apart: by order 1 the error would be a hundredth of the last difference."""
    found = convergence([EXACT + COURSE * h for h in (1e-2, 1e-4, 1e-6)], [1e-2, 1e-4, 1e-6])
    assert_allclose(found.bar.mean, 3 * found.steps[-1].mean)


def test_an_order_whose_differences_change_their_course_counts_for_nothing():
    """Sizes of differences fall by four each time, but they point elsewhere each time."""
    shapes = [np.sin(k * np.pi * T) for k in (1, 2, 3, 4)]
    values = [EXACT + shape * 4.0**-k for k, shape in enumerate(shapes)]
    found = convergence(values, [1, 0.5, 0.25, 0.125])
    assert max(one.agreement for one in found.orders) < 0.8
    assert not found.is_settled


def test_a_disturbance_widens_the_bar_and_unsettles_the_order_when_it_is_large():
    sizes = [1, 0.5, 0.25, 0.125]
    values = family(sizes, 2)
    free = convergence(values, sizes)
    slight = convergence(values, sizes, free.steps[-1] * 0.05)
    assert slight.is_settled
    assert_allclose(slight.bar.mean, free.bar.mean + 0.05 * free.steps[-1].mean)
    assert not convergence(values, sizes, free.steps[-1] * 0.2).is_settled
