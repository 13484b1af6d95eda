"""Mistakes in a model file, and the line that the user reads."""

# ruff: noqa: E501  (a table of messages is easiest to read with one mistake a line)

from pathlib import Path

import pytest

from fmbd.model import ModelError, load_model_text

FIVE_BAR = (Path(__file__).parents[2] / "models" / "five_bar.yaml").read_text()


def problems(text, path="five_bar.yaml"):
    with pytest.raises(ModelError) as error:
        load_model_text(text, path)
    return error.value.problems


def five_bar_with(*changes):
    """The problems of the five-bar after replacing the first occurrence of each text."""
    text = FIVE_BAR
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return problems(text)


def position(text, word):
    """line:column, counted from 1, of the first `word` in the text."""
    before = text[: text.index(word)]
    return f"{before.count(chr(10)) + 1}:{len(before) - before.rfind(chr(10))}"


def test_the_place_is_the_line_and_column_of_the_mistake():
    text = FIVE_BAR.replace("length: l2", "lenght: l2", 1)
    place = position(text, "lenght")
    expected = f"five_bar.yaml:{place}: bodies.rod_right: unknown key 'lenght', did you mean 'length'?"
    assert problems(text) == [expected]


def test_a_bad_value_is_placed_at_the_value():
    text = FIVE_BAR.replace("density: 2712", "density: -2712", 1)
    place = position(text, "-2712")
    expected = f"five_bar.yaml:{place}: materials.aluminium.density: must be positive, is -2712"
    assert problems(text) == [expected]


