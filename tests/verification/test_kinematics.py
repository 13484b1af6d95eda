"""Kinematics: the five-bar's circles and singular positions in closed form; an arm of two links; a slider-crank."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.ndimage import label
from simulation import load, model, revolute

import fmbd

L1, L2 = 0.4, 0.5
FEET = np.array([[0.3, 0.0], [-0.3, 0.0]])  # right, left
COARSE = {"simulation.duration": 1, "simulation.output_interval": 0.05}
PATH = ["0.1 - 0.2*t", "0.6 + 0.1*t"]


def arms(place):
    """Angles of the cranks and of the rods against the ground, (n, 2) each; elbows outside, from law of cosines."""
    reach = np.asarray(place)[:, None] - FEET
    d = np.hypot(*np.moveaxis(reach, -1, 0))
    bend = np.arccos((L1**2 + d**2 - L2**2) / (2 * L1 * d)) * [-1, 1]
    crank = np.arctan2(reach[..., 1], reach[..., 0]) + bend
    elbow = FEET + L1 * direction(crank)
    rod = np.asarray(place)[:, None] - elbow
    return crank, np.arctan2(rod[..., 1], rod[..., 0])


def direction(angle):
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def two_links(**more):
    rod = {"type": "rigid", "mass": 1, "inertia": 1, "points": {"end": [L1, 0]}}
    joints = {"first": revolute("ground.origin", "a.origin"), "second": revolute("a.end", "b.origin")}
    return model(
        bodies={"a": rod, "b": rod},
        joints=joints,
        simulation={"duration": 1, "output_interval": 0.01},
        **more,
    )


def test_joints_of_the_five_bar_along_a_path():
    """Each crank is at the corner of a triangle; J follows from the rods, which keep their lengths: u.dp = u.dA."""
    found = fmbd.kinematics(load("five_bar.yaml", COARSE), "effector", path=PATH)
    crank, rod = arms(found.place)
    assert_allclose(
        found.place, np.stack([0.1 - 0.2 * found.time, 0.6 + 0.1 * found.time], axis=-1), atol=1e-12
    )
    assert_allclose(found.values, crank, atol=1e-12)
    along = direction(rod)
    turned = L1 * np.stack([-np.sin(crank), np.cos(crank)], axis=-1)  # dA / d theta
    J_q = (along * turned).sum(axis=-1)[:, :, None] * np.eye(2)
    assert_allclose(found.jacobian, np.linalg.solve(along, J_q), atol=1e-11)
    assert_allclose(found.condition, np.linalg.cond(found.jacobian), rtol=1e-12)


def test_determinants_of_the_five_bar():
    """Parallel: l2^2 sin of the angle between the rods; serial: l1 l2 sin(elbow) of both arms. dp: their quotient."""
    found = fmbd.kinematics(load("five_bar.yaml", COARSE), "effector", path=PATH)
    crank, rod = arms(found.place)
    assert_allclose(np.abs(found.parallel), L2**2 * np.abs(np.sin(rod[:, 0] - rod[:, 1])), rtol=1e-11)
    assert_allclose(np.abs(found.serial), np.abs(np.prod(L1 * L2 * np.sin(rod - crank), axis=1)), rtol=1e-11)
    area = np.abs(np.linalg.det(found.jacobian))
    assert_allclose(area, np.abs(found.serial / found.parallel), rtol=1e-11)
    assert found.crossings("parallel") == found.crossings("serial") == []


def test_place_of_the_five_bar_by_its_joints():
    """The effector is where two circles about the elbows meet, on the upper side."""
    motion = {"shoulder_right": "0.98 + 0.3*sin(3*t)", "shoulder_left": "1.71 + 0.2*t"}
    found = fmbd.kinematics(load("five_bar.yaml", COARSE), "effector", joints=motion)
    t = found.time
    angles = np.stack([0.98 + 0.3 * np.sin(3 * t), 1.71 + 0.2 * t], axis=-1)
    assert_allclose(found.values, angles, atol=1e-12)
    right, left = np.moveaxis(FEET + L1 * direction(angles), 1, 0)
    half = (left - right) / 2
    c = np.hypot(*half.T)[:, None]
    normal = np.stack([half[:, 1], -half[:, 0]], axis=-1) / c
    assert_allclose(found.place, (right + left) / 2 + normal * np.sqrt(L2**2 - c**2), atol=1e-11)


def test_nearest_singular_positions_of_the_five_bar():
    """Serial: the farther arm stretches. Parallel: the rods do, the effector halfway between the elbows."""
    standing = ["-0.1 + 0*t", "0.7"]
    found = fmbd.kinematics(load("five_bar.yaml", COARSE), "effector", path=standing)
    place = np.array([-0.1, 0.7])
    serial = found.nearest("serial")
    assert_allclose(serial.distance, L1 + L2 - np.hypot(*(place - FEET[0])), rtol=1e-7)
    parallel = found.nearest("parallel")
    elbows = FEET + L1 * direction(parallel.inputs)
    assert_allclose(np.hypot(*(elbows[0] - elbows[1])), 2 * L2, rtol=1e-7)
    assert_allclose(parallel.place, elbows.mean(axis=0), atol=1e-6)
    # all places halfway between elbows that are 2 l2 apart: the crank on the left gives at most two on the right
    left = FEET[1] + L1 * direction(np.linspace(-np.pi, np.pi, 200_001))
    reach = left - FEET[0]
    d = np.hypot(*reach.T)
    with np.errstate(invalid="ignore"):
        bend = np.arccos((L1**2 + d**2 - (2 * L2) ** 2) / (2 * L1 * d))
    ways = [np.arctan2(reach[:, 1], reach[:, 0]) + sign * bend for sign in (1, -1)]
    halfway = np.concatenate([(left + FEET[0] + L1 * direction(way)) / 2 for way in ways])
    assert_allclose(parallel.distance, np.nanmin(np.hypot(*(halfway - place).T)), rtol=1e-7)


def test_workspace_of_the_five_bar():
    """On a grid of crank angles the loop closes where the elbows are less than 2 l2 apart; that piece of it."""
    angles = np.linspace(-0.5, 3.5, 15)
    sweep = {"shoulder_right": angles, "shoulder_left": angles}
    found = fmbd.kinematics(load("five_bar.yaml"), "effector", sweep=sweep)
    right, left = (foot + L1 * direction(angles) for foot in FEET)
    apart = np.hypot(*np.moveaxis(right[:, None] - left[None], -1, 0))
    pieces, _ = label(apart < 2 * L2)
    start = np.abs(angles - 0.981).argmin(), np.abs(angles - 1.712).argmin()
    wanted = np.argwhere(pieces == pieces[start])
    assert_allclose(found.values, angles[wanted], atol=1e-12)
    assert found.wanted == 15**2 > len(found.position)
    assert (np.sign(found.parallel) == np.sign(found.parallel[0])).all()


def test_an_arm_is_singular_where_it_stretches():
    """det J = l1 l2 sin(second); nothing but the inputs holds it, always."""
    found = fmbd.kinematics(two_links(), "b.end", joints={"first": "0.3*t", "second": "t - 0.505"})
    assert_allclose(np.linalg.det(found.jacobian), L1**2 * np.sin(found.values[:, 1]), atol=1e-12)
    assert_allclose(found.parallel, 1.0)
    assert found.crossings("serial") == [50]
    assert found.crossings("parallel") == []
    assert (
        fmbd.kinematics(two_links(), "b.end", path=None, joints={"first": 0, "second": 1}).nearest("parallel")
        is None
    )


def test_dead_centres_of_a_slider_crank():
    """One input: dx/d(angle) of crank r and rod l; driven by its slider it is stuck where both are in line."""
    bodies = {
        "crank": {"type": "rigid", "mass": 1, "inertia": 1, "points": {"pin": [0.2, 0]}},
        "rod": {"type": "rigid", "mass": 1, "inertia": 1, "points": {"end": [0.5, 0]}},
        "piston": {"type": "rigid", "mass": 1, "inertia": 1},
    }
    joints = {
        "shaft": revolute("ground.origin", "crank.origin"),
        "pin": revolute("crank.pin", "rod.origin"),
        "piston_pin": revolute("rod.end", "piston.origin"),
        "guide": {"type": "prismatic", "between": ["ground.origin", "piston.origin"]},
    }
    engine = model(
        bodies=bodies,
        joints=joints,
        initial={"joints": {"shaft": 0.5}, "hints": {"guide": 0.6, "pin": -0.7, "piston_pin": 0.2}},
        simulation={"duration": 1, "output_interval": 0.01},
    )
    found = fmbd.kinematics(engine, "piston.origin", joints={"shaft": "0.5 + t"})
    a = 0.5 + found.time
    side = np.sqrt(0.5**2 - 0.2**2 * np.sin(a) ** 2)
    assert_allclose(found.place[:, 0], 0.2 * np.cos(a) + side, atol=1e-12)
    slope = -0.2 * np.sin(a) - 0.2**2 * np.sin(a) * np.cos(a) / side
    assert_allclose(found.jacobian[:, :, 0], np.stack([slope, 0 * slope], axis=-1), atol=1e-11)
    assert_allclose(found.serial, np.abs(slope), atol=1e-11)
    assert found.crossings("serial") == [], "from 0.5 to 1.5 rad it goes one way"
    assert "condition" not in found.data()
    turned = fmbd.kinematics(engine, "piston.origin", sweep={"shaft": np.linspace(0.5, 7.0, 66)})
    back = turned.values[turned.crossings("serial"), 0]
    assert_allclose(back, [3.1, 6.2], atol=1e-9)  # the last before pi and 2 pi
    around = fmbd.kinematics(engine, "crank.pin", sweep={"shaft": np.linspace(0.5, 7.0, 66)})
    assert around.crossings("serial") == [] and np.allclose(around.serial, 0.2)
    pushed = fmbd.kinematics(engine, "crank.pin", joints={"guide": "0.66 + 0.02*t"})
    dead = pushed.nearest("parallel")
    assert_allclose(dead.inputs, [0.7], atol=1e-7)
    assert_allclose(dead.place, [0.2, 0.0], atol=1e-6)


def test_what_cannot_be_is_said():
    five_bar = load("five_bar.yaml", COARSE)
    with pytest.raises(fmbd.AnalysisError, match=r"2 degrees of freedom, but 1 input \(shoulder_left\)"):
        fmbd.kinematics(five_bar, "effector", joints={"shoulder_left": "1 + t"})
    driven = two_links().with_("joints.first.driven", "t").with_("joints.second.driven", 0)
    with pytest.raises(
        fmbd.AnalysisError, match=r"0 degrees of freedom, but 1 input \(first\): .* of joints\.first"
    ):
        fmbd.kinematics(driven, "b.end", joints={"first": "t"})
    with pytest.raises(fmbd.AnalysisError, match=r"effector cannot reach \(0\.\d+, 0\.6\) at t = 0\.\d+ s"):
        fmbd.kinematics(five_bar, "effector", path=["0.1 + t", "0.6"])
    # the farther foot is at (-0.3, 0): 0.9 m of reach, 1.8439 m away
    with pytest.raises(fmbd.AnalysisError, match=r"reach \(1\.5, 0\.4\) at t = 0 s: .* misses by 0\.9439 m"):
        fmbd.kinematics(five_bar, "effector", path=["1.5", "0.4"])
    with pytest.raises(fmbd.AnalysisError, match=r"the loops cannot be closed at t = .* with shoulder_right"):
        fmbd.kinematics(
            five_bar, "effector", joints={"shoulder_right": "0.98 - 3*t", "shoulder_left": "1.71"}
        )
    with pytest.raises(fmbd.UnknownQuantity, match="did you mean 'end'"):
        fmbd.kinematics(five_bar, "rod_right.ende", path=PATH)
    with pytest.raises(fmbd.UnknownQuantity, match="unknown joint that can move 'elbow'"):
        fmbd.kinematics(five_bar, "effector", sweep={"elbow": [1, 2]})
