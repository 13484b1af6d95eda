"""What a model file means: the objects that loading it gives."""

import math
import pickle
from pathlib import Path

import pytest

from fmbd.model import (
    Backlash,
    Beam,
    Constant,
    ControllerRef,
    DCMotor,
    ForceTable,
    Friction,
    GravityCompensation,
    Limits,
    Placement,
    PointRef,
    RigidBody,
    Table,
    TimeExpression,
    load_model,
    load_model_text,
)

FIVE_BAR = Path(__file__).parents[2] / "models" / "five_bar.yaml"

# A pendulum on which single parts are hung; `{}` takes more top-level keys.
FRAME = """
fmbd: 1
parameters: {{l: 0.5, half: l/2}}
materials: {{steel: {{density: 7800, youngs_modulus: 2.1e11}}}}
sections:
  strip: {{type: rectangle, width: 0.03, height: 0.003}}
  slim: {{type: rectangle, width: 0.01, height: 0.001}}
bodies:
  arm: {{type: rigid, mass: 3, inertia: 0.1, points: {{A: [l, 0], B: {{at: [half, 0], angle: pi/2}}}}}}
{bodies}
joints:
  hinge: {{type: revolute, between: [ground.origin, arm.origin]}}
{joints}
{rest}
"""


def model(rest="", bodies="", joints="", path=None):
    return load_model_text(FRAME.format(rest=rest, bodies=bodies, joints=joints), path)


def beam(keys):
    body = f"  rod: {{type: beam, length: l, {keys}}}"
    return model(bodies=body, joints="  tip: {type: weld, between: [arm.A, rod.start]}").bodies["rod"]


def rigid(keys):
    body = f"  part: {{type: rigid, {keys}}}"
    return model(bodies=body, joints="  tip: {type: weld, between: [arm.A, part.origin]}").bodies["part"]


def signal(text, path=None):
    return model(f"signals: {{s: {text}}}", path=path).signals["s"]


class TestFiveBar:
    """models/five_bar.yaml is Table 1 of Hoang et al. (2022)."""

    five_bar = load_model(FIVE_BAR)

    def test_the_arms_are_written_one_after_the_other(self):
        assert list(self.five_bar.bodies) == ["crank_right", "rod_right", "crank_left", "rod_left"]
        assert self.five_bar.ground.points["O1"].at == (0.3, 0.0)
        assert self.five_bar.ground.points["O2"].at == (-0.3, 0.0)

    def test_the_cranks_inertia_of_table_1_is_about_the_shoulder(self):
        crank = self.five_bar.bodies["crank_right"]
        assert isinstance(crank, RigidBody)
        assert crank.inertia == pytest.approx(0.2 - 3 * 0.2**2, rel=1e-14)
        assert crank.points["A"].at == (0.4, 0.0)
        assert crank.points["center_of_mass"].at == (0.2, 0.0)

    def test_the_rods_are_one_element_of_the_aluminium_strip(self):
        rod = self.five_bar.bodies["rod_left"]
        assert isinstance(rod, Beam)
        (piece,) = rod.pieces
        assert piece.mass_per_length == pytest.approx((2712 * 0.03 * 0.003,), rel=1e-14)
        assert piece.bending_stiffness == pytest.approx((7.102e10 * 0.03 * 0.003**3 / 12,), rel=1e-14)
        assert rod.nodes == (0.0, 0.5)
        assert rod.point_masses["end"].mass == 0.25
        assert rod.frame == "clamped"

    def test_the_motors_share_one_pd_law_with_gravity_compensation(self):
        motor = self.five_bar.motors["motor_right"]
        assert isinstance(motor, DCMotor)
        assert (motor.gear_ratio, motor.rotor_inertia, motor.resistance, motor.inductance) == (10, 0.1, 3, 0)
        assert motor.transmission is not None
        assert (motor.transmission.stiffness, motor.transmission.damping) == (5000, 50)
        assert motor.input == ControllerRef("position_control")
        law = self.five_bar.controllers["position_control"]
        assert (law.kp, law.kd, law.limit) == (4.0, 1.2, None)
        assert isinstance(law.target, Placement)
        assert law.target.places == {"effector": (-0.1, 0.7)}
        assert law.feedforward == GravityCompensation(computed="target")

    def test_it_starts_placed_and_runs_for_three_seconds(self):
        assert self.five_bar.initial.place == {"effector": (0.1, 0.6)}
        assert self.five_bar.joints["effector"].cut
        assert self.five_bar.simulation.duration == 3.0
        assert self.five_bar.simulation.atol == 1e-6

    def test_it_can_be_sent_to_another_process(self):
        assert pickle.loads(pickle.dumps(self.five_bar)) == self.five_bar


