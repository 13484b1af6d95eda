"""The compiled recursion and Lagrange's equations on whole Jacobians are two programs for one model.

The first works body by body in modal coordinates, the second (fmbd.system.matrices) knows no recursion and no
modes. A mistake in either shows as a difference.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fmbd.model import load_model_text
from fmbd.solvers.integrate import Statistics, integrate, output_times
from fmbd.system import assemble

EVERYTHING = """
fmbd: 1
gravity: [0.7, -9.81]
ground: {points: {P: {at: [0.2, -0.1], angle: 0.3}, W: [1.2, -0.5]}}
bodies:
  cart: {type: rigid, mass: 2, inertia: 0.3, center_of_mass: [0.1, 0.05],
         points: {a: {at: [0.2, 0.1], angle: 0.5}, b: [-0.1, 0.3]}}
  arm: {type: beam, length: 0.8, nodes: [0, 0.3, 0.8], frame: chord, mass_per_length: 0.9,
        bending_stiffness: 12, points: {mid: 0.35, far: 0.7},
        point_masses: {mid: {mass: 0.2, inertia: 0.03}, end: 0.1},
        damping: {stiffness_proportional: 1e-3, modal_ratios: 0.02}}
  rod: {type: beam, length: 0.6, elements: 2, mass_per_length: 0.5, bending_stiffness: 5, points: {mid: 0.2},
        point_masses: {end: {mass: 0.1, inertia: 0.01}}}
  slider: {type: rigid, mass: 0.7, inertia: 0.05, points: {c: {at: [0.1, 0.2], angle: -0.4}}}
  puck: {type: rigid, mass: 0.4, inertia: 0.02, center_of_mass: [0.02, 0.0], points: {e: [0.1, 0]}}
  tail: {type: rigid, mass: 0.2, inertia: 0.01, center_of_mass: [0.1, 0.0]}
  crank: {type: rigid, mass: 1.4, inertia: 0.02, center_of_mass: [0.1, 0.0],
          points: {tip: {at: [0.3, 0], angle: 0.2}}}
joints:
  rail: {type: prismatic, between: [ground.P, cart.a], axis: [1, 2],
         spring: {stiffness: 40, damping: 2, rest: 0.05, backlash: 0.2},
         limits: {lower: -0.1, upper: 0.05, stiffness: 70, damping: 0.4, transition: 0.1}}
  hinge: {type: revolute, between: [arm.mid, cart.b],
          friction: {viscous: 0.2, coulomb: 1, static: 3, stribeck_speed: 2, transition_speed: 0.7}}
  pin: {type: pin_in_slot, between: [rod.mid, arm.far], axis: [2, -1],
        spring: {x: {stiffness: 30, damping: 1, rest: 0.02}, angle: {stiffness: 3, damping: 0.1, rest: 0.1}}}
  shove: {type: prismatic, between: [rod.end, slider.c], driven: "0.1*sin(3*t) + 0.05*t"}
  fly: {type: free, between: [ground.origin, puck.origin], axis: [0, 1]}
  wag: {type: revolute, between: [puck.e, tail.origin]}
  drive: {type: revolute, between: [ground.W, crank.origin], driven: "0.4*t + 0.2*sin(2*t)"}
  groove: {type: prismatic, between: [crank.tip, rod.start], axis: [1, 1], cut: true,
           spring: {stiffness: 20, damping: 0.3, rest: 0.1}}
  towed: {type: pin_in_slot, between: [slider.origin, tail.origin], cut: true, driven: {x: "0.2*sin(t)"}}
springs:
  cord: {type: point_to_point, between: [arm.end, puck.e], stiffness: 50, damping: 1.5, rest_length: 0.4}
  twist: {type: torsional, between: [rod.start, puck.origin], stiffness: 4, damping: 0.2, rest_angle: 0.3}
  worn: {type: torsional, between: [rod.end, crank.tip], stiffness: 9, damping: 1,
         backlash: {gap: 0.2, transition: 0.2}}
  rubber: {type: point_to_point, between: [cart.a, slider.c], force_table: [[-0.5, -9], [0, 1], [0.2, 0], [0.5, 7]]}
loads:
  pull: {type: force, at: arm.start, force: ["2*cos(t)", 1.5], frame: following}
  push: {type: force, at: slider.origin, force: [0.4, "t"]}
  turn: {type: moment, at: rod.end, moment: 0.3}
  wind: {type: distributed, on: arm, force: [0.6, -1.1], frame: following, from: 0.1, to: 0.55}
  snow: {type: distributed, on: rod, force: [0.3, 0.8]}
motors:
  a: {type: dc, joint: rail, gear_ratio: 5, resistance: 2, torque_constant: 0.5, voltage: law}
  b: {type: dc, joint: fly, gear_ratio: 7, rotor_inertia: 0.01, resistance: 3, inductance: 0.1,
      torque_constant: 0.4, back_emf: 0.3, transmission: {stiffness: 30, damping: 0.4, backlash: 0.2}, voltage: law}
  c: {type: torque, joint: wag, gear_ratio: 4, rotor_inertia: 0.002, torque: follow}
  d: {type: dc, joint: groove, resistance: 3, torque_constant: 0.4, voltage: "sin(t)"}
controllers:
  law: {type: pid, kp: 3, ki: 2, kd: 0.5, target: {rail: "0.1*t", fly: "sin(t)"}, limit: LIMIT,
        feedforward: {type: gravity_compensation, computed: online}}
  follow: {type: pd, kp: 3, kd: 0.5, target: 0.1, feedforward: "0.2*t"}
