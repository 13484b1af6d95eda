"""Geometric stiffening of beams with `foreshortening: true`, against published and closed forms.

Without it all of these would have the wrong sign: tension would soften a beam, rotation would make it diverge.
"""

import sys

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from simulation import MODELS, load, rods, simulate

import fmbd
from fmbd.beams import Foreshortening, floating_beam
from fmbd.errors import ModelError
from fmbd.model import load_model_text
from fmbd.model.pieces import uniform_piece

# flapwise frequencies w sqrt(rhoA L^4/EI) of a rotating cantilever at speeds 0, 2, ..., 12 in the same units; Wright
# et al., J. Appl. Mech. 49 (1982) 197-202. In the plane of rotation: sqrt(w^2 - speed^2).
SPEEDS = np.arange(0, 13, 2)
FLAPWISE = np.array(
    [
        [3.51601527, 22.03449157],
        [4.13731957, 22.61492196],
        [5.58500142, 24.27334939],
        [7.36037302, 26.80908168],
        [9.25683760, 29.99538189],
        [11.20232776, 33.64036586],
        [13.17015049, 37.60311233],
    ]
)


def frequencies(elements, speed):
    """The first two of a rotating cantilever of unit length, mass and bending stiffness."""
    beam = floating_beam([uniform_piece(1.0, 1.0, 1.0)], np.linspace(0, 1, elements + 1))
    shortening = Foreshortening.of(beam, beam.modal_basis()[0])
    stiffening = shortening.nodal(shortening.by_moment())
    return np.sqrt(eigh(beam.K + speed**2 * (stiffening - beam.M_w), beam.M, eigvals_only=True)[:2])


def test_frequencies_of_a_rotating_beam():
    """To 1e-4 at 16 elements, with order 4."""
    expected = np.sqrt(FLAPWISE**2 - SPEEDS[:, None] ** 2)
    errors = [
        np.abs(np.array([frequencies(n, speed) for speed in SPEEDS]) / expected - 1).max() for n in (8, 16)
    ]
    assert errors[1] < 1e-4
    assert errors[0] / errors[1] > 12


SPIN_UP = """
fmbd: 1
gravity: [0, 0]
bodies:
  arm: {type: beam, length: 10, elements: 4, mass_per_length: 1.2, bending_stiffness: 1.4e4, foreshortening: true}
joints:
  root:
    type: revolute
    between: [ground.origin, arm.start]
    driven: {angle: "6/15*(t**2/2 + (15/(2*pi))**2*(cos(2*pi*t/15) - 1))"}
simulation: {method: dop853, rtol: 1e-8, atol: 1e-8, duration: 15, output_interval: 0.002}
"""


def test_spin_up_of_a_slender_arm():
    """Kane, Ryan and Banerjee's manoeuvre: the tip lags by 0.57379 m at 6.762 s, by a geometrically exact beam.

    Second-order theory differs from it by the slope squared, 0.08^2 / 6; the linear beam diverges.
    """
    run = fmbd.simulate(load_model_text(SPIN_UP))
    lag = -run["arm.end.deflection"]
    assert_allclose(lag.max(), 0.57379, rtol=1.1e-3)
    assert_allclose(run.time[lag.argmax()], 6.762, atol=0.01)
    exact = [0.151274, 0.468442, 0.559037, 0.362769, 0.112680]
    assert_allclose(np.interp([2.5, 5, 7.5, 10, 12.5], run.time, lag), exact, rtol=1.1e-3)
    linear = fmbd.simulate(load_model_text(SPIN_UP.replace("foreshortening: true", "foreshortening: false")))
    assert np.abs(linear["arm.end.deflection"]).max() > 10


def test_spin_up_of_a_slender_arm_in_segments():
    """Two segments that shorten come as near as 1.4e-4 to the geometrically exact beam, eight times nearer than one."""
    run = fmbd.simulate(load_model_text(SPIN_UP, overrides={"bodies.arm.segments": 2}))
    lag = -run["arm.end.deflection"]
    assert_allclose(lag.max(), 0.57379, rtol=2e-4)
    assert_allclose(run.time[lag.argmax()], 6.762, atol=0.01)
    assert run.statistics["warnings"] == ""


STRING = """
fmbd: 1
gravity: [0, 0]
bodies:
  string: {type: beam, length: 2, elements: 16, mass_per_length: 0.5, bending_stiffness: 3, frame: chord,
           foreshortening: true}
  slide: {type: rigid, mass: 1e-9, inertia: 1e-9}
joints:
  left: {type: revolute, between: [ground.origin, string.start]}
  right: {type: revolute, between: [string.end, slide.origin]}
  rail: {type: prismatic, between: [ground.origin, slide.origin], cut: true}
loads:
  pull: {type: force, at: slide.origin, force: [FORCE, 0]}
"""


