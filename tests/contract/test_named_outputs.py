"""Named outputs obey mechanics: rates are derivatives, forces balance, no choice of the program shows."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from test_two_formulations import EVERYTHING

import fmbd
from fmbd.model import Beam, load_model_text
from fmbd.results.axial import axial_forces

MODELS = Path(__file__).parents[2] / "models"
DERIVATIVES = {
    "position": "velocity",
    "velocity": "acceleration",
    "angle": "angular_velocity",
    "angular_velocity": "angular_acceleration",
    "rate": "acceleration",
}


def derivative(values: np.ndarray, h: float) -> np.ndarray:
    """Central differences of order 4; the two rows at each end are lost."""
    return (values[:-4] - 8.0 * values[1:-3] + 8.0 * values[3:-1] - values[4:]) / (12.0 * h)


def test_every_rate_is_the_derivative_of_what_it_is_the_rate_of() -> None:
    """Points, frames, joint coordinates, springs; all joints, reversed, driven, in loops; both beam frames.

    The start does not close the loops; the first steps, which do, are left out.
    """
    h = 1e-5
    text = EVERYTHING.replace("LIMIT", "1e3")
    text += f"simulation: {{duration: 2e-3, output_interval: {h}, max_step: 1e-4, rtol: 1e-11}}\n"
    run = fmbd.simulate(load_model_text(text))
    checked = 0
    for name in run:
        owner, _, last = name.rpartition(".")
        rate = f"{name}.rate" if f"{name}.rate" in run else f"{owner}.{DERIVATIVES.get(last)}"
        if last in ("length", "angle") and owner in run.model.springs:
            rate = f"{owner}.rate"
        if rate in run:
            expected = derivative(run[name], h)[60:]
            assert_allclose(
                run[rate][62:-2],
                expected,
                rtol=1e-6,
                atol=2e-6 * max(1.0, np.abs(expected).max()),
                err_msg=name,
            )
            checked += 1
    assert checked > 190


def newton(run: fmbd.Run, forces: dict[str, float], points: dict[str, float], mass: float) -> np.ndarray:
    """Sum of joint forces and weight less sum of weight * acceleration over points, shape (nt, 2)."""
    applied = sum(sign * run[f"{joint}.force"] for joint, sign in forces.items())
    inertia = sum(weight * run[f"{point}.acceleration"] for point, weight in points.items())
    return applied + mass * np.array(run.model.gravity) - inertia


GAUSS = 0.5 - np.sqrt(1.0 / 12.0), 0.5 + np.sqrt(1.0 / 12.0)


@pytest.fixture(scope="module")
def five_bar() -> fmbd.Run:
    model = fmbd.load_model(MODELS / "five_bar.yaml", {"simulation.duration": 0.2})
    for rod in ("rod_right", "rod_left"):
        points = {"near": float(GAUSS[0] * 0.5), "far": float(GAUSS[1] * 0.5)}
        model = model.with_(f"bodies.{rod}.points", points)
    return fmbd.simulate(model)


@pytest.mark.parametrize("side", ["right", "left"])
def test_forces_on_each_body_give_its_mass_times_acceleration(five_bar: fmbd.Run, side: str) -> None:
    """Newton's law for cranks and rods of the five-bar, from outputs alone.

    A joint's force acts on the body of its first point, the opposite on that of its second. The rod's
    acceleration is a cubic along it, so two Gauss points integrate it exactly.
    """
    run = five_bar
    crank = newton(
        run, {f"shoulder_{side}": -1, f"elbow_{side}": 1}, {f"crank_{side}.center_of_mass": 3.0}, 3.0
    )
    assert np.abs(crank).max() < 1e-9
    rod_mass = 2712 * 0.030 * 0.003 * 0.5
    points = {f"rod_{side}.near": rod_mass / 2, f"rod_{side}.far": rod_mass / 2, f"rod_{side}.end": 0.25}
    tip = 1 if side == "right" else -1
    rod = newton(run, {f"elbow_{side}": -1, "effector": tip}, points, rod_mass + 0.25)
    assert np.abs(rod).max() < 1e-9


def test_moments_on_a_crank_give_its_angular_acceleration(five_bar: fmbd.Run) -> None:
    """Euler's law about the shoulder: transmission, weight and rod; I = 0.2 kg m2 (Table 1 of the paper)."""
    run = five_bar
    arm = run["crank_right.A.position"] - run["ground.O1.position"]
    centre = run["crank_right.center_of_mass.position"] - run["ground.O1.position"]
    elbow = run["elbow_right.force"]
    moment = run["motor_right.transmission_torque"] - 3 * 9.81 * centre[:, 0]
    moment += arm[:, 0] * elbow[:, 1] - arm[:, 1] * elbow[:, 0]
    assert_allclose(moment, 0.2 * run["crank_right.angular_acceleration"], atol=1e-9)


