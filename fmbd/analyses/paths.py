"""From the path of a point, or the motion of joints, to a model that starts where the motion does."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fmbd.analyses.deflection import compensated
from fmbd.analyses.feeding import changed
from fmbd.analyses.guide import Coordinate, Guide, actuated
from fmbd.analyses.prescribed import Course
from fmbd.analyses.singularities import remarks_on_path
from fmbd.model import Model
from fmbd.model.tables import Table
from fmbd.solvers.integrate import output_times
from fmbd.system import assemble

Array = np.ndarray

#: Joint values and rates at the start that are nearer than this [rad, m] to the motion's are taken for the same.
SAME = 1e-6
#: Knots of the joints' motion between two output times.
FINER = 2
#: Share of a cubic piece at which its second derivative has no error of order 2: x (1 - x) / 2 = 1 / 12.
RIGHT = 0.5 - 0.5 / 3.0**0.5


def on_path(
    model: Model, point: str, course: Course, compensate: float | None = None
) -> tuple[Array, dict[str, Any], tuple[str, ...]]:
    """The path at the output times (nt, 2), how the joints move with the point on it, and remarks for the user.

    compensate: time [s] over which the static deflection is taken up, if it is
    """
    simulation = model.simulation
    times = output_times(simulation.duration, simulation.output_interval)
    system = assemble(model, points=[point])
    joints = actuated(model, list(model.motors))
    guide = Guide(system, joints, point)
    path = course.at(times)[..., 0]
    if compensate is None:
        qs = guide.follow(times, path)
    else:
        qs = guide.follow(times, compensated(system, guide, times, path, compensate))
    values = np.array([guide.values(q, t) for q, t in zip(qs, times, strict=True)])
    moved = {joint: _table(times, column) for (joint, _), column in zip(joints, values.T, strict=True)}
    return path, moved, tuple(remarks_on_path(guide, times, qs))


def _table(times: Array, values: Array) -> Table:
    """A smooth function by its values, by order 8 between them; longer at both ends, where a table has no rate.

    Second derivatives of cubic pieces are right to order 4 at two points of each only: output times are such.
    """
    from scipy.interpolate import make_interp_spline

    smooth = make_interp_spline(times, values, k=min(7, times.size - 1))
    longer = np.concatenate([[2.0 * times[0] - times[1]], times, [2.0 * times[-1] - times[-2]]])
    places = (np.arange(-1, FINER * times.size) + RIGHT) / FINER
    knots = np.interp(places, np.arange(-1, times.size + 1), longer)
    first, last = smooth(knots[[0, -1]], 1).tolist()
    return Table(tuple(knots.tolist()), tuple(smooth(knots).tolist()), "cubic", (first, last))


def started(model: Model, course: Course) -> Model:
    """The model with a start from which its joints can move as they should; itself if its own start is one.

    Other joints with motors keep their start.
    """
    system = assemble(model)
    joints = actuated(model, list(model.motors))
    guide = Guide(system, joints)
    seen = guide.mechanism.coordinates(system.start.q, joints)
    own = np.array([(value, row[:-1] @ system.start.v + row[-1]) for value, row in seen])
    first = course.at(np.zeros(1))[0, :, :2]
    named = {joint: n for n, joint in enumerate(course.signals)}
    wanted = np.array(
        [first[named[j]] if j in named else kept for (j, _), kept in zip(joints, own, strict=True)]
    )
    if np.allclose(own, wanted, rtol=0.0, atol=SAME):
        return model
    free = guide.all_joints(guide.begin_joints(wanted[:, 0]))
    values, rates = (dict(zip(joints, column.tolist(), strict=True)) for column in wanted.T)
    initial = {
        "joints": _by_joint(values),
        "hints": _by_joint({name: value for name, value in free.items() if name not in values}),
        "rates": model.initial.rates | _by_joint({name: r for name, r in rates.items() if name[0] in named}),
    }
    return changed(model, {"initial": initial})


def _by_joint(values: Mapping[Coordinate, float]) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = {}
    for (joint, direction), value in values.items():
        found.setdefault(joint, {})[direction] = value
    return found
