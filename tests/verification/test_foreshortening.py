"""Geometric stiffening of beams with `foreshortening: true`, against published and closed forms.

Without it all of these would have the wrong sign: tension would soften a beam, rotation would make it diverge.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from simulation import simulate

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
    """w_n^2 = (n pi/L)^4 EI/m + (n pi/L)^2 F/m of a hinged beam, whose end slides: by differences of the motion."""
    system = fmbd.assemble(load_model_text(STRING.replace("FORCE", str(force))))
    q, zero, step = system.start.q, np.zeros(system.planar.nq), 1e-7
    columns = [
        (system.accelerations(q + step * e, zero)[0] - system.accelerations(q - step * e, zero)[0])
        / (2 * step)
        for e in np.eye(q.size)[system.elastic]
    ]
    squares = np.sort(-np.linalg.eigvals(np.array(columns)[:, system.elastic].T).real)[:3]
    k = np.arange(1, 4) * np.pi / 2
    assert_allclose(squares, (k**4 * 3 + k**2 * force) / 0.5, rtol=1e-3)


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
    axis, accelerations = run.motion.beam_points("arm", x), run.motion.beam_accelerations("arm", x)
    assert np.abs(run["arm.end.deflection"]).max() > 0.5
    for k, point in enumerate(("start", "near", "node2", "end")):
        assert_allclose(axis[:, k], run[f"arm.{point}.position"] @ [1, 1j], rtol=0, atol=1e-12)
        moved = run[f"arm.{point}.acceleration"] @ [1, 1j]
        assert_allclose(accelerations[:, k], moved, rtol=0, atol=1e-10)


def test_the_methods_agree_and_energy_balances():
    """Five-bar with rods that shorten, 0.2 s of its controlled move."""
    rods = {f"bodies.rod_{side}.{key}": value for side in ("right", "left") for key, value in ON.items()}
    changes = rods | {"simulation.duration": 0.2, "simulation.output_interval": 0.01}
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
