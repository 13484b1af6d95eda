"""The report page: it says what the run is, and in a browser it plays, and draws the mechanism where the archive says.

What a person would do in the browser is done by a script, see browser.py.
"""

import html
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import used
from numpy.testing import assert_allclose

import fmbd
from fmbd.results.report.embedding import envelope
from fmbd.results.report.page import report

MODELS = Path(__file__).parents[2] / "models"

SCRIPT = """
// The orange tip of the trail [m], and the time [s] that the page shows with it.
function tip() {
  const canvas = element("scene"), [x, y] = middle(canvas, [213, 94, 0]);
  const { pixels, originX, originY } = canvas.dataset;
  const time = parseFloat(element("clock").textContent);
  return { time, x: (x - originX) / pixels, y: (originY - y) / pixels, pixel: 1 / pixels };
}

function moveSlider(time) {
  element("time").value = time;
  element("time").dispatchEvent(new Event("input"));
}

async function use() {
  const first = document.querySelector(".panel canvas");
  said.fits = document.documentElement.scrollWidth <= window.innerWidth;
  said.start = tip();
  element("play").click();
  await wait(1);
  element("play").click();
  said.played = tip();
  await wait(0.3);
  said.paused = tip();
  moveSlider(0.15);
  said.moved = tip();
  said.now = legend(0, 0);
  point("pointermove", first, 0.25);
  said.hovered = legend(0, 0);
  point("pointerdown", first, 0.25);
  point("pointermove", first, 0.75);
  point("pointerup", first, 0.75);
  said.zoomed = [...overTime.range];
  first.dispatchEvent(new Event("dblclick"));
  said.unzoomed = [...overTime.range];
  point("pointerdown", first, 0.5);
  point("pointerup", first, 0.5);
  said.clicked = tip();
  element("deflection").value = 50;
  element("deflection").dispatchEvent(new Event("change"));
  said.exaggerated = tip();
}
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> fmbd.Run:
    path = tmp_path_factory.mktemp("report") / "run.vtkhdf"
    return fmbd.simulate(fmbd.load_model(MODELS / "five_bar.yaml", {"simulation.duration": 0.2}), path)


@pytest.fixture(scope="module")
def page(run: fmbd.Run) -> str:
    return report(run)


@pytest.fixture(scope="module")
def said(page: str, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the script saw in the browser."""
    return used(page, SCRIPT, tmp_path_factory.mktemp("browser"))


def assert_drawn_where_archived(run: fmbd.Run, seen: dict[str, float], time: float | None = None) -> None:
    """To half a pixel, and what the end point moves in the half millisecond that the clock may be off."""
    at = seen["time"] if time is None else time
    place = [np.interp(at, run.time, x) for x in run["rod_right.end.position"].T]
    speed = np.abs(run["rod_right.end.velocity"]).max()
    assert_allclose([seen["x"], seen["y"]], place, atol=0.5 * seen["pixel"] + 5e-4 * speed)


def test_the_page_has_no_errors_and_fits(said: dict[str, Any]) -> None:
    assert said["errors"] == []
    assert said["fits"]


def test_the_end_point_is_drawn_where_the_archive_says(run: fmbd.Run, said: dict[str, Any]) -> None:
    assert said["start"]["time"] == 0.0
    assert_drawn_where_archived(run, said["start"])
    assert_drawn_where_archived(run, said["moved"], 0.15)


def test_it_plays_and_pauses(run: fmbd.Run, said: dict[str, Any]) -> None:
    assert 0.0 < said["played"]["time"] < 0.2
    assert said["paused"] == said["played"]
    assert_drawn_where_archived(run, said["played"])


def test_a_click_into_a_plot_moves_the_mechanism(run: fmbd.Run, said: dict[str, Any]) -> None:
    assert_allclose(said["clicked"]["time"], 0.1, atol=2e-4)
    assert_drawn_where_archived(run, said["clicked"])


def test_legends_show_values_at_the_time_and_at_the_pointer(run: fmbd.Run, said: dict[str, Any]) -> None:
    rotor = run["motor_right.rotor"]
    for text, time in ((said["now"], 0.15), (said["hovered"], 0.05)):
        assert text.startswith("motor_right")
        assert_allclose(float(text.removeprefix("motor_right")), np.interp(time, run.time, rotor), rtol=1e-3)


def test_dragging_zooms_and_a_double_click_shows_all(said: dict[str, Any]) -> None:
    assert_allclose(said["zoomed"], [0.05, 0.15], atol=1e-3)
    assert_allclose(said["unzoomed"], [0.0, 0.2], atol=1e-6)


def test_exaggerated_beams_stay_attached(run: fmbd.Run, said: dict[str, Any]) -> None:
    """Both rods are held at both ends: their ends stay where they are."""
    assert_drawn_where_archived(run, said["exaggerated"], said["clicked"]["time"])


def test_the_page_needs_nothing_else(page: str) -> None:
    body = page.split('<script type="application/json"')[0]
    assert not re.findall(r"""(?:src|href)\s*=|url\(|@import""", body)
    assert "default-src 'none'" in page
    assert len(page.encode()) < 5e6


def test_the_page_says_what_was_modelled(run: fmbd.Run, page: str) -> None:
    for text in (
        "<h1>five-bar",
        "2 rigid bodies, 2 beams, 5 joints, 2 motors, 10 coordinates, 2 constraints",
        "Hoang et al.",
        "<tr><th>stiffness</th><td>5000</td></tr>",
        "<tr><th>effector</th><td>[rod_right.end, rod_left.end]</td><td>true</td></tr>",
        "0.2 of 0.2 s, 201 outputs",
        run.source.attributes["model_sha256"],
    ):
        assert text in page


def test_warnings() -> None:
    """A beam that is far too soft, a run that stops at its start."""
    model = fmbd.load_model(MODELS / "cantilever.yaml", {"simulation.duration": 0.5, "parameters.F": 20})
    page = report(fmbd.simulate(model))
    assert "ruler: bends by " in page


def test_names_and_texts_are_quoted() -> None:
    text = "</script><script>alert(1)</script>"
    model = fmbd.load_model(MODELS / "pendulum.yaml", {"simulation.duration": 0.1, "description": text})
    page = report(fmbd.simulate(model))
    assert text not in page
    assert html.escape(text) in page


def test_long_curves_keep_their_extremes() -> None:
    x = np.linspace(0.0, 1.0, 100_001)
    y = np.sin(300.0 * x) * np.exp(-x)
    y[31_234] = 9.0
    short_x, short_y = envelope(x, y, 2000)
    assert short_x.size <= 2002
    assert np.all(np.diff(short_x) > 0.0)
    assert (short_x[0], short_x[-1]) == (0.0, 1.0)
    assert (short_y.max(), short_y.min()) == (9.0, y.min())
    assert_allclose(short_y, np.interp(short_x, x, y))