# A crank driven in a circle shakes a loop of a hinge, a pin in a slot, a weld and a slide; the joints point
# both ways, and springs and friction act in them.
LOOP = """
fmbd: 1
gravity: [0.4, -9.81]
ground: {points: {P: {at: [1.1, -0.2], angle: 0.3}}}
bodies:
  crank: {type: rigid, mass: 2, inertia: 0.1, center_of_mass: [0.1, 0.02],
          points: {tip: {at: [0.3, 0], angle: 0.4}}}
  rod: {type: beam, length: 0.8, elements: 2, frame: FRAME, mass_per_length: 0.9, bending_stiffness: 30,
        points: {mid: 0.7}}
  shoe: {type: rigid, mass: 0.7, inertia: 0.05, center_of_mass: [0.02, 0.03],
         points: {pin: {at: [0.05, 0.1], angle: -0.5}}}
  slide: {type: rigid, mass: 0.4, inertia: 0.02, points: {top: {at: [0, 0.1], angle: 0.2}}}
joints:
  bearing: {type: revolute, between: [ground.origin, crank.origin], driven: "2*t + 0.3*t**2"}
  hinge: {type: revolute, between: [rod.start, crank.tip], friction: 0.1}
  slot: {type: pin_in_slot, between: [rod.mid, shoe.pin], axis: [2, -1],
         spring: {x: {stiffness: 300, rest: 0.05}, angle: {stiffness: 2}}}
  bolts: {type: weld, between: [slide.top, shoe.origin]}
  rail: {type: prismatic, between: [ground.P, slide.origin], axis: [1, 2],
         spring: {stiffness: 40, damping: 2}}
initial: {joints: {rail: 0.4}, rates: {rail: 0.1}, hints: {hinge: -0.2}}
"""


def loop_cut_at(joint: str, frame: str) -> fmbd.Run:
    text = LOOP.replace("FRAME", frame).replace(f"  {joint}: {{", f"  {joint}: {{cut: true, ")
    text += "simulation: {duration: 1e-4, output_interval: 1e-4}\n"
    run = fmbd.simulate(load_model_text(text))
    assert run.system.tree.cut == (joint,)
    return run


@pytest.mark.parametrize("frame", ["clamped", "chord"])
def test_joint_forces_do_not_depend_on_where_the_loop_is_cut(frame: str) -> None:
    """Joints of the tree, forwards or backwards, or closed by multipliers: the same force, moment, effort."""
    names = [
        f"{joint}.{what}"
        for joint in ("bearing", "hinge", "slot", "bolts", "rail")
        for what in ("force", "moment")
    ]
    names += ["bearing.angle.driving_moment"]
    expected = loop_cut_at("slot", frame)
    for joint in ("bearing", "hinge", "bolts", "rail"):
        run = loop_cut_at(joint, frame)
        for name in names:
            scale = max(1.0, np.abs(expected[name][0]).max())
            assert_allclose(
                run[name][0], expected[name][0], atol=1e-9 * scale, err_msg=f"{name}, cut at {joint}"
            )


