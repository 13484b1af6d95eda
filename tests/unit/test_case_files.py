"""Case files of `fmbd verify`: what is wrong with them, and where; what a comparison says."""

# ruff: noqa: E501  (a table of messages is easiest to read with one mistake a line)

import pytest

import fmbd
from fmbd.cli import main

MODEL = """
fmbd: 1
parameters: {length: 2}
gravity: [0, -9]
bodies: {bob: {type: rigid, mass: 1, inertia: 0, center_of_mass: [length, 0]}}
joints: {pivot: {type: revolute, between: [ground.origin, bob.origin]}}
springs: {}
simulation: {duration: 0.1, output_interval: 0.05}
"""
# released from the horizontal, angular acceleration g / length
CASE = """fmbd: 1
model: bob.yaml
source: Galilei
set: {simulation.rtol: 1e-9}
expect:
  - quantities: [pivot.angle.acceleration, bob.center_of_mass.position.x]
    at: {0: [-9/length, length]}
    tolerance: 1e-12
  - analysis: frequencies
    variant: with a spring
    set: {joints.pivot.spring: {stiffness: 16}}
    quantities: [frequency.1]
    values: [1/pi]
    tolerance: {relative: 1e-9}
"""


@pytest.fixture
def case(tmp_path, monkeypatch):
    """A folder with the model and the case, changed by replacing one text by another."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bob.yaml").write_text(MODEL)

    def write(old="", new=""):
        assert old in CASE
        (tmp_path / "bob.case.yaml").write_text(CASE.replace(old, new) if old else CASE)
        return "bob.case.yaml"

    return write


def test_quantities_are_compared_one_by_one(case):
    first, second, third = fmbd.verify([case()])
    assert (first.case, first.variant, first.source) == ("bob", "", "Galilei")
    assert (first.quantity, first.unit, first.time) == ("pivot.angle.acceleration", "rad/s^2", 0)
    assert first.expected == -4.5
    assert second.quantity == "bob.center_of_mass.position.x"
    assert (third.variant, third.time) == ("with a spring", None)
    assert all(found.holds for found in (first, second, third))


def test_of_several_times_the_worst_is_shown(case):
    changed = case("{0: [-9/length, length]}", "{0: [-9/length, length], 0.05: [-4.5, 2], 0.1: [-4.5, 2]}")
    worst = fmbd.verify([changed])[0]
    assert (worst.time, worst.count) == (0.1, 3)
    assert not worst.holds


def test_a_model_names_the_case_beside_it_and_a_folder_all_its_cases(case):
    case()
    assert len(fmbd.verify(["bob.yaml"])) == len(fmbd.verify(["."])) == 3


def test_the_exit_code_says_whether_all_hold(case, capsys):
    assert main(["verify", case(), "--jobs", "1"]) == 0
    assert "3 quantities, 3 values: all hold" in capsys.readouterr().out
    assert main(["verify", case("[1/pi]", "[0.32]"), "--jobs", "1"]) == 1
    out = capsys.readouterr().out
    assert "FAILS" in out and "1 of 3 FAIL" in out


def test_a_run_that_stops_fails(case):
    case("set: {", "set: {bodies.bob.mass: 0, ")
    first, second, _ = fmbd.verify(["bob.yaml"])
    assert not first.holds and not second.holds
    assert first.problem.startswith("stopped: ")


MISTAKES = [
    ("source: Galilei", "sauce: Galilei", "bob.case.yaml:3:1: unknown key 'sauce', did you mean 'source'?"),
    ("bob.yaml", "bub.yaml", "bob.case.yaml:2:8: model: there is no file 'bub.yaml'"),
    ("rtol", "rtoll", "bob.case.yaml:4:1: set: bob.yaml: simulation: unknown key 'rtoll', did you mean 'rtol'?"),
    ("pivot.angle.acc", "pivot.angel.acc", "bob.case.yaml:6:17: expect[0].quantities: no quantity 'pivot.angel.acceleration', did you mean 'pivot.angle.acceleration'?"),
    ("position.x]", "position]", "bob.case.yaml:6:17: expect[0].quantities: 'bob.center_of_mass.position' has several columns: name one, such as bob.center_of_mass.position.x"),
    ("-9/length, length", "-9/length", "bob.case.yaml:7:13: expect[0].at.0: has 1 values for 2 quantities"),
    ("{0: [", "{0.02: [", "bob.case.yaml:7:5: expect[0].at: 0.02 s is no output time; near it there is 0 s"),
    ("length]}", "lenght]}", "bob.case.yaml:7:25: expect[0].at.0[1]: unknown name 'lenght', did you mean 'length'?"),
    ("1e-12", "-1", "bob.case.yaml:8:16: expect[0].tolerance: must not be negative, is -1"),
    ("analysis: frequencies", "analysis: mode", "bob.case.yaml:9:15: expect[1].analysis: unknown choice 'mode', did you mean 'modes'? (one of: run, statics, modes, frequencies)"),
    ("analysis: frequencies", "moving: true", "bob.case.yaml:13:13: expect[1].values: is not for the analysis 'run', which is compared by 'at'"),
    ("    variant: with a spring", "    moving: true", "bob.case.yaml:9:5: expect[1]: moving: is for the analyses statics and modes, not for frequencies"),
    ("stiffness", "stifness", "bob.case.yaml:11:5: expect[1].set: bob.yaml: joints.pivot.spring: unknown key 'stifness', did you mean 'stiffness'?"),
    ("frequency.1", "frequency.2", "bob.case.yaml:12:17: expect[1].quantities: no quantity 'frequency.2': the last is frequency.1"),
    ("values: [1/pi]", "at: {1: [1/pi]}", "bob.case.yaml:13:5: expect[1].at: is not for the analysis 'frequencies', which is compared by 'values'"),
    ("    values: [1/pi]\n", "", "bob.case.yaml:9:5: expect[1]: needs one of the keys 'at', 'values' and 'order'"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message"), MISTAKES, ids=[message for *_, message in MISTAKES])
def test_a_mistake_is_named_with_its_place(case, capsys, old, new, message):
    assert main(["verify", case(old, new), "--jobs", "1"]) == 2
    assert capsys.readouterr().err == message + "\n"


def test_a_name_that_is_no_case(capsys, tmp_path):
    assert main(["verify", "andrew"]) == 2
    assert capsys.readouterr().err == "unknown verification case 'andrew', did you mean 'andrews'?\n"