# What is replaced, by what, and where and how the message reads.
MISTAKES = [
    # numbers
    ("length: l2", "length: 0", "bodies.rod_right.length: must be positive, is 0"),
    ("length: l2", "length: l3", "bodies.rod_right.length: unknown name 'l3' (known: l1, l2, base, stiffness)"),
    ("length: l2", "length: [1]", "bodies.rod_right.length: must be a number or an expression, not a list"),
    ("length: l2", "length:", "bodies.rod_right.length: must be a number or an expression, not empty"),
    ("mass: 3", "mass: true", "bodies.crank_right.mass: must be a number or an expression, not true"),
    ("mass: 3", "mass: .nan", "bodies.crank_right.mass: must be a finite number, not nan"),
    ("mass: 3", "mass: 1e31", "bodies.crank_right.mass: is too large: 1e+31; numbers up to 1e+30 make sense"),
    ("mass: 3", "mass: -3", "bodies.crank_right.mass: must not be negative, is -3"),
    ("density: 2712", "density: 1/0", "materials.aluminium.density: division by zero in 1 / 0"),
    ("gravity: [0, -9.81]", "gravity: -9.81", "gravity: must be a list, not -9.81"),
    ("gravity: [0, -9.81]", "gravity: [0, 0, -9.81]", "gravity: must have 2 values, has 3"),
    ("gravity: [0, -9.81]", "gravity: [0]", "gravity: has too few values: number 2 is missing"),
    # parameters
    ("l1: 0.4 ", "l1: l2*l4\n  l4: l1 ", "parameters.l1: loop l1 -> l4 -> l1"),
    ("l1: 0.4 ", "l1: l1/2 ", "parameters.l1: loop l1 -> l1"),
    ("l1: 0.4 ", "l1: t ", "parameters.l1: must not depend on the time t: only signals do"),
    ("l1: 0.4 ", "l1: no ", "parameters.l1: unknown name 'no' (known: l1, l2, base, stiffness)"),
    ("l1: 0.4 ", "l1: false ", "parameters.l1: must be a number or an expression, not false"),
    ("l1: 0.4 ", "l1: 0.4\n  e: 1 ", "parameters: 'e' is a constant or function in expressions"),
    # rigid bodies
    ("    mass: 3\n", "", "bodies.crank_right: missing key 'mass' (or a 'shape' with a density)"),
    ("about: O", "about: Q", "bodies.crank_right.inertia.about: unknown point 'Q' (known: origin, center_of_mass, O, A)"),
    ("value: 0.2", "value: 0.1", "inertia.value: is 0.1 about 'O', less than mass times its squared distance"),
    ("A: [l1, 0]", "origin: [0, 0]", "bodies.crank_right.points.origin: the point 'origin' always exists"),
    ("mass: 3", "shape: {type: disk, radius: 1}", "bodies.crank_right.shape.type: unknown type 'disk', did you mean 'disc'?"),
    ("mass: 3", "shape: {type: disc, radius: 1}\n    mass: 3", "bodies.crank_right.inertia: follows from 'shape'"),
    # beams
    ("type: beam", "type: beem", "bodies.rod_right.type: unknown type 'beem', did you mean 'beam'? (one of: rigid, beam)"),
    ("    type: beam\n", "", "bodies.rod_right: missing key 'type' (one of: rigid, beam)"),
    ("    elements: 1\n", "", "bodies.rod_right: missing key 'elements' (or 'nodes')"),
    ("elements: 1", "elements: 1.5", "bodies.rod_right.elements: must be a whole number, is 1.5"),
    ("elements: 1", "elements: 4\n    segments: 3", "segments: must divide the number of elements, 4, into equal parts, is 3"),
    ("elements: 1", "elements: 4\n    segments: 0", "segments: must divide the number of elements, 4, into equal parts, is 0"),
    ("elements: 1", "elements: 4\n    segments: 2\n    damping: {modal_ratios: 0.1}", "damping.modal_ratios: belongs to the motion of the beam as a whole"),
    ("elements: 1", "elements: 0", "bodies.rod_right.elements: must be at least 1, is 0"),
    ("elements: 1", "elements: 1e6", "elements: the beams up to here have 1000000 elements; 100000 are allowed"),
    ("elements: 1", "nodes: [0, 0.3, 0.2, l2]", "nodes[2]: must be greater than the node before it (0.3), is 0.2"),
    ("elements: 1", "nodes: [0, 0.4]", "bodies.rod_right.nodes[1]: the last node must be at 0.5, is at 0.4"),
    ("elements: 1", "nodes: [0.1, l2]", "bodies.rod_right.nodes[0]: the first node must be at 0, is at 0.1"),
    ("elements: 1", "elements: 1\n    nodes: [0, l2]", "bodies.rod_right.nodes: 'elements' is given too"),
    ("frame: clamped", "modes: 3", "bodies.rod_right.modes: must be between 1 and twice the number of elements, 2, is 3"),
    ("frame: clamped", "modes: {upto: 3}", "bodies.rod_right.modes: unknown key 'upto', did you mean 'up_to'?"),
    ("elements: 1", "elements: 2\n    segments: 2\n    modes: 3", "bodies.rod_right.modes: are those of a whole beam"),
    ("frame: clamped", "frame: clampd", "frame: unknown choice 'clampd', did you mean 'clamped'? (one of: clamped, chord)"),
    ("{end: 0.25}", "{ende: 0.25}", "bodies.rod_right.point_masses.ende: unknown point 'ende', did you mean 'end'?"),
    ("{end: 0.25}", "{end: -1}", "bodies.rod_right.point_masses.end: must not be negative, is -1"),
    ("frame: clamped", "points: {mid: 0.6}", "bodies.rod_right.points.mid: lies off the beam: 0.6 m on a length of 0.5 m"),
    ("frame: clamped", "points: {node1: 0.1}", "the name 'node1' is kept for the beam's own points"),
    ("aluminium\n", "aluminum\n", "bodies.rod_right.material: unknown material 'aluminum', did you mean 'aluminium'?"),
    ("    section: strip\n", "", "missing key 'section' (or mass_per_length and bending_stiffness)"),
    ("section: strip", "section: {start: strip, end: stri}", "bodies.rod_right.section.end: unknown section 'stri'"),
    ("section: strip", "section: [{until: 0.6, section: strip}, {section: strip}]", "section[0].until: must lie between 0"),
    ("section: strip", "section: [{until: 0.4, section: strip}]", "section[0].until: the last piece must end with the beam"),
    ("elements: 1", "elements: 1\n    rotary_inertia: yes", "bodies.rod_right.rotary_inertia: unknown name 'yes' (known: l1, l2, base, stiffness); a switch is true or false"),
    ("length: l2", "length: 500 mm", "bodies.rod_right.length: '500 mm' has a unit: write the number alone: lengths are in metres"),
    # joints
    ("{type: revolute", "{type: revolute, motion: 1", "joints.shoulder_right: unknown key 'motion' (known: type, between, "),
    ("crank_right.A", "crank_rigth.A", "joints.elbow_right.between[0]: unknown body 'crank_rigth', did you mean 'crank_right'?"),
    ("crank_right.A", "crank_right.B", "joints.elbow_right.between[0]: unknown point 'B' of 'crank_right'"),
    ("crank_right.A", "crank_right", "must be a point such as 'rod.end' or 'ground.origin', not 'crank_right'"),
    ("crank_right.A, ", "rod_right.end, ", "joints.elbow_right.between: holds the body 'rod_right' twice"),
    ("type: revolute", "type: revolte", "joints.shoulder_right.type: unknown choice 'revolte', did you mean 'revolute'?"),
    ("{type: revolute", "{friction: -1, type: revolute", "joints.shoulder_right.friction: must not be negative, is -1"),
    ("{type: revolute", "{type: weld, friction: 1", "joints.shoulder_right.friction: a weld has no free coordinate"),
    ("{type: revolute", "{type: free, friction: 1", "friction: must say which coordinate: {x: ..., y: ..., angle: ...}"),
    ("{type: revolute", "{type: revolute, spring: {stifness: 1}", "joints.shoulder_right.spring: unknown key 'stifness'"),
    ("{type: revolute", "{type: prismatic, spring: {y: 1}", "spring: 'y' is not a free coordinate of this joint (x)"),
    ("{type: revolute", "{type: revolute, friction: {angel: 1}", "friction: 'angel' is not a free coordinate of this joint (angle)"),
    ("{type: revolute", "{type: revolute, friction: {angle: {colomb: 1}}", "friction.angle: unknown key 'colomb', did you mean 'coulomb'?"),
    ("{type: revolute", "{type: revolute, friction: {coulomb: 2, static: 1}", "friction.static: must not be less than coulomb (2), is 1"),
    ("{type: revolute", "{type: revolute, friction: {coulomb: 1, static: 2}", "friction.static: needs a stribeck_speed, at which it gives"),
    ("{type: revolute", "{type: revolute, friction: {static: 2, stribeck_speed: 1e-3}", "stribeck_speed: must be at least twice the"),
    ("{type: revolute", "{type: revolute, limits: {stiffness: 1}", "shoulder_right.limits: missing key 'lower' or 'upper'"),
    ("{type: revolute", "{type: revolute, limits: {lower: 1}", "joints.shoulder_right.limits: missing key 'stiffness'"),
    ("{type: revolute", "{type: revolute, limits: {lower: 1, upper: 0, stiffness: 1}", "limits.upper: must be above lower (1) by the"),
    ("{type: revolute", "{type: weld, limits: {upper: 1, stiffness: 1}", "limits: a weld has no free coordinate"),
    ("{type: revolute", "{type: revolute, spring: {backlash: 0.1}", "spring.backlash: needs a stiffness greater than 0"),
    ("{type: revolute", "{type: revolute, spring: {stiffness: 1, backlash: {gap: 1, transition: 2}}", "must not be wider than the gap (1), is 2"),
    ("{type: revolute", "{type: revolute, spring: {force_table: [[0, 1], [0, 2]]}", "force_table[1]: the stretch 0 does not increase (before: 0)"),
    ("{type: revolute", "{type: revolute, spring: {force_table: [[0, 1]]}", "force_table: a table needs at least two points, has 1"),
    ("{type: revolute", "{type: revolute, spring: {force_table: 3}", "must be a file, a list of points or a mapping, not 3"),
    ("{type: revolute", "{type: revolute, spring: {force_table: a.csv}", "force_table: a.csv: there is no such file"),
    ("{type: revolute", "{type: revolute, spring: {force_table: [[0, 1], [1, 2]], stiffness: 1}", "stiffness: 'force_table' is given, too"),
    ("{type: revolute", "{type: revolute, axis: [0, 0]", "joints.shoulder_right.axis: must be a direction, not [0, 0]"),
    ("cut: true", "cut: yes", "joints.effector.cut: must be true or false, not 'yes'"),
    # motors, controllers and signals
    ("joint: shoulder_right", "joint: sholder_right", "motors.motor_right.joint: unknown joint 'sholder_right'"),
    ("{type: revolute", "{type: revolute, driven: t", "motors.motor_right.joint: the joint 'shoulder_right' is driven"),
    ("gear_ratio: 10", "gear_ratio: 0", "motors.motor_right.gear_ratio: must not be zero"),
    ("rotor_inertia: 0.1", "rotor_inertia: 0", "transmission: an elastic transmission needs a rotor_inertia greater"),
    ("voltage: position_control", "voltage: position_contol", "unknown signal or controller 'position_contol', did you"),
    ("voltage: position_control", "voltage: 3*sin(x)", "motors.motor_right.voltage: unknown name 'x'"),
    ("voltage: position_control", "voltage: {type: sin}", "motors.motor_right.voltage.type: unknown type 'sin', did you"),
    ("voltage: position_control", "voltage: {type: ramp, start: 1, end: 1, to: 1}", "end: must be later than start (1)"),
    ("voltage: position_control", "voltage: {type: table, file: a.csv}", "a.csv: there is no such file"),
    ("effector: [-0.1", "efector: [-0.1", "controllers.position_control.target.place: unknown joint or point 'efector'"),
    ("{place: {effector: [-0.1, 0.7]}}", "{shoulder_right: 1}", "target: has no target for 'shoulder_left'"),
    ("kd: 1.2", "ki: 1", "controllers.position_control: unknown key 'ki'"),
    ("kd: 1.2", "limit: 0", "controllers.position_control.limit: must be positive, is 0"),
    ("kd: 1.2", "limit: [1, -1]", "controllers.position_control.limit: must be [low, high] with low < high"),
    ("gravity_compensation", "gravity_compensatin", "unknown signal 'gravity_compensatin', did you mean 'gravity_compen"),
    # beam options
    ("section: strip", "section: strip\n    shear: true", "bodies.rod_right.material: needs 'poissons_ratio' or 'shear_modulus'"),
    ("section: strip", "section: strip\n    shear: {coefficient: 1}", "rod_right.shear: unknown key 'coefficient', did you mean 'shear_coeff"),
    ("section: strip", "section: strip\n    shear: {shear_stiffness: 1}", "shear.shear_stiffness: is for a beam of mass_per_length and"),
    ("section: strip", "section: strip\n    rotary_inertia: 0.1", "rod_right.rotary_inertia: is true or false for a beam of material"),
    ("section: strip", "section: strip\n    mass: lump", "rod_right.mass: unknown choice 'lump', did you mean 'lumped'?"),
    ("density: 2712", "density: 2712, poissons_ratio: 0.6", "aluminium.poissons_ratio: must lie above -1 and up to 0.5, is 0.6"),
    # start and simulation
    ("place: {effector: [0.1", "place: {rod_right.ende: [0.1", "initial.place: unknown point 'ende' of 'rod_right'"),
    ("{shoulder_right: 1.0", "{shoulder_right: {x: 1.0}", "hints.shoulder_right: 'x' is not a free coordinate"),
    ("duration: 3", "duration: 0", "simulation.duration: must be positive, is 0"),
    ("rtol: 1e-6", "rtol: -1e-6", "simulation.rtol: must be positive, is -1e-06"),
    ("duration: 3", "method: dop85", "simulation.method: unknown choice 'dop85', did you mean 'dop853'?"),
    # the file as a whole
    ("fmbd: 1", "fmbd: 2", "fmbd: this program reads format 1, not 2"),
    ("fmbd: 1\n", "", "missing key 'fmbd', the version of the file format: write 'fmbd: 1'"),
    ("gravity:", "gravty:", "unknown key 'gravty', did you mean 'gravity'?"),
    ("crank_right:", "crank-right:", "bodies: the name 'crank-right' may hold letters, digits and underscores only"),
    ("crank_right:", "ground:", "bodies: 'ground' is the fixed world and cannot be the name of a body"),
    ("  motor_right:", "  rod_right:", "motors: the name 'rod_right' is taken: it stands in 'bodies', too"),
    ("sections:", "signals: {position_control: 1}\nsections:", "the name 'position_control' is taken: it stands in 'signals', too"),
    ("sections:", "signals: {l1: 1}\nsections:", "signals: 'l1' is already a parameter"),
    ("name: five-bar", "name: 5", "name: must be a text, not 5 (quotes make a text)"),
    ("name: five-bar", "name: a\nname: b", "the key 'name' is given twice, first in line 3"),
    ("name: five-bar", "name: !!python/name:os.system", "the tag 'tag:yaml.org,2002:python/name:os.system' is refused"),
    ("name: five-bar", "name: [five", "not valid YAML"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message"), MISTAKES, ids=[new for _, new, _ in MISTAKES])
def test_a_mistake_is_named_in_one_line(old, new, message):
    lines = five_bar_with((old, new))
    assert any(message in line for line in lines), lines
    assert all(line.startswith("five_bar.yaml:") and "\n" not in line for line in lines)


def test_all_mistakes_are_reported_at_once_in_the_order_of_the_file():
    lines = five_bar_with(
        ("duration: 3", "duration: 0"), ("length: l2", "lenght: l2"), ("l1: 0.4", "l1: 0.4*q")
    )
    assert [line.split(": ")[1] for line in lines] == [
        "parameters.l1",
        "bodies.rod_right",
        "simulation.duration",
    ]


def test_what_follows_from_a_mistake_is_not_reported_again():
    """The broken material is used by two rods, these by joints, these by the start and the controller."""
    assert len(five_bar_with(("density: 2712", "density: x"))) == 1


def test_a_body_that_nothing_holds_is_told_how_to_be_free():
    lines = five_bar_with(("joints:", "  stone: {type: rigid, mass: 1, inertia: 1}\njoints:"))
    assert len(lines) == 1
    assert "bodies.stone: no joint holds this body" in lines[0]
    assert "{type: free, between: [ground.origin, stone.origin]}" in lines[0]


def test_a_controller_must_be_used():
    lines = five_bar_with(*[("voltage: position_control", "voltage: 0")] * 2)
    assert [line.split(": ", 2)[1] for line in lines] == ["controllers.position_control"]


@pytest.mark.parametrize(
    ("sections", "message"),
    [
        ("a: {type: circle, diameter: 1}\n  b: {type: rectangle, width: 1, height: 1}", "is a rectangle, but the start is a circle"),
        ("a: {type: general, area: 1, second_moment: 1}\n  b: {type: general, area: 1, second_moment: 2}", "no dimensions that could vary"),
        ("a: {type: tube, outer_diameter: 1, inner_diameter: 1}", "inner_diameter: must be smaller than outer_diameter (1), is 1"),
        ("a: {type: i_beam, height: 1, flange_width: 1, flange_thickness: 0.5, web_thickness: 0.1}", "less than half the height"),
        ("a: {type: i_beam, height: 1, flange_width: 1, flange_thickness: 0.1, web_thickness: 2}", "must be at most flange_width"),
    ],
)  # fmt: skip
def test_sections_that_cannot_be(sections, message):
    text = f"""
fmbd: 1
materials: {{m: {{density: 1, youngs_modulus: 1}}}}
sections:
  {sections}
bodies:
  rod: {{type: beam, length: 1, elements: 1, material: m, section: {{start: a, end: b}}}}
joints: {{j: {{type: weld, between: [ground.origin, rod.start]}}}}
"""
    assert message in "\n".join(problems(text))
