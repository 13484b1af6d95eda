"""Loops that close more than once, gears, and joints counted from another turn."""

from math import pi

import numpy as np
import pytest
import yaml
from mechanisms import cut_at, five_bar
from numpy.testing import assert_allclose
from physics import assert_same, build, run, start, trajectory

from fmbd.system import System

TIMES = np.linspace(0.0, 0.5, 6)

FOUR_BAR = """
fmbd: 1
gravity: [0, -9.81]
ground: {points: {B: [RIGHT, 0]}}
bodies:
  left: {type: rigid, mass: 1, inertia: 0.1, center_of_mass: [0.5, 0], points: {tip: [1, 0], middle: [0.5, 0]}}
  coupler: {type: rigid, mass: 1, inertia: 0.1, center_of_mass: [0.5, 0], points: {tip: [1, 0]}}
  right: {type: rigid, mass: 1, inertia: 0.1, center_of_mass: [0.5, 0], points: {tip: [1, 0], middle: [0.5, 0]}}
  EXTRA_BODY
joints:
  foot: {type: revolute, between: [ground.origin, left.origin]}
  knee: {type: revolute, between: [left.tip, coupler.origin]}
  other_foot: {type: revolute, between: [ground.B, right.origin]}
  other_knee: {type: revolute, between: [coupler.tip, right.tip]}
  EXTRA_JOINTS
initial: {joints: {foot: 1.2}, rates: {foot: -2}, hints: {knee: -1.2, other_foot: 1.3}}
simulation: {rtol: RTOL}
"""
POINTS = ["left.tip", "right.tip"]


def four_bar(body: str = "", joints: str = "", rtol: float = 1e-11, right: float = 1.2) -> str:
    words = {"EXTRA_BODY": body, "EXTRA_JOINTS": joints, "RTOL": f"{rtol}", "RIGHT": f"{right}"}
    text = FOUR_BAR
    for word, replacement in words.items():
        text = text.replace(word, replacement)
    return text


@pytest.mark.parametrize("kind", ["revolute", "pin_in_slot"])
def test_a_joint_that_is_there_twice(kind):
    """A second joint that asks for nothing new changes nothing; the multipliers together are the one of before."""
    again = f"again: {{type: {kind}, between: [coupler.tip, right.tip], axis: [3, 1]}}"
    once, twice = build(four_bar()), build(four_bar(joints=again))
    assert_same(start(once, POINTS), start(twice, POINTS))
    assert_same(trajectory(once, POINTS, TIMES), trajectory(twice, POINTS, TIMES))


@pytest.mark.parametrize("longer", [0, 5e-11])
@pytest.mark.parametrize("rtol", [1e-3, 1e-10])
def test_a_parallelogram_with_a_second_coupler(rtol, longer):
    """Between parallel cranks a second, massless-like coupler is redundant in one direction, and stays closed.

    So it does if its length is rounded: no position closes both loops better than that.

    Exact: the cranks and the first coupler are a pendulum, (2 J + m) phi'' = -(2 m / 2 + m) g cos(phi), whose energy
    is conserved.
    """
    body = f"second: {{type: rigid, mass: 1e-9, inertia: 1e-9, points: {{tip: [{1 + longer!r}, 0]}}}}"
    joints = """
  lower: {type: revolute, between: [left.middle, second.origin]}
  lower_too: {type: revolute, between: [second.tip, right.middle]}"""
    system = build(four_bar(body, joints, rtol, right=1))
    assert len(system.constraints) == 4
    block = run(system, TIMES)
    assert (
        block.constraint_error.max() < 1e-9
    )  # between the steps the interpolant, of order 7, is not projected
    angle = block.position[:, system.coordinate_names.index("foot.angle")]
    rate = block.velocity[:, system.coordinate_names.index("foot.angle")]
    inertia, weight = 2 * (0.1 + 0.25) + 1, 2 * 9.81
    energy = inertia * rate**2 / 2 + weight * np.sin(angle)
    assert np.ptp(angle) > 0.5
    assert_allclose(energy, energy[0], rtol=max(rtol, 1e-7))


@pytest.mark.parametrize("angle", ["0", "0.3", "pi/2", "2"])
@pytest.mark.parametrize("held", ["start", "end"])
def test_a_beam_pulled_along_its_axis_does_not_give_way(angle, held):
    """A slot across a clamped beam's free end asks for nothing that a beam, which keeps its length, does not keep.

    At some of the angles cos or sin leave 1e-16 of a component across the beam: it must not count.
    """
    side, free = ("", "end") if held == "start" else ("-", "start")
    text = f"""
fmbd: 1
gravity: [1, -2]
ground: {{points: {{A: {{at: [0, 0], angle: "{angle}"}},
                    B: {{at: ["{side}cos({angle})", "{side}sin({angle})"], angle: "{angle}"}}}}}}
bodies: {{rod: {{type: beam, length: 1, elements: 2, mass_per_length: 1, bending_stiffness: 1}}}}
joints:
  clamp: {{type: weld, between: [ground.A, rod.{held}]}}
  slot: {{type: pin_in_slot, between: [ground.B, rod.{free}], axis: [0, 1], cut: true}}
"""
    free_system = build(text.replace("pin_in_slot", "free"))
    system = build(text)
    assert len(system.constraints) == 1
    expected = free_system.accelerations(free_system.start.q, free_system.start.v)[0]
    for q_dd, multipliers in (
        system.accelerations(system.start.q, system.start.v),
        system.matrices().accelerations(),
    ):
        assert_allclose(q_dd, expected, rtol=1e-9)
        assert multipliers == pytest.approx(0, abs=1e-9)