@pytest.mark.parametrize("cut", ["bearing", "slot"])
def test_the_driving_moment_times_its_rate_is_the_power_put_in(cut: str) -> None:
    """Nothing else does work on the loop; the balance of energy knows that work from its own integral."""
    h = 1e-5
    text = LOOP.replace("FRAME", "chord").replace(f"  {cut}: {{", f"  {cut}: {{cut: true, ")
    text += f"simulation: {{duration: 1e-3, output_interval: {h}, rtol: 1e-11}}\n"
    run = fmbd.simulate(load_model_text(text))
    power = run["bearing.angle.driving_moment"] * run["bearing.angle.rate"]
    assert_allclose(derivative(run["energy.work"], h), power[2:-2], rtol=1e-6)


def test_multipliers_of_a_stabilised_run_are_those_of_its_joint_forces() -> None:
    """Baumgarte's terms are in them: from the rounded start the loop is open by 1.7e-5 m at first."""
    angles = {"shoulder_right": 0.9812, "elbow_right": 1.5958, "shoulder_left": 1.7125, "elbow_left": -1.2922}
    changes = {"simulation.method": "baumgarte", "simulation.duration": 0.01}
    changes["initial"] = {"joints": angles, "consistent": False}
    run = fmbd.simulate(fmbd.load_model(MODELS / "five_bar.yaml", changes))
    assert run["constraint_error"][0] > 1e-5
    assert_allclose(run["effector.force"], run.multipliers, rtol=1e-9)


@pytest.mark.parametrize("segments", [1, 2])
def test_axial_forces_balance_along_every_beam(segments: int) -> None:
    """All that acts on a beam of a mechanism with all parts, summed up from its end, leaves nothing at its start.

    Springs, motors, loads, loops, reversed and driven joints are among what acts; accelerations are those of a run.
    """
    text = (
        EVERYTHING.replace("LIMIT", "1e3")
        + "simulation: {duration: 0.01, output_interval: 1e-3, rtol: 1e-11}\n"
    )
    changes = {f"bodies.{name}.damping": {"stiffness_proportional": 1e-3} for name in ("arm", "rod")}
    changes |= {f"bodies.{name}.segments": segments for name in ("arm", "rod")}
    model = load_model_text(text, overrides=changes)
    run = fmbd.simulate(model)
    beams = [name for name, body in model.bodies.items() if isinstance(body, Beam)]
    assert len(beams) > 1
    for name in beams:
        x = np.array(model.bodies[name].nodes)
        before, after = axial_forces(run.forces, name, x)
        assert np.abs(after).max() > 1e-2
        assert_allclose(before[:, 0], 0, atol=1e-8 * max(1.0, np.abs(after).max()))
        assert_allclose(after[:, -1], 0, atol=1e-12)


@pytest.mark.parametrize("segments", [1, 2])
def test_axial_forces_balance_along_beams_that_shorten(segments: int) -> None:
    """The same of the rods of a five-bar: forces act where the points are, drawn along by up to 2e-6 m."""
    rods = {"foreshortening": True, "frame": "chord", "elements": 2, "segments": segments}
    changes = {f"bodies.rod_{side}.{key}": value for side in ("right", "left") for key, value in rods.items()}
    changes |= {"simulation.duration": 0.05, "simulation.output_interval": 5e-3}
    model = fmbd.load_model(MODELS / "five_bar.yaml", changes)
    run = fmbd.simulate(model)
    for name in ("rod_right", "rod_left"):
        before, after = axial_forces(run.forces, name, np.array(model.bodies[name].nodes))
        assert np.abs(after).max() > 1
        assert_allclose(before[:, 0], 0, atol=1e-11)


TURNING = """
fmbd: 1
gravity: [0, -9.81]
bodies:
  rod: {type: beam, length: 0.8, elements: 4, mass_per_length: 0.9, bending_stiffness: 30,
        points: {middle: 0.3}, point_masses: {end: 0.5}}
joints: {hinge: {type: revolute, between: [ground.origin, rod.start]}}
initial: {joints: {hinge: -pi/2}, rates: {hinge: 3}}
simulation: {duration: 1e-4}
"""


