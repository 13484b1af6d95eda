"""Mode shapes and Bode plots show what the analyses found, and can be read."""

from pathlib import Path

import numpy as np
import pytest
from legibility import overlaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from numpy.testing import assert_allclose

import fmbd
from fmbd.analyses import bode, mode_shapes
from fmbd.analyses.sampling import phases
from fmbd.model import load_model_text
from fmbd.results.plots.mechanism import BEAM

MODELS = Path(__file__).parents[2] / "models"
WELDED = """
fmbd: 1
bodies: {block: {type: rigid, mass: 1, inertia: 1}}
joints: {weld: {type: weld, between: [ground.origin, block.origin]}}
"""


def beams(ax: Axes) -> list[np.ndarray]:
    """The axes of the beams in full colour, (n, 2) each."""
    lines = [
        line for line in ax.lines if to_hex(line.get_color()) == BEAM.lower() and line.get_alpha() == 1.0
    ]
    return [line.get_xydata() for line in lines]


def titles(figure: mode_shapes.Figure) -> list[str]:
    return [ax.get_title(loc="left") for ax in figure.axes if ax.get_title(loc="left")]


def test_a_cantilever_is_drawn_in_the_shape_of_its_mode() -> None:
    """cosh kx - cos kx - s (sinh kx - sin kx), k L = 4.69409113 for the second mode; four elements have it to 1 %."""
    figure = mode_shapes.draw(fmbd.modes(MODELS / "cantilever.yaml"), 2)
    assert titles(figure) == ["1: 6.684 Hz, ζ = 0.005", "2: 41.94 Hz, ζ = 0.005"]
    (axis,) = beams(figure.axes[1])
    kx = 4.69409113 * axis[:, 0] / axis[-1, 0]
    end = kx[-1]
    s = (np.cosh(end) + np.cos(end)) / (np.sinh(end) + np.sin(end))
    exact = np.cosh(kx) - np.cos(kx) - s * (np.sinh(kx) - np.sin(kx))
    assert_allclose(axis[:, 1] / axis[-1, 1], exact / exact[-1], atol=0.01)


def test_loops_stay_closed_however_large_a_shape_is_drawn() -> None:
    figure = mode_shapes.draw(fmbd.modes(MODELS / "five_bar.yaml", lock="all"), 6)
    for ax in figure.axes:
        right, left = beams(ax)
        assert_allclose(right[-1], left[-1], atol=1e-8)
        assert abs(right - right[0]).max() > 0.2, "the rod has its size"


def test_motions_that_do_not_vibrate_say_how_long_they_last() -> None:
    """Motors that hold nothing let the five-bar sink or settle, without a frequency."""
    found = fmbd.modes(MODELS / "five_bar.yaml", release=True, open_loop=True)
    named = titles(mode_shapes.draw(found, len(found.poles)))
    assert any(" Hz, " in title for title in named)
    for title, pole in zip(named, found.poles):
        if pole.imag == 0.0 and pole != 0.0:
            assert title.endswith(f"in {abs(1.0 / pole.real):.3g} s")


def test_what_cannot_move_has_no_modes_to_draw() -> None:
    with pytest.raises(fmbd.AnalysisError, match="nothing can move"):
        mode_shapes.draw(fmbd.modes(load_model_text(WELDED), about="start"), 6)


def test_a_bode_plot_is_the_response_with_its_resonances_at_their_height() -> None:
    """The tip of the cantilever by the force on it: 1 / (2 zeta) above the static deflection, all but, at 6.7 Hz."""
    space = fmbd.linearize(
        MODELS / "cantilever.yaml", inputs=["bend.force.y"], outputs=["ruler.end.deflection"]
    )
    gain, phase = bode.draw(space, np.array([0.1, 20.0])).axes
    f, size = gain.lines[0].get_data()
    assert (f[0], f[-1]) == (0.1, 20.0)
    assert_allclose(size[0], 0.5**3 / (3 * 2.1e11 * 0.03 * 0.002**3 / 12), rtol=1e-3)
    exact = np.abs(space.frequency_response(np.linspace(6.6, 6.8, 20001))).max()
    assert_allclose(size.max(), exact, rtol=1e-3)
    _, degrees = phase.lines[0].get_data()
    assert_allclose(degrees[[0, -1]], [0.0, -180.0], atol=3.0)
    assert gain.get_ylabel() == "gain [m/N]"
    assert gain.get_title(loc="left") == "by bend.force.y"


@pytest.mark.parametrize("model", ["five_bar", "cantilever", "slider_crank", "door", "verification/andrews"])
def test_no_text_is_clipped_or_in_the_way(model: str) -> None:
    assert not overlaps(mode_shapes.draw(fmbd.modes(MODELS / f"{model}.yaml", about="start"), 12))


def test_phases_of_few_frequencies_are_those_of_the_curve() -> None:
    """Between five frequencies phases turn by more than a half turn: they are followed on the way."""
    space = fmbd.linearize(MODELS / "five_bar.yaml", outputs=["elbow_right.angle"])
    few = np.geomspace(0.1, 100.0, 5)
    found, response = phases(space, few), space.frequency_response(few)
    for k, axes in enumerate(bode.draw(space, few).axes[2:]):
        x, y = axes.lines[0].get_data()
        assert_allclose(found[:, 0, k], np.interp(np.log(few), np.log(x), y), atol=0.5)
    assert_allclose(np.exp(1j * np.radians(found)), response / np.abs(response), atol=1e-9)
    coarse = np.degrees(np.unwrap(np.angle(response), axis=0))
    assert np.abs(found - coarse).max() == pytest.approx(720.0), "turns that five points do not show"


def test_bode_plots_of_many_inputs_and_outputs_are_readable() -> None:
    outputs = ["rod_right.end.position", "rod_right.end.slope", "effector.force", "motor_left.current"]
    for chosen in (None, outputs):
        space = fmbd.linearize(MODELS / "five_bar.yaml", outputs=chosen)
        assert not overlaps(bode.draw(space, np.array([0.1, 300.0])))


def test_inputs_of_other_units_have_axes_of_their_own_name() -> None:
    loads = {
        "push": {"type": "force", "at": "ruler.end", "force": [0, 0]},
        "twist": {"type": "moment", "at": "ruler.end", "moment": 0},
    }
    model = fmbd.load_model(MODELS / "cantilever.yaml", {"loads": loads, "signals": {}})
    space = fmbd.linearize(model, inputs=["push.force.y", "twist.moment"], outputs=["ruler.end.deflection"])
    figure = bode.draw(space, np.array([1.0, 100.0]))
    named = [ax.get_ylabel() for ax in figure.axes]
    assert named == ["gain [m/N]", "gain [m/(N m)]", "phase [°]", "phase [°]"]
    assert not overlaps(figure)
