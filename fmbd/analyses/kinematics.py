"""Kinematics of the rigid mechanism: a point and the joints that move it, over time or a grid; singular positions."""

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.analyses.guide import Coordinate, Guide, actuated, checked_point
from fmbd.analyses.prescribed import Course, read_file, read_signals
from fmbd.analyses.singularities import Singularity, jacobian, nearest, parallel, serial
from fmbd.errors import AnalysisError, UnknownQuantity
from fmbd.model import Model, load_model
from fmbd.model.names import unknown
from fmbd.results.files import save_data
from fmbd.solvers.integrate import output_times
from fmbd.system import System, assemble

Array = np.ndarray

#: Files that kinematics can be written to.
KINDS = (".csv", ".h5", ".json", ".npz", ".mat")
#: Where a point turns back its velocities before and after are opposite, to this cosine.
REVERSED = 0.9


@dataclass(frozen=True, eq=False)
class Kinematics:
    """n positions of the rigid mechanism, beams straight; `singularities.py` says what is singular.

    Over a grid, positions that cannot be reached from the start without passing a parallel singularity are left out.
    """

    guide: Guide
    point: str
    time: Array  #: [s], shape (n,); zero over a grid
    position: Array  #: generalised coordinates, shape (n, nq)
    wanted: int  #: positions asked for; over a grid not all can be reached

    @property
    def inputs(self) -> tuple[str, ...]:
        """The joint coordinates that move the mechanism."""
        return tuple(".".join(joint) for joint in self.guide.joints)

    @cached_property
    def values(self) -> Array:
        """The inputs [rad or m], shape (n, inputs)."""
        return self._each(self.guide.values)

    @cached_property
    def place(self) -> Array:
        """The point [m], shape (n, 2)."""
        return self._each(self.guide.place)

    @cached_property
    def jacobian(self) -> Array:
        """J = dp / d theta, shape (n, 2, inputs)."""
        return self._each(lambda q, t: jacobian(self.guide, q, t))

    @cached_property
    def parallel(self) -> Array:
        """det [Phi_x; A], shape (n,): changes its sign where the inputs do not hold the mechanism."""
        return self._each(lambda q, t: parallel(self.guide, q, t))

    @cached_property
    def serial(self) -> Array:
        """Shape (n,). Of two inputs det [Phi_x; P], which changes its sign at the limits of the point's reach.

        Of one input |dp / d theta|, zero where the point stands still and turns back; NaN of more.
        """
        return self._each(lambda q, t: serial(self.guide, q, t))

    @cached_property
    def condition(self) -> Array:
        """Condition number of J, shape (n,); infinite at singular positions, says nothing of one input."""
        size = np.linalg.svd(np.nan_to_num(self.jacobian, posinf=0.0), compute_uv=False)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(size[:, -1] > 0.0, size[:, 0] / size[:, -1], np.inf)

    def crossings(self, kind: str) -> list[int]:
        """After which positions a singular one is passed on the way to the next; kind is `parallel` or `serial`."""
        if kind == "serial" and len(self.inputs) == 1:
            J = self.jacobian[:, :, 0]
            along = (J[:-1] * J[1:]).sum(axis=1)
            size = np.linalg.norm(J, axis=1)
            return [int(k) for k in np.flatnonzero(along <= -REVERSED * size[:-1] * size[1:])]
        sign = np.sign(getattr(self, kind))
        return [int(k) for k in np.flatnonzero(sign[:-1] * sign[1:] <= 0.0)]

    def nearest(self, kind: str) -> Singularity | None:
        """The singular position, `parallel` or `serial`, that is nearest to the position with the least determinant.

        Of a single input no serial one is looked for.
        """
        if kind == "serial" and len(self.inputs) == 1:
            return None
        size = np.abs(getattr(self, kind))
        if not np.isfinite(size).any():
            return None
        k = int(np.nanargmin(size))
        return nearest(self.guide, self.position[k], float(self.time[k]), kind)

    def save(self, path: str | Path) -> None:
        """Write all positions: .csv, .h5, .json, .npz, .mat. Raises ValueError for another kind of file."""
        save_data(path, self.data(), self.table(), KINDS)

    def data(self) -> dict[str, Array]:
        """What is written: time, inputs, the point, J, its condition unless of one input, the determinants."""
        found = {"time": self.time} | dict(zip(self.inputs, self.values.T, strict=True))
        found |= {f"{self.point}.{axis}": self.place[:, k] for k, axis in enumerate("xy")}
        for k, axis in enumerate("xy"):
            found |= {f"d{axis}/d({name})": self.jacobian[:, k, j] for j, name in enumerate(self.inputs)}
        if len(self.inputs) > 1:
            found["condition"] = self.condition
        return found | {"parallel": self.parallel, "serial": self.serial}

    def table(self) -> Iterator[Sequence[str | float]]:
        """Rows of positions; the first names the columns."""
        data = self.data()
        yield list(data)
        yield from np.stack(list(data.values()), axis=-1).tolist()

    def _each(self, function: Callable[[Array, float], Any]) -> Array:
        return np.array([function(q, float(t)) for q, t in zip(self.position, self.time, strict=True)])


