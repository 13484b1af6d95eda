"""How right a result is, from the same result at several resolutions: orders, Richardson's extrapolation, error bars.

    Q_k    the quantity at the k-th resolution, k = 1 ... m, of size h_k: over time (nt,), (nt, columns), or a number ()
    D_k    Q_k - Q_(k+1), differences of successive resolutions, |D| in the mean over time (RMS)
    p      observed order: (h1^p - h2^p) / (h2^p - h3^p) = |D_1| / |D_2|, ln(|D_1| / |D_2|) / ln r if h1/h2 = h2/h3 = r
    c      agreement of two differences, their correlation: 1 where the error keeps its course and only shrinks

If Q_k = Q + C h_k^p with a C that does not depend on h, then p is the same for each three resolutions, c is 1, and the
error of the finest is D_(m-1) / (r^p - 1): the results are in the asymptotic range. Only then is that said, with the
factor of safety 1.25 of P. J. Roache, Verification and Validation in Computational Science and Engineering, Hermosa,
1998. Elsewhere the factor is 3:

    on |D_(m-1)| / (r^p - 1), but with a p of 1/2 at least, where the last two differences shrink on one course; never
    less than on |D_(m-1)| itself (W. L. Oberkampf and C. J. Roy, Verification and Validation in Scientific Computing,
    Cambridge, 2010, section 8.7)
    on the range of the last three results, where they do not: they swing, or go astray (L. Eca and M. Hoekstra, Journal
    of Computational Physics 262, 2014, pp. 104-130)
    on |D_1| where there is no other
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

Array = np.ndarray

#: In the asymptotic range two orders in a row differ by no more than this share, and differences agree by this much.
SAME_ORDER = 0.2
AGREEING = 0.8
SMALLEST_ORDER = 0.5
#: Factors of safety where an order is settled, and where none is.
SETTLED, UNSETTLED = 1.25, 3.0

_LARGEST_ORDER = 20.0
_ROUND_OFF = 1e-11


@dataclass(frozen=True)
class Size:
    """The size of a quantity, or of a difference: largest over time, in the mean (RMS), at the end.

    Of several columns it is the length of the vector that they are.
    """

    largest: float
    mean: float
    end: float

    @classmethod
    def of(cls, values: Array) -> "Size":
        """The size of values of shape (nt,), (nt, columns) or ()."""
        values = np.asarray(values, float)
        length = np.abs(values).reshape(-1) if values.ndim < 2 else np.linalg.norm(values, axis=1)
        return cls(float(length.max()), float(np.sqrt(np.mean(length**2))), float(length[-1]))

    def __mul__(self, factor: float) -> "Size":
        return Size(self.largest * factor, self.mean * factor, self.end * factor)

    def or_larger(self, *others: "Size") -> "Size":
        """The largest of each."""
        sizes = (self, *others)
        return Size(max(s.largest for s in sizes), max(s.mean for s in sizes), max(s.end for s in sizes))

    def __add__(self, other: "Size") -> "Size":
        return Size(self.largest + other.largest, self.mean + other.mean, self.end + other.end)


@dataclass(frozen=True)
class Order:
    """What three resolutions in a row show."""

    order: float  #: p, nan if the differences do not shrink as any positive order would have them
    agreement: float  #: c, -1 to 1


@dataclass(frozen=True)
class Convergence:
    """A quantity at several resolutions, from coarse to fine."""

    differences: tuple[Size, ...]  #: to the finest, of all but the finest
    steps: tuple[Size, ...]  #: |D_k|
    orders: tuple[Order, ...]  #: of each three in a row
    is_settled: bool  #: in the asymptotic range
    bar: Size  #: error bar of the finest
    size: Size  #: of the finest itself
    extrapolated: Array | None  #: Richardson's, where settled

    @property
    def order(self) -> float:
        """The order observed in the three finest; nan where there is none."""
        return self.orders[-1].order if self.orders else np.nan

    @property
    def is_exact(self) -> bool:
        """Whether the two finest are the same, but for round-off."""
        return self.steps[-1].mean <= _ROUND_OFF * self.size.mean

    @property
    def errors(self) -> tuple[Size, ...]:
        """Bounds of the error of each: difference to the finest, and its error bar."""
        return (*(difference + self.bar for difference in self.differences), self.bar)

    def shares(self) -> tuple[float, ...]:
        """The largest error over time of each, in shares of the largest value of the finest."""
        return tuple(
            error.largest / self.size.largest if self.size.largest else np.nan for error in self.errors
        )


def convergence(
    values: Sequence[Array], sizes: Sequence[float], disturbance: Size | None = None
) -> Convergence:
    """What `values`, two or more from coarse to fine, at resolutions of sizes h (any unit) tell of their limit.

    disturbance: size of an error that the values have besides; it is added to the error bar, and beyond a tenth of the
    last difference it unsettles the order
    """
    differences = [np.asarray(a, float) - b for a, b in pairwise(values)]
    steps = tuple(Size.of(difference) for difference in differences)
    orders = tuple(
        observed_order(differences[k], differences[k + 1], sizes[k : k + 3]) for k in range(len(values) - 2)
    )
    settled = is_settled(orders) and (disturbance is None or disturbance.mean <= 0.1 * steps[-1].mean)
    bar, extrapolated = _cautious(differences, orders, sizes) * UNSETTLED, None
    if settled:
        gain = (sizes[-2] / sizes[-1]) ** orders[-1].order - 1.0
        bar, extrapolated = steps[-1] * (SETTLED / gain), values[-1] - differences[-1] / gain
    return Convergence(
        differences=tuple(Size.of(np.asarray(a, float) - values[-1]) for a in values[:-1]),
        steps=steps,
        orders=orders,
        is_settled=settled,
        bar=bar if disturbance is None else bar + disturbance,
        size=Size.of(values[-1]),
        extrapolated=extrapolated,
    )


def _cautious(differences: Sequence[Array], orders: Sequence[Order], sizes: Sequence[float]) -> Size:
    """What the error of the finest is guessed from where no order is settled."""
    last = Size.of(differences[-1])
    if not orders:
        return last
    if orders[-1].order > 0.0 and orders[-1].agreement >= AGREEING:
        ratio = abs(sizes[-2] / sizes[-1])
        return last * max(1.0, 1.0 / (ratio ** max(orders[-1].order, SMALLEST_ORDER) - 1.0))
    both = Size.of(differences[-2]), Size.of(differences[-2] + differences[-1])
    return last.or_larger(*both)


def is_settled(orders: Sequence[Order]) -> bool:
    """Whether two orders in a row, of differences that agree, are about the same."""
    if len(orders) < 2:
        return False
    before, last = orders[-2:]
    return (
        last.order >= SMALLEST_ORDER
        and last.agreement >= AGREEING
        and before.agreement >= AGREEING
        and abs(last.order - before.order) <= SAME_ORDER * last.order
    )


def observed_order(first: Array, second: Array, sizes: Sequence[float]) -> Order:
    """The order that two differences in a row show, of resolutions of three `sizes`, from coarse to fine."""
    a, b = Size.of(first).mean, Size.of(second).mean
    if a == 0.0 or b == 0.0:
        return Order(np.nan, np.nan)
    agreement = float(np.mean(first * second)) * np.size(first) / _count(first) / (a * b)
    h1, h2, h3 = np.abs(sizes) / np.abs(sizes[2])

    def ratio(p: float) -> float:
        return (h1**p - h2**p) / (h2**p - h3**p)

    low, high = 1e-6, _LARGEST_ORDER
    if not ratio(low) < a / b < ratio(high):
        return Order(np.nan, agreement)
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if ratio(middle) < a / b else (low, middle)
    return Order(0.5 * (low + high), agreement)


def _count(values: Array) -> int:
    """Output times."""
    return len(values) if np.ndim(values) else 1