class TestRigidBodies:
    def test_a_box_has_the_inertia_of_a_rectangle(self):
        box = "{type: box, length: 0.5, height: 0.06, width: 0.04, center: [0.25, 0]}"
        part = rigid(f"shape: {box}, density: 7700")
        assert part.mass == pytest.approx(7700 * 0.5 * 0.06 * 0.04)
        assert part.inertia == pytest.approx(part.mass * (0.5**2 + 0.06**2) / 12)
        assert part.center_of_mass == (0.25, 0.0)

    def test_a_rod_may_point_anywhere(self):
        part = rigid("shape: {type: rod, length: 2, start: [1, 0], angle: pi/2}, mass: 3")
        assert part.center_of_mass == pytest.approx((1, 1))
        assert part.inertia == pytest.approx(3 * 2**2 / 12)

    def test_a_disc_takes_its_density_from_a_material(self):
        part = rigid("shape: {type: disc, radius: 0.1, thickness: 0.01}, material: steel")
        assert part.mass == pytest.approx(7800 * math.pi * 0.1**2 * 0.01)
        assert part.inertia == pytest.approx(part.mass * 0.1**2 / 2)

    def test_an_inertia_about_any_named_point_is_moved_to_the_centre_of_mass(self):
        part = rigid("mass: 2, center_of_mass: [1, 2], points: {P: [4, 6]}, inertia: {about: P, value: 51}")
        assert part.inertia == pytest.approx(51 - 2 * 5**2)

    def test_points_carry_a_frame(self):
        points = model().bodies["arm"].points
        assert points["B"].at == (0.25, 0.0)
        assert points["B"].angle == math.pi / 2
        assert points["A"].angle == 0.0


# Area and second moment of the sections below, by the closed forms of any handbook.
SECTIONS = {
    "{type: rectangle, width: 0.03, height: 0.01}": (3e-4, 0.03 * 0.01**3 / 12, 0.01),
    "{type: circle, diameter: 0.01}": (math.pi * 0.01**2 / 4, math.pi * 0.01**4 / 64, 0.01),
    "{type: tube, outer_diameter: 0.02, inner_diameter: 0.016}": (
        math.pi * (0.02**2 - 0.016**2) / 4,
        math.pi * (0.02**4 - 0.016**4) / 64,
        0.02,
    ),
    "{type: i_beam, height: 0.1, flange_width: 0.05, flange_thickness: 0.005, web_thickness: 0.004}": (
        2 * 0.05 * 0.005 + 0.09 * 0.004,
        2 * (0.05 * 0.005**3 / 12 + 0.05 * 0.005 * 0.0475**2) + 0.004 * 0.09**3 / 12,
        0.1,
    ),
    "{type: general, area: 1e-4, second_moment: 1e-9, height: 0.02}": (1e-4, 1e-9, 0.02),
}


