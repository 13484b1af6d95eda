"""Named outputs of a run: values against formulas of textbooks, names, units, and where a run is kept."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fmbd
from fmbd.model import load_model_text

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def five_bar() -> fmbd.Run:
    model = fmbd.load_model(MODELS / "five_bar.yaml")
    return fmbd.simulate(model.with_("simulation.duration", 0.1))


# A load that goes on at once at the tip of a critically damped cantilever; after 2 s it is at rest.
CANTILEVER = """
fmbd: 1
materials: {steel: {density: 7850, youngs_modulus: 2.1e11}}
sections: {flat: {type: rectangle, width: 0.03, height: 0.01}}
bodies:
  rod: {type: beam, length: 1.2, elements: 2, material: steel, section: flat, points: {third: 0.4},
        damping: {modal_ratios: 1}}
joints: {clamp: {type: weld, between: [ground.origin, rod.start]}}
loads: {tip: {type: force, at: rod.end, force: [0, 50]}}
simulation: {duration: 2, output_interval: 2, rtol: 1e-11}
"""


def test_a_cantilever_under_a_tip_load_has_the_forces_and_stresses_of_the_textbook() -> None:
    """M(x) = F (L - x), V = M' = -F, stress -M (h/2) / I above the axis; F = 50 N, L = 1.2 m, h = 10 mm."""
    run = fmbd.simulate(load_model_text(CANTILEVER))
    moment = 50 * (1.2 - np.array([0, 0.6, 1.2]))
    assert_allclose(run["rod.bending_moment"][-1], moment, atol=1e-9)
    assert_allclose(run["rod.shear_force"][-1], [-50, -50, -50], rtol=1e-9)
    assert_allclose(run["rod.stress"][-1], -moment * 0.005 / (0.03 * 0.01**3 / 12), atol=1e-2)
    assert_allclose(run["rod.third.bending_moment"][-1], 50 * 0.8, rtol=1e-9)
    stiffness = 2.1e11 * 0.03 * 0.01**3 / 12
    assert_allclose(run["rod.end.deflection"][-1], 50 * 1.2**3 / (3 * stiffness), rtol=1e-9)
    assert_allclose(run["rod.slope"][-1, -1], 50 * 1.2**2 / (2 * stiffness), rtol=1e-9)


def test_what_the_clamp_puts_on_the_ground() -> None:
    """A joint's force and moment act on the body of its first point, here the ground."""
    run = fmbd.simulate(load_model_text(CANTILEVER))
    assert_allclose(run["clamp.force"][-1], [0, 50], atol=1e-8)
    assert_allclose(run["clamp.moment"][-1], 50 * 1.2, rtol=1e-9)


def test_where_sections_meet_the_bending_moment_is_the_mean_of_both_sides() -> None:
    """Within one element w'' has no jump, but E I does: here it halves at x = 0.4 m."""
    text = CANTILEVER.replace("section: flat", "section: [{until: 0.4, section: flat}, {section: thin}]")
    text = text.replace("elements: 2", "elements: 1").replace(
        "duration: 2, output_interval: 2", "duration: 0.01"
    )
    text = text.replace(
        "height: 0.01}}", "height: 0.01}, thin: {type: rectangle, width: 0.015, height: 0.01}}"
    )
    run = fmbd.simulate(load_model_text(text))
    curvature = run.position @ run.system.beams[0].curvature(0.4)
    assert_allclose(
        run["rod.third.bending_moment"], 0.75 * 2.1e11 * 0.03 * 0.01**3 / 12 * curvature, rtol=1e-12
    )


def test_stress_needs_the_height_of_the_section() -> None:
    text = CANTILEVER.replace("material: steel, section: flat", "mass_per_length: 2, bending_stiffness: 500")
    run = fmbd.simulate(load_model_text(text).with_("simulation.duration", 1e-3))
    assert "rod.bending_moment" in run
    with pytest.raises(fmbd.UnknownQuantity, match=r"'rod\.stress': beam 'rod' has no section with a height"):
        run["rod.stress"]