@pytest.mark.parametrize("force", [-5, 0, 40, 400])
def test_frequencies_of_a_beam_under_tension(force):
    """w_n^2 = (n pi/L)^4 EI/m + (n pi/L)^2 F/m of a hinged beam, whose end slides."""
    found = fmbd.modes(load_model_text(STRING.replace("FORCE", str(force)))).frequencies[:3]
    k = np.arange(1, 4) * np.pi / 2
    assert_allclose(found, np.sqrt((k**4 * 3 + k**2 * force) / 0.5) / (2 * np.pi), rtol=1e-4)


SPINNING = """
fmbd: 1
gravity: [0, 0]
bodies:
  arm: {type: beam, length: 1, elements: 16, mass_per_length: 1, bending_stiffness: 1, foreshortening: true}
joints:
  root: {type: revolute, between: [ground.origin, arm.start], driven: SPEED*t}
"""


@pytest.mark.parametrize("k", [0, 1, 3, 6])
def test_modes_of_a_spinning_model(k):
    """The same frequencies from `fmbd modes --moving`."""
    model = load_model_text(SPINNING.replace("SPEED", str(SPEEDS[k])))
    found = fmbd.modes(model, moving=True).frequencies[:2] * 2 * np.pi
    assert_allclose(found, np.sqrt(FLAPWISE[k] ** 2 - SPEEDS[k] ** 2), rtol=1e-4)


def test_static_deflections_of_the_held_five_bar():
    """-1.140 and 1.228 mm with the rotors held, by a geometrically exact program (Exudyn's ANCF cable)."""
    rest = fmbd.equilibrium(load("five_bar.yaml", rods_on() | rods(8)), lock="all")
    tips = [-0.5 * rest[f"rod_{side}.start.slope"] for side in ("right", "left")]
    assert_allclose(tips, [-1.140e-3, 1.228e-3], rtol=1e-3)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of Exudyn itself
def test_the_five_bar_moves_as_in_exudyn():
    """The move of 3 s beside ANCF cable beams, 8 elements a rod: tips from the tangents at the roots, end point.

    Linear beams differ by half of the deflection after 0.5 s: axial forces shift their frequencies by 2 %.
    """
    pytest.importorskip("exudyn", reason="Exudyn is not installed (extra `bench`)")
    sys.path.insert(0, str(MODELS.parent / "benchmarks"))
    try:
        from exudyn_five_bar import ExudynFiveBar
    finally:
        sys.path.pop(0)
    exact = ExudynFiveBar(8, 0.0).solve(60_000, 1e-8)
    outputs = {"simulation.output_interval": 0.01, "simulation.rtol": 1e-8}
    run = simulate("five_bar.yaml", rods_on() | rods(8) | outputs)
    tips = []
    for side in ("right", "left"):
        way, angle = (run[f"rod_{side}.{name}"] for name in ("end.position", "start.angle"))
        way = way - run[f"rod_{side}.start.position"]
        tips.append(np.cos(angle) * way[:, 1] - np.sin(angle) * way[:, 0])
    difference = np.stack(tips, axis=1) - exact.tip
    early = run.time <= 0.5
    assert np.sqrt((difference[early] ** 2).mean() / (exact.tip[early] ** 2).mean()) < 0.005
    assert np.sqrt((difference**2).mean() / (exact.tip**2).mean()) < 0.02
    assert np.abs(run["rod_right.end.position"] - exact.end).max() < 2e-6


def rods_on():
    """Changes of the five-bar: rods that shorten."""
    on = {"foreshortening": True, "frame": "chord"}
    return {f"bodies.rod_{side}.{key}": value for side in ("right", "left") for key, value in on.items()}


def test_all_modes_shorten_a_beam_as_its_elements_do():
    """A beam that keeps all of its modes is the same beam, in other coordinates; so are its points and axial forces."""
    runs = [
        fmbd.simulate(load_model_text(SPIN_UP, overrides=changes | {"simulation.duration": 2}))
        for changes in ({}, {"bodies.arm.modes": 8})
    ]
    for name in ("arm.end.position", "arm.node2.acceleration", "arm.deflection", "arm.axial_force"):
        assert_allclose(runs[1][name], runs[0][name], rtol=0, atol=1e-5 * np.abs(runs[0][name]).max())


