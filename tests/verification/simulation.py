"""Simulate a model of models/ and look at results by name, at chosen times."""

from pathlib import Path

import numpy as np

from fmbd.model import load_model
from fmbd.solvers.integrate import Statistics, integrate, output_times
from fmbd.system import assemble

MODELS = Path(__file__).parents[2] / "models"


class Run:
    def __init__(self, model):
        self.system = assemble(model)
        self.statistics = Statistics(model.simulation.method)
        times = output_times(model.simulation.duration, model.simulation.output_interval)
        blocks = list(integrate(self.system, times, self.statistics))
        self.time = np.concatenate([b.time for b in blocks])
        self.position = np.concatenate([b.position for b in blocks])
        self.velocity = np.concatenate([b.velocity for b in blocks])
        self.acceleration = np.concatenate([b.acceleration for b in blocks])
        self.multipliers = np.concatenate([b.multipliers for b in blocks])
        self.states = np.concatenate([b.states for b in blocks])
        self.constraint_error = np.concatenate([b.constraint_error for b in blocks])
        self.energy = {k: np.concatenate([b.energy[k] for b in blocks]) for k in blocks[0].energy}
        self.status = f"stopped: {self.statistics.reason}" if self.statistics.reason else "complete"

    def __getitem__(self, name):
        s = self.system
        if name in s.coordinate_names:
            return self.position[:, s.coordinate_names.index(name)]
        if name.endswith(".rate"):
            return self.velocity[:, s.coordinate_names.index(name[:-5])]
        if name.endswith(".acceleration"):
            return self.acceleration[:, s.coordinate_names.index(name[:-13])]
        if name.startswith("multipliers."):
            return self.multipliers[:, s.constraint_names.index(name[12:])]
        if name.startswith("energy."):
            return self.energy[name[7:]]
        if name == "constraint_error":
            return self.constraint_error[:, 0]
        if name in [n for n, _ in s.states]:
            return self.states[:, [n for n, _ in s.states].index(name)]
        body, point, what = name.split(".")
        k = s.lowered.stations[body, point]
        out = []
        for t, q, v in zip(self.time, self.position, self.velocity):
            p, _, J = s.reference.stations(q, t)
            out.append(p[k] if what == "position" else J[k, :2] @ np.append(v, 1))
        return np.array(out)


def load(name, changes=None):
    """A model of models/, with changes {path: value}."""
    return load_model(MODELS / name, changes)


def simulate(name, changes=None):
    """The run of a model of models/, with changes {path: value}."""
    return Run(load(name, changes))


def at(run, times):
    """Rows of a run at the given times [s], which must be output times."""
    rows = np.searchsorted(run.time, np.asarray(times) - 1e-9)
    assert np.abs(run.time[rows] - times).max() < 1e-9, "not an output time"
    return rows