def test_a_beam_held_by_its_far_end_keeps_all_digits():
    """Twelve elements, the lightest of whose nodes moves 1e-7 kg m2: recursion and matrices agree nevertheless."""
    data = five_bar()
    data["bodies"]["rod_left"]["elements"] = 12
    data["initial"]["rates"] = {"shoulder_right": 1, "shoulder_left": -1}
    points = ["rod_left.start", "rod_left.node5", "rod_left.end"]
    assert_same(start(build(data), points), start(build(cut_at(data, ["elbow_left"])), points), 1e-10)


def test_a_joint_that_is_there_twice_on_a_massless_body():
    """Only the load has a mass; rail and roller hold the carriage twice. Exact: a body slides, s'' = -g sin(0.3)."""
    system = build("""
fmbd: 1
gravity: [0, -9.81]
ground: {points: {slope: {at: [0, 0], angle: 0.3}}}
bodies:
  carriage: {type: rigid, mass: 0, inertia: 0, points: {front: [0.5, 0]}}
  load: {type: rigid, mass: 2, inertia: 0.1}
joints:
  rail: {type: prismatic, between: [ground.slope, carriage.origin]}
  roller: {type: pin_in_slot, between: [ground.slope, carriage.front]}
  bolt: {type: weld, between: [carriage.origin, load.origin]}
""")
    acceleration, multiplier = system.accelerations(system.start.q, system.start.v)
    assert acceleration == pytest.approx(-9.81 * np.sin(0.3), rel=1e-12)
    assert multiplier == pytest.approx(0, abs=1e-9)
    assert run(system, TIMES).position[-1] == pytest.approx(-9.81 * np.sin(0.3) * 0.5**2 / 2, rel=1e-12)


def triangle(where: str, cut: str, more: str = "") -> str:
    """A four-bar whose coupler and rocker, 0.8 and 0.6 m, meet at a right angle if the crank is at 0 or pi/2.

    The rocker's pivot is then 1 m to the left of the crank's tip.
    """
    data = yaml.safe_load(f"""
fmbd: 1
bodies:
  crank: {{type: rigid, mass: 1, inertia: 0.1, points: {{tip: [0.5, 0]}}}}
  coupler: {{type: rigid, mass: 1, inertia: 0.1, points: {{tip: [0.8, 0]}}}}
  rocker: {{type: rigid, mass: 1, inertia: 0.1, points: {{tip: [0.6, 0]}}}}
joints:
  foot: {{type: revolute, between: [ground.origin, crank.origin]}}
  knee: {{type: revolute, between: [crank.tip, coupler.origin]}}
  elbow: {{type: revolute, between: [coupler.tip, rocker.tip]}}
  pivot: {{type: revolute, between: [ground.pivot, rocker.origin]}}
{where}
{more}
""")
    return yaml.safe_dump(cut_at(data, [cut]), sort_keys=False)


UPRIGHT = "ground: {points: {pivot: {at: [-1, 0.5], angle: -0.5}}}"
GIVEN = f"{UPRIGHT}\ninitial: {{joints: {{foot: pi/2}}, hints: {{knee: 2.2, elbow: 1.6, pivot: -0.4}}}}"
LEVEL = "ground: {points: {pivot: [-0.5, 0]}}"


@pytest.mark.parametrize("cut", ["foot", "knee", "elbow", "pivot"])
@pytest.mark.parametrize(
    ("where", "elbow"),
    [
        # (knee, elbow, pivot) = (0.93, -1.57, 1.43), not (2.21, 1.57, -0.43)
        (f"{UPRIGHT}\ninitial: {{place: {{knee: [0, 0.5]}}}}", (-0.64, 0.98)),
        (f"{UPRIGHT}\ninitial: {{joints: {{foot: pi/2}}}}", (-0.64, 0.98)),
        # both equally far from zero: (2.50, -1.57, 0.93), the knee positive
        (f"{LEVEL}\ninitial: {{joints: {{foot: 0}}}}", (-0.14, 0.48)),
        (f"{UPRIGHT}\ninitial: {{place: {{knee: [0, 0.5]}}, hints: {{knee: 2.2}}}}", (-0.64, 0.02)),
    ],
)
def test_the_assembly_mode_does_not_depend_on_the_cut(where, elbow, cut):
    """Of two modes, the one whose joint coordinates, cut joints included, are nearest to the hints or zero."""
    system = build(triangle(where, cut))
    position = system.reference.stations(system.start.q)[0][system.station_of_place("elbow")]
    assert_allclose(position, elbow, atol=1e-9)


