"""Every kind of part obeys the balances of mechanics: energy, momentum, angular momentum.

    T + V + dissipated - work = constant,    p = constant and L = constant without gravity and outer forces

for the samples of parts.py, one for every kind of part and its variants. A force with a wrong sign on one of two
bodies, a lever arm measured to the wrong point, a power that misses a term: each breaks a balance.
"""

from collections.abc import Iterable
from typing import Any, get_args

import numpy as np
import pytest
import yaml
from numpy.testing import assert_allclose
from parts import SAMPLES, model
from physics import run

import fmbd.model as models
from fmbd.model import load_model_text
from fmbd.model.controllers import Controller
from fmbd.model.joints import Joint
from fmbd.model.loads import Load
from fmbd.model.motors import Motor
from fmbd.model.signals import Signal
from fmbd.model.springs import Spring
from fmbd.system import System, assemble


@pytest.fixture(autouse=True)
def table(tmp_path, monkeypatch):
    """The file that the table signals read."""
    (tmp_path / "drive.csv").write_text("t,u\n0,0.2\n0.1,1\n0.25,-0.5\n0.4,0.6\n0.7,0\n")
    monkeypatch.chdir(tmp_path)


def types(kinds: Iterable[Any]) -> set[str]:
    """The values that the key `type` takes in these classes."""
    found: set[str] = set()
    for kind in kinds:
        fields = getattr(kind, "model_fields", {})
        found |= set(get_args(fields["type"].annotation)) if "type" in fields else {kind.type}
    return found


def test_every_kind_of_part_has_a_sample():
    """A new kind of part joins SAMPLES in parts.py under `family.type`, and with that all tests below."""
    families = {
        "bodies": [models.RigidBody, models.Beam],
        "joints": [Joint],
        "springs": get_args(Spring),
        "loads": get_args(Load),
        "motors": get_args(Motor),
        "controllers": get_args(Controller),
        "signals": get_args(Signal),
    }
    assert families.keys() == {
        name for name, kind in models.Model.__annotations__.items() if name in families
    }
    wanted = {f"{family}.{kind}" for family, kinds in families.items() for kind in types(kinds)}
    assert wanted == {name.split()[0] for name in SAMPLES}


def system_of(name: str, gravity: bool = True) -> System:
    data = model(SAMPLES[name])
    if not gravity:
        data["gravity"] = [0, 0]
    return assemble(load_model_text(yaml.safe_dump(data, sort_keys=False)))


TIMES = np.linspace(0.0, 0.5, 5)


@pytest.mark.parametrize("name", SAMPLES)
def test_energy_balance(name):
    """Kinetic, potential, elastic and dissipated energy less the work done stay what they are, to 1e-9."""
    block = run(system_of(name), TIMES)
    energy = block.energy
    exchanged = np.ptp(energy[SAMPLES[name].energy])
    assert exchanged > 1e-3
    assert np.abs(energy["balance"]).max() < 1e-9 * max(1.0, max(np.abs(e).max() for e in energy.values()))
    assert np.all(np.diff(energy["dissipated"]) >= 0.0)


@pytest.mark.parametrize("name", [name for name, sample in SAMPLES.items() if sample.internal])
def test_momentum_is_conserved(name):
    """Without gravity, what acts between base and arm leaves momentum and angular momentum alone."""
    system = system_of(name, gravity=False)
    block = run(system, TIMES)
    momentum = np.array(
        [momenta(system, q, v, t) for q, v, t in zip(block.position, block.velocity, block.time)]
    )
    assert np.abs(np.diff(block.velocity[:, :3], axis=0)).max() > 1e-3
    assert_allclose(momentum, momentum[[0] * TIMES.size], rtol=0, atol=1e-9)


def momenta(system: System, q: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
    """Momentum and angular momentum about the world's origin.

    The first coordinates, x, y and angle of the base, move everything: their generalised momenta are the
    momentum, and the angular momentum about the point (x, y).
    """
    assert system.coordinate_names[:3] == ["float.x", "float.y", "float.angle"]
    reference = system.reference
    frames, x, r = reference.frames(q, t)[0], np.append(q, t), np.append(v, 1.0)
    px, py, turning = reference.inertia.momenta(frames, x, r)[:3]
    return np.array([px, py, turning + q[0] * py - q[1] * px])


@pytest.mark.parametrize("name", SAMPLES)
def test_two_formulations(name):
    """The recursion and the matrices agree at the start and somewhere else."""
    system = system_of(name)
    rng = np.random.default_rng(3)
    for size in (0.0, 0.1):
        # beams bend by a tenth of what the joints move
        sizes = size * np.where(system.elastic, 0.1, 1.0)
        q, v = (x + sizes * rng.normal(size=x.size) for x in (system.start.q, system.start.v))
        z = system.start.z + size * rng.normal(size=len(system.states))
        expected, _ = system.matrices(q, v, 0.2, z).accelerations()
        assert_allclose(
            system.accelerations(q, v, 0.2, z)[0], expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max()
        )