@pytest.mark.parametrize("foreshortening", [False, True])
@pytest.mark.parametrize("segments", [1, 4])
def test_axial_force_of_a_hanging_rod_that_swings(segments: int, foreshortening: bool) -> None:
    """At the lowest point: weight and centrifugal force of what lies beyond, 0.5 kg at the end and 0.9 kg/m."""
    changes = {"segments": segments, "foreshortening": foreshortening, "frame": "chord"}
    overrides = {f"bodies.rod.{key}": value for key, value in changes.items()}
    run = fmbd.simulate(load_model_text(TURNING, overrides=overrides))

    def expected(x):
        return 0.5 * (9.81 + 9 * 0.8) + 0.9 * (9.81 * (0.8 - x) + 9 * (0.8**2 - x**2) / 2)

    nodes = np.array([0, 0.2, 0.4, 0.6, 0.8])
    assert_allclose(run["rod.axial_force"][0], expected(nodes), rtol=1e-12)
    assert_allclose(run["rod.middle.axial_force"][0], expected(0.3), rtol=1e-12)
    assert_allclose(run["rod.axial_force"][0, 0], -run["hinge.force"][0, 1], rtol=1e-12)
    assert run.units("rod.axial_force") == "N"


FLYING = """
fmbd: 1
gravity: [0, 0]
bodies:
  base: {type: rigid, mass: 2, inertia: 0.3, center_of_mass: [0.1, 0.2]}
  boom: {type: beam, length: 1, elements: 2, mass_per_length: 1.5, bending_stiffness: 2000,
         point_masses: {end: {mass: 0.7, inertia: 0.05}}}
joints:
  float: {type: free, between: [ground.origin, base.origin]}
  root: {type: weld, between: [base.origin, boom.start]}
initial: {joints: {float: {x: 1, y: 2, angle: 0.3}}, rates: {float: {x: 0.4, y: -0.3, angle: 2}}}
simulation: {duration: 0.5, rtol: 1e-11, output_interval: 0.05}
"""


@pytest.mark.parametrize("foreshortening", [False, True])
@pytest.mark.parametrize(("segments", "rotary"), [(1, 0.0), (2, 0.0), (1, 0.02), (2, 0.02)])
def test_momentum_of_what_flies_freely(segments: int, rotary: float, foreshortening: bool) -> None:
    """At the start all turn as one, as formulas say; then the boom bends, and the sums stay what they are.

    A boom that shortens is right to second order: it bends so little that the third power of that is nothing.
    """
    changes = {"segments": segments, "foreshortening": foreshortening, "rotary_inertia": rotary or False}
    changes = {f"bodies.boom.{key}": value for key, value in changes.items()}
    run = fmbd.simulate(load_model_text(FLYING, overrides=changes))
    place, rate, e = 1 + 2j, 0.4 - 0.3j, np.exp(0.3j)

    def moments(mass: float, first: complex, second: float) -> tuple[complex, float]:
        """Of a body by its mass, first moment and moment of inertia about the base's origin; it turns by 2 rad/s."""
        p = mass * rate + 2j * first * e
        return p, (np.conj(place) * p + np.conj(first * e) * rate).imag + 2 * second

    bodies = {
        "base": moments(2, 2 * (0.1 + 0.2j), 0.3 + 2 * 0.05),
        "boom": moments(1.5 + 0.7, 1.5 / 2 + 0.7, 1.5 / 3 + 0.7 + 0.05 + rotary * 1),
    }
    for name, (p, L) in bodies.items():
        assert_allclose(run[f"{name}.momentum"][0] @ [1, 1j], p, rtol=1e-12)
        assert_allclose(run[f"{name}.angular_momentum"][0], L, rtol=1e-12)
    assert np.abs(run["boom.end.deflection"]).max() > 1e-4
    for quantity in ("momentum", "angular_momentum"):
        total = sum(run[f"{name}.{quantity}"] for name in bodies)
        assert_allclose(total, total[[0] * len(run.time)], rtol=0, atol=1e-8)
        assert np.ptp(run[f"boom.{quantity}"], axis=0).max() > 1e-3