MOTOR = """
fmbd: 1
bodies: {wheel: {type: rigid, mass: 1, inertia: 0.3}}
joints: {axle: {type: revolute, between: [ground.origin, wheel.origin], friction: 0.05}}
motors:
  m: {type: dc, joint: axle, gear_ratio: 4, resistance: 3, torque_constant: 0.5, back_emf: 0.4,
      voltage: 10*t, REST}
simulation: {duration: 0.5, output_interval: 1e-3, rtol: 1e-9}
"""


@pytest.mark.parametrize(
    "rest",
    [
        "rotor_inertia: 0",
        "rotor_inertia: 0.02",
        "rotor_inertia: 0.02, transmission: {stiffness: 80, damping: 0.3}",
        "rotor_inertia: 0.02, inductance: 0.1",
    ],
)
def test_a_motor_obeys_its_circuit_and_drives_its_load(rest: str) -> None:
    """U = R i + L i' + Ke phi', torque = Km i, and the transmission drives 0.3 kg m2 against friction."""
    run = fmbd.simulate(load_model_text(MOTOR.replace("REST", rest)))
    rotor_rate = run["m.rotor.rate"] if "m.rotor" in run else 4 * run["axle.angle.rate"]
    assert_allclose(run["m.voltage"], 10 * run.time)
    voltage = 3 * run["m.current"] + 0.4 * rotor_rate
    if "inductance" in rest:
        # i' by central differences: good to the square of the interval
        voltage[1:-1] += 0.1 * np.gradient(run["m.current"], run.time)[1:-1]
        assert_allclose(voltage[1:-1], run["m.voltage"][1:-1], atol=1e-4)
    else:
        assert_allclose(voltage, run["m.voltage"], atol=1e-12)
    assert_allclose(run["m.torque"], 0.5 * run["m.current"])
    driven = 0.3 * run["axle.angle.acceleration"] + 0.05 * run["axle.angle.rate"]
    assert_allclose(run["m.transmission_torque"], driven, atol=1e-9)


def test_a_spring_pulls_its_points_together() -> None:
    """A mass of 2 kg on a vertical spring: the tension k (l - rest) + d l' carries its weight and inertia."""
    text = """
fmbd: 1
gravity: [0, -9.81]
bodies: {mass: {type: rigid, mass: 2, inertia: 1}}
joints: {guide: {type: prismatic, between: [ground.origin, mass.origin], axis: [0, -1]}}
springs:
  coil: {type: point_to_point, between: [ground.origin, mass.origin], stiffness: 300, damping: 4,
         rest_length: 0.2}
initial: {joints: {guide: 0.25}}
simulation: {duration: 0.5, output_interval: 0.01}
"""
    run = fmbd.simulate(load_model_text(text))
    assert_allclose(run["coil.length"], run["guide.x"])
    assert_allclose(run["coil.rate"], run["guide.x.rate"])
    assert_allclose(run["coil.force"], 300 * (run["coil.length"] - 0.2) + 4 * run["coil.rate"], atol=1e-9)
    assert_allclose(run["coil.force"], 2 * (9.81 - run["guide.x.acceleration"]), atol=1e-9)


def test_both_arms_of_the_five_bar_end_at_one_point(five_bar: fmbd.Run) -> None:
    assert_allclose(five_bar["rod_right.end.position"], five_bar["rod_left.end.position"], atol=1e-9)
    assert_allclose(five_bar["rod_right.end.position"][0], [0.1, 0.6], atol=1e-9)


def test_the_force_in_the_cut_joint_is_the_multiplier(five_bar: fmbd.Run) -> None:
    """lambda = [X, Y] of the paper acts on arm 1, whose tip is the first point of the joint."""
    assert_allclose(five_bar["effector.force"], five_bar.multipliers, rtol=1e-9)
    assert_allclose(five_bar["effector.force"][:, 0], five_bar["multipliers.effector.x"], rtol=1e-9)


def test_what_is_given_out_may_be_changed(five_bar: fmbd.Run) -> None:
    """A user's `angle *= 180 / pi` leaves the run as it is."""
    for name in ("time", "shoulder_right.angle", "energy.kinetic", "effector.force", "rod_right.deflection"):
        kept = five_bar[name].copy()
        given = five_bar[name]
        given *= 180.0 / np.pi
        np.testing.assert_array_equal(five_bar[name], kept, err_msg=name)