class TestBeams:
    @pytest.mark.parametrize("section", SECTIONS)
    def test_a_section_gives_mass_stiffness_and_height(self, section):
        area, second_moment, height = SECTIONS[section]
        loaded = load_model_text(
            f"""
            fmbd: 1
            materials: {{unit: {{density: 1, youngs_modulus: 1}}}}
            sections: {{s: {section}}}
            bodies: {{rod: {{type: beam, length: 1, elements: 1, material: unit, section: s}}}}
            joints: {{j: {{type: weld, between: [ground.origin, rod.start]}}}}
            """
        )
        (piece,) = loaded.bodies["rod"].pieces
        assert piece.mass_per_length == pytest.approx((area,), rel=1e-13)
        assert piece.bending_stiffness == pytest.approx((second_moment,), rel=1e-13)
        assert piece.height == (height,)

    def test_a_taper_varies_dimensions_linearly_and_the_polynomials_are_exact(self):
        (piece,) = beam("elements: 2, material: steel, section: {start: strip, end: slim}").pieces
        for xi in (0.0, 0.1, 0.3, 0.5):
            width = 0.03 + (0.01 - 0.03) * xi / 0.5
            height = 0.003 + (0.001 - 0.003) * xi / 0.5
            value = [
                sum(c * xi**k for k, c in enumerate(p))
                for p in (piece.mass_per_length, piece.bending_stiffness)
            ]
            assert value == pytest.approx([7800 * width * height, 2.1e11 * width * height**3 / 12], rel=1e-12)

    def test_pieces_follow_one_another(self):
        layout = "[{until: 0.2, section: strip}, {until: l, section: {start: strip, end: slim}}]"
        first, second = beam(f"elements: 2, material: steel, section: {layout}").pieces
        assert (first.start, first.end, second.start, second.end) == (0.0, 0.2, 0.2, 0.5)
        assert first.mass_per_length == second.mass_per_length[:1]

    def test_properties_may_be_numbers(self):
        (piece,) = beam("elements: 1, mass_per_length: 0.3, bending_stiffness: 4").pieces
        assert (piece.mass_per_length, piece.bending_stiffness, piece.height) == ((0.3,), (4.0,), None)

    def test_elements_are_equal_or_given_by_their_nodes(self):
        numbers = "mass_per_length: 1, bending_stiffness: 1"
        assert beam(f"elements: 2*2, {numbers}").nodes == (0.0, 0.125, 0.25, 0.375, 0.5)
        assert beam(f"nodes: [0, 0.1, l], {numbers}").nodes == (0.0, 0.1, 0.5)

    def test_nodes_ends_and_named_places_are_points(self):
        rod = beam(
            "elements: 2, mass_per_length: 1, bending_stiffness: 1, points: {mid: half},"
            "point_masses: {mid: {mass: 0.1, inertia: 1e-4}, node1: 2}"
        )
        assert rod.points == {"start": 0, "end": 0.5, "node0": 0, "node1": 0.25, "node2": 0.5, "mid": 0.25}
        assert (rod.point_masses["mid"].inertia, rod.point_masses["node1"].mass) == (1e-4, 2.0)

    def test_modal_damping_is_one_ratio_or_a_list(self):
        numbers = "elements: 1, mass_per_length: 1, bending_stiffness: 1"
        assert beam(f"{numbers}, damping: {{modal_ratios: 0.01}}").damping.modal_ratios == 0.01
        assert beam(f"{numbers}, damping: {{modal_ratios: [0.01, 2/100]}}").damping.modal_ratios == (
            0.01,
            0.02,
        )
        assert beam(numbers).damping.stiffness_proportional == 0.0


