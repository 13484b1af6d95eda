"""`fmbd sensitivity` as a person reads it."""

import re
from pathlib import Path

import pytest

from fmbd.cli import main

BEAM = """
fmbd: 1
gravity: [0, -9.81]
materials: {steel: {density: 7850, youngs_modulus: 2.1e11}}
sections: {bar: {type: rectangle, width: 0.02, height: 0.1}}
bodies:
  rod: {type: beam, length: 0.6, elements: 2, material: steel, section: bar, frame: clamped}
  wheel: {type: rigid, mass: 3, inertia: 0.1}
joints:
  wall: {type: weld, between: [ground.origin, rod.start]}
  foot: {type: weld, between: [ground.origin, wheel.origin]}
"""


@pytest.fixture
def rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.chdir(tmp_path)
    Path("beam.yaml").write_text(BEAM)

    def asked(path: str) -> list[str]:
        arguments = [
            "--quantity",
            "rod.end.deflection",
            "--analysis",
            "statics",
            "--jobs",
            "1",
            "-o",
            "found.h5",
        ]
        assert main(["sensitivity", "beam.yaml", "--to", path, *arguments]) == 0
        out = capsys.readouterr().out
        return next(line for line in out.splitlines() if line.startswith("rod.end.deflection")).split(None, 5)

    return asked


def test_a_small_derivative_is_no_zero(rows) -> None:
    """The end of a hanging beam: w = -rho A g L^4 / (8 E I), dw/dE = -w / E."""
    E, area, inertia = 2.1e11, 0.02 * 0.1, 0.02 * 0.1**3 / 12
    w = -7850 * area * 9.81 * 0.6**4 / (8 * E * inertia)
    _, _, value, derivative, _, relative = rows("materials.steel.youngs_modulus")
    assert float(value) == pytest.approx(w, rel=1e-6)
    assert float(derivative) == pytest.approx(-w / E, rel=1e-5)
    assert float(relative) == pytest.approx(-1, rel=1e-5)


def test_noise_is_said_to_be_zero(rows) -> None:
    """What does not change has no relative derivative either."""
    error = rows("bodies.wheel.mass")[4:]
    assert re.fullmatch(r"\S+ zero, within the error", " ".join(error))


def test_a_whole_number_has_no_derivative(rows, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--quantity", "rod.end.deflection", "--analysis", "statics"]
    assert main(["sensitivity", "beam.yaml", "--to", "bodies.rod.elements", *arguments]) == 2
    assert capsys.readouterr().err.startswith("bodies.rod.elements: is a whole number, by which nothing")


@pytest.mark.parametrize("command", ["info", "plot", "report"])
def test_its_file_says_what_it_is(rows, command: str, capsys: pytest.CaptureFixture[str]) -> None:
    rows("bodies.rod.length")
    assert main([command, "found.h5"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("found.h5: derivatives of `fmbd sensitivity`, not the archive of a run")
