"""Figures show what the archive says, and can be read: names, units, nothing clipped, nothing in the way."""

from pathlib import Path

import numpy as np
import pytest
from legibility import overlaps
from numpy.testing import assert_allclose

import fmbd
from fmbd.results.plots.charts import Curve, labels_of, scaled
from fmbd.results.plots.kinds import KINDS, chart
from fmbd.results.plots.mechanism import coil
from fmbd.results.plots.plot import charts, figures
from fmbd.results.plots.spectra import peaks, spectrum
from fmbd.results.plots.style import save

MODELS = Path(__file__).parents[2] / "models"


def run_of(model: str, duration: float) -> fmbd.Run:
    return fmbd.simulate(fmbd.load_model(MODELS / f"{model}.yaml", {"simulation.duration": duration}))


@pytest.fixture(scope="module")
def five_bar() -> fmbd.Run:
    return run_of("five_bar", 0.05)


@pytest.fixture(scope="module")
def cantilever() -> fmbd.Run:
    return run_of("cantilever", 1.5)


@pytest.mark.parametrize(
    ("names", "labels", "axis"),
    [
        (["a.end.deflection", "b.end.deflection"], ["a", "b"], "end deflection"),
        (["energy.kinetic", "energy.work"], ["kinetic", "work"], "energy"),
        (["hinge.angle.rate"], ["hinge"], "angle rate"),
        (["tip.position.x", "tip.position.y"], ["x", "y"], "tip position"),
        (["a.voltage", "b.back_emf"], ["a.voltage", "b.back_emf"], "voltage"),
        (["rod.deflection", "rod.end.deflection"], ["rod.deflection", "rod.end.deflection"], "voltage"),
    ],
)
def test_what_all_names_share_goes_to_the_axis(names: list[str], labels: list[str], axis: str) -> None:
    assert labels_of(names, "V") == (labels, axis)


@pytest.mark.parametrize(
    ("unit", "largest", "factor", "shown"),
    [
        ("m", 0.5, 1.0, "m"),
        ("m", 0.012, 1e3, "mm"),
        ("m", 0.0009, 1e3, "mm"),
        ("J", 9.9e-10, 1e9, "nJ"),
        ("Pa", 2.5e7, 1e-6, "MPa"),
        ("N m", 12e3, 1e-3, "kN m"),
        ("rad/s^2", 5e5, 1.0, "rad/s²"),
        ("(m)/s", 0.0, 1.0, "m/s"),
    ],
)
def test_units_are_chosen_to_read_well(unit: str, largest: float, factor: float, shown: str) -> None:
    found, text = scaled(unit, largest)
    assert_allclose(found, factor)
    assert text == shown


def test_the_paper_figures_hold_the_named_outputs(five_bar: fmbd.Run) -> None:
    joints, beams, constraints = charts({"run": five_bar})
    (rotor, rotor_rate), (angle, _) = joints.rows
    assert [curve.label for curve in rotor.curves] == ["motor_right", "motor_left"]
    assert [curve.label for curve in angle.curves] == [
        f"{joint}_{arm}" for arm in ("right", "left") for joint in ("shoulder", "elbow")
    ]
    assert_allclose(rotor_rate.curves[1].y, five_bar["motor_left.rotor.rate"])
    deflection, slope = beams.panels
    assert_allclose(deflection.curves[0].y, five_bar["rod_right.end.deflection"], atol=1e-15)
    assert_allclose(slope.curves[1].y, five_bar["rod_left.end.slope"], atol=1e-15)
    assert_allclose(constraints.panels[0].curves[0].y, five_bar["constraint_error"])


def test_quantities_of_one_unit_share_a_panel(five_bar: fmbd.Run) -> None:
    names = ["rod_left.end.position", "rod_right.end.position.x", "*.voltage"]
    (found,) = charts({"run": five_bar}, names)
    lengths, volts = found.panels
    assert [curve.label for curve in lengths.curves] == [
        "rod_left.x",
        "rod_left.y",
        "rod_right.x",
    ]
    assert_allclose(lengths.curves[1].y, five_bar["rod_left.end.position"][:, 1])
    assert (volts.quantity, volts.unit, len(volts.curves)) == ("voltage", "V", 2)


