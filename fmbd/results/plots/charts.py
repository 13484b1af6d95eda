"""What a figure shows, before anything is drawn: charts of panels of curves, and how axes are named.

The figures of `fmbd plot` and the plots of a report are drawn from the same charts.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Longest name of a vertical axis that fits beside a panel.
AXIS_CHARACTERS = 24

WORDS = {
    "m": "length",
    "m/s": "velocity",
    "m/s^2": "acceleration",
    "rad": "angle",
    "rad/s": "angular velocity",
    "rad/s^2": "angular acceleration",
    "N": "force",
    "N m": "moment",
    "Pa": "stress",
    "J": "energy",
    "V": "voltage",
    "A": "current",
    "s": "time",
    "Hz": "frequency",
}

PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
SMALL = ("m", "rad", "N", "Pa", "J", "V", "A", "s")
LARGE = ("N", "Pa", "J", "V", "A")


@dataclass(frozen=True)
class Curve:
    """y over x, both of shape (n,), in SI units.

    look: a line, marked points that lines join, or a guide to the eye beside what was computed
    """

    label: str
    x: Array
    y: Array
    look: Literal["line", "points", "guide"] = "line"


@dataclass(frozen=True)
class Panel:
    """Curves on one pair of axes: the name and the SI unit of what is upwards.

    together: how the curves belong together: each on its own, a `family` in order such as one shape at several times,
    or the `same` quantity of several runs
    """

    quantity: str
    unit: str
    curves: tuple[Curve, ...]
    logarithmic: bool = False
    title: str = ""
    together: Literal["", "family", "same"] = ""


@dataclass(frozen=True)
class Chart:
    """Rows of panels over one horizontal axis; `across` is its name and unit, "" for none.

    name: short, for file names; title: for headings
    """

    name: str
    title: str
    rows: tuple[tuple[Panel, ...], ...]
    across: tuple[str, str] = ("time", "s")
    logarithmic_across: bool = False

    @property
    def panels(self) -> tuple[Panel, ...]:
        """All panels, row by row."""
        return tuple(panel for row in self.rows for panel in row)


def panels_by_unit(series: Iterable[tuple[str, str, Array]], x: Array) -> list[Panel]:
    """Curves that are given by name, unit and values (n,), those of one unit in one panel."""
    groups: dict[str, list[tuple[str, Array]]] = {}
    for name, unit, values in series:
        groups.setdefault(unit, []).append((name, values))
    return [panel(unit, group, x) for unit, group in groups.items()]


def panel(
    unit: str, series: Sequence[tuple[str, Array]], x: Array, quantity: str = "", logarithmic: bool = False
) -> Panel:
    """One panel of curves of one unit; what their names share becomes the name of the axis."""
    labels, shared = labels_of([name for name, _ in series], unit)
    curves = tuple(Curve(label, x, values) for label, (_, values) in zip(labels, series))
    return Panel(quantity or shared, unit, curves, logarithmic)


def labels_of(names: Sequence[str], unit: str) -> tuple[list[str], str]:
    """Labels for a legend, and the name of the axis: what all names share is taken out of the labels.

    `a.end.deflection`, `b.end.deflection` give the labels `a` and `b` on the axis `end deflection`.
    """
    parts = [name.split(".") for name in names]
    shared = [part for part in parts[0] if all(part in others for others in parts)]
    if len(names) == 1:
        shared = parts[0][1:]
    labels = [".".join(part for part in own if part not in shared) for own in parts]
    axis = " ".join(shared).replace("_", " ")
    if not axis or len(axis) > AXIS_CHARACTERS or not all(labels) or len(set(labels)) < len(labels):
        return list(names), WORDS.get(unit, "value")
    return labels, axis


def scaled(unit: str, largest: float) -> tuple[float, str]:
    """Factor and unit by which values up to `largest` in an SI unit read well: 0.012 m as 12 mm."""
    first = unit.split(" ")[0].split("/")[0]
    power = int(np.floor(np.log10(largest))) if 0.0 < largest < np.inf else 0
    exponent = 0
    if power < -1 and first in SMALL:
        exponent = max(3 * ((power + 1) // 3), min(PREFIXES))
    elif power >= 4 and first in LARGE:
        exponent = min(3 * (power // 3), max(PREFIXES))
    return 10.0**-exponent, typeset(PREFIXES[exponent] + unit)


def typeset(unit: str) -> str:
    """A unit as it is printed: m/s² for m/s^2."""
    return re.sub(r"\((\w+)\)", r"\1", unit).replace("^2", "²").replace("Ohm", "Ω")


def scale_of(panel: Panel) -> tuple[float, str]:
    """Factor and unit for all curves of a panel; logarithmic axes keep SI units."""
    if panel.logarithmic:
        return 1.0, typeset(panel.unit)
    finite = [np.abs(curve.y[np.isfinite(curve.y)]).max(initial=0.0) for curve in panel.curves]
    return scaled(panel.unit, max(finite, default=0.0))