class TestJoints:
    BALL = "  ball: {type: rigid, mass: 1, inertia: 1}"

    def joint(self, keys, path=None):
        joint = f"  j: {{between: [arm.A, ball.origin], {keys}}}"
        return model(bodies=self.BALL, joints=joint, path=path).joints["j"]

    @pytest.mark.parametrize(
        ("kind", "coordinates", "of_motor"),
        [
            ("revolute", ("angle",), "angle"),
            ("prismatic", ("x",), "x"),
            ("weld", (), None),
            ("pin_in_slot", ("x", "angle"), "angle"),
            ("free", ("x", "y", "angle"), "angle"),
        ],
    )
    def test_a_type_says_which_coordinates_are_free(self, kind, coordinates, of_motor):
        joint = self.joint(f"type: {kind}")
        assert joint.coordinates == coordinates
        assert joint.motor_coordinate == of_motor
        assert joint.between == (PointRef("arm", "A"), PointRef("ball", "origin"))

    def test_with_one_coordinate_its_name_can_be_left_out(self):
        short = self.joint(
            "type: prismatic, spring: {stiffness: 2}, friction: 0.1, driven: 0.5, axis: [0, -3]"
        )
        long = self.joint(
            "type: prismatic, axis: [0, -1], spring: {x: {stiffness: 2}}, friction: {x: .1}, driven: {x: .5}"
        )
        assert short == long
        assert short.spring["x"].stiffness == 2.0
        assert short.driven == {"x": Constant(value=0.5)}

    def test_a_driving_signal_may_be_written_in_place(self):
        joint = self.joint("type: revolute, driven: {type: ramp, end: 2, to: pi}")
        assert joint.driven["angle"].to == math.pi

    def test_several_coordinates_are_named(self):
        joint = self.joint("type: pin_in_slot, friction: {x: 1, angle: 2}, driven: {angle: t}")
        assert {name: law.viscous for name, law in joint.friction.items()} == {"x": 1.0, "angle": 2.0}
        assert list(joint.driven) == ["angle"]

    def test_laws_are_by_coordinate_and_as_short_as_can_be(self):
        joint = self.joint(
            "type: pin_in_slot, friction: {x: {coulomb: 1}, angle: 2*half}, limits: {x: {lower: 0, stiffness: 9}}"
        )
        assert joint.friction == {"x": Friction(coulomb=1.0, static=1.0), "angle": Friction(viscous=0.5)}
        assert joint.limits == {"x": Limits(lower=0.0, stiffness=9.0)}
        joint = self.joint("type: revolute, friction: {coulomb: 1}, spring: {stiffness: 2, backlash: 0.5}")
        assert joint.friction["angle"].static == 1.0
        assert joint.spring["angle"].backlash == Backlash(gap=0.5, transition=0.05)

    def test_a_force_table_stands_in_the_model_or_beside_it(self, tmp_path):
        (tmp_path / "rubber.csv").write_text("N, mm, m\n-1, 0, 0\n5, 500, 0.5\n")
        table = ForceTable((0.0, 0.5), (-1.0, 5.0), "monotone")
        for written in (
            "[[0, -1], [l, 5]]",
            "{points: [[0, -1], [l, 5]]}",
            "{file: rubber.csv, stretch: m, force: 0}",
        ):
            joint = self.joint(f"type: revolute, spring: {{force_table: {written}}}", tmp_path / "m.yaml")
            assert joint.spring["angle"].force_table == table
        joint = self.joint("type: revolute, spring: {force_table: rubber.csv}", tmp_path / "m.yaml")
        assert joint.spring["angle"].force_table.stretches == (-1.0, 5.0)


class TestSignals:
    def test_a_number_and_an_expression_of_parameters_are_constants(self):
        assert signal("3") == Constant(value=3.0)
        assert signal("2*half") == Constant(value=0.5)

    def test_an_expression_in_t_becomes_a_program(self):
        moving = signal("half*t")
        assert isinstance(moving, TimeExpression)
        assert moving.program == (("const", 0.25), ("t", 0.0), ("mul", 0.0))
        assert moving == signal("{type: expression, value: half*t}")

    def test_a_name_stands_for_the_signal(self):
        loads = model(
            "signals: {e: {type: step, after: 2}}\nloads: {pull: {type: force, at: arm.A, force: [e, e]}}"
        ).loads
        assert loads["pull"].force[0].after == 2.0

    def test_a_table_is_read_beside_the_model(self, tmp_path):
        (tmp_path / "drive.csv").write_text("u, t\n5, 0\n\n7, 0.5\n")
        by_header = "{type: table, file: drive.csv, time: t, value: u, interpolation: cubic}"
        assert signal(by_header, tmp_path / "m.yaml") == Table((0.0, 0.5), (5.0, 7.0), "cubic")
        by_number = "{type: table, file: drive.csv, time: 1, value: 0}"
        assert signal(by_number, tmp_path / "m.yaml") == Table((0.0, 0.5), (5.0, 7.0), "linear")


