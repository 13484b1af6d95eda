"""The commands that make pictures: files as asked for, one-line answers to what cannot be drawn."""

import re
from pathlib import Path

import pytest

import fmbd
from fmbd.cli import main

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with short runs of the five-bar, by two methods, and of the pendulum."""
    folder = tmp_path_factory.mktemp("runs")
    model = fmbd.load_model(MODELS / "five_bar.yaml", {"simulation.duration": 0.2})
    fmbd.simulate(model, folder / "short.vtkhdf")
    fmbd.simulate(model.with_("simulation.method", "rk45"), folder / "other.vtkhdf")
    pendulum = fmbd.load_model(MODELS / "pendulum.yaml", {"simulation.duration": 0.5})
    fmbd.simulate(pendulum, folder / "pendulum.vtkhdf")
    return folder


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(
    runs: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path_factory.mktemp("here")
    for archive in runs.iterdir():
        (folder / archive.name).symlink_to(archive)
    monkeypatch.chdir(folder)


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command."""
    code = main(list(arguments))
    return code, *capsys.readouterr()


def test_plot_draws_the_figures_of_the_paper(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = answer(capsys, "plot", "short.vtkhdf")
    assert (code, err) == (0, "")
    pictures = [f"short-{name}.png" for name in ("joints", "beams", "constraints")]
    assert out.splitlines() == [f"wrote {picture}" for picture in pictures]
    for picture in pictures:
        assert Path(picture).read_bytes().startswith(b"\x89PNG")


def test_plot_writes_where_it_is_told_to() -> None:
    for name, start in (("a.svg", b"<?xml"), ("a.pdf", b"%PDF"), ("a.png", b"\x89PNG")):
        assert main(["plot", "short.vtkhdf", "*.voltage", "-o", name]) == 0
        assert Path(name).read_bytes().startswith(start)
    assert main(["plot", "short.vtkhdf", "energy", "mechanism", "-o", "b.svg"]) == 0
    assert Path("b-energy.svg").is_file()
    assert Path("b-mechanism.svg").is_file()


def test_plot_names_the_peaks_of_spectra(capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = answer(capsys, "plot", "short.vtkhdf", "rod_left.end.slope", "--spectrum")
    assert code == 0
    assert re.search(r"rod_left +\d.* Hz \(.* mrad\)", out)


def test_plot_compares_archives() -> None:
    assert main(["plot", "short.vtkhdf", "other.vtkhdf", "beams", "-o", "both.svg"]) == 0
    assert Path("both.svg").is_file()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["plot", "no.vtkhdf"], "no.vtkhdf: No such file or directory"),
        (["plot", "short.vtkhdf", "enrgy"], "no quantity 'enrgy', did you mean 'energy'?"),
        (["plot", "pendulum.vtkhdf", "beams"], "beams: the model 'pendulum' has nothing to show there"),
        (["plot", "short.vtkhdf", "energy", "--from", "9"], "fewer than two output times lie between 9 and inf s"),
        (["plot", "short.vtkhdf", "mechanism", "--spectrum"], "mechanism: shows one archive over time"),
    ],
)  # fmt: skip
def test_what_cannot_be_drawn_is_answered_in_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted(Path().iterdir())
    code, _, err = answer(capsys, *arguments)
    assert (code, err) == (2, message + "\n")
    assert sorted(Path().iterdir()) == before
