"""Polynomials in one variable: properties of a tapered section along a beam."""

from itertools import zip_longest


class Polynomial(tuple[float, ...]):
    """Coefficients in ascending powers; + - * with polynomials and numbers."""

    __slots__ = ()

    def __add__(self, other: "Polynomial | float") -> "Polynomial":  # type: ignore[override]
        return Polynomial(a + b for a, b in zip_longest(self, _coefficients(other), fillvalue=0.0))

    def __mul__(self, other: "Polynomial | float") -> "Polynomial":  # type: ignore[override]
        factor = _coefficients(other)
        product = [0.0] * (len(self) + len(factor) - 1)
        for i, a in enumerate(self):
            for j, b in enumerate(factor):
                product[i + j] += a * b
        return Polynomial(product)

    def __sub__(self, other: "Polynomial | float") -> "Polynomial":
        return self + Polynomial(_coefficients(other)) * -1.0

    def __truediv__(self, other: float) -> "Polynomial":
        return Polynomial(a / other for a in self)

    def __pow__(self, exponent: int) -> "Polynomial":
        power = Polynomial((1.0,))
        for _ in range(exponent):
            power = power * self
        return power

    __rmul__ = __mul__  # type: ignore[assignment]


def linear(start: float, end: float, length: float) -> Polynomial:
    """From `start` at 0 to `end` at `length`; a constant when they are equal."""
    return Polynomial((start,) if start == end else (start, (end - start) / length))


def _coefficients(value: "Polynomial | float") -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)