def test_a_window_of_time(five_bar: fmbd.Run) -> None:
    (found,) = charts({"run": five_bar}, ["energy"], between=(0.01, 0.02))
    assert_allclose(found.panels[0].curves[0].x, np.linspace(0.01, 0.02, 11))
    with pytest.raises(ValueError, match="fewer than two output times lie between 7 and 8 s"):
        charts({"run": five_bar}, ["energy"], between=(7, 8))


def test_runs_are_compared_curve_by_curve(five_bar: fmbd.Run) -> None:
    longer = run_of("five_bar", 0.1)
    (found,) = charts({"short": five_bar, "long": longer}, ["*.rotor"])
    assert [panel.title for panel in found.panels] == ["motor_right", "motor_left"]
    short, long = found.panels[1].curves
    assert (short.label, long.label) == ("short", "long")
    assert_allclose(short.y, five_bar["motor_left.rotor"])
    assert_allclose(long.y, longer["motor_left.rotor"])


def test_the_peak_of_a_sine_is_its_amplitude() -> None:
    """0.3 at 20 Hz on a drift, sampled for 50 periods."""
    t = np.arange(2500) * 1e-3
    f, a = spectrum(t, 2.0 + 5.0 * t + 0.3 * np.sin(2 * np.pi * 20.0 * t))
    (frequency, height), *_ = peaks(Curve("", f, a))
    assert_allclose((frequency, height), (20.0, 0.3), rtol=1e-3)


def test_the_spectrum_of_a_free_cantilever_shows_its_first_frequency(cantilever: fmbd.Run) -> None:
    """(1.8751 / L)^2 sqrt(E I / rho A) / 2 pi, of the Euler-Bernoulli beam; 0.85 s resolve it to a tenth of 1.2 Hz."""
    exact = (1.87510407 / 0.5) ** 2 * np.sqrt(2.1e11 * 0.002**2 / 12 / 7850) / (2 * np.pi)
    (found,) = charts({"run": cantilever}, ["ruler.end.deflection"], spectrum=True, between=(0.65, 1.5))
    (frequency, _), *_ = peaks(found.panels[0].curves[0])
    assert found.across == ("frequency", "Hz")
    assert_allclose(frequency, exact, atol=0.12)


@pytest.mark.parametrize("model", ["five_bar", "slider_crank", "cantilever", "verification/andrews", "door"])
def test_no_text_is_clipped_or_in_the_way(model: str) -> None:
    run = run_of(model, 0.02)
    kinds = [kind for kind in KINDS if chart(run, kind).rows]
    for name, figure in figures({"run": run}, [*kinds, "mechanism"]).items():
        assert not overlaps(figure), name


def test_comparisons_and_spectra_are_readable(five_bar: fmbd.Run) -> None:
    runs = {"one": five_bar, "another": run_of("five_bar", 0.02)}
    for name, figure in (figures(runs) | figures({"": five_bar}, spectrum=True)).items():
        assert not overlaps(figure), name


def test_the_same_figure_gives_the_same_file(five_bar: fmbd.Run, tmp_path: Path) -> None:
    for suffix in (".svg", ".pdf", ".png"):
        files = [tmp_path / f"{k}{suffix}" for k in range(2)]
        for file in files:
            save(figures({"run": five_bar}, ["energy"])["energy"], file, suffix)
        assert files[0].read_bytes() == files[1].read_bytes()


def test_a_name_that_no_run_has(five_bar: fmbd.Run) -> None:
    for name, message in (
        ("enrgy", "no quantity 'enrgy', did you mean 'energy'?"),
        ("rod_rigt.end.slope", "no quantity 'rod_rigt.end.slope', did you mean 'rod_right.end.slope'?"),
        ("*.voltages", r"no quantity is like '\*.voltages'"),
    ):
        with pytest.raises(fmbd.UnknownQuantity, match=message.replace("?", r"\?")):
            charts({"run": five_bar}, [name])
    with pytest.raises(ValueError, match="beams: the model 'pendulum' has nothing to show there"):
        charts({"run": run_of("pendulum", 0.1)}, ["beams"])


def test_a_spring_is_drawn_from_end_to_end() -> None:
    points = coil(np.array([1.0 + 1.0j, 4.0 + 5.0j]), 0.1)
    assert (points[0], points[-1]) == (1.0 + 1.0j, 4.0 + 5.0j)
    assert_allclose(points.mean(), 2.5 + 3.0j)
