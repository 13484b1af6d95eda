"""Inputs and outputs of a linearised mechanism: what can be put in and read out by name, and what follows from it.

Each input is given a constant of its own beside what it has: the motor's signal, the load's component, or what a
controller adds up. Outputs are quantities of a run (results/quantities.py), evaluated at states nearby.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from fmbd.analyses.arrangement import Arrangement
from fmbd.analyses.linearisation import Linearisation
from fmbd.errors import UnknownQuantity
from fmbd.model.names import unknown
from fmbd.planar.arrays import SIGNAL, allocate, records
from fmbd.planar.signals import CONSTANT
from fmbd.results.layout import ENERGIES
from fmbd.results.recording import Recording
from fmbd.results.run import Run
from fmbd.system import System
from fmbd.system.applied import apply_loads

Array = np.ndarray

_STEP = 1e-5  # of the differences of outputs, as the largest change of a coordinate [rad, m] or a rate
_LOAD_FIELDS = ("fx", "fy", "moment")


@dataclass(frozen=True)
class Input:
    """Something that can be put in: the motors and the components of loads that it changes alike."""

    name: str
    unit: str  #: "" of a signal
    motors: tuple[int, ...] = ()
    loads: tuple[tuple[str, int, str], ...] = ()  #: (array of loads, index, field)


def inputs_by_name(lin: Linearisation) -> dict[str, Input]:
    """Voltages and torques of motors whose shafts are not held, components of loads, signals that feed only these."""
    system, planar = lin.system, lin.system.planar
    found = []
    for m, (name, motor) in enumerate(zip(system.input_names, system.model.motors.values(), strict=True)):
        if m not in lin.arrangement.locked:
            found.append(Input(name, "V" if motor.type == "dc" else "N m", motors=(m,)))
    fields = {"force": ("fx", "fy"), "distributed": ("fx", "fy"), "moment": ("moment",)}
    own = _numbers_of_loads(system)
    for name, load in system.model.loads.items():
        array = "distributed" if load.type == "distributed" else "loads"
        unit = {"force": "N", "distributed": "N/m", "moment": "N m"}[load.type]
        for field in fields[load.type]:
            full = f"{name}.moment" if field == "moment" else f"{name}.force.{field[1]}"
            found.append(Input(full, unit, loads=tuple((array, k, field) for k in own[name])))
    for name, signal in system.model.signals.items():
        number = system.lowered.signals.find(signal)
        targets = planar.controllers["target"]
        if number < 0 or number in [*planar.constraints["driver"], *planar.bodies["driver"].flat, *targets]:
            continue
        motors = tuple(
            m for m, motor in enumerate(planar.motors) if motor.signal == number and motor.controller < 0
        )
        parts = [
            (array, k, field)
            for array in ("loads", "distributed")
            for k, load in enumerate(getattr(planar, array))
            for field in _LOAD_FIELDS
            if field in load.dtype.names and load[field] == number
        ]
        if motors or parts:
            found.append(Input(name, "", motors, tuple(parts)))
    return {entry.name: entry for entry in found}


def _numbers_of_loads(system: System) -> dict[str, list[int]]:
    """Where each load of the model is in its array; a distributed one on a beam in segments is in several places."""
    loads = system.lowered.model.loads
    at_points = [name for name, load in loads.items() if load.type != "distributed"]
    # distributed loads stand in the order of the bodies that they are on
    on_bodies = [
        name
        for link in system.tree.links
        for name, load in loads.items()
        if load.type == "distributed" and load.on == link.name
    ]
    own: dict[str, list[int]] = {name: [] for name in system.model.loads}
    for names in (at_points, on_bodies):
        for k, name in enumerate(names):
            own[name.split(".")[0]].append(k)
    return own


def chosen_inputs(lin: Linearisation, names: Iterable[str] | None) -> list[Input]:
    """The inputs named; by default those of the motors, or of all loads if there is none. Raises UnknownQuantity."""
    known = inputs_by_name(lin)
    if names is None:
        parts = [entry for entry in known.values() if entry.unit]
        return [entry for entry in parts if entry.motors] or parts
    names = list(names)
    for name in names:
        if name not in known:
            raise UnknownQuantity(unknown("input", name, known) + f" (inputs: {', '.join(known) or 'none'})")
    return [known[name] for name in names]


def forces_of(lin: Linearisation, inputs: list[Input]) -> tuple[Array, Array]:
    """Generalised forces, modal (nq, nu), and rates of the states (nz, nu) by a unit of each input."""
    q, _, z = lin.state
    force, rates = np.zeros((q.size, len(inputs))), np.zeros((z.size, len(inputs)))
    saturated = _saturated(lin)
    for k, entry in enumerate(inputs):
        motors = [m for m in entry.motors if not saturated[m]]
        by_motor, by_state = lin.by_input(motors)
        force[:, k], rates[:, k] = by_motor.sum(axis=1), by_state.sum(axis=1)
        for array, index, field in entry.loads:
            force[:, k] += lin.basis.T @ _unit_load(lin, array, index, field)
    return force, rates


def _saturated(lin: Linearisation) -> list[bool]:
    """Whether the controller of a motor is at its limit."""
    system = lin.system
    lin.arrangement.rates(system.to_modal(lin.state[0]), system.to_modal(lin.state[1]), lin.state[2])
    laws, drives = system.planar.controllers, system.work.drives
    return [
        motor.controller >= 0 and not laws[motor.controller].low < drive.input < laws[motor.controller].high
        for motor, drive in zip(system.planar.motors, drives, strict=True)
    ]


def _unit_load(lin: Linearisation, array: str, index: int, field: str) -> Array:
    """Generalised force, nodal (nq,), of a unit of one component of a load."""
    system, q, t = lin.system, lin.state[0], lin.arrangement.t
    kept = {name: getattr(system.planar, name)[:0] for name in ("loads", "distributed")}
    load = getattr(system.planar, array)[index : index + 1].copy()
    for other in _LOAD_FIELDS:
        if other in load.dtype.names:
            load[other] = 0 if other == field else 1  # signal 0 is one, signal 1 is nothing
    bodies, stations = system.reference.frames(q, t)
    x = np.append(q, t)
    planar = system.planar._replace(**kept | {array: load})
    if array == "loads":
        return apply_loads(planar, system.reference, bodies, stations, x, np.eye(2)[:, :1])[:-1]
    stretches = system.reference.stretches
    own = slice(index, index + 1)
    bent = [(0, elastic, H) for k, elastic, H in stretches.bent if k == index]
    part = type(stretches)(stretches.total[own], stretches.first[own], stretches.shape[own], bent)
    sums = part.sums(bodies[load["body"]], x)[0]
    direction = np.array([1.0, 0.0] if field == "fx" else [0.0, 1.0])
    if load["following"][0]:
        angle = bodies[load["body"][0], 2, 0]
        c, s = np.cos(angle), np.sin(angle)
        direction = np.array([[c, -s], [s, c]]) @ direction
    return (direction @ sums[:, 1:])[:-1]


class Probe:
    """Outputs of a mechanism near the state of a linearisation, by its inputs."""

    def __init__(self, lin: Linearisation, inputs: list[Input], outputs: Iterable[str]) -> None:
        self.lin, self.inputs = lin, inputs
        self.arrangement, self._constants = _with_constants(lin, inputs)
        self._saturated = _saturated(lin)
        run = self._run(*(part[None] for part in lin.state))
        self.names: list[str] = []
        self.units: list[str] = []
        self._quantities = list(outputs)
        for name in self._quantities:
            for column in run.columns(name) or ("",):
                self.names.append(f"{name}.{column}".rstrip("."))
                self.units.append(run.units(name))

    def by_state(self) -> Array:
        """Derivatives of the outputs by x (ny, nx), torques on held shafts as they are; extrapolated differences."""
        lin = self.lin
        directions = lin.directions(np.eye(lin.size))
        size = np.max([np.abs(part).max(axis=0, initial=0.0) for part in directions], axis=0)
        h = _STEP / np.where(size > 0.0, size, 1.0)
        moved = [
            np.concatenate([given + steps * (part * h).T for steps in (1.0, -1.0, 2.0, -2.0)])
            for given, part in zip(lin.state, directions, strict=True)
        ]
        values = self._outputs(self._run(*moved)).reshape(4, lin.size, -1)
        near, far = values[0] - values[1], values[2] - values[3]
        return ((8.0 * near - far) / (12.0 * h[:, None])).T

    def by_input(self) -> Array:
        """Derivatives by the inputs at the same state (ny, nu): the outputs are linear in them."""
        return self._by(self.inputs)

    def by_held(self) -> Array:
        """Derivatives by the inputs of the motors that are held (ny, held)."""
        return self._by([Input("", "", motors=(m,)) for m in self.lin.arrangement.locked])

    def _by(self, inputs: list[Input]) -> Array:
        columns = [np.zeros((len(self.names), 0))]
        state = [part[None] for part in self.lin.state]
        for entry in inputs:
            difference = np.zeros(len(self.names))
            for sign in (1.0, -1.0):
                with_more = self._put(entry, sign)
                difference += 0.5 * sign * self._outputs(self._run(*state))[0]
                for field, old in with_more:
                    field[...] = old
            columns.append(difference[:, None])
        return np.hstack(columns)

    def _put(self, entry: Input, more: float) -> list[tuple[Array, Array]]:
        """Add to an input; returns what was changed, with what was there."""
        changed = []
        for field in self._fields(entry):
            changed.append((field, field.copy()))
            field += more
        return changed

    def _fields(self, entry: Input) -> Iterator[Array]:
        planar = self.arrangement.system.planar
        for m in entry.motors:
            motor = planar.motors[m]
            if motor.controller < 0:
                yield planar.signals["p"][int(motor.signal), 0:1]
            elif not self._saturated[m]:
                yield planar.controllers["bias"][motor.controller : motor.controller + 1]
        for part in entry.loads:
            yield planar.signals["p"][self._constants[part], 0:1]

    def _outputs(self, run: Run) -> Array:
        parts = [run[name].reshape(len(run.time), -1) for name in self._quantities]
        return np.hstack([np.zeros((len(run.time), 0)), *parts])

    def _run(self, q: Array, v: Array, z: Array) -> Run:
        """Any states (k, nq), (k, nq), (k, nz) as a run."""
        system, t = self.arrangement.system, self.arrangement.t
        recording = Recording(system.coordinates, system.constraints, system.states, [])
        a, multipliers = np.zeros_like(q), np.zeros((len(q), len(system.constraints)))
        for k in range(len(q)):
            modal, _ = self.arrangement.rates(system.to_modal(q[k]), system.to_modal(v[k]), z[k])
            a[k], multipliers[k] = system.to_nodal(modal), system.work.reactions["multiplier"]
        none = dict.fromkeys(ENERGIES, np.zeros(len(q)))
        recording.write(np.full(len(q), t), q, v, a, multipliers, z, none, {})
        recording.finish("complete", {})
        return Run(recording, lambda: system.model, lambda: system)


def _with_constants(
    lin: Linearisation, inputs: list[Input]
) -> tuple[Arrangement, dict[tuple[str, int, str], int]]:
    """A copy of the arrangement in which motors without controllers, and loads that are inputs, have own constants."""
    arrangement, planar = lin.arrangement, lin.system.planar
    values = lin.system.reference.signals(arrangement.t)[:, 0]
    motors, loads, distributed = planar.motors.copy(), planar.loads.copy(), planar.distributed.copy()
    arrays = {"loads": loads, "distributed": distributed}
    own: list[float] = []
    for motor in motors:
        if motor.controller < 0:
            own.append(values[motor.signal])
            motor.signal = planar.signals.size + len(own) - 1
    places: dict[tuple[str, int, str], int] = {}
    for entry in inputs:
        for part in entry.loads:
            if part not in places:
                array, k, field = part
                own.append(values[arrays[array][k][field]])
                places[part] = planar.signals.size + len(own) - 1
                arrays[array][field][k] = places[part]
    signals = records(planar.signals.size + len(own), SIGNAL)
    signals[: planar.signals.size] = planar.signals
    signals["kind"][planar.signals.size :] = CONSTANT
    signals["p"][planar.signals.size :, 0] = own
    changed = planar._replace(
        signals=signals,
        motors=motors,
        controllers=planar.controllers.copy(),
        loads=loads,
        distributed=distributed,
    )
    lowered = replace(lin.system.lowered, planar=changed)
    system = replace(lin.system, lowered=lowered, work=allocate(changed))
    return replace(arrangement, system=system), places
