"""Statics, modes and state spaces as a person asks for them: what is printed, files, refusals."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from fmbd.cli import main

ROOT = Path(__file__).parents[2]
FIVE_BAR = str(ROOT / "models" / "five_bar.yaml")
IDLE = ("--set", "controllers={}", "--set", "motors.*.voltage=0")
FALLING = """
fmbd: 1
gravity: [0, -9.81]
bodies: {ball: {type: rigid, mass: 1, inertia: 1}}
joints: {loose: {type: free, between: [ground.origin, ball.origin]}}
"""


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def answer(capsys, *arguments):
    """Exit code, standard output and standard error of a command; whether it had to compile does not matter."""
    code = main(list(arguments))
    out, err = capsys.readouterr()
    return code, out, re.sub(r"^compiling the kernels.*\n", "", err, flags=re.MULTILINE)


def test_statics_says_what_holds_and_what_is_carried(capsys):
    code, out, err = answer(capsys, "statics", FIVE_BAR, *IDLE)
    assert (code, err) == (0, "")
    assert out.startswith("five-bar: stable equilibrium at t = 0 s\n")
    for fact in (
        "motor_right, motor_left at the start angles; free, they would let the mechanism move (--lock none)",
        "motor_right.rotor      9.81212   562.193                        0",
        "rod_right    -0.000987835  node1",  # the deflection of the independent program
        "rod_right.end   0.100078  0.599213",
        "effector            5.66856  -0.529133    5.6932",
    ):
        assert fact in out
    assert len(out.splitlines()) < 45, "more than one screen"
    assert max(map(len, out.splitlines())) <= 150


def test_statics_prints_and_writes_what_is_asked_for(capsys, tmp_path):
    arguments = (
        "--lock",
        "motor_right,motor_left",
        "--quantities",
        "rod_right.end.position",
        "-o",
        "rest.json",
    )
    code, out, _ = answer(capsys, "statics", FIVE_BAR, *arguments)
    assert code == 0
    x, y = json.loads((tmp_path / "rest.json").read_text())["quantities"]["rod_right.end.position"]
    rows = [line.split() for line in out.splitlines()]
    assert ["rod_right.end.position.x", f"{x:.10g}", "m"] in rows
    assert ["rod_right.end.position.y", f"{y:.10g}", "m"] in rows


def test_modes_of_a_state_of_a_run(capsys):
    assert main(["run", FIVE_BAR, "--duration", "0.05", "-o", "run.vtkhdf", "--quiet"]) == 0
    code, out, _ = answer(
        capsys, "modes", FIVE_BAR, "--about", "run.vtkhdf", "--time", "0.03", "--number", "4", "-o", "m.npz"
    )
    assert code == 0
    assert "modes about the state of the run at t = 0.03 s" in out
    assert "remark" in out and "in motion" in out
    assert "more, up to" in out
    with np.load("m.npz") as file:
        assert file["shapes"].shape == (len(file["poles"]), 10)


def test_modes_warn_of_a_start_that_is_not_at_rest(capsys):
    code, out, _ = answer(capsys, "modes", FIVE_BAR, "--about", "start", "--lock", "all")
    assert code == 0
    assert "motors held  motor_right, motor_left" in out
    assert "not at rest: " in out and "an equilibrium is about 0.0" in out


def test_linearize_shows_a_frequency_response(capsys):
    wanted = ("--outputs", "effector.angle", "--bode", "0.1:10:3", "-o", "space.npz")
    code, out, _ = answer(capsys, "linearize", FIVE_BAR, *wanted)
    assert code == 0
    assert "response to motor_left.voltage [V]: gain, phase [deg]" in out
    with np.load("space.npz") as file:
        np.testing.assert_allclose(file["frequencies"], [0.1, 1, 10])
        first = file["response"][0, 0, 0]
    assert f"{abs(first):.4e}" in out


def test_pictures_of_modes_and_of_a_frequency_response(capsys):
    for name, start in (("shapes.svg", b"<?xml"), ("shapes.pdf", b"%PDF")):
        code, out, _ = answer(capsys, "modes", FIVE_BAR, "--lock", "all", "--number", "4", "--plot", name)
        assert (code, out.splitlines()[-1]) == (0, f"wrote {name}")
        assert Path(name).read_bytes().startswith(start)
    code, out, _ = answer(capsys, "linearize", FIVE_BAR, "--bode", "0.1:100", "--plot", "bode.png")
    assert (code, out.splitlines()[-1]) == (0, "wrote bode.png")
    assert Path("bode.png").read_bytes().startswith(b"\x89PNG")


PATH = ("--point", "effector", "--path", "0.1 - 0.2*t", "0.6 + 0.1*t")
SHORT = ("--set", "simulation.duration=0.1", "--set", "simulation.output_interval=0.01")


def test_inverse_feeds_its_inputs_to_a_model(capsys, tmp_path):
    """What is written runs, and reads as what was printed."""
    files = ("--model", "fed.yaml", "--forward", "forward.vtkhdf", "-o", "inputs.csv")
    code, out, err = answer(capsys, "inverse", FIVE_BAR, *PATH, *SHORT, *files)
    assert (code, err) == (0, "")
    assert out.startswith("five-bar: inverse dynamics over 0.1 s\n")
    for fact in (
        "rod_right.end, from (0.1, 0.6) to (0.08, 0.61) m",
        "m off its path",
        "voltage, most [V]",
        "complete; ",
    ):
        assert fact in out
    assert max(map(len, out.splitlines())) <= 150
    table = np.genfromtxt("inputs.csv", delimiter=",", names=True)
    assert f"{np.abs(table['motor_leftvoltageV']).max():.6g}" in out
    assert answer(capsys, "run", "fed.yaml", "--quiet")[0] == 0
    assert answer(capsys, "info", "forward.vtkhdf")[0] == 0


def test_kinematics_says_what_is_near(capsys):
    code, out, err = answer(capsys, "kinematics", FIVE_BAR, *PATH, *SHORT, "-o", "positions.json")
    assert (code, err) == (0, "")
    for fact in ("x from 0.08 to 0.1 m", "condition", "parallel  ", "serial  ", "nearest 0.17"):
        assert fact in out  # 0.9 m, both links, less 0.72 m from the foot on the left to the effector
    found = json.loads(Path("positions.json").read_text())
    assert found["effector.x"][0] == pytest.approx(0.1)
    sweep = ("--sweep", "shoulder_right=0.5:1.5:3", "--sweep", "shoulder_left=1.5:3.6:3")
    code, out, _ = answer(capsys, "kinematics", FIVE_BAR, "--point", "effector", *sweep)
    assert code == 0
    assert (
        "4 of 9 on the grid can be reached" in out
    )  # those with elbows less than 1 m apart, from the start on


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (("inverse", FIVE_BAR, "--joint", "shoulder_rigt=1"), 2, "did you mean 'shoulder_right'?"),
        (("inverse", FIVE_BAR, "--joint", "shoulder_right=1+z"), 2, "unknown name 'z'"),
        (
            ("inverse", FIVE_BAR, "--point", "effector", "--path", "0.1+t", "0.6"),
            1,
            "effector cannot reach (0.371, 0.6)",
        ),
        (("inverse", FIVE_BAR, "--file", "none.csv"), 2, "none.csv: No such file or directory"),
        (("kinematics", FIVE_BAR, "--point", "efector", "--path", "0", "1"), 2, "did you mean 'effector'?"),
        (("statics", "falling.yaml"), 1, "no equilibrium: nothing stops loose.y, which can move freely"),
        (("modes", FIVE_BAR, "--lock", "arm"), 2, "unknown motor 'arm' (known: motor_right, motor_left)"),
        (("modes", FIVE_BAR, "--about", "start", "--time", "1"), 1, "the start is at t = 0 s, not at 1 s"),
        (("modes", FIVE_BAR, "--about", "none.vtkhdf"), 2, "none.vtkhdf: No such file or directory"),
        (("linearize", FIVE_BAR, "--inputs", "motor_right.volts"), 2, "did you mean 'motor_right.voltage'?"),
        (("linearize", FIVE_BAR, "--plot", "bode.svg"), 2, "say of which frequencies, --bode FROM:TO"),
        (("statics", FIVE_BAR, "--quantities", "effector.fores"), 2, "did you mean 'effector.force'?"),
    ],
)
def test_refusals(capsys, tmp_path, arguments, code, message):
    (tmp_path / "falling.yaml").write_text(FALLING)
    found, _, err = answer(capsys, *arguments)
    assert found == code
    assert message in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ("inverse", FIVE_BAR, "--joint", "shoulder_right"),
            "'shoulder_right' is not of the form NAME=SIGNAL",
        ),
        (("inverse", FIVE_BAR, "--point", "effector"), "give the motion by --joint, by --point with"),
        (("kinematics", FIVE_BAR, "--point", "effector"), "and one of --joint, --path, --file and --sweep"),
        (("kinematics", FIVE_BAR, "--sweep", "a=1:2"), "'a=1:2' is not of the form JOINT=FIRST:LAST:COUNT"),
        (("linearize", FIVE_BAR, "--bode", "10:1"), "'10:1' is not of the form FROM:TO or FROM:TO:N"),
        (("statics", FIVE_BAR, "-o", "rest.txt"), "'rest.txt' does not end in .h5 or .json or .csv"),
        (("statics", FIVE_BAR, "--time", "-1"), "'-1' is not a time from 0 on"),
        (("modes", FIVE_BAR, "--plot", "shapes.gif"), "'shapes.gif' does not end in .svg or .pdf or .png"),
    ],
)
def test_command_lines_that_cannot_be_understood(capsys, arguments, message):
    with pytest.raises(SystemExit):
        main(list(arguments))
    assert message in capsys.readouterr().err
