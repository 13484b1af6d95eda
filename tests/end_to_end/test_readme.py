"""What the README shows, tried: its model, its commands, its Python."""

import re
import shlex
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


def test_sensitivity(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The derivatives that are shown, to seven digits."""
    program, *arguments = shlex.split(block("sh", "fmbd sensitivity"))
    assert program == ".venv/bin/fmbd"
    assert main(arguments) == 0
    row = re.compile(r"^(effector.force.[xy]) \[N\] +(\S+) +(\S+)", re.MULTILINE)
    shown, got = row.findall(README), row.findall(capsys.readouterr().out)
    assert len(shown) == 2
    for one, other in zip(shown, got):
        assert one[0] == other[0]
        assert [float(x) for x in one[1:]] == pytest.approx([float(x) for x in other[1:]], rel=1e-7)


def test_citation_and_changelog_know_the_version() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert citation["version"] == fmbd.__version__
    assert f"] - {fmbd.__version__}" in (ROOT / "CHANGELOG.md").read_text()