def kinematics(
    model: Model | str | Path,
    point: str,
    *,
    joints: Mapping[str, Any] | None = None,
    path: Sequence[Any] | None = None,
    file: str | Path | None = None,
    sweep: Mapping[str, Sequence[float]] | None = None,
) -> Kinematics:
    """Positions of the rigid mechanism, from the motion of joints, the path of a point, or a grid of joint values.

    point: a joint, for its first point, or body.point
    joints, path, file: as for `fmbd.inverse`, at the output times of the model's simulation
    sweep: values of joints [rad or m], {joint: values}; of all combinations those that can be reached
    Joints that are named are the inputs, with a path the joints of all motors: as many as degrees of freedom.

    Raises ModelError, UnknownQuantity, OSError; AnalysisError for a motion that the loops do not allow, or a number of
    inputs that is not that of the degrees of freedom.
    """
    if not isinstance(model, Model):
        model = load_model(model)
    if [joints, path, file, sweep].count(None) != 3:
        raise ValueError("give one of joints, path, file, sweep")
    point = checked_point(model, point)
    system = assemble(model, points=[point])
    if sweep is not None:
        guide = _guide(system, _inputs(model, list(sweep)), point)
        grid = [np.asarray(values, float) for values in sweep.values()]
        position = _over_grid(guide, grid)
        return Kinematics(
            guide, point, np.zeros(len(position)), position, int(np.prod([v.size for v in grid]))
        )
    times = output_times(model.simulation.duration, model.simulation.output_interval)
    given = (
        read_signals(model, joints or dict(zip("xy", path or (), strict=True)))
        if file is None
        else read_file(model, file)
    )
    values = Course(given, model.simulation.duration).at(times)[..., 0]
    if joints is None and set(given) == {"x", "y"}:
        guide = _guide(system, actuated(model, list(model.motors)), point)
        position = guide.follow_path(times, values)
    else:
        guide = _guide(system, _inputs(model, list(given)), point)
        position = guide.follow_joints(times, values)
    return Kinematics(guide, point, times, position, times.size)


def _inputs(model: Model, names: list[str]) -> list[Coordinate]:
    """What the joints move by; raises UnknownQuantity."""
    known = [name for name, joint in model.joints.items() if joint.motor_coordinate]
    for name in names:
        if name not in known:
            raise UnknownQuantity(unknown("joint that can move", name, known))
    return [(name, str(model.joints[name].motor_coordinate)) for name in names]


def _guide(system: System, joints: list[Coordinate], point: str) -> Guide:
    """The mechanism with these inputs; AnalysisError unless it has as many degrees of freedom."""
    guide = Guide(system, joints, point)
    loops, inputs, _ = guide.rows(guide.start, 0.0)
    free = loops.shape[1] - len(loops)
    if free != len(inputs):
        names = ", ".join(name for name, _ in joints) or "none"
        driven = [f"joints.{name}" for name, joint in system.model.joints.items() if joint.driven]
        hint = f": what is to be an input must not be driven, remove `driven` of {', '.join(driven)}"
        raise AnalysisError(
            f"the mechanism has {free} degree{'s' if free != 1 else ''} of freedom, "
            f"but {len(inputs)} input{'s' if len(inputs) != 1 else ''} ({names})"
            + (hint if driven and free < len(inputs) else "")
        )
    return guide


def _over_grid(guide: Guide, grid: list[Array]) -> Array:
    """Positions (n, nq) in the order of the grid, each found from a neighbour, the first from the start."""
    first = tuple(
        int(np.abs(v - s).argmin()) for v, s in zip(grid, guide.values(guide.start, 0.0), strict=True)
    )
    found: dict[tuple[int, ...], Array] = {}
    try:
        found[first] = guide.begin_joints(np.array([v[k] for v, k in zip(grid, first, strict=True)]))
    except AnalysisError:
        raise AnalysisError("the grid is out of reach from the start") from None
    side = np.sign(parallel(guide, found[first], 0.0))
    waiting = deque([first])
    while waiting:
        here = waiting.popleft()
        for axis, step in product(range(len(grid)), (-1, 1)):
            there = tuple(k + step * (axis == a) for a, k in enumerate(here))
            if there in found or not 0 <= there[axis] < grid[axis].size:
                continue
            try:
                values = np.array([v[k] for v, k in zip(grid, there, strict=True)])
                q = guide.at_joints(found[here], values, 0.0)
            except AnalysisError:
                continue
            if np.sign(parallel(guide, q, 0.0)) == side:  # else it has flipped over
                found[there] = q
                waiting.append(there)
    return np.array([found[k] for k in sorted(found)])
