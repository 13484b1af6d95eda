"""What the README shows, tried: its model, its commands, its Python, and the script of the figures."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

import fmbd
from fmbd.cli import main

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text()


def block(language: str, holding: str) -> str:
    """The first code block in this language that holds a text."""
    blocks = re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.DOTALL | re.MULTILINE)
    return next(text for text in blocks if holding in text)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the README's reader works: a folder with models/ in it."""
    (tmp_path / "models").symlink_to(ROOT / "models")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_model_of_your_own(folder: Path) -> None:
    (folder / "swing.yaml").write_text(block("yaml", "hinge"))
    for line in block("sh", "swing.yaml").splitlines():
        program, *arguments = shlex.split(line, comments=True)
        assert program == ".venv/bin/fmbd"
        assert main(arguments) == 0, line
    header = (folder / "swing.csv").read_text().splitlines()[0]
    assert header.startswith("time")


def test_the_error_that_is_shown(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = block("yaml", "hinge")
    (folder / "swing.yaml").write_text(text.replace("length", "lenght"))
    assert main(["check", "swing.yaml"]) == 2
    shown = re.search(r"`(swing.yaml:\d+:\d+: .*?\?)`", README)
    assert shown and shown[1] in capsys.readouterr().err


def test_results_in_python(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    namespace: dict[str, object] = {}
    exec(block("python", "fmbd.simulate"), namespace)
    time, *_ = capsys.readouterr().out.split()
    assert float(time) == 3
    assert fmbd.open_run(folder / "five_bar_4.vtkhdf").status == "complete"


def test_analyses(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for line in block("sh", "fmbd statics").splitlines():
        program, *arguments = shlex.split(line, comments=True)
        assert program == ".venv/bin/fmbd"
        assert main(arguments) == 0, line
    assert (folder / "five_bar.mat").stat().st_size > 1000
    shown = re.search(r"^five-bar: modes.*?\.\.\.$", README, flags=re.DOTALL | re.MULTILINE)
    assert shown and shown[0].removesuffix("...") in capsys.readouterr().out
    namespace: dict[str, object] = {"fmbd": fmbd, "model": fmbd.load_model("models/five_bar.yaml")}
    exec(block("python", "fmbd.equilibrium"), namespace)
    assert capsys.readouterr().out.startswith("stable -0.00098")


def test_figures_of_the_five_bar(folder: Path) -> None:
    archive = folder / "short.vtkhdf"
    fmbd.simulate(fmbd.load_model("models/five_bar.yaml", {"simulation.duration": 0.02}), archive)
    script = ROOT / "postprocess" / "five_bar_figures.py"
    subprocess.run([sys.executable, script, archive, "--folder", folder / "figures"], check=True)
    pictures = sorted((folder / "figures").iterdir())
    assert [picture.name for picture in pictures] == [
        "five_bar_closure.png",
        "five_bar_deflections.png",
        "five_bar_joints.png",
    ]
    assert all(picture.stat().st_size > 10_000 for picture in pictures)


def test_study_of_the_elements_of_the_five_bar(folder: Path) -> None:
    """Its script, for a short move; the table of the README has the rows and columns that it prints."""
    script = ROOT / "postprocess" / "five_bar_refinement.py"
    command = [sys.executable, script, "--folder", folder, "--duration", "0.02"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    assert (folder / "five_bar_refinement.svg").stat().st_size > 10_000
    for line in done.stdout.splitlines():
        if line.startswith("| "):
            assert re.match(r"\|[^|]*\|[^|]*\|", line)[0] in README


def test_citation_and_changelog_know_the_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert citation["version"] == fmbd.__version__
    assert f"] - {fmbd.__version__}" in (ROOT / "CHANGELOG.md").read_text()
