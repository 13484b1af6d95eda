"""A mechanism moves the same however its file is written: only the names of the coordinates may change.

What must agree is physical, the positions, velocities and accelerations of points, at the start and along a run at
tight tolerance. The coordinates, the tree and the order of the arithmetic differ.
"""

from functools import cache

import numpy as np
import pytest
from mechanisms import MECHANISMS, POINTS, cut_at, joints_reversed, moved, reordered
from physics import assert_same, build, start, trajectory

TIMES = np.linspace(0.0, 0.15, 4)
CUTS = {
    "five_bar": [["elbow_left"], ["elbow_right"], ["shoulder_left"], ["shoulder_right"]],
    "shaper": [
        ["slot", "guide"],
        ["slot", "wrist"],
        ["slot", "pivot"],
        ["shaft", "pin"],
        ["shaft", "guide"],
        ["pivot", "wrist"],
        ["shaft", "pivot"],
    ],
}
MOVES = [(0.0, 0.0, 0.0), (0.0, 12.0, -7.0), (2.0, 0.0, 0.0), (-2.7, 30.0, 40.0)]


@cache
def original(name):
    """Start and trajectory of a mechanism as it is first written."""
    system = build(MECHANISMS[name]())
    return start(system, POINTS[name]), trajectory(system, POINTS[name], TIMES)


def check(name, data):
    system = build(data)
    at_start, later = original(name)
    assert_same(at_start, start(system, POINTS[name]))
    assert_same(later, trajectory(system, POINTS[name], TIMES))
    return system


@pytest.mark.parametrize("name", MECHANISMS)
def test_the_points_move(name):
    """The trajectories that are compared below go somewhere."""
    path = original(name)[1][:, 0]
    assert np.ptp(path, axis=0).max(axis=-1).min() > 0.01


@pytest.mark.parametrize("name", MECHANISMS)
def test_order_of_the_file(name):
    """Bodies, joints, springs, loads and motors in the opposite order."""
    data = MECHANISMS[name]()
    assert [link.name for link in check(name, reordered(data)).tree.links] != [
        link.name for link in build(data).tree.links
    ]


@pytest.mark.parametrize(("name", "joints"), [(name, joints) for name in CUTS for joints in CUTS[name]])
def test_choice_of_the_cut_joints(name, joints):
    """Other joints close the loops: a motor's, a slot, a slide, joints at beams that are then held by their ends."""
    system = check(name, cut_at(MECHANISMS[name](), joints))
    assert sorted(system.tree.cut) == sorted(joints)


@pytest.mark.parametrize("name", MECHANISMS)
def test_joints_written_from_the_other_point(name):
    """[b, a] for [a, b], with the sign of the coordinate changed wherever it is given."""
    check(name, joints_reversed(MECHANISMS[name]()))


@pytest.mark.parametrize("turn, x, y", MOVES)
@pytest.mark.parametrize("name", MECHANISMS)
def test_scene_moved(name, turn, x, y):
    """Ground points, places, gravity and fixed forces turned and shifted: the motion is turned and shifted."""
    system = build(moved(MECHANISMS[name](), turn, x, y))
    back = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    for expected, found in zip(
        original(name), (start(system, POINTS[name]), trajectory(system, POINTS[name], TIMES))
    ):
        found[:, 0] -= (x, y)
        assert_same(expected, found @ back)


def test_scene_far_away():
    """Ten kilometres from the origin the loops close as well as numbers of that size can tell, 2e-12 m."""
    data = moved(MECHANISMS["five_bar"](), 0.0, 1e4, -1e4)
    data["simulation"] |= {"rtol": 1e-8, "atol": 1e-10}
    found = trajectory(build(data), POINTS["five_bar"], TIMES)
    found[:, 0] -= (1e4, -1e4)
    assert_same(original("five_bar")[1][:, :2], found[:, :2], 1e-7)
