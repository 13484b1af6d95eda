"""Charts that every run has by name: joints, beams, constraints, energy, motors, reactions, shapes.

The first three are figures 4, 5 and 6 of Hoang et al. (2022), for any mechanism.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fmbd.model import Beam
from fmbd.results.layout import ENERGIES
from fmbd.results.plots.charts import Chart, Curve, Panel, panel, panels_by_unit

if TYPE_CHECKING:
    from fmbd.results.run import Run

Array = NDArray[np.float64]
Row = tuple[Panel, ...]

#: Times at which the shapes of beams are shown.
INSTANTS = 9
STATIONS = 60
MOST_BEAMS = 8


def joints(run: "Run") -> Sequence[Row]:
    """Rotors and joints: positions on the left, rates on the right."""
    rotors = [name for name in run.source.coordinates if name.split(".")[0] in run.model.motors]
    carried = [name for name in run.source.coordinates if name.split(".")[0] in run.model.joints]
    rows = []
    for group in (rotors, carried):
        positions = panels_by_unit(((name, run.units(name), run[name]) for name in group), run.time)
        rates = panels_by_unit(
            ((name, run.units(f"{name}.rate"), run[f"{name}.rate"]) for name in group), run.time
        )
        rows += [
            (left, Panel(f"{left.quantity} rate", right.unit, right.curves))
            for left, right in zip(positions, rates)
        ]
    return rows


def beams(run: "Run") -> Sequence[Row]:
    """Deflection and slope at the tip of each beam; of one between its ends, deflection at the middle."""
    deflections, slopes = [], []
    for name, beam in _beams(run):
        middle = beam.frame == "chord"
        end = np.array([beam.length])
        at = end / 2.0 if middle else end
        deflections.append((f"{name}, middle" if middle else name, run.motion.deflection(name, at)[:, 0]))
        slopes.append((f"{name}, end" if middle else name, run.motion.slope(name, end)[:, 0]))
    if not deflections:
        return []
    return [
        (panel("m", deflections, run.time, "tip deflection"),),
        (panel("rad", slopes, run.time, "tip slope"),),
    ]


def constraints(run: "Run") -> Sequence[Row]:
    """What closed loops miss, in position and in velocity."""
    if not run.source.constraints:
        return []
    named = (("constraint_error", "position error"), ("velocity_constraint_error", "velocity error"))
    return [
        (Panel(label, run.units(name), (Curve(label, run.time, run[name]),), True),) for name, label in named
    ]


def energy(run: "Run") -> Sequence[Row]:
    """Where the energy goes, the potential one counted from the start, and what the integration loses."""
    parts = [(name, run.energy[name]) for name in ENERGIES if name not in ("balance", "potential")]
    parts.insert(1, ("potential, from start", run.energy["potential"] - run.energy["potential"][:1]))
    moved = [(name, values) for name, values in parts if values.any()]
    balance = [("balance", run.energy["balance"])]
    return [(panel("J", moved or parts, run.time, "energy"),), (panel("J", balance, run.time, "balance"),)]


def motors(run: "Run") -> Sequence[Row]:
    """Voltage and current of DC motors, torque on the rotors."""
    rows = []
    for quantity in ("voltage", "current", "torque"):
        names = [f"{name}.{quantity}" for name in run.model.motors if f"{name}.{quantity}" in run]
        rows += [
            (found,)
            for found in panels_by_unit(((name, run.units(name), run[name]) for name in names), run.time)
        ]
    return rows


def reactions(run: "Run") -> Sequence[Row]:
    """Size of the force in each joint, moments of those that carry one."""
    forces, moments = [], []
    for name, joint in run.model.joints.items():
        if joint.type == "free":
            continue
        forces.append((name, np.linalg.norm(run[f"{name}.force"], axis=1)))
        if "angle" not in joint.coordinates or "angle" in joint.driven:
            moments.append((name, run[f"{name}.moment"]))
    rows = [(panel("N", forces, run.time, "reaction force"),)] if forces else []
    return rows + ([(panel("N m", moments, run.time, "reaction moment"),)] if moments else [])


def shapes(run: "Run") -> Sequence[Row]:
    """Deflection along each beam at times from start to end; of many beams those that bend most."""
    rows = np.unique(np.linspace(0, len(run.time) - 1, INSTANTS).round().astype(int))
    found = []
    for name, beam in _beams(run):
        x = np.linspace(0.0, beam.length, STATIONS)
        found.append((name, x, run.motion.deflection(name, x)[rows]))
    least = sorted((np.abs(deflection).max() for *_, deflection in found), reverse=True)[:MOST_BEAMS]
    return [
        (Panel("deflection", "m", _instants(run.time[rows], x, deflection), title=name, together="family"),)
        for name, x, deflection in found
        if np.abs(deflection).max() >= least[-1]
    ][:MOST_BEAMS]


def _instants(time: Array, x: Array, deflection: Array) -> tuple[Curve, ...]:
    return tuple(Curve(f"{t:.4g} s", x, w) for t, w in zip(time, deflection))


def _beams(run: "Run") -> list[tuple[str, Beam]]:
    return [(name, body) for name, body in run.model.bodies.items() if isinstance(body, Beam)]


#: Name of a chart: its heading and what makes its rows; no rows where a model has nothing of the kind.
KINDS: dict[str, tuple[str, Callable[["Run"], Sequence[Row]]]] = {
    "joints": ("Joints: positions and rates", joints),
    "beams": ("Beams: deflection and slope at the tip", beams),
    "constraints": ("Error of the constraints", constraints),
    "energy": ("Energy", energy),
    "motors": ("Motors", motors),
    "reactions": ("Forces in the joints", reactions),
    "shapes": ("Beams: shapes over time", shapes),
}

#: The figures of the paper.
DEFAULT = ("joints", "beams", "constraints")


def chart(run: "Run", kind: str) -> Chart:
    """A chart by the name of its kind; without rows if the model has nothing that it could show."""
    title, make = KINDS[kind]
    across = ("position along the beam", "m") if kind == "shapes" else ("time", "s")
    return Chart(kind, title, tuple(make(run)), across)
