"""Motors fed with what they need for a motion: inputs from the constraints of their shafts, and models with them."""

import io
from collections.abc import Mapping
from typing import Any

import numpy as np

from fmbd.model import ControllerRef, Model, load_model_text
from fmbd.model.motors import DCMotor
from fmbd.results.layout import ENERGIES
from fmbd.results.recording import Recording
from fmbd.results.run import Run
from fmbd.system import assemble
from fmbd.system.motors import has_rotor, motor_coordinate

Array = np.ndarray

#: Energies of a run that know of the work of its motors.
_OF_MOTORS = ("dissipated", "work", "balance")


def idle(model: Model, motors: list[str]) -> Model:
    """The model with these motors short-circuited, or without torque."""
    return _with_inputs(model, dict.fromkeys(motors, 0))


def fed(model: Model, inputs: Mapping[str, Array], times: Array, file: str) -> Model:
    """The model with inputs (nt,) of motors by name at times [s], read from a table of this name."""
    text = io.StringIO()
    columns = {name: input_path(model, name).removeprefix("motors.") for name in inputs}
    text.write(",".join(["time", *columns.values()]) + "\n")
    for row in np.stack([times, *inputs.values()], axis=-1).tolist():
        text.write(",".join(map(repr, row)) + "\n")
    entry = {"type": "table", "file": file, "time": "time", "interpolation": "cubic"}
    tables = {name: entry | {"value": column} for name, column in columns.items()}
    return _with_inputs(model, tables, {file: text.getvalue()})


def changed(model: Model, changes: Mapping[str, Any], files: Mapping[str, str] | None = None) -> Model:
    """The model with other values by path, which go before all earlier ones; and further tables by name."""
    kept = {path: value for path, value in model.overrides.items() if path not in changes}
    return load_model_text(model.text, model.path, {**kept, **changes}, {**model.files, **(files or {})})


def efforts(run: Run, motors: list[str]) -> tuple[dict[str, Array], dict[str, Array]]:
    """Torques on the rotors and currents of motors (nt,), from a run whose shafts are moved by constraints.

    A motor that is short-circuited brakes by itself; the constraint does the rest.
    """
    torques, currents = {}, {}
    for name in motors:
        motor = run.model.motors[name]
        torques[name] = run[f"{name}.torque"] - run[f"multipliers.{name}.shaft"] / motor.gear_ratio
        if motor.type == "dc":
            currents[name] = torques[name] / motor.torque_constant
    return torques, currents


def inputs(run: Run, torques: Mapping[str, Array], currents: Mapping[str, Array]) -> dict[str, Array]:
    """Voltages of DC motors, torques of the others, shape (nt,)."""
    found = dict(torques)
    for name, current in currents.items():
        motor = run.model.motors[name]
        assert isinstance(motor, DCMotor)
        found[name] = motor.resistance * current + motor.back_emf * rotor_rate(run, name)
        if motor.inductance:
            from scipy.interpolate import CubicSpline

            found[name] += motor.inductance * CubicSpline(run.time, current)(run.time, 1)
    return found


def as_fed(run: Run, model: Model, currents: Mapping[str, Array]) -> Run:
    """The same motion as a run of the model that is fed with the inputs found; the work of motors is left open."""
    system = assemble(model)
    names = list(run.source.constraints)
    kept = [names.index(name) for name in system.constraint_names]
    states = [
        currents[name] if (name := state.removesuffix(".current")) in currents else run[state]
        for state, _ in system.states
    ]
    recording = Recording(system.coordinates, system.constraints, system.states, [])
    unknown = np.full_like(run.time, np.nan)
    recording.write(
        run.time,
        run.position,
        run.velocity,
        run.acceleration,
        run.multipliers[:, kept],
        np.reshape(states, (len(states), -1)).T if states else np.zeros((run.time.size, 0)),
        {name: unknown if name in _OF_MOTORS else run.energy[name] for name in ENERGIES},
        {},
    )
    recording.finish(run.status, dict(run.statistics))
    return Run(recording, lambda: model, lambda: system)


def rotor_rate(run: Run, name: str) -> Array:
    """Rate of a rotor, or of the joint by the gear ratio [rad/s], shape (nt,)."""
    motor = run.model.motors[name]
    if has_rotor(motor):
        return run[f"{name}.rotor.rate"]
    return motor.gear_ratio * run[f"{motor.joint}.{motor_coordinate(run.model, motor)}.rate"]


def _with_inputs(model: Model, given: Mapping[str, Any], files: Mapping[str, str] | None = None) -> Model:
    """The model with other inputs of motors by name, without the controllers that then have no motor."""
    others = [motor.input for name, motor in model.motors.items() if name not in given]
    used = {law.name for law in others if isinstance(law, ControllerRef)}
    laws = model.document.data.get("controllers") or {}
    changes = {input_path(model, name): value for name, value in given.items()}
    if not used.issuperset(laws):
        changes["controllers"] = {name: law for name, law in laws.items() if name in used}
    return changed(model, changes, files)


def input_path(model: Model, name: str) -> str:
    """The path of a motor's input in the model."""
    return f"motors.{name}.{'voltage' if model.motors[name].type == 'dc' else 'torque'}"
