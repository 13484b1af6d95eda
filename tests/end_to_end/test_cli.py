"""What a person types and what comes back: outputs, one-line errors, exit codes, files."""

import csv
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

import fmbd
from fmbd.cli import main

ROOT = Path(__file__).parents[2]
FIVE_BAR = str(ROOT / "models" / "five_bar.yaml")
SHORT = ("--duration", "0.02")


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def archive(tmp_path):
    """A short run of the five-bar."""
    path = tmp_path / "short.vtkhdf"
    assert main(["run", FIVE_BAR, *SHORT, "-o", str(path), "--quiet"]) == 0
    return path


def fmbd_command(*arguments, **options):
    """The program as a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "fmbd", *arguments],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


def answer(capsys, *arguments):
    """Exit code, standard output and standard error of a command."""
    code = main(list(arguments))
    return code, *capsys.readouterr()


def test_check_says_what_the_five_bar_is(capsys):
    code, out, err = answer(capsys, "check", FIVE_BAR)
    assert (code, err) == (0, "")
    for fact in (
        "└ rod_left         elbow_left (revolute)",  # the tree
        "closed by effector (revolute) of rod_right.end and rod_left.end",
        "8 = 10 coordinates - 2 independent constraints; 2 of the rigid mechanism",
        "shoulder_right.angle  0.981212",  # the exact inverse kinematics of (0.1, 0.6)
        "effector at (0.1, 0.6) m",
        "2 motions are free",
        "takes the rotor to 15.708 rad, plus 0.439917 V against gravity",  # the reference law
        "3 s by auto",
    ):
        assert fact in out
    assert len(out.splitlines()) < 45, "more than one screen"
    assert max(map(len, out.splitlines())) <= 150


def test_check_warns_of_small_steps(capsys):
    """Sixteen elements a rod: 36 kHz, so that three seconds take 110 000 steps (22 000 for 0.5 s were counted)."""
    assert main(["check", FIVE_BAR, "--set", "bodies.*.elements=16"]) == 0
    assert "dop853 below 2.6e-05 s: 110,000 steps or more" in capsys.readouterr().out


def test_check_names_what_is_redundant(capsys, tmp_path):
    model = tmp_path / "held_twice.yaml"
    model.write_text(
        "fmbd: 1\n"
        "bodies: {a: {type: rigid, mass: 1, inertia: 1, points: {p: [1, 0]}},"
        " b: {type: rigid, mass: 1, inertia: 1, points: {p: [1, 0]}}}\n"
        "joints:\n"
        "  one: {type: prismatic, between: [ground.origin, a.origin]}\n"
        "  two: {type: prismatic, between: [ground.origin, b.origin]}\n"
        "  three: {type: weld, between: [a.p, b.p]}\n"
    )
    code, out, _ = answer(capsys, "check", str(model))
    assert code == 0
    assert "1 = 2 coordinates - 1 independent constraints" in out
    assert re.findall(r"redundant +(\S+)", out) == ["three.y", "three.angle"]


def test_run_summarises_and_archives(archive, capsys):
    """The archive is named after the model; nothing but the table is printed when no terminal watches."""
    code, out, err = answer(capsys, "run", FIVE_BAR, *SHORT)
    assert (code, err) == (0, "")
    assert out.startswith("five-bar: complete\n")
    assert "0.02 of 0.02 s, 21 outputs" in out
    assert "fmbd info five-bar.vtkhdf" in out
    assert "\x1b" not in out, "colours, though this is no terminal"
    assert fmbd.open_run("five-bar.vtkhdf").status == "complete"


def test_run_with_changes(archive):
    changes = (
        "--set",
        "bodies.*.elements=2",
        "--set",
        "parameters.l1=0.41",
        "--method",
        "rk45",
        "--rtol",
        "1e-4",
    )
    assert main(["run", FIVE_BAR, *SHORT, *changes, "-o", "changed.vtkhdf", "--quiet"]) == 0
    model = fmbd.open_run("changed.vtkhdf").model
    assert len(model.bodies["rod_left"].nodes) == 3
    assert model.parameters["l1"] == 0.41
    assert (model.simulation.method, model.simulation.rtol) == ("rk45", 1e-4)
    assert model.simulation.duration == 0.02


def test_quiet_is_quiet(capsys):
    assert answer(capsys, "run", FIVE_BAR, *SHORT, "--quiet") == (0, "", "")


def test_a_run_replaces_an_archive_and_nothing_else(archive, capsys):
    assert main(["run", FIVE_BAR, *SHORT, "-o", str(archive), "--quiet"]) == 0
    for name, content in (("notes.txt", b"dear diary"), ("data.h5", None)):
        path = archive.with_name(name)
        if content is None:
            h5py.File(path, "w").close()
        else:
            path.write_bytes(content)
        before = path.read_bytes()
        code, _, err = answer(capsys, "run", FIVE_BAR, *SHORT, "-o", str(path))
        assert code == 2
        assert err.count("\n") == 1
        assert f"{path}: not an fmbd archive" in err
        assert path.read_bytes() == before


def test_a_run_that_cannot_go_on(capsys, tmp_path):
    """A pendulum without inertia; what there was at the start is archived, and the exit code is 1."""
    model = tmp_path / "ghost.yaml"
    model.write_text(
        "fmbd: 1\n"
        "bodies: {ghost: {type: rigid, mass: 0, inertia: 0}}\n"
        "joints: {hinge: {type: revolute, between: [ground.origin, ghost.origin]}}\n"
    )
    code, out, _ = answer(capsys, "run", str(model))
    assert code == 1
    assert out.startswith("ghost: stopped: ")
    assert "hinge" in out
    code, out, err = answer(capsys, "run", str(model), "--quiet")
    assert (code, out) == (1, "")
    assert err.startswith("ghost: stopped: ")


def test_ctrl_c_keeps_what_was_computed(tmp_path):
    path = tmp_path / "long.vtkhdf"
    process = fmbd_command(
        "run",
        FIVE_BAR,
        "--duration",
        "5000",
        "-o",
        str(path),
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    deadline = time.monotonic() + 120
    while not (path.exists() and len(fmbd.open_run(path).time)):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert process.returncode == 130
    assert out.startswith("five-bar: stopped: interrupted by the user at t = ")
    assert "Traceback" not in err
    run = fmbd.open_run(path)
    assert run.status.startswith("stopped: interrupted by the user")
    assert 0 < run.time[-1] < 5000


def test_a_file_that_is_being_written_is_left_alone(archive, capsys):
    """The archive of a run that goes on: this process is its writer."""
    with h5py.File(archive, "r+") as file:
        file.attrs["status"] = "running"
    code, _, err = answer(capsys, "run", FIVE_BAR, *SHORT, "-o", str(archive))
    assert code == 2
    assert "another run is writing it" in err


def test_info(archive, capsys):
    code, out, err = answer(capsys, "info", str(archive))
    assert (code, err) == (0, "")
    assert out.startswith(f"{archive}: complete\n")
    assert "21, t = 0 to 0.02 s" in out
    assert "rod_right.w1 [m]" in out
    assert "effector.x [N]" in out


def test_info_lists_all_names(archive, capsys):
    code, out, _ = answer(capsys, "info", str(archive), "--names")
    assert code == 0
    listed = [line.split()[0] for line in out.splitlines()[1:]]
    assert tuple(listed) == fmbd.open_run(archive).names
    assert re.search(r"^rod_right.end.velocity +m/s +x y$", out, flags=re.MULTILINE)


def test_info_is_quick(archive):
    """It needs neither the compiler nor the model, whose imports take longer than the answer."""
    program = (
        "import sys\nfrom fmbd.cli import main\n"
        f"main(['info', {str(archive)!r}])\n"
        "print(sorted({'numba', 'scipy', 'pydantic', 'pyvista', 'vtkmodules'} & sys.modules.keys()))"
    )
    result = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert result.stdout.endswith("[]\n")


def test_export_is_the_run_in_full_precision(archive):
    names = ["rod_right.end.position", "effector.angle", "rod_left.bending_moment", "energy.balance"]
    assert main(["export", str(archive), "table.csv", "--quantities", *names, "--every", "5"]) == 0
    with Path("table.csv").open() as file:
        head, *rows = csv.reader(file)
    assert head == [
        "time[s]",
        "rod_right.end.position.x[m]",
        "rod_right.end.position.y[m]",
        "effector.angle[rad]",
        "rod_left.bending_moment.node0[N m]",
        "rod_left.bending_moment.node1[N m]",
        "energy.balance[J]",
    ]
    run = fmbd.open_run(archive)
    expected = np.column_stack([run.time, *(run[name] for name in names)])[::5]
    np.testing.assert_array_equal(np.array(rows, float), expected)


def test_export_of_all_coordinates(archive):
    assert main(["export", str(archive), "table.csv"]) == 0
    values = np.loadtxt("table.csv", delimiter=",", skiprows=1)
    run = fmbd.open_run(archive)
    np.testing.assert_array_equal(values, np.column_stack([run.time, run.position]))


def test_export_that_fails_leaves_the_old_file(archive, capsys):
    Path("table.csv").write_text("precious\n")
    code, _, err = answer(
        capsys, "export", str(archive), "table.csv", "--quantities", "rod_right.ent.position"
    )
    assert code == 2
    assert err == "no quantity 'rod_right.ent.position', did you mean 'rod_right.end.position'?\n"
    assert Path("table.csv").read_text() == "precious\n"
    assert sorted(path.name for path in Path().iterdir()) == ["short.vtkhdf", "table.csv"]


def test_matrices_with_names(capsys):
    """Three rows as the paper's Table 1 makes them: rotor inertia 0.1, Km Ke / Ra + d / r^2, Km / Ra."""
    code, out, err = answer(capsys, "matrices", FIVE_BAR)
    assert (code, err) == (0, "")
    tables = {text.split()[0]: text.splitlines() for text in out.split("\n\n")}
    assert re.match(r" 1 motor_right.rotor +0\.1( +\.){9}$", tables["M"][1])
    assert re.match(r" 1 motor_right.rotor +0\.833333 +-5( +\.){8}$", tables["D"][1])
    assert re.match(r" 1 motor_right.rotor +0\.333333 +\.$", tables["B"][1])
    assert tables["C"] == ["C  zero (10 x 10)"]
    assert tables["Phi_q"][1].startswith("1 effector.x")


