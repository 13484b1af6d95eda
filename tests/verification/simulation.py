"""What the verification tests share: load and simulate a file of models/ with changes, find rows by time, cases."""

from pathlib import Path

import numpy as np
import yaml

import fmbd
from fmbd.model import load_model_text

MODELS = Path(__file__).parents[2] / "models"
G = 9.81

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


def model(**parts):
    """A model of these parts."""
    return load_model_text(yaml.safe_dump({"fmbd": 1, **parts}, sort_keys=False))


def revolute(a, b, **more):
    """A revolute joint."""
    return {"type": "revolute", "between": [a, b], **more}


def table_on_three_cranks():
    """Parallel cranks, one of them redundant, a spring on the middle one: mass 3, arms 0.5 with inertias 0.1."""
    crank = {"type": "rigid", "mass": 1, "inertia": 0.1, "points": {"end": [0.5, 0]}}
    table = {"type": "rigid", "mass": 3, "inertia": 0.1, "points": {f"H{k}": [k, 0] for k in range(3)}}
    feet = {f"foot{k}": revolute(f"ground.F{k}", f"crank{k}.origin") for k in range(3)}
    feet["foot1"]["spring"] = {"stiffness": 40, "rest": 1.2}
    return model(
        gravity=[0, -G],
        ground={"points": {f"F{k}": [k, 0] for k in range(3)}},
        bodies={f"crank{k}": crank for k in range(3)} | {"table": table},
        joints=feet | {f"head{k}": revolute(f"crank{k}.end", f"table.H{k}") for k in range(3)},
        initial={"joints": {"foot0": 1.0}},
    )