class TestDrives:
    CONTROLLER = (
        "controllers: {{law: {{type: {}}}}}\nmotors: {{m: {{type: torque, joint: hinge, torque: law}}}}"
    )

    def law(self, keys):
        return model(self.CONTROLLER.format(keys)).controllers["law"]

    def test_a_motors_back_emf_is_its_torque_constant_unless_it_is_given(self):
        text = (
            "motors: {m: {type: dc, joint: hinge, resistance: 3, torque_constant: 0.7, voltage: 12*sin(t)}}"
        )
        motor = model(text).motors["m"]
        assert (motor.back_emf, motor.gear_ratio, motor.transmission) == (0.7, 1.0, None)
        assert isinstance(motor.input, TimeExpression)

    def test_targets_are_signals_signals_by_joint_or_places(self):
        assert self.law("pd, kp: 1, target: 1.2").target == Constant(value=1.2)
        assert self.law("pd, kp: 1, target: {hinge: 1.2}").target == {"hinge": Constant(value=1.2)}
        assert self.law("pd, kp: 1, target: {type: sine, amplitude: 2, frequency: 1}").target.amplitude == 2.0
        assert self.law("pid, kp: 1, ki: 2, target: {place: {arm.A: [l, 0]}}").target.places == {
            "arm.A": (0.5, 0)
        }

    def test_feedforward_and_limits(self):
        law = self.law("pd, kp: 1, target: 0, limit: 24")
        assert law.limit == (-24.0, 24.0)
        assert law.feedforward == Constant(value=0.0)
        online = "{type: gravity_compensation, computed: online}"
        law = self.law(f"pd, kp: 1, target: 0, limit: [-1, 2], feedforward: {online}")
        assert law.limit == (-1.0, 2.0)
        assert law.feedforward == GravityCompensation(computed="online")


def test_a_distributed_load_covers_the_beam_unless_it_is_limited():
    rod = "  rod: {type: beam, length: l, elements: 1, mass_per_length: 1, bending_stiffness: 1}"
    weld = "  tip: {type: weld, between: [arm.A, rod.start]}"
    loads = model(
        "loads: {a: {type: distributed, on: rod, force: [0, -1]},"
        "b: {type: distributed, on: rod, force: [0, t], from: 0.1, to: 0.2, frame: following}}",
        bodies=rod,
        joints=weld,
    ).loads
    assert (loads["a"].from_, loads["a"].to) == (0.0, 0.5)
    assert (loads["b"].from_, loads["b"].to, loads["b"].frame) == (0.1, 0.2, "following")


def test_initial_values_are_by_joint_and_coordinate():
    initial = model("initial: {joints: {hinge: pi/4}, rates: {hinge: {angle: 2}}, consistent: false}").initial
    assert initial.joints == {"hinge": {"angle": math.pi / 4}}
    assert initial.rates == {"hinge": {"angle": 2.0}}
    assert not initial.consistent


def test_tolerances_and_intervals_follow_from_what_is_given():
    simulation = model("simulation: {duration: 4, rtol: 1e-8}").simulation
    assert simulation.atol == 1e-8
    assert simulation.output_interval == 0.004
    assert model("simulation: {rtol: 1e-8, atol: 1e-7}").simulation.atol == 1e-7


def test_parameters_refer_to_each_other_in_any_order():
    loaded = load_model_text(
        """
        fmbd: 1
        parameters: {area: width*height, width: 2*height, height: 3}
        bodies: {b: {type: rigid, mass: area, inertia: 0}}
        joints: {j: {type: free, between: [ground.origin, b.origin]}}
        """
    )
    assert loaded.parameters == {"area": 18.0, "width": 6.0, "height": 3.0}
    assert loaded.bodies["b"].mass == 18.0
    assert loaded.name == "model"


def test_yaml_reads_as_people_write_it():
    """YAML 1.1 would make the key `on` true and 1e-6 a text."""
    loaded = model("simulation: {rtol: 1e-6}\ndescription: yes\nname: on")
    assert (loaded.name, loaded.description, loaded.simulation.rtol) == ("on", "yes", 1e-6)


def test_later_errors_can_be_placed_in_the_file():
    five_bar = load_model(FIVE_BAR)
    line = next(k for k, text in enumerate(FIVE_BAR.read_text().splitlines(), 1) if "effector:" in text)
    assert five_bar.locate(("joints", "effector", "between")).startswith(f"{FIVE_BAR}:{line}:")
    error = five_bar.error(("joints", "effector"), "the loop cannot be closed")
    assert str(error) == f"{FIVE_BAR}:{line}:3: joints.effector: the loop cannot be closed"
