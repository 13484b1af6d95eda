"""Inverse dynamics: torques, currents and voltages with which the motors make a mechanism follow a motion.

The shafts of the motors follow the motion by constraints, and the mechanism, beams, loops, transmissions and all, is
integrated from its start as it is: what the constraints put on the shafts is what the motors must. As each motor acts
where the motion is prescribed, this has one solution, which the same model, fed with these inputs, repeats.

    tau       torque on a rotor, or on the joint by the gear ratio r if it has no inertia
    i, u      tau = Km i,  u = Ra i + La i' + Ke r theta'

A path of a point is led back to that: the joints move as in the rigid mechanism with its point on the path. What
beams and transmissions give way is in the forces, and moves the point off the path: by how much is reported. What of
it is static can be compensated. To follow it exactly in spite of vibrations is another problem, whose solution begins
before the motion does.
Source: W. Blajer, K. Kolodziejczyk, A geometric approach to solving problems of control constraints, Multibody System
Dynamics 11 (4), 2004, pp. 343-364; R. Seifried, Dynamics of Underactuated Multibody Systems, Springer, 2014.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fmbd.analyses.feeding import as_fed, efforts, fed, idle, input_path, inputs, rotor_rate
from fmbd.analyses.guide import actuated, as_point, checked_point
from fmbd.analyses.paths import on_path, started
from fmbd.analyses.prescribed import Course, read_file, read_signals
from fmbd.errors import AnalysisError, UnknownQuantity
from fmbd.model import ControllerRef, Model, load_model
from fmbd.model.names import unknown
from fmbd.planar.equations import close_at_start
from fmbd.results.files import save_data
from fmbd.results.run import Run
from fmbd.results.simulate import simulate, simulate_system
from fmbd.system import System, assemble

Array = np.ndarray

#: Files that the inputs can be written to.
KINDS = (".csv", ".h5", ".json", ".npz", ".mat")
#: The table of inputs in the model.
TABLE = "inputs.csv"


@dataclass(frozen=True, eq=False)
class Inverse:
    """A prescribed motion with what the motors do in it. `inverse["motor.voltage"]` gives any quantity of a run.

    Of nt output times, m motors whose motion is prescribed.
    """

    model: Model  #: the model, started where the motion does and fed with the inputs from a table
    run: Run  #: the motion as a run of that model; its energies of work and losses are not known
    motors: tuple[str, ...]
    point: str | None  #: the point that was to follow a path, body.point
    path: Array | None  #: the path [m], shape (nt, 2)
    remarks: tuple[str, ...]  #: for the user

    def __getitem__(self, name: str) -> Array:
        """A quantity at all output times, in SI units; UnknownQuantity."""
        return self.run[name]

    @property
    def time(self) -> Array:
        """Output times [s], shape (nt,)."""
        return self.run.time

    @cached_property
    def torque(self) -> Array:
        """Torques on the rotors [N m], shape (nt, m)."""
        return np.stack([self.run[f"{name}.torque"] for name in self.motors], axis=-1)

    @cached_property
    def power(self) -> Array:
        """Mechanical power of the motors [W], shape (nt, m)."""
        return self.torque * np.stack([rotor_rate(self.run, name) for name in self.motors], axis=-1)

    @property
    def inputs(self) -> dict[str, Array]:
        """Voltages [V] of DC motors, torques [N m] of the others, by motor, shape (nt,)."""
        return {name: self.run[input_path(self.model, name).removeprefix("motors.")] for name in self.motors}

    @property
    def error(self) -> Array | None:
        """How far the point is off its path [m], shape (nt,); None without a path."""
        if self.path is None:
            return None
        return np.hypot(*(self.run[f"{self.point}.position"] - self.path).T)

    def forward(
        self, output: str | Path | None = None, on_progress: Callable[[float], None] | None = None
    ) -> Run:
        """Run the model with the inputs found; arguments as for `simulate`."""
        return simulate(self.model, output, on_progress)

    def deviation(self, run: Run) -> dict[str, float]:
        """Largest differences of a run of the same model: of the joints of the motors [rad, m], and the point [m]."""
        coordinates = [".".join(name) for name in actuated(self.model, list(self.motors))]
        names = [*coordinates, *([f"{self.point}.position"] if self.point else [])]
        n = len(run.time)
        return {name: float(np.abs(run[name] - self.run[name][:n]).max()) for name in names}

    def save(self, path: str | Path) -> None:
        """Write the inputs over time: .csv, .h5, .json, .npz, .mat. Raises ValueError for another kind of file."""
        save_data(path, self.data(), self.table(), KINDS)

    def save_model(self, path: str | Path) -> None:
        """Write the model that is fed with the inputs, and beside it the tables that it reads. Raises OSError."""
        path = Path(path)
        own = f"{path.stem}.inputs.csv"
        model = fed(self.model, self.inputs, self.time, own)
        for name, text in model.files.items():
            table = path.parent / name
            if name == own or (name != TABLE and not table.exists()):
                table.parent.mkdir(parents=True, exist_ok=True)
                table.write_text(text, encoding="utf-8")
        path.write_text(model.yaml(), encoding="utf-8")

    def data(self) -> dict[str, Any]:
        """What is written: time, motion and inputs by name."""
        return {name: self.run[name] for name in self.names}

    def table(self) -> Iterator[Sequence[str | float]]:
        """Rows over time; the first names the columns, name[unit]."""
        yield [f"{name}[{self.run.units(name)}]" for name in self.names]
        yield from np.stack([self.run[name] for name in self.names], axis=-1).tolist()

    @property
    def names(self) -> list[str]:
        """Time, joint coordinates of the motors, their torques, currents and voltages, place of the point."""
        found = ["time", *(".".join(name) for name in actuated(self.model, list(self.motors)))]
        for name in self.motors:
            electric = self.model.motors[name].type == "dc"
            found += [f"{name}.{what}" for what in ("torque", *(("current", "voltage") if electric else ()))]
        return found + [f"{self.point}.position.{axis}" for axis in ("x", "y") if self.point]


def inverse(
    model: Model | str | Path,
    *,
    joints: Mapping[str, Any] | None = None,
    point: str | None = None,
    path: Sequence[Any] | None = None,
    file: str | Path | None = None,
    compensate: float | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> Inverse:
    """What motors must do for a motion over the model's `simulation.duration`, by its method and tolerances.

    joints: motion of the joints that motors drive, {joint: signal} [rad or m]; with an elastic transmission of the
    motor's side of it, rotor angle by gear ratio. Signals as in the model file: number, expression in t, name, mapping.
    Motors whose joints are not named keep their inputs.
    point, path: a joint, for its first point, or body.point, and the signals of its x and y [m]; moved by all motors
    file: instead of the signals a CSV file with the columns `time` [s] and x, y, or the joints; or one that was written
        by `save`, or from a run, of which the coordinates of joints, or the positions of the point, are read
    compensate: time [s] from the start over which a path takes up the deflection that the mechanism has at rest in its
    place, under gravity; left out, it does not

    The mechanism starts where the motion does, beams straight, transmissions relaxed.

    Raises ModelError for the model or a motion that jumps, UnknownQuantity for a name that is none, AnalysisError for
    a path out of reach and a motion that cannot be computed to its end, OSError for the file.
    """
    if not isinstance(model, Model):
        model = load_model(model)
    if not model.motors:
        raise AnalysisError("the model has no motors")
    end = model.simulation.duration
    if [joints, path, file].count(None) != 2 or (joints if point else path) is not None:
        raise ValueError("give joints, or a point with a path or a file, or a file")
    if point is None:
        given = read_file(model, file) if file else read_signals(model, joints or {})
        motors = _motors_of(model, given)
        return _followed(started(model, Course(given, end)), motors, given, on_progress)
    line = (
        read_file(model, file, point)
        if file
        else read_signals(model, dict(zip("xy", path or (), strict=True)))
    )
    places, moved, remarks = on_path(model, checked_point(model, point), Course(line, end), compensate)
    found = _followed(started(model, Course(moved, end)), list(model.motors), moved, on_progress)
    return replace(found, point=as_point(model, point), path=places, remarks=(*found.remarks, *remarks))


def _followed(
    model: Model, motors: list[str], joints: Mapping[str, Any], on_progress: Callable[[float], None] | None
) -> Inverse:
    """The motion, and the model fed with what its motors need for it."""
    shafts = {name: joints[model.motors[name].joint] for name in motors}
    run = simulate_system(_closed(assemble(idle(model, motors), shafts)), on_progress)
    if run.status != "complete":
        raise AnalysisError(f"the motion cannot be computed to its end: {run.status}")
    torques, currents = efforts(run, motors)
    driven = fed(model, inputs(run, torques, currents), run.time, TABLE)
    motion = as_fed(run, driven, currents)
    left = _left_alone(model, motors)
    remarks = (*run.system.start.remarks, *left, *_remarks(motion.source.state_names, currents))
    return Inverse(driven, motion, tuple(motors), None, None, remarks)


def _closed(system: System) -> System:
    """With a start that agrees with the motion to round-off, not only nearly."""
    start, nq = system.start, system.planar.nq
    y = np.concatenate([system.to_modal(start.q), system.to_modal(start.v), start.z, [0.0, 0.0]])
    close_at_start(system.planar, system.work, y, np.zeros(nq), 1e-12)
    q, v = system.to_nodal(y[:nq]), system.to_nodal(y[nq : 2 * nq])
    return replace(system, start=replace(start, q=q, v=v))


def _left_alone(model: Model, motors: Sequence[str]) -> Iterator[str]:
    """What motors without a prescribed motion do."""
    for name, motor in model.motors.items():
        if name not in motors:
            what = "voltage" if motor.type == "dc" else "torque"
            if isinstance(motor.input, ControllerRef):
                what = f"controller {motor.input.name}"
            yield f"no motion of {motor.joint} is prescribed: {name} keeps its {what} meanwhile"


def _remarks(states: Sequence[str], currents: Mapping[str, Array]) -> Iterator[str]:
    for name, current in currents.items():
        if f"{name}.current" in states and abs(current[0]) > 1e-6 * np.abs(current).max():
            yield f"{name} should start with {current[0]:.4g} A; a run starts without current"


def _motors_of(model: Model, joints: Mapping[str, Any]) -> list[str]:
    """The motors of the joints; raises UnknownQuantity for a joint without one."""
    by_joint = {motor.joint: name for name, motor in model.motors.items()}
    for name in joints:
        if name not in by_joint:
            raise UnknownQuantity(unknown("joint with a motor", name, by_joint))
    return [name for name, motor in model.motors.items() if motor.joint in joints]
