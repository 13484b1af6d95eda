"""The scripts that researchers copy run as their heads say, and draw what they promise."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import fmbd

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted((ROOT / "postprocess").glob("*.py"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a short run of the five-bar and one of the cantilever."""
    here = tmp_path_factory.mktemp("postprocess")
    for model, duration, archive in (("five_bar", 0.1, "five-bar"), ("cantilever", 1.0, "cantilever")):
        changed = fmbd.load_model(ROOT / "models" / f"{model}.yaml", {"simulation.duration": duration})
        fmbd.simulate(changed, here / f"{archive}.vtkhdf")
    return here


def run(folder: Path, script: str, *arguments: str) -> str:
    """What a script prints."""
    command = [sys.executable, ROOT / "postprocess" / script, *arguments]
    return subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout


def assert_drawn(picture: Path) -> None:
    """A picture that is not empty."""
    with Image.open(picture) as image:
        assert np.asarray(image.convert("L")).std() > 5.0


def test_figures_of_the_five_bar(folder: Path) -> None:
    out = run(folder, "five_bar_figures.py", "five-bar.vtkhdf", "--folder", "figures")
    for name in ("joints", "deflections", "closure"):
        assert f"figures/five_bar_{name}.png" in out
        assert_drawn(folder / "figures" / f"five_bar_{name}.png")


def test_the_way_to_the_target(folder: Path) -> None:
    """The end point starts 224 mm from its target, and has hardly left after a tenth of a second."""
    out = run(folder, "end_point.py", "five-bar.vtkhdf", "rod_right.end", "--target", "-0.1", "0.7")
    assert "within 1 mm for good: never; at the end: 2" in out
    assert_drawn(folder / "end_point.png")


def test_a_map_of_the_bending_moment(folder: Path) -> None:
    run(folder, "beam_map.py", "cantilever.vtkhdf", "ruler", "--from", "0.5", "-o", "map.png")
    assert_drawn(folder / "map.png")


def test_a_spectrogram(folder: Path) -> None:
    run(folder, "spectrogram.py", "cantilever.vtkhdf", "ruler.end.deflection", "-o", "spectrogram.png")
    assert_drawn(folder / "spectrogram.png")


def test_pictures_of_the_gallery(folder: Path) -> None:
    """A mechanism and the model of which curves are drawn; each a few kilobytes, as the repository keeps them."""
    models = [ROOT / "models" / f"{name}.yaml" for name in ("pendulum", "dc_motor")]
    run(folder, "gallery.py", *map(str, models), "--folder", "pictures")
    for model in models:
        picture = folder / "pictures" / f"{model.stem}.png"
        assert_drawn(picture)
        assert picture.stat().st_size < 30_000


def test_study_of_the_elements_of_the_five_bar(folder: Path) -> None:
    """For a short move; the table of the README has the rows and columns that it prints."""
    out = run(folder, "five_bar_refinement.py", "--folder", ".", "--duration", "0.02")
    assert (folder / "five_bar_refinement.svg").stat().st_size > 10_000
    readme = (ROOT / "README.md").read_text()
    for line in out.splitlines():
        if line.startswith("| "):
            assert re.match(r"\|[^|]*\|[^|]*\|", line)[0] in readme


def test_what_rods_that_shorten_change(folder: Path) -> None:
    """The right rod is pressed along by the load that it carries: it bends further, by a tenth."""
    out = run(folder, "five_bar_stiffening.py", "--elements", "1")
    assert re.search(r"tip at the end +-0\.9\d\d mm linear, +-1\.0\d\d mm with", out)


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_every_script_is_listed_and_tested(script: Path) -> None:
    assert f"({script.name})" in (script.parent / "README.md").read_text()
    tests = "".join(
        (Path(__file__).parent / f"test_{name}.py").read_text() for name in ("postprocess", "paraview")
    )
    assert f'"{script.name}"' in tests
