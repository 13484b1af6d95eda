"""Changed copies of a model: `with_` in Python, `--set` on the command line."""

# ruff: noqa: E501  (a table of messages is easiest to read with one mistake a line)

from pathlib import Path

import numpy as np
import pytest

from fmbd.model import ModelError, load_model, load_model_text

FIVE_BAR = load_model(Path(__file__).parents[2] / "models" / "five_bar.yaml")


def test_a_copy_differs_in_one_value_and_the_original_does_not_change():
    changed = FIVE_BAR.with_("bodies.rod_right.elements", 4)
    assert changed.bodies["rod_right"].nodes == (0.0, 0.125, 0.25, 0.375, 0.5)
    assert changed.bodies["rod_left"].nodes == (0.0, 0.5)
    assert FIVE_BAR.bodies["rod_right"].nodes == (0.0, 0.5)
    assert changed.overrides == {"bodies.rod_right.elements": 4}


def test_what_depends_on_a_parameter_follows_it():
    assert FIVE_BAR.with_("parameters.l2", 0.6).bodies["rod_left"].length == 0.6
    assert FIVE_BAR.with_("parameters.l2", "l1 + 0.1").bodies["rod_left"].length == 0.5


def test_a_string_is_read_as_yaml():
    changed = FIVE_BAR.with_("gravity", "[0, -1.62]").with_("simulation.rtol", "1e-9")
    assert changed.gravity == (0.0, -1.62)
    assert changed.simulation.atol == 1e-9
    assert changed.overrides == {"gravity": [0, -1.62], "simulation.rtol": 1e-9}


def test_a_star_stands_for_all_parts_that_can_have_the_key():
    changed = FIVE_BAR.with_("bodies.*.elements", 2)
    assert [len(changed.bodies[name].nodes) for name in ("rod_right", "rod_left")] == [3, 3]
    changed = changed.with_("motors.*.transmission.stiffness", 1)
    assert {motor.transmission.stiffness for motor in changed.motors.values()} == {1.0}
    changed = changed.with_("bodies.*.damping.stiffness_proportional", 1e-4)
    assert changed.bodies["rod_left"].damping.stiffness_proportional == 1e-4


def test_elements_and_nodes_replace_each_other():
    uneven = FIVE_BAR.with_("bodies.*.nodes", [0, 0.1, 0.5])
    assert uneven.bodies["rod_left"].nodes == (0.0, 0.1, 0.5)
    assert uneven.with_("bodies.*.elements", 1).bodies["rod_left"].nodes == (0.0, 0.5)


def test_items_of_lists_and_names_with_a_dot_can_be_reached():
    assert FIVE_BAR.with_("gravity.1", -1.0).gravity == (0.0, -1.0)
    moved = FIVE_BAR.with_("joints.effector.between[1]", "rod_left.node1")
    assert moved.joints["effector"].between[1].point == "node1"
    placed = FIVE_BAR.with_("initial.place", {"rod_right.end": [0.1, 0.6]})
    assert placed.with_("initial.place.rod_right.end", [0, 0.6]).initial.place == {
        "rod_right.end": (0.0, 0.6)
    }


def test_later_changes_win_and_numpy_numbers_are_numbers():
    changed = FIVE_BAR.with_("parameters.l1", 0.3).with_("parameters.l1", np.float64(0.35))
    assert changed.parameters["l1"] == 0.35
    assert changed.with_("bodies.*.elements", np.int64(3)).bodies["rod_left"].nodes[1] == pytest.approx(
        0.5 / 3
    )


def test_what_an_alias_repeats_is_changed_in_one_place_only():
    text = """
    fmbd: 1
    bodies: {a: &body {type: rigid, mass: 1, inertia: 1}, b: *body}
    joints:
      j: {type: free, between: [ground.origin, a.origin]}
      k: {type: free, between: [a.origin, b.origin]}
    """
    changed = load_model_text(text).with_("bodies.a.mass", 2)
    assert (changed.bodies["a"].mass, changed.bodies["b"].mass) == (2.0, 1.0)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("bodies.rod_rigt.elements", 3, "bodies.rod_rigt.elements: unknown name 'rod_rigt' in 'bodies', did you mean 'rod_right'?"),
        ("bodys.rod_right.elements", 3, "bodys.rod_right.elements: unknown key 'bodys', did you mean 'bodies'?"),
        ("bodies.rod_right.elemnts", 3, "five_bar.yaml: bodies.rod_right: unknown key 'elemnts', did you mean 'elements'?"),
        ("bodies.*.elemnts", 3, "bodies.*.elemnts: no part of 'bodies' can have the key 'elemnts'"),
        ("bodies.*.elements", 0, "five_bar.yaml: bodies.rod_left.elements: must be at least 1, is 0"),
        ("parameters.l3", 3, "parameters.l3: unknown name 'l3' in 'parameters' (known: l1, l2, base, stiffness)"),
        ("gravity.2", 3, "gravity.2: '2' is not a position in a list of 2 values (the first is 0)"),
        ("name.first", 3, "name.first: 'first' leads nowhere: what stands before it is a plain value"),
        ("gravity", "[0", "gravity:2:1: not valid YAML"),
        ("gravity", np.zeros(2), "gravity: a value of type ndarray cannot stand in a model"),
        ("", 3, ": unknown key ''"),
    ],
)  # fmt: skip
def test_a_path_or_value_that_makes_no_sense_is_refused(path, value, message):
    with pytest.raises(ModelError) as error:
        FIVE_BAR.with_(path, value)
    assert message in str(error.value)


def test_overrides_can_be_given_while_loading():
    model = load_model_text(FIVE_BAR.text, overrides={"simulation.duration": 1, "bodies.*.elements": 2})
    assert (model.simulation.duration, len(model.bodies["rod_left"].nodes)) == (1.0, 3)