def test_matrices_saved_at_a_time(archive, capsys):
    assert main(["matrices", FIVE_BAR, "--at", "0.02", "--npz", "m.npz"]) == 0
    saved = np.load("m.npz")
    run = fmbd.open_run(archive)
    np.testing.assert_allclose(saved["q"], run.position[-1], rtol=0, atol=1e-12)
    M = run.system.matrices(run.position[-1], run.velocity[-1], 0.02).M
    np.testing.assert_allclose(saved["M"], M, rtol=0, atol=1e-12)
    assert list(saved["coordinates"]) == list(run.system.coordinate_names)


def test_schema_is_the_committed_one(capsys):
    code, out, _ = answer(capsys, "schema")
    assert code == 0
    assert out == (ROOT / "models" / "fmbd.schema.json").read_text()


@pytest.mark.parametrize("command", ["check", "run", "matrices"])
def test_a_typo_is_named_with_its_place(command, capsys, tmp_path):
    typo = tmp_path / "typo.yaml"
    typo.write_text(Path(FIVE_BAR).read_text().replace("length: l2", "lenght: l2", 1))
    code, out, err = answer(capsys, command, "typo.yaml")
    assert (code, out) == (2, "")
    assert err == "typo.yaml:34:5: bodies.rod_right: unknown key 'lenght', did you mean 'length'?\n"


