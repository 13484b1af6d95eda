"""Lower springs, friction and stops of all kinds to the records of one array (see planar.laws)."""

from typing import Any

import numpy as np

from fmbd.model.laws import ForceTable, Friction, Limits, SpringLaw
from fmbd.model.motors import Transmission
from fmbd.planar import laws
from fmbd.planar.arrays import SPRING
from fmbd.system.bodies import fill

Array = np.ndarray


class SpringTable:
    """Collects springs in the order of their indices; `names` are those of their forces."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self._springs: list[dict[str, Any]] = []
        self._curves = [np.zeros((0, 6))]

    def __len__(self) -> int:
        return len(self.names)

    def add_spring(self, name: str, path: int, spring: SpringLaw | Transmission, rest: float = 0.0) -> None:
        """A spring and damper: linear, with backlash, or by a table."""
        if spring.backlash is not None:
            half = 0.5 * spring.backlash.gap
            p = (-half, half, spring.stiffness, spring.damping, spring.backlash.transition)
            self._add(name, path, rest=rest, kind=laws.BACKLASH, p=p)
        elif isinstance(spring, SpringLaw) and spring.force_table is not None:
            start, curve = sum(map(len, self._curves)), _pieces(spring.force_table)
            self._curves.append(curve)
            place = {"start": start, "count": len(curve)}
            self._add(name, path, d=spring.damping, rest=rest, kind=laws.TABLE, **place)
        else:
            self._add(name, path, k=spring.stiffness, d=spring.damping, rest=rest)

    def add_friction(self, name: str, path: int, friction: Friction) -> None:
        """Friction: viscous, and dry."""
        speeds = friction.stribeck_speed or 1.0, friction.transition_speed  # unused without a fall
        p = (friction.coulomb, friction.static, *speeds, 0.0)
        kind = laws.FRICTION if friction.static > 0.0 else laws.LINEAR
        self._add(name, path, d=friction.viscous, kind=kind, p=p)

    def add_stops(self, name: str, path: int, limits: Limits) -> None:
        """Stops of a joint coordinate."""
        lower = -np.inf if limits.lower is None else limits.lower
        upper = np.inf if limits.upper is None else limits.upper
        p = (lower, upper, limits.stiffness, limits.damping, limits.transition)
        self._add(name, path, kind=laws.STOP, p=p)

    def _add(self, name: str, path: int, **fields: Any) -> None:
        self.names.append(name)
        self._springs.append({"pathway": path} | fields)

    def lower(self) -> tuple[Any, Array]:
        """Spring records, pieces of the tables (pieces, 6)."""
        return fill(SPRING, self._springs), np.concatenate(self._curves)


def _pieces(table: ForceTable) -> Array:
    """Rows (s, c0, c1, c2, c3, E): from the stretch s on, the tension c0 + c1 x + c2 x^2 + c3 x^3; the energy at s.

    The first row is the straight line before the table, the last the one behind it. E is zero where the stretch is.
    """
    s, T = np.asarray(table.stretches), np.asarray(table.forces)
    c = np.zeros((s.size + 1, 4))
    if table.interpolation == "linear":
        c[1:-1, 0], c[1:-1, 1] = T[:-1], np.diff(T) / np.diff(s)
    else:
        from scipy.interpolate import PchipInterpolator

        c[1:-1] = PchipInterpolator(s, T).c[::-1].T  # c is (4, n-1), highest power first
    last = s[-1] - s[-2]
    c[0, :2] = c[1, :2]
    c[-1, :2] = T[-1], c[-2, 1:] @ (1.0, 2.0 * last, 3.0 * last**2)
    knots = np.insert(s, 0, s[0])
    energy = np.insert(np.cumsum(_work(c[:-1], np.diff(knots))), 0, 0.0)
    at_zero = max(int(np.searchsorted(knots, 0.0, "right")) - 1, 0)
    energy -= energy[at_zero] + _work(c[at_zero], -knots[at_zero])
    return np.column_stack([knots, c, energy])


def _work(c: Array, x: Array) -> Array:
    """Integral from 0 to x of the cubics with coefficients c (..., 4)."""
    powers = np.arange(1, 5)
    return (c * np.asarray(x)[..., None] ** powers / powers).sum(axis=-1)