@pytest.mark.parametrize(("rest", "turns"), [(3, 0), (-3, -1), (7, 1), (10, 1)])
@pytest.mark.parametrize("cut", ["foot", "knee", "elbow", "pivot"])
def test_a_torsional_spring_across_a_loop(cut, rest, turns):
    """It starts within half a turn of its rest angle, whichever joint is cut.

    The coupler is at pi + atan(3/4): 3.79 by way of the crank, 3.79 - 2 pi by way of the rocker.
    """
    ends = "between: [ground.origin, coupler.origin]"
    springs = f"springs: {{s: {{type: torsional, {ends}, stiffness: 3, rest_angle: {rest}}}}}"
    system = build(triangle(GIVEN, cut, springs))
    angle = system.reference.pathways(system.start.q)[0][system.planar.springs[0].pathway]
    assert angle == pytest.approx(pi + np.arctan(0.75) + 2 * pi * turns, abs=1e-9)
    assert_same(
        start(build(triangle(GIVEN, "knee", springs)), ["coupler.tip"]), start(system, ["coupler.tip"])
    )


def test_a_torsional_spring_in_an_open_chain_counts_turns():
    """Without a loop the joint between its ends says how far it is wound, 7 rad. Exact: J q'' = -k (7 - 0.5)."""
    system = build("""
fmbd: 1
bodies: {disc: {type: rigid, mass: 1, inertia: 0.1}}
joints: {axle: {type: revolute, between: [ground.origin, disc.origin]}}
springs: {s: {type: torsional, between: [ground.origin, disc.origin], stiffness: 3, rest_angle: 0.5}}
initial: {joints: {axle: 7}}
""")
    acceleration = system.accelerations(system.start.q, system.start.v)[0]
    assert acceleration == pytest.approx(-3 * 6.5 / 0.1, rel=1e-12)


def geared(transmission: str, ratio: float, foot: str = "revolute") -> System:
    """A motor between a base and an arm whose centre of mass is on the axis."""
    rates = "hip: -0.6" if foot == "weld" else "foot: 1.1, hip: -0.6"
    return build(f"""
fmbd: 1
bodies:
  base: {{type: rigid, mass: 2, inertia: 0.5, points: {{hip: [0.4, 0]}}}}
  arm: {{type: rigid, mass: 1e-6, inertia: 0.2}}
joints:
  foot: {{type: {foot}, between: [ground.origin, base.origin]}}
  hip: {{type: revolute, between: [base.hip, arm.origin]}}
motors:
  m: {{type: torque, joint: hip, gear_ratio: {ratio}, rotor_inertia: 0.03, torque: 0.7, transmission: {transmission}}}
initial: {{rates: {{{rates}}}}}
simulation: {{rtol: 1e-11}}
""")


@pytest.mark.parametrize("transmission", ["rigid", "{stiffness: 9, damping: 0.1}"])
@pytest.mark.parametrize("ratio", [6.0, -3.0])
def test_a_rotor_turns_with_the_body_it_sits_on(ratio, transmission):
    """T = 1/2 I (omega + phi')^2 + the rest, phi' = r theta' at the start; fixed axis, so no other terms."""
    system = geared(transmission, ratio)
    block = run(system, TIMES)
    base, rotor, arm = (
        block.velocity[:, system.coordinate_names.index(name)]
        for name in ("foot.angle", "m.rotor", "hip.angle")
    )
    assert rotor[0] == pytest.approx(ratio * -0.6)
    light = 1e-6 * 0.4**2
    kinetic = (0.5 + light) * base**2 / 2 + 0.03 * (base + rotor) ** 2 / 2 + 0.2 * (base + arm) ** 2 / 2
    assert_allclose(block.energy["kinetic"], kinetic, rtol=1e-12)
    assert np.abs(block.energy["balance"]).max() < 1e-9


def test_a_rigid_gear_adds_the_square_of_its_ratio():
    """On a base that does not move: (J + r^2 I) theta'' = r tau."""
    system = geared("rigid", 6.0, "weld")
    hip = system.coordinate_names.index("hip.angle")
    acceleration = system.accelerations(system.start.q, system.start.v)[0][hip]
    assert acceleration == pytest.approx(6 * 0.7 / (0.2 + 36 * 0.03), rel=1e-12)


def test_hints_a_full_turn_off():
    """A hint only says where to look: 2 pi more in a joint of the tree leaves motors at a cut joint as they were.

    The motors count the angles of their joints; cut, these are differences of angles that have gone round.
    """
    points = ["crank_right.A", "rod_left.end"]
    data = five_bar()
    expected = start(build(data), points)
    data["initial"]["hints"]["effector"] += 2 * pi
    for joint in ("shoulder_left", "shoulder_right"):
        assert_same(expected, start(build(cut_at(data, [joint])), points))
    for motor in data["motors"].values():
        del motor["rotor_inertia"], motor["transmission"]
        motor["gear_ratio"] = 1.5
    expected = start(build(data), points)
    for joint in ("shoulder_left", "shoulder_right"):
        assert_same(expected, start(build(cut_at(data, [joint])), points))
