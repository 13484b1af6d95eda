"""The five-bar robot in all comparisons: its cases, what is observed of a run, how an error is measured.

The controlled move of models/five_bar.yaml: 3 s, links of 1, 4 or 16 elements, undamped or with damping proportional
to their stiffness. Observed are the end point and the deflections of both tips, every 10 ms.
"""

import time
from collections.abc import Mapping
from typing import Any, NamedTuple, get_args

import numpy as np
from common import MODELS, GaveUp, OutOfTime

from fmbd.model import load_model
from fmbd.model.simulation import Simulation
from fmbd.planar.equations import evaluate_accelerations
from fmbd.solvers.integrate import Statistics, integrate
from fmbd.system import System, assemble

Array = np.ndarray

TIMES = np.linspace(0.0, 3.0, 301)
#: Damping that is proportional to stiffness [s], by name.
DAMPING = {"undamped": 0.0, "damped": 5e-5}
CRANK, LINK, HALF_BASE = 0.4, 0.5, 0.3
#: The methods that fmbd offers.
METHODS: tuple[str, ...] = get_args(Simulation.model_fields["method"].annotation)


class Observed(NamedTuple):
    """End point [m], shape (times, 2); deflections of the right and the left tip [m], shape (times, 2)."""

    end: Array
    tip: Array


def five_bar(
    elements: int,
    damping: float,
    method: str = "dop853",
    rtol: float = 1e-6,
    more: Mapping[str, Any] | None = None,
) -> System:
    """The mechanism, ready to be simulated by a method at a tolerance (relative and absolute), with more changes."""
    changes: dict[str, Any] = {
        "bodies.*.elements": elements,
        "simulation.method": method,
        "simulation.rtol": rtol,
        "simulation.atol": rtol,
    }
    for rod in ("rod_right", "rod_left"):
        changes[f"bodies.{rod}.damping"] = {"stiffness_proportional": damping}
    return assemble(load_model(MODELS / "five_bar.yaml", changes | dict(more or {})))


def by_fmbd(system: System, limit: float, times: Array = TIMES) -> tuple[Array, Statistics]:
    """Nodal coordinates at `times`, shape (times, nq), and counts. Raises OutOfTime after `limit` CPU seconds."""
    statistics = Statistics(system.model.simulation.method)
    deadline, late = time.process_time() + limit, f"not finished in {limit:g} s"

    def watch(_: float) -> None:
        if time.process_time() > deadline:
            statistics.reason = late

    position = [block.position for block in integrate(system, times, statistics, watch)]
    if statistics.reason == late:
        raise OutOfTime(late)
    if statistics.reason:
        raise GaveUp(statistics.reason)
    return np.concatenate(position), statistics


def by_scipy(system: System, method: str, rtol: float, limit: float) -> Array:
    """The same by SciPy, from fmbd's accelerations: index 1, modal coordinates, no stabilisation."""
    from scipy.integrate import solve_ivp

    nq, z = system.planar.nq, system.start.z
    qdd, dz = np.zeros(nq), np.zeros(z.size)
    deadline = time.process_time() + limit

    def rates(t: float, y: Array) -> Array:
        if time.process_time() > deadline:
            raise OutOfTime(f"not finished in {limit:g} s")
        evaluate_accelerations(system.planar, system.work, t, y[:nq], y[nq:], z, dz, qdd)
        return np.concatenate((y[nq:], qdd))

    start = np.concatenate([system.to_modal(system.start.q), system.to_modal(system.start.v)])
    solution = solve_ivp(rates, (TIMES[0], TIMES[-1]), start, method, t_eval=TIMES, rtol=rtol, atol=rtol)
    if not solution.success:
        raise GaveUp(solution.message)
    return system.to_nodal(solution.y[:nq].T)


def observe(system: System, q: Array) -> Observed:
    """End point and deflections from nodal coordinates, shape (times, nq)."""
    names = system.coordinate_names
    column = {name: q[:, k] for k, name in enumerate(names)}
    last = sum(name.startswith("rod_right.w") for name in names)
    tip = np.stack([column[f"rod_{side}.w{last}"] for side in ("right", "left")], axis=1)
    shoulder = column["shoulder_right.angle"]
    rod = shoulder + column["elbow_right.angle"]
    x = HALF_BASE + CRANK * np.cos(shoulder) + LINK * np.cos(rod) - tip[:, 0] * np.sin(rod)
    y = CRANK * np.sin(shoulder) + LINK * np.sin(rod) + tip[:, 0] * np.cos(rod)
    return Observed(np.stack([x, y], axis=1), tip)


def errors(found: Observed, reference: Observed) -> dict[str, float]:
    """End point: root mean square and maximum [m]; tips: relative to the reference's root mean square and peak."""
    end = np.hypot(*(found.end - reference.end).T)
    tip = np.abs(found.tip - reference.tip)
    return {
        "end_rms": float(np.sqrt(np.mean(end**2))),
        "end_max": float(end.max()),
        "tip_rms": float(np.sqrt(np.mean(tip**2) / np.mean(reference.tip**2))),
        "tip_max": float(tip.max() / np.abs(reference.tip).max()),
    }