@pytest.mark.parametrize(
    "arguments, message",
    [
        (["check", "no.yaml"], "no.yaml: there is no such file"),
        (["check", FIVE_BAR, "--set", "bodies.rod_rigth.elements=2"], "did you mean 'rod_right'?"),
        (["run", FIVE_BAR, "--set", "bodies.rod_right.elments=2"], "did you mean 'elements'?"),
        (["run", FIVE_BAR, "--rtol", "-1"], "simulation.rtol: must be positive, is -1"),
        (["run", FIVE_BAR, "--method", "euler"], "one of: auto, dop853, rk45"),
        (
            ["run", FIVE_BAR, "-o", "no/such/folder.vtkhdf"],
            "cannot write no/such/folder.vtkhdf: No such file",
        ),
        (["info", "no.vtkhdf"], "no.vtkhdf: No such file"),
        (["info", FIVE_BAR], "not an fmbd archive"),
        (["export", "no.vtkhdf", "table.csv"], "no.vtkhdf: No such file"),
    ],
)
def test_bad_input_is_answered_in_one_line(arguments, message, capsys):
    code, out, err = answer(capsys, *arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1


@pytest.mark.parametrize(
    "arguments, message",
    [
        ([], "required: COMMAND"),
        (["rnu", FIVE_BAR], "invalid choice: 'rnu'"),
        (["run", FIVE_BAR, "--set", "elements"], "'elements' is not of the form PATH=VALUE"),
        (["export", "a.vtkhdf", "table.xlsx"], "does not end in .csv"),
        (["export", "a.vtkhdf", "table.csv", "--every", "0"], "'0' is not a whole number from 1 on"),
        (["matrices", FIVE_BAR, "--at", "noon"], "'noon' is neither a time nor `initial`"),
        (["matrices", FIVE_BAR, "--precision", "99"], "from 1 to 17"),
    ],
)
def test_a_command_line_that_cannot_be_understood(arguments, message, capsys):
    with pytest.raises(SystemExit) as exit_:
        main(arguments)
    assert exit_.value.code == 2
    assert message in capsys.readouterr().err


def test_help_and_version(capsys):
    for arguments in (["--help"], ["run", "--help"]):
        with pytest.raises(SystemExit) as exit_:
            main(arguments)
        assert exit_.value.code == 0
    assert "Ctrl-C keeps what is in it" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out == f"fmbd {fmbd.__version__}\n"


def test_a_reader_that_stops_reading():
    """As `fmbd matrices ... | head -1` does, when there is more to say than a pipe holds."""
    command = fmbd_command("matrices", FIVE_BAR, "--set", "bodies.*.elements=20", "--precision", "17")
    with command as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == ""
        assert process.wait(timeout=30) == 141


def test_what_a_terminal_shows(tmp_path):
    """Colours, a bar with the time left; NO_COLOR takes the colours away."""
    pty = pytest.importorskip("pty")
    for no_color in (False, True):
        controller, terminal = pty.openpty()
        environment = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
        process = subprocess.Popen(
            [
                sys.executable,
                "-m",
                "fmbd",
                "run",
                FIVE_BAR,
                "--duration",
                "1",
                "-o",
                str(tmp_path / "a.vtkhdf"),
            ],
            env=environment
            | {"PYTHONPATH": str(ROOT), "TERM": "xterm"}
            | ({"NO_COLOR": "1"} if no_color else {}),
            stdout=terminal,
            stderr=terminal,
        )
        os.close(terminal)
        seen = b""
        try:
            while part := os.read(controller, 4096):
                seen += part
        except OSError:  # the program has closed the terminal
            pass
        os.close(controller)
        assert process.wait(timeout=30) == 0
        assert b"left" in seen
        assert b"five-bar: complete" in seen
        assert (re.search(rb"\x1b\[[0-9;]*3[0-9]m", seen) is None) == no_color