def test_names_say_unit_and_columns(five_bar: fmbd.Run) -> None:
    assert five_bar.units("shoulder_right.angle.rate") == "rad/s"
    assert five_bar.units("rod_right.bending_moment") == "N m"
    assert five_bar.columns("rod_right.end.position") == ("x", "y")
    assert five_bar.columns("rod_right.deflection") == ("node0", "node1")
    assert {"motor_right.rotor", "effector.angle", "energy.balance", "ground.O1.position"} <= set(
        five_bar.names
    )
    for name in five_bar:
        shape = (len(five_bar.time), len(five_bar.columns(name)))
        assert five_bar[name].shape == (shape if shape[1] else shape[:1]), name


@pytest.mark.parametrize(
    ("name", "nearest"),
    [
        ("rod_right.end.positon", "rod_right.end.position"),
        ("rod_rigth.end.position", "rod_right.end.position"),
        ("energy.kinetik", "energy.kinetic"),
    ],
)
def test_an_unknown_name_is_answered_by_the_nearest(five_bar: fmbd.Run, name: str, nearest: str) -> None:
    with pytest.raises(KeyError) as error:
        five_bar[name]
    assert str(error.value) == f"no quantity '{name}', did you mean '{nearest}'?"


def test_a_run_in_memory_and_its_archive_say_the_same(tmp_path: Path) -> None:
    model = fmbd.load_model(MODELS / "five_bar.yaml", {"simulation.duration": 0.05, "bodies.*.elements": 2})
    in_memory, written = fmbd.simulate(model), fmbd.simulate(model, tmp_path / "run.vtkhdf")
    opened = fmbd.open_run(tmp_path / "run.vtkhdf")
    assert in_memory.names == written.names == opened.names
    for name in in_memory:
        np.testing.assert_array_equal(in_memory[name], opened[name], err_msg=name)
        assert in_memory.units(name) == opened.units(name)
    timing = {"wall_time", "cpu_time", "compile_time"}
    assert {k: v for k, v in in_memory.statistics.items() if k not in timing} == {
        k: v for k, v in opened.statistics.items() if k not in timing
    }


def test_an_archive_holds_all_that_its_model_is_made_of(tmp_path: Path) -> None:
    """The table that drives the joint is deleted, an override is in the text, and both come back."""
    (tmp_path / "drive.csv").write_text("t, u\n0, 0.1\n1, 0.4\n")
    (tmp_path / "swing.yaml").write_text("""
fmbd: 1
bodies: {bar: {type: rigid, mass: 1, inertia: 0.1}}
joints: {pivot: {type: revolute, between: [ground.origin, bar.origin],
                 driven: {type: table, file: drive.csv, time: t, value: u}}}
simulation: {duration: 0.1}
""")
    model = fmbd.load_model(tmp_path / "swing.yaml", {"bodies.bar.inertia": "0.5*2"})
    fmbd.simulate(model, tmp_path / "run.vtkhdf")
    (tmp_path / "drive.csv").unlink()
    (tmp_path / "swing.yaml").unlink()
    run = fmbd.open_run(tmp_path / "run.vtkhdf")
    assert run.model.name == "swing"
    assert run.model.bodies["bar"].inertia == 1.0
    assert run.model.with_("bodies.bar.mass", 2).bodies["bar"].mass == 2.0
    assert_allclose(run["pivot.angle"], 0.1 + 0.3 * run.time)
    assert_allclose(run["bar.angular_velocity"], 0.3)


def test_coordinates_and_energies_are_read_without_numba_and_scipy(tmp_path: Path) -> None:
    fmbd.simulate(
        fmbd.load_model(MODELS / "pendulum.yaml", {"simulation.duration": 0.1}), tmp_path / "p.vtkhdf"
    )
    code = f"""
import sys, fmbd
run = fmbd.open_run({str(tmp_path / "p.vtkhdf")!r})
coordinate = run.source.coordinates[0]
run[coordinate], run[coordinate + ".rate"], run["energy.balance"], run["constraint_error"], run.names
sys.exit(bool({{"numba", "scipy", "pyvista"}} & sys.modules.keys()))
"""
    assert subprocess.run([sys.executable, "-c", code], cwd=MODELS.parent).returncode == 0