initial: {consistent: false}
"""


THICK = {"rotary_inertia": 0.02, "shear": {"shear_stiffness": 300}}


@pytest.mark.parametrize(
    ("limit", "changes"),
    [(0.5, {}), (1e3, {}), (0.5, THICK), (0.5, THICK | {"mass": "lumped"})],
    ids=["limited", "free", "thick", "lumped"],
)
def test_matrices_and_recursion_are_one_model(limit, changes):
    """Every joint, spring, load, motor and controller at once: two formulations, one acceleration.

    Reversed and tilted joints, both beam frames, point inertias, prescribed joints inside and before a loop; beams with
    rotary inertia, shear and lumped mass, too.
    """
    overrides = {f"bodies.{beam}.{key}": value for beam in ("arm", "rod") for key, value in changes.items()}
    system = assemble(load_model_text(EVERYTHING.replace("LIMIT", str(limit)), overrides=overrides))
    rng = np.random.default_rng(7)
    for t in (0.0, 0.37, 2.4):
        q, v = system.start.q + 0.1 * rng.normal(size=system.planar.nq), rng.normal(size=system.planar.nq)
        z = rng.normal(size=len(system.states))
        acceleration, multipliers = system.matrices(q, v, t, z).accelerations()
        from_recursion, multipliers_too = system.accelerations(q, v, t, z)
        assert_allclose(acceleration, from_recursion, rtol=1e-9)
        assert_allclose(multipliers, multipliers_too, rtol=1e-9)


@pytest.mark.parametrize(
    ("changes", "shortened", "size"),
    [
        ({}, 2, 0.005),
        ({"segments": 2, "damping": {}}, 4, 0.005),
        ({"modes": 3}, 2, 0.0005),
        (THICK, 2, 0.005),
        (THICK | {"mass": "lumped"}, 2, 0.005),
    ],
    ids=["whole", "segments", "modes", "thick", "lumped"],
)
def test_beams_that_shorten_are_one_model_too(changes, shortened, size):
    """The same with foreshortening, at deflections that are small against the lengths; in segments, of few modes."""
    text = EVERYTHING.replace("LIMIT", "0.5")
    text = text.replace("frame: chord,", "frame: chord, foreshortening: true,")
    text = text.replace("elements: 2,", "elements: 2, frame: chord, foreshortening: true,")
    overrides = {f"bodies.{beam}.{key}": value for beam in ("arm", "rod") for key, value in changes.items()}
    system = assemble(load_model_text(text, overrides=overrides))
    assert np.count_nonzero(system.planar.bodies.axial >= 0) == shortened
    rng = np.random.default_rng(7)
    for t in (0.0, 0.37, 2.4):
        sizes = np.where(system.elastic, size, 0.1)
        q, v = system.start.q + sizes * rng.normal(size=sizes.size), rng.normal(size=sizes.size)
        z = rng.normal(size=len(system.states))
        acceleration, multipliers = system.matrices(q, v, t, z).accelerations()
        from_recursion, multipliers_too = system.accelerations(q, v, t, z)
        assert_allclose(acceleration, from_recursion, rtol=1e-9)
        assert_allclose(multipliers, multipliers_too, rtol=1e-9)


LADEN = """
fmbd: 1
gravity: [0, -9.81]
bodies:
  rod: {{type: beam, length: 0.6, elements: {elements}, mass_per_length: 0.3, bending_stiffness: 80,
        points: {{k: 0.2}}}}
  load: {{type: rigid, mass: 4, inertia: 0.1, center_of_mass: [1, 0.2]}}
  bob: {{type: rigid, mass: 1, inertia: 0.1, center_of_mass: [0.1, 0]}}
joints:
  pivot: {{type: revolute, between: [ground.origin, rod.start]}}
  fixed: {{type: weld, between: [rod.end, load.origin]}}
  hinge: {{type: {hinge}, between: [rod.k, bob.origin]}}
simulation: {{duration: 0.02, rtol: 1e-9}}
"""


@pytest.mark.parametrize("hinge", ["weld", "revolute", "prismatic"])
@pytest.mark.parametrize("elements", [2, 8, 16])
def test_heavy_bodies_on_a_light_beam(hinge: str, elements: int) -> None:
    """Twenty times the beam's mass hangs on its rows: M q'' = f holds as well as dense Cholesky solves it.

    The norm is that of M^-1, in which round-off is measured against what the forces do. A dense solve is good to 3e-9
    at 16 elements; when the child's inertia was condensed by differences the recursion was good to 1e-2.
    """
    system = assemble(load_model_text(LADEN.format(hinge=hinge, elements=elements)))
    rng = np.random.default_rng(7)
    q = system.start.q + np.where(system.elastic, 1e-3, 0.5) * rng.uniform(-1, 1, system.start.q.size)
    terms = system.matrices(q, 0.0 * q)
    force = terms.f - terms.g - terms.K @ q
    factor = np.linalg.cholesky(terms.M)
    residual = np.linalg.solve(factor, terms.M @ system.accelerations(q, 0.0 * q)[0] - force)
    assert np.linalg.norm(residual) < 1e-8 * np.linalg.norm(np.linalg.solve(factor, force))


def test_a_laden_beam_keeps_its_energy() -> None:
    """It takes a few thousand steps, where lost digits made it crawl."""
    system = assemble(load_model_text(LADEN.format(hinge="revolute", elements=8)))
    statistics = Statistics("dop853")
    blocks = list(integrate(system, output_times(0.02, 0.01), statistics))
    assert max(np.abs(block.energy["balance"]).max() for block in blocks) < 1e-9
    assert statistics.steps < 5000
