"""What the verification tests share: load and simulate a file of models/ with changes, find rows by time."""

from pathlib import Path

import numpy as np

import fmbd

MODELS = Path(__file__).parents[2] / "models"


def load(name, changes=None):
    """A model of models/, with changes {path: value}."""
    return fmbd.load_model(MODELS / name, changes)


def simulate(name, changes=None):
    """The run of a model of models/, with changes {path: value}."""
    return fmbd.simulate(load(name, changes))


def at(run, times):
    """Rows of a run at the given times [s], which must be output times."""
    rows = np.searchsorted(run.time, np.asarray(times) - 1e-9)
    assert np.abs(run.time[rows] - times).max() < 1e-9, "not an output time"
    return rows


def columns(run, *names):
    """Quantities side by side, shape (output times, names)."""
    return np.stack([run[name] for name in names], axis=-1)
