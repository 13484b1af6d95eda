"""The page about a study: it says the verdict, and in a browser its plots show what the study found."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import used
from numpy.testing import assert_allclose

import fmbd
from fmbd.cli import main

BEAM = Path(__file__).parents[2] / "models" / "verification" / "beam.yaml"
QUANTITY = "beam.end.deflection"
ELEMENTS = [1, 2, 4, 8]

SCRIPT = """
// Where the plot draws the marked points of its first curve: the middle of their pixels, as shares of the axes.
function marked(canvas, share) {
  const ratio = window.devicePixelRatio, width = canvas.clientWidth - MARGIN.left - MARGIN.right;
  const from = Math.round((MARGIN.left + share * width - 5) * ratio);
  const context = canvas.getContext("2d");
  const { data } = context.getImageData(from, 0, Math.round(10 * ratio), canvas.height);
  let total = 0, count = 0;
  for (let k = 0; k < data.length; k += 4) {
    if (data[k] !== 0 || data[k + 1] !== 114 || data[k + 2] !== 178) continue;
    total += Math.floor(k / 4 / Math.round(10 * ratio)) + 0.5;
    count++;
  }
  const height = canvas.clientHeight - MARGIN.top - MARGIN.bottom;
  return 1 - (total / count / ratio - MARGIN.top) / height;
}

async function use() {
  const [series, differences, convergence] = document.querySelectorAll(".panel canvas");
  const errors = groups[1];
  said.fits = document.documentElement.scrollWidth <= window.innerWidth;
  point("pointermove", series, 0.5);
  said.values = [0, 1, 2, 3].map((k) => legend(0, k));
  const [low, high] = errors.range.map(Math.log10), share = (x) => (Math.log10(x) - low) / (high - low);
  said.height = marked(convergence, share(1));
  said.limits = errors.plots[0].limits();
  point("pointermove", convergence, share(2.1));
  said.largest = legend(1, 0);
  said.bar = legend(1, 2);
  point("pointermove", convergence, share(7.5));
  said.barAtFinest = legend(1, 2);
  point("pointerdown", differences, 0.25);
  point("pointermove", differences, 0.75);
  point("pointerup", differences, 0.75);
  said.zoomed = [...overTime.range];
  point("pointerdown", convergence, share(1.5));
  point("pointermove", convergence, share(5));
  point("pointerup", convergence, share(5));
  said.zoomedAcross = [...errors.range];
}
"""


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a study of the elements of a beam."""
    path = tmp_path_factory.mktemp("study") / "study.h5"
    model = fmbd.load_model(BEAM, {"simulation.duration": 2})
    fmbd.refine(model, {"bodies.*.elements": ELEMENTS}, [QUANTITY]).save(path)
    return path


@pytest.fixture(scope="module")
def study(path: Path) -> fmbd.Study:
    return fmbd.open_study(path)


@pytest.fixture(scope="module")
def said(study: fmbd.Study, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return used(study.report(), SCRIPT, tmp_path_factory.mktemp("browser"))


def test_the_page_has_no_errors_and_fits(said: dict[str, Any]) -> None:
    assert said["errors"] == []
    assert said["fits"]


def test_the_pointer_reads_the_series_of_every_member(study: fmbd.Study, said: dict[str, Any]) -> None:
    for text, value, member in zip(said["values"], ELEMENTS, study.members):
        found = member.measured
        middle = 1e3 * np.interp(1.0, found.time, found.values[QUANTITY])  # mm
        assert text.startswith(str(value))
        assert_allclose(float(text.removeprefix(str(value))), middle, rtol=1e-3)


def test_points_are_drawn_where_the_study_has_them(study: fmbd.Study, said: dict[str, Any]) -> None:
    """The largest difference of one element, on an axis of some 130 pixels: to a pixel."""
    low, high = said["limits"]
    largest = study.result(QUANTITY).found.differences[0].largest
    assert_allclose(said["height"], (np.log10(largest) - low) / (high - low), atol=1 / 128)


def test_the_pointer_reads_the_nearest_point(study: fmbd.Study, said: dict[str, Any]) -> None:
    found = study.result(QUANTITY).found
    assert_allclose(float(said["largest"].removeprefix("largest")), found.differences[1].largest, rtol=1e-3)
    assert said["bar"] == "error bar, largest", "the error bar is that of the finest alone"
    bar = float(said["barAtFinest"].removeprefix("error bar, largest"))
    assert_allclose(bar, found.bar.largest, rtol=1e-3)


def test_dragging_zooms_along_time_and_along_what_is_refined(said: dict[str, Any]) -> None:
    assert_allclose(said["zoomed"], [0.5, 1.5], atol=0.01)
    assert_allclose(said["zoomedAcross"], [1.5, 5.0], rtol=0.02)


def test_the_page_says_what_was_found_and_needs_nothing_else(path: Path, study: fmbd.Study) -> None:
    page = study.report()
    for text in (
        study.result(QUANTITY).verdict,
        "refinement of bodies.*.elements = 1, 2, 4, 8",
        f"<h3>{QUANTITY} [m], at most ",
        study.attributes["model_sha256"],
    ):
        assert text in page
    assert not re.findall(
        r"""(?:src|href)\s*=|url\(|@import""", page.split('<script type="application/json"')[0]
    )


def test_a_study_comes_back_from_its_file(path: Path, study: fmbd.Study, tmp_path: Path) -> None:
    """So that its figure is the same, and its report and figure come from the commands for archives."""
    again = tmp_path / "again.h5"
    study.save(again)
    other = fmbd.open_study(again)
    assert other.axes == study.axes
    assert [dict(member.changes) for member in other.members] == [dict(m.changes) for m in study.members]
    assert other.result(QUANTITY).verdict == study.result(QUANTITY).verdict
    assert other.check is not None
    assert main(["plot", str(path), "-o", str(tmp_path / "a.svg")]) == 0
    other.plot(tmp_path / "b.svg")
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert main(["report", str(path), "-o", str(tmp_path / "a.html")]) == 0
    assert study.result(QUANTITY).verdict in (tmp_path / "a.html").read_text()


def test_info_says_what_a_study_found(
    path: Path, study: fmbd.Study, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["info", str(path)]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert study.result(QUANTITY).verdict in told
    assert "bodies.*.elements = 1, 2, 4, 8 members 4, 4 of them complete" in told
    assert main(["export", str(path), "a.csv"]) == 2
    assert capsys.readouterr().err.startswith(f"{path}: a study, not the archive of a run: `fmbd info`")


def test_what_a_study_cannot_do_is_answered_in_one_line(
    path: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["plot", str(path), "energy"]) == 2
    assert capsys.readouterr().err == f"{path}: a study is drawn whole, without names and alone\n"
    other = tmp_path / "other.h5"
    other.write_bytes(b"no")
    for what in (other, tmp_path / "missing.h5"):
        assert main(["report", str(what)]) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1
    with pytest.raises(fmbd.ArchiveError, match="neither a study nor an archive of fmbd"):
        fmbd.open_study(other)
