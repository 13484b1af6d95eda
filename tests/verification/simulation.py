"""What the verification tests share: load and simulate a file of models/ with changes, find rows by time, cases."""

from pathlib import Path

import numpy as np

import fmbd

MODELS = Path(__file__).parents[2] / "models"

#: Constrained mechanisms: model, end [s], how close to dop853 another method has to come there.
#: dop853 itself is compared with published numbers in the files named after the models.
CASES = [
    ("verification/andrews.yaml", 0.03, 1e-8),
    ("verification/car_axis.yaml", 3, 1e-9),
    ("slider_crank.yaml", 10, 1e-8),
    ("four_bars.yaml", 0.5, 1e-8),
]
# of the five-bar
STIFF = {f"bodies.rod_{side}.damping.stiffness_proportional": 5e-5 for side in ("right", "left")}


def load(name, changes=None):
    """A model of models/, with changes {path: value}."""
    return fmbd.load_model(MODELS / name, changes)


def simulate(name, changes=None):
    """The run of a model of models/, with changes {path: value}."""
    return fmbd.simulate(load(name, changes))


def by_dop853(rtol=1e-13):
    """Changes for a run that others are compared with."""
    return {"simulation.method": "dop853", "simulation.rtol": rtol}


def rods(elements):
    """Changes of the five-bar: finite elements of each rod."""
    return {f"bodies.rod_{side}.elements": elements for side in ("right", "left")}


def at(run, times):
    """Rows of a run at the given times [s], which must be output times."""
    rows = np.searchsorted(run.time, np.asarray(times) - 1e-9)
    assert np.abs(run.time[rows] - times).max() < 1e-9, "not an output time"
    return rows


def columns(run, *names):
    """Quantities side by side, shape (output times, names)."""
    return np.stack([run[name] for name in names], axis=-1)
