"""Families of models, ever finer: members, verdicts, files, and what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import h5py
import pytest
from numpy.testing import assert_allclose

import fmbd
from fmbd.cli import main
from fmbd.studies.convergence import Order
from fmbd.studies.tables import table

MODELS = Path(__file__).parents[2] / "models"
BEAM = str(MODELS / "verification" / "beam.yaml")
PENDULUM = str(MODELS / "pendulum.yaml")
FOUR_BARS = str(MODELS / "four_bars.yaml")
ELEMENTS = "bodies.*.elements"


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_the_frequency_of_a_cantilever_with_its_error():
    """(1.87510406871 / L)^2 sqrt(EI / m) / 2 pi, with units for all; elements are too stiff by order 4."""
    study = fmbd.refine(BEAM, {ELEMENTS: [1, 2, 4, 8]}, ["frequency.1"], analysis="modes")
    (result,) = study.results
    exact = 0.559591209967
    assert_allclose(result.found.order, 4, atol=0.15)
    finest = study.members[-1].measured.values["frequency.1"]
    assert abs(finest - exact) < result.found.bar.end < 2 * abs(finest - exact)
    assert abs(result.found.extrapolated - exact) < 0.1 * abs(finest - exact)
    assert result.verdict == (
        "frequency.1 converges with order 3.9 in elements: 8 is right to 0.00028 %, "
        "1 is enough for 1 %, 2 is enough for 0.1 %"
    )


def test_three_members_are_too_few_to_be_certain():
    """So the verdict says, and it stands in no green box; where there is no order, the table has a dash."""
    study = fmbd.refine(BEAM, {ELEMENTS: [1, 2, 4]}, ["frequency.1"], analysis="modes")
    (result,) = study.results
    assert result.verdict.startswith(
        "frequency.1: too few members to tell an order in elements (it takes four); 4 is right to about"
    )
    page = study.report()
    assert '<ul class="verdicts">' not in page
    assert f'<ul class="warnings"><li>{result.verdict}</li></ul>' in page
    exact = replace(result.found, orders=(Order(float("nan"), 0.0),))
    _, headings, rows = table(study, replace(result, found=exact))
    assert rows[2][headings.index("order")] == "-"


def test_several_values_are_refined_from_the_finest_of_the_others():
    over = {"simulation.rtol": [1e-3, 1e-5], ELEMENTS: [1, 2]}
    study = fmbd.refine(BEAM, over, ["beam.end.deflection"])
    changes = [dict(member.changes) for member in study.members]
    assert changes == [
        {"simulation.rtol": 1e-3, ELEMENTS: 2},
        {"simulation.rtol": 1e-5, ELEMENTS: 1},
        {"simulation.rtol": 1e-5, ELEMENTS: 2},
    ]
    time, mesh = study.results
    assert (time.members, mesh.members) == ((0, 2), (1, 2))
    assert study.check.changes["simulation.rtol"] == 1e-6
    assert time.time_error is None, "tolerances are refined themselves"
    assert mesh.time_error.mean > 0


def test_the_error_of_time_is_measured_and_said(capsys):
    """A tolerance so loose that elements hardly show."""
    arguments = ["--over", "bodies.*.elements=8,12", "--quantity", "beam.end.deflection", "--jobs", "1"]
    assert main(["refine", BEAM, "--set", "simulation.rtol=1e-3", *arguments]) == 0
    assert "too much, choose a tighter tolerance" in capsys.readouterr().out


def test_a_member_that_fails_is_reported_and_left_out(capsys):
    """Tight tolerances do not get the four bars through their singular positions."""
    over = ["--over", "simulation.rtol=1e-7,1e-8,1e-10", "--set", "simulation.method=dop853"]
    assert main(["refine", FOUR_BARS, *over, "--quantity", "foot0.angle", "--jobs", "2"]) == 1
    out = capsys.readouterr().out
    assert "left out  simulation.rtol = 1e-10: stopped: at t = 1.2" in out
    assert "1e-08 is right to about" in out


def test_the_file_of_a_study(capsys):
    over = ["--over", "simulation.rtol=1e-4,1e-6,1e-8"]
    names = ["pivot.angle", "bob.center_of_mass.position", "bob.origin.position"]  # the last does not move
    output = ["-o", "study.h5", "--plot", "study.svg", "--jobs", "1"]
    assert main(["refine", PENDULUM, *over, "--quantity", *names, *output]) == 0
    assert "wrote study.h5" in capsys.readouterr().out
    assert Path("study.svg").read_text().startswith("<?xml")
    with h5py.File("study.h5") as file:
        assert file.attrs["fmbd_version"] == fmbd.__version__
        assert file["model"].asstr()[()] == Path(PENDULUM).read_text()
        assert json.loads(file["members/0"].attrs["changes"]) == {"simulation.rtol": 1e-4}
        series = [file[f"members/{k}/values/pivot.angle"][:] for k in range(3)]
        result = file["results/pivot.angle/simulation.rtol"]
        assert result.attrs["units"] == "rad"
        assert "right to about" in result.attrs["verdict"]
        assert_allclose(result["difference_largest"][0], abs(series[0] - series[2]).max())
        assert file["members/2/values/bob.center_of_mass.position"].shape == (1001, 2)


# ruff: noqa: E501  (a table of messages is easiest to read with one mistake a line)
MISTAKES = [
    ("bodies.*.elements=8,4", "bodies.*.elements: give the values from coarse to fine: 4,8"),
    ("simulation.rtol=1e-8,1e-6", "simulation.rtol: give the values from coarse to fine: 1e-06,1e-08"),
    ("bodies.*.elements=4", "bodies.*.elements: give two positive values or more, from coarse to fine, such as 1,2,4,8"),
    ("bodies.*.elements=1,many", "bodies.*.elements: what is refined must be numbers, not 1, many"),
    ("bodies.*.lements=1,2", "bodies.*.lements: no part of 'bodies' can have the key 'lements'"),
    ("simulation.duration=2,1", "members must have the same duration and output interval to be compared"),
]  # fmt: skip


@pytest.mark.parametrize(("over", "message"), MISTAKES)
def test_what_cannot_be_refined(capsys, over, message):
    assert main(["refine", BEAM, "--over", over, "--quantity", "beam.end.deflection"]) == 2
    assert capsys.readouterr().err == message + "\n"


def test_quantities_that_cannot_be_compared(capsys):
    over = ["--over", "bodies.*.elements=1,2"]
    assert main(["refine", BEAM, *over, "--quantity", "beam.end.deflecton"]) == 2
    assert "did you mean 'beam.end.deflection'?" in capsys.readouterr().err
    assert main(["refine", BEAM, *over, "--quantity", "beam.deflection"]) == 2
    assert "ask for a point, such as beam.end.deflection" in capsys.readouterr().err
    for name, advice in {
        "beam.node2.slope": "points.here=1, and ask for beam.here.slope",
        "beam.deflection.node1": "points.here=1, and ask for beam.here.deflection",
        "beam.w1": "points.here=1, and ask for beam.here.deflection",
        "beam.slope1.rate": "points.here=1, and ask for beam.here.slope",
    }.items():
        assert main(["refine", BEAM, *over, "--quantity", name]) == 2
        message = (
            f"'{name}' is at another place in each member: give the place a name, such as --set bodies.beam."
        )
        assert capsys.readouterr().err == f"{message}{advice}\n"


def test_a_place_with_a_name_stays_where_it_is(capsys):
    """Static deflection q x^2 (6 L^2 - 4 L x + x^2) / 24 EI at a third of the length, and at the fixed node 0."""
    names = ["beam.here.deflection", "beam.node0.bending_moment", "beam.end.position"]
    where = ["--set", "bodies.beam.points.here=1/3", "--set", "gravity=[0, -1e-3]", "--set", "loads={}"]
    over = ["--over", "bodies.*.elements=1,2,4,8", "--analysis", "statics", "-o", "study.h5", "--jobs", "1"]
    assert main(["refine", BEAM, *where, *over, "--quantity", *names]) == 0
    assert "beam.end.position [m]" in capsys.readouterr().out
    with h5py.File("study.h5") as file:
        assert file.attrs["analysis"] == "statics"
        assert file["members/3/values/beam.end.position"].shape == (1, 2)
        found = file["members/3/values/beam.here.deflection"][()]
    assert_allclose(found, -1e-3 / 9 * (6 - 4 / 3 + 1 / 9) / 24, rtol=1e-3)


def test_what_holds_the_motors_of_an_equilibrium(capsys):
    """Torques that hold the five-bar, as `fmbd.equilibrium` finds them; what rests has no rates."""
    five_bar = str(MODELS / "five_bar.yaml")
    over = ["--over", "bodies.*.elements=1,2", "--quantity", "motor_right.torque", "--jobs", "1"]
    assert main(["refine", five_bar, *over, "--lock", "all"]) == 2
    assert capsys.readouterr().err == "lock: is for the analyses statics and modes, not for run\n"
    held = fmbd.refine(five_bar, {ELEMENTS: [1, 2]}, ["motor_right.torque"], "statics", lock="all")
    rest = fmbd.equilibrium(fmbd.load_model(five_bar, {ELEMENTS: 2}), lock="all")
    assert held.members[-1].measured.values["motor_right.torque"] == rest["motor_right.torque"]
    assert (
        main(
            ["refine", five_bar, *over[:-4], "--analysis", "statics", "--quantity", "elbow_right.angle.rate"]
        )
        == 2
    )
    assert (
        capsys.readouterr().err == "no quantity 'elbow_right.angle.rate': nothing moves at an equilibrium\n"
    )


def test_a_model_that_needs_what_is_refined(capsys):
    """Beams that stretch are none without segments: members are, each with its own."""
    arguments = [
        "--over",
        "bodies.beam.segments=2,4",
        "--set",
        "bodies.beam.stretch=1e4",
        "--analysis",
        "modes",
    ]
    assert main(["refine", BEAM, *arguments, "--quantity", "frequency.1", "--jobs", "1"]) == 0
    assert "bodies.beam.segments" in capsys.readouterr().out
    assert (
        main(["refine", BEAM, *arguments, "--set", "bodies.beam.elments=1", "--quantity", "frequency.1"]) == 2
    )
    assert "did you mean 'elements'" in capsys.readouterr().err
