"""Derivatives by differences and their errors; what `fmbd sensitivity` shows, writes and refuses."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.testing import assert_allclose

import fmbd
from fmbd.cli import main
from fmbd.studies.derivatives import Samples, delta_of, summaries

T = np.linspace(0, 3, 61)


def samples(f, p, h, noise, seed=0):
    """f of t and p with an error of this size, and by it thrice as large in the run that is loose."""
    chance = np.random.default_rng(seed)
    values = np.array(
        [f(T, p + d) + noise * chance.uniform(-1, 1, T.size) for d in (0, h, -h, h / 2, -h / 2)]
    )
    return Samples(values, h, delta_of(values[0], values[0] + 3 * noise))


@pytest.mark.parametrize("h", [0.1, 1e-2, 1e-3])
@pytest.mark.parametrize("noise", [0, 1e-8, 1e-5])
def test_the_error_holds_what_is_wrong_with_a_derivative(h, noise):
    """exp(p t), by p t exp(p t): what is left of the step, and of a noise of a third of delta."""
    for seed in range(20):
        found, error = samples(lambda t, p: np.exp(p * t), 0.7, h, noise, seed).derivative()
        assert (np.abs(found - T * np.exp(0.7 * T)) <= error + 1e-12).all()
        assert error.max() < 10 * (h**2 + 3 * noise / h) + 1e-9


def test_peaks_are_found_between_output_times():
    """The amplitude p of p sin(1.3 t + 0.1), whose peak is between two of the times; its end, its mean."""
    course = np.sin(1.3 * T + 0.1)
    p, h = 2.0, 2e-3
    values = np.array([(p + d) * course for d in (0, h, -h, h / 2, -h / 2)])[..., None]
    numbers = {
        name: part.derivative()[0][0] for name, part in summaries(Samples(values, h, 0 * values[0])).items()
    }
    assert_allclose(numbers["peak"], 1, atol=1e-6)
    assert course.max() < 1 - 1e-5
    assert_allclose(numbers["end"], course[-1])
    assert_allclose(numbers["RMS"], np.sqrt((course**2).mean()))


MODEL = """
fmbd: 1
parameters: {reach: 2, one: 1}
gravity: [0, -9]
materials: {foam: {density: 500, youngs_modulus: 1e6}}
sections: {square: {type: rectangle, width: 0.1, height: 0.1}}
bodies:
  hub: {type: rigid, mass: 2*one, inertia: 1, points: {rim: [0.5, 0]}}
  rod: {type: beam, length: reach/2, elements: 1, material: foam, section: square}
joints:
  pivot: {type: revolute, between: [ground.origin, hub.origin], spring: {stiffness: 400}}
  weld: {type: weld, between: [hub.rim, rod.start]}
simulation: {duration: 0.05, output_interval: 0.01}
"""


@pytest.fixture
def model(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("arm.yaml").write_text(MODEL)
    return "arm.yaml"


def test_the_table_and_the_file(model, capsys):
    to = ["--to", "parameters.reach", "gravity[1]", "--jobs", "2", "-o", "arm.h5"]
    names = ["--quantity", "pivot.angle", "rod.end.position"]
    assert main(["sensitivity", model, *to, *names]) == 0
    out = capsys.readouterr().out
    assert "arm: by parameters.reach = 2, steps 0.002 and 0.001" in out
    assert "rod.end.position.x, peak [m]" in out
    assert "wrote arm.h5" in out
    with h5py.File("arm.h5") as file:
        assert file["time"].shape == (6,)
        assert file["values/rod.end.position"].shape == (6, 2)
        found = file["derivatives/pivot.angle/gravity[1]"]
        assert found.attrs["nominal"] == -9
        # gravity alone moves it, and little: the angle is proportional to it
        angle = file["values/pivot.angle"][:]
        assert_allclose(found["derivative"], angle / -9, rtol=1e-4, atol=1e-9)
        assert_allclose(found["end"].attrs["derivative"], found["derivative"][-1])
        assert (found["error"][:] < 1e-5).all()


def test_one_number_in_several_places(model):
    """With the density of both materials, and with the mass of both cubes, whatever moves is doubled."""
    both = fmbd.sensitivity(model, ["bodies.hub.mass"], ["energy.potential"], "statics", lock=None)
    by_name = fmbd.sensitivity(model, ["parameters.one"], ["energy.potential"], "statics")
    one = both["energy.potential", "bodies.hub.mass"].numbers["value"]
    two = by_name["energy.potential", "parameters.one"].numbers["value"]
    assert_allclose(two.derivative, 2 * one.derivative, rtol=1e-8)


MISTAKES = [
    ("bodies.rod.lenght", "bodies.rod.lenght: the model file has no number there, did you mean 'bodies.rod.length'?"),
    ("bodies.rod.material", "bodies.rod.material: the model file has no number there"),
    ("simulation.duration", "simulation.duration: the model file has no number there"),
    ("gravity.*", "gravity.*: these are different numbers, -9, 0"),
    ("bodies.rod.elements", "bodies.rod.elements: is a whole number, by which nothing can be differentiated"),
]  # fmt: skip


@pytest.mark.parametrize(("path", "message"), MISTAKES)
def test_what_is_no_number_of_the_file(model, capsys, path, message):
    assert main(["sensitivity", model, "--to", path, "--quantity", "pivot.angle"]) == 2
    assert capsys.readouterr().err.startswith(message)


def test_what_cannot_be_differentiated(model, capsys):
    to = ["--to", "parameters.reach", "--jobs", "1"]
    assert main(["sensitivity", model, *to, "--quantity", "pivot.angel"]) == 2
    assert capsys.readouterr().err == "no quantity 'pivot.angel', did you mean 'pivot.angle'?\n"
    heavy = [
        "--set",
        "bodies.hub.mass=1e-300",
        "--set",
        "bodies.hub.inertia=0",
        "--set",
        "bodies.rod.length=1e-9",
    ]
    assert (
        main(["sensitivity", model, "--to", "gravity.1", "--quantity", "pivot.angle", *heavy, "--jobs", "1"])
        == 1
    )
    assert "the model as it is: stopped" in capsys.readouterr().err