@pytest.mark.parametrize("segments", [1, 2])
def test_points_of_the_axis_are_the_points_of_the_beam(segments):
    """What is drawn, and accelerated, along a beam that shortens: its named points, their second differences."""
    changes = {"bodies.arm.segments": segments, "simulation.duration": 6, "bodies.arm.points": {"near": 3.2}}
    run = fmbd.simulate(load_model_text(SPIN_UP, overrides=changes))
    x = np.array([0, 3.2, 5, 10])
    axis, _, accelerations = run.motion.beam_points("arm", x)
    assert np.abs(run["arm.end.deflection"]).max() > 0.5
    for k, point in enumerate(("start", "near", "node2", "end")):
        assert_allclose(axis[:, k], run[f"arm.{point}.position"] @ [1, 1j], rtol=0, atol=1e-12)
        moved = run[f"arm.{point}.acceleration"] @ [1, 1j]
        assert_allclose(accelerations[:, k], moved, rtol=0, atol=1e-10)


def test_the_methods_agree_and_energy_balances():
    """Five-bar with rods that shorten, 0.2 s of its controlled move."""
    changes = rods_on() | {"simulation.duration": 0.2, "simulation.output_interval": 0.01}
    runs = [
        simulate("five_bar.yaml", changes | {"simulation.method": method, "simulation.rtol": rtol})
        for method, rtol in (
            ("dop853", 1e-11),
            ("dop853", 1e-7),
            ("generalized_alpha", 1e-6),
            ("rodas5p", 1e-7),
        )
    ]
    exact = runs[0]
    for run, tolerance in zip(runs, (1e-12, 1e-5, 1e-2, 1e-4), strict=True):
        assert run.status == "complete"
        slope = run["rod_right.start.slope"] - exact["rod_right.start.slope"]
        assert np.abs(slope).max() < tolerance * np.abs(exact["rod_right.start.slope"]).max()
    assert np.abs(exact["energy.balance"]).max() < 1e-10


ON = {"foreshortening": True, "frame": "chord"}


@pytest.mark.parametrize("segments", [1, 2])
def test_elements_too_small_for_a_chord_are_refused(segments):
    """It would turn with the last of them, of next to no inertia."""
    changes = {"bodies.string.elements": 30 * segments, "bodies.string.segments": segments}
    with pytest.raises(ModelError, match=r"bodies.string.foreshortening.*fewer elements"):
        fmbd.assemble(load_model_text(STRING.replace("FORCE", "0"), overrides=changes))


def test_a_clamped_frame_on_a_hinge_is_refused():
    """It would turn with a cross-section that has no inertia; the message says what to write instead."""
    with pytest.raises(ModelError, match=r"foreshortening.*frame: chord"):
        fmbd.assemble(load_model_text(STRING.replace("frame: chord", "frame: clamped").replace("FORCE", "0")))


def test_a_hub_without_inertia_does_not_hold_a_clamped_frame():
    """A weld to a body that may turn itself and weighs nothing: as a hinge; a heavy hub, or the ground, will do."""
    text = SPINNING.replace(
        "between: [ground.origin, arm.start], driven: SPEED*t", "between: [ground.origin, hub.origin]"
    )
    text = text.replace("joints:", "joints:\n  weld: {type: weld, between: [hub.origin, arm.start]}")
    for inertia, fits in ((1e-5, False), (0.1, True)):
        hub = f"bodies:\n  hub: {{type: rigid, mass: 0.1, inertia: {inertia}}}"
        model = load_model_text(text.replace("bodies:", hub))
        if fits:
            fmbd.assemble(model)
        else:
            with pytest.raises(ModelError, match="frame: chord"):
                fmbd.assemble(model)


def test_the_gain_of_a_load_along_a_beam_that_sags():
    """It bends what is bent: gain from `fmbd linearize` and slope of the equilibria."""
    text = STRING.replace("FORCE", "0").replace("gravity: [0, 0]", "gravity: [0, -1]")

    def model(force):
        wind = f"loads:\n  wind: {{type: distributed, on: string, force: [{force}, 0]}}"
        return load_model_text(text.replace("loads:", wind))

    gain = fmbd.linearize(model(0), inputs=["wind.force.x"], outputs=["string.node8.deflection"]).gain()[0, 0]
    ends = [fmbd.equilibrium(model(force))["string.node8.deflection"] for force in (-0.01, 0.01)]
    assert_allclose(gain, (ends[1] - ends[0]) / 0.02, rtol=1e-4)
    assert abs(gain) > 1e-3
