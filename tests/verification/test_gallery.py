"""The models that users copy: each stands in the gallery, and runs as it is."""

import numpy as np
import pytest
from simulation import MODELS

import fmbd

FILES = sorted(set(MODELS.rglob("*.yaml")) - set(MODELS.rglob("*.case.yaml")))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_model_is_exemplary(path):
    """Its first line names the schema for editors; it says what it is, and the gallery lists it."""
    text = path.read_text()
    _, schema = text.splitlines()[0].split("$schema=")
    assert (path.parent / schema).resolve() == MODELS / "fmbd.schema.json"
    assert fmbd.load_model(path).description
    assert f"({path.relative_to(MODELS)})" in (MODELS / "README.md").read_text()


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_model_runs_as_it_is(path):
    """To the end, and with the tolerance it has it loses little of the energy that moves in it."""
    run = fmbd.simulate(path)
    assert run.status == "complete"
    moved = max(np.ptp(run[f"energy.{name}"]) for name in ("kinetic", "potential", "elastic", "work"))
    assert np.abs(run["energy.balance"]).max() < 1e-4 * moved
