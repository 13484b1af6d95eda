"""One small model for every kind of part that a file may hold. A new kind must join: test_parts.py looks for it.

All are the same mechanism with something added: a base that floats freely (first joint, so that its coordinates come
first and move everything), and a body on it.
"""

from copy import deepcopy
from typing import Any, NamedTuple

import yaml

BASE = """
fmbd: 1
gravity: [0.5, -3]
ground: {points: {P: {at: [0.4, 0.9], angle: 0.2}}}
bodies:
  base: {type: rigid, mass: 2, inertia: 0.1, center_of_mass: [0.05, 0.02],
         points: {hip: {at: [0.3, 0.1], angle: 0.4}, back: [-0.2, 0.1]}}
  arm: {type: rigid, mass: 0.8, inertia: 0.03, center_of_mass: [0.2, 0.01], points: {hand: {at: [0.4, 0], angle: -0.3}}}
joints:
  float: {type: free, between: [ground.origin, base.origin]}
  hip: {type: revolute, between: [base.hip, arm.origin]}
initial:
  joints: {float: {x: 0.1, y: 0.2, angle: 0.3}, hip: 0.5}
  rates: {float: {x: 0.4, y: -0.3, angle: 0.6}, hip: 1.5}
simulation: {rtol: 1e-11, atol: 1e-13, duration: 0.5, output_interval: 0.125}
"""


class Sample(NamedTuple):
    """What to change in BASE, and the kind of energy that shows that the part is at work."""

    changes: dict[str, Any]
    energy: str
    internal: bool = True  #: its forces act between bodies: it changes no momentum


def model(sample: Sample) -> dict[str, Any]:
    """The whole model, as data."""
    data: dict[str, Any] = yaml.safe_load(BASE)
    changes = deepcopy(sample.changes)
    for family, parts in changes.items():
        for name, part in parts.items():
            data.setdefault(family, {})[name] = part
    return data


def _sample(text: str, energy: str, internal: bool = True) -> Sample:
    return Sample(yaml.safe_load(text), energy, internal)


def _joint(text: str, values: str, rates: str, energy: str) -> Sample:
    """The joint between base and arm replaced; values and rates of its coordinates at the start."""
    joints = "float: {x: 0.1, y: 0.2, angle: 0.3}"
    speeds = "float: {x: 0.4, y: -0.3, angle: 0.6}"
    changes = f"""
joints: {{hip: {{between: [base.hip, arm.hand], {text}}}}}
initial: {{joints: {{{joints}, {values}}}, rates: {{{speeds}, {rates}}}}}
"""
    return _sample(changes, energy)


def _spring(text: str) -> Sample:
    """A spring between base and arm."""
    return _sample(f"springs: {{s: {{between: [base.back, arm.hand], {text}}}}}", "elastic")


def _load(text: str, arm: str = "") -> Sample:
    """A load on the arm, which may be another than that of BASE."""
    other = f"bodies: {{arm: {{{arm}}}}}" if arm else ""
    return _sample(f"loads: {{f: {{{text}}}}}\n{other}", "work", internal=False)


def _body(text: str, energy: str = "elastic", more: str = "") -> Sample:
    """The arm replaced, with a spring at its far end."""
    spring = "{type: point_to_point, between: [base.back, arm.tip], stiffness: 30, rest_length: 0.2}"
    return _sample(f"bodies: {{arm: {{{text}}}}}\nsprings: {{band: {spring}}}\n{more}", energy)


def _motor(text: str, controller: str = "") -> Sample:
    """A motor at the hip."""
    law = f"controllers: {{law: {{{controller}}}}}" if controller else ""
    return _sample(f"motors: {{m: {{joint: hip, {text}}}}}\n{law}", "work")


def _signal(text: str) -> Sample:
    """A signal as the moment on the arm."""
    return _sample(
        f"signals: {{s: {{{text}}}}}\nloads: {{push: {{type: moment, at: arm.origin, moment: s}}}}",
        "work",
        internal=False,
    )


BEAM = """type: beam, length: 0.4, elements: 2, mass_per_length: 2, bending_stiffness: 4,
          points: {origin: 0.1, hand: 0.3, tip: 0.4}"""
FINE = BEAM.replace("elements: 2", "elements: 6")
SHORTENING = f"{BEAM}, frame: chord, foreshortening: true"
THICK = "rotary_inertia: 0.005, shear: {shear_stiffness: 500}"
POINT = "{mass: 0.1, inertia: 0.01}"
TAPERED = """type: beam, length: 0.4, nodes: [0, 0.1, 0.4], material: foam,
             points: {origin: 0.1, hand: 0.3, tip: 0.4},
             section: [{until: 0.2, section: {start: thick, end: thin}}, {until: 0.4, section: thin}]"""
FOAM = """
materials: {foam: {density: 500, youngs_modulus: 1e7, poissons_ratio: 0.3}}
sections: {thick: {type: rectangle, width: 0.08, height: 0.04}, thin: {type: rectangle, width: 0.08, height: 0.02}}
"""
DC = "type: dc, resistance: 2, torque_constant: 0.3, back_emf: 0.2"
ROTOR = "gear_ratio: 7, rotor_inertia: 3e-3"

#: family.type, and a variant after a blank.
SAMPLES = {
    "joints.revolute": _joint(
        "type: revolute, spring: {stiffness: 4, damping: 0.1, rest: 0.2}", "hip: 0.5", "hip: 2", "elastic"
    ),
    "joints.revolute friction": _joint("type: revolute, friction: 0.2", "hip: 0.5", "hip: 2", "dissipated"),
    "joints.revolute dry friction": _joint(
        "type: revolute, friction: {viscous: 0.02, coulomb: 0.2, static: 0.3, stribeck_speed: 0.4}",
        "hip: 0.5",
        "hip: 2",
        "dissipated",
    ),
    "joints.revolute stops": _joint(
        "type: revolute, limits: {lower: 0.45, upper: 0.55, stiffness: 90, damping: 0.3, transition: 0.01}",
        "hip: 0.5",
        "hip: 2",
        "elastic",
    ),
    "joints.revolute driven": _joint('type: revolute, driven: "0.5 + sin(4*t)"', "", "", "work"),
    "joints.revolute backwards": _sample(
        "joints: {hip: {type: revolute, between: [arm.hand, base.hip], spring: {stiffness: 3}}}", "elastic"
    ),
    "joints.prismatic": _joint(
        "type: prismatic, axis: [1, 1], spring: {stiffness: 40, damping: 1, rest: 0.1}",
        "hip: 0.05",
        "hip: 0.4",
        "elastic",
    ),
    "joints.prismatic backlash": _joint(
        "type: prismatic, axis: [1, 1], spring: {stiffness: 90, damping: 1, rest: 0.03, backlash: 0.04}",
        "hip: 0.03",
        "hip: 0.4",
        "elastic",
    ),
    "joints.prismatic driven": _joint('type: prismatic, axis: [1, 1], driven: "0.2*t*t"', "", "", "work"),
    "joints.prismatic backwards": _sample(
        """
joints: {hip: {type: prismatic, between: [arm.hand, base.hip], driven: "0.5 + 0.2*sin(3*t)"}}
initial: {joints: {}, rates: {float: {angle: 2}}}
""",
        "work",
    ),
    "joints.weld": _joint("type: weld", "", "", "kinetic"),
    "joints.pin_in_slot": _joint(
        "type: pin_in_slot, friction: {x: 0.5, angle: 0.1}, spring: {x: {stiffness: 30}}",
        "hip: {x: 0.1, angle: 0.4}",
        "hip: {x: 0.3, angle: 1}",
        "elastic",
    ),
    "joints.pin_in_slot driven": _joint(
        'type: pin_in_slot, driven: {x: "0.1*sin(5*t)"}', "hip: {angle: 0.4}", "hip: {angle: 1}", "work"
    ),
    "joints.pin_in_slot backwards": _sample(
        """
joints: {hip: {type: pin_in_slot, between: [arm.hand, base.hip], friction: {x: 1},
               driven: {angle: "0.5 + 0.2*sin(3*t)"}}}
initial: {joints: {}, rates: {hip: {x: 1}}}
""",
        "work",
    ),
    "joints.free": _joint(
        """type: free, axis: [1, 2], friction: {x: 0.3, y: 0.2},
           spring: {x: {stiffness: 30, rest: 0.05}, y: {stiffness: 20, damping: 0.1}, angle: {stiffness: 1}}""",
        "hip: {x: 0.1, y: -0.05, angle: 0.7}",
        "hip: {x: 0.3, y: 0.2, angle: -0.8}",
        "elastic",
    ),
    "joints.free laws": _joint(
        """type: free, axis: [1, 2], friction: {y: {coulomb: 0.4, transition_speed: 0.3}},
           limits: {x: {upper: 0.12, stiffness: 200, damping: 1, transition: 0.08}, angle: {lower: 0.6, stiffness: 3}},
           spring: {y: {force_table: [[-0.1, -4], [0, 0], [0.05, 0.5], [0.1, 5]], damping: 0.1}}""",
        "hip: {x: 0.1, y: -0.05, angle: 0.7}",
        "hip: {x: 0.3, y: 0.2, angle: -0.8}",
        "elastic",
    ),
    "joints.free driven": _joint(
        'type: free, driven: {x: "0.1*t", y: "0.2*t*t", angle: "sin(3*t)"}', "", "", "work"
    ),
    "springs.point_to_point": _spring("type: point_to_point, stiffness: 50, damping: 2, rest_length: 0.5"),
    "springs.point_to_point relaxed": _spring("type: point_to_point, stiffness: 50, damping: 2"),
    "springs.point_to_point backlash": _spring(
        "type: point_to_point, stiffness: 200, damping: 4, backlash: {gap: 0.02, transition: 0.02}"
    ),
    "springs.point_to_point curve": _spring(
        "type: point_to_point, force_table: [[-0.2, -9], [0, 1], [0.05, 3], [0.1, 2], [0.3, 20]], damping: 0.5"
    ),
    "springs.torsional": _spring("type: torsional, stiffness: 5, damping: 0.3, rest_angle: 1"),
    "springs.torsional curve": _spring(
        "type: torsional, force_table: {points: [[-0.5, -3], [0, 0.5], [2, 1]], interpolation: linear}, rest_angle: 1"
    ),
    "springs.torsional backlash": _spring("type: torsional, stiffness: 9, damping: 0.05, backlash: 0.1"),
    "loads.force": _load('type: force, at: arm.hand, force: ["3*cos(6*t)", 2]'),
    "loads.force following": _load('type: force, at: arm.hand, force: ["3*cos(6*t)", 2], frame: following'),
    "loads.moment": _load('type: moment, at: arm.hand, moment: "0.4 + t"'),
    "loads.distributed": _load(
        'type: distributed, "on": arm, force: [4, "-5*cos(3*t)"], from: 0.05, to: 0.33', BEAM
    ),
    "loads.distributed following": _load(
        'type: distributed, "on": arm, force: [4, "-5*cos(3*t)"], frame: following', BEAM
    ),
    "loads.distributed segments": _load(
        'type: distributed, "on": arm, force: [4, "-5*cos(3*t)"], from: 0.05, to: 0.33',
        f"{BEAM}, segments: 2",
    ),
    "loads.distributed foreshortened": _load(
        'type: distributed, "on": arm, force: [4, "-5*cos(3*t)"], from: 0.05, to: 0.33', SHORTENING
    ),
    "loads.distributed foreshortened segments": _load(
        'type: distributed, "on": arm, force: [4, "-5*cos(3*t)"], from: 0.05, to: 0.33',
        f"{SHORTENING}, segments: 2",
    ),
    "loads.distributed following foreshortened": _load(
        'type: distributed, "on": arm, force: [4, "-5*cos(3*t)"], frame: following', SHORTENING
    ),
    "motors.dc": _motor(f"{DC}, gear_ratio: 3, voltage: '4*cos(5*t)'"),
    "motors.dc rigid": _motor(f"{DC}, {ROTOR}, voltage: 4"),
    "motors.dc elastic": _motor(f"{DC}, {ROTOR}, transmission: {{stiffness: 4, damping: 0.2}}, voltage: 4"),
    "motors.dc backlash": _motor(
        f"{DC}, {ROTOR}, transmission: {{stiffness: 40, damping: 0.2, backlash: 0.02}}, voltage: '9*cos(20*t)'"
    ),
    "motors.dc inductance": _motor(f"{DC}, {ROTOR}, inductance: 0.02, voltage: 4"),
    "motors.torque": _motor("type: torque, torque: '0.3*cos(5*t)'"),
    "motors.torque elastic": _motor(f"type: torque, {ROTOR}, transmission: {{stiffness: 40}}, torque: 0.2"),
    "controllers.pd": _motor(
        f"{DC}, {ROTOR}, voltage: law", "type: pd, kp: 3, kd: 0.4, target: '1 + sin(3*t)', feedforward: 0.3"
    ),
    "controllers.pd joint": _motor(
        f"{DC}, {ROTOR}, voltage: law",
        "type: pd, kp: 30, kd: 0.4, measure: joint, target: {hip: 1}, limit: [-6, 4]",
    ),
    "controllers.pid": _motor(
        "type: torque, gear_ratio: 2, torque: law",
        """type: pid, kp: 3, ki: 5, kd: 0.2, target: 1, limit: 2,
           feedforward: {type: gravity_compensation, computed: online}""",
    ),
    "signals.constant": _signal("type: constant, value: 0.5"),
    "signals.step": _signal("type: step, at: 0.21, before: 0.1, after: 0.8"),
    "signals.ramp": _signal("type: ramp, start: 0.1, end: 0.3, from: 0.1, to: 1"),
    "signals.smooth_step": _signal("type: smooth_step, start: 0.1, end: 0.3, to: 1"),
    "signals.sine": _signal("type: sine, amplitude: 1, frequency: 3, phase: 0.3, offset: 0.2"),
    "signals.pulse": _signal(
        "type: pulse, start: 0.07, width: 0.04, period: 0.1, amplitude: 2, offset: -0.1"
    ),
    "signals.expression": _signal("type: expression, value: 'sqrt(1 + t)*cos(7*t)'"),
    "signals.table": _signal("type: table, file: drive.csv, interpolation: cubic"),
    "signals.table linear": _signal("type: table, file: drive.csv"),
    "bodies.rigid": _body(
        """type: rigid, mass: 1, inertia: {about: tip, value: 0.2}, center_of_mass: [0.2, 0],
           points: {tip: [0.4, 0], hand: [0.1, 0.1]}"""
    ),
    "bodies.rigid box": _body(
        """type: rigid, density: 500, points: {tip: [0.4, 0]},
           shape: {type: box, length: 0.4, height: 0.1, width: 0.05, center: [0.1, 0.1], angle: 0.3}"""
    ),
    "bodies.rigid rod": _body(
        """type: rigid, mass: 1, points: {tip: [0.4, 0]},
           shape: {type: rod, length: 0.4, start: [0.1, 0], angle: 0.3}"""
    ),
    "bodies.rigid disc": _body(
        """type: rigid, mass: 1, points: {tip: [0.4, 0]}, shape: {type: disc, radius: 0.2, center: [0.1, 0]}"""
    ),
    "bodies.beam": _body(
        f"{BEAM}, point_masses: {{start: 0.1, tip: {{mass: 0.2, inertia: 0.01}}, hand: 0.3}}"
    ),
    "bodies.beam chord": _body(
        f"{BEAM}, frame: chord, point_masses: {{start: {{mass: 0.1, inertia: 0.02}}, hand: 0.3}}"
    ),
    "bodies.beam segments": _body(
        f"{BEAM}, segments: 2, point_masses: {{start: 0.1, tip: {{mass: 0.2, inertia: 0.01}}, hand: 0.3}}"
    ),
    "bodies.beam segments damped": _body(
        f"{TAPERED}, segments: 2, damping: {{stiffness_proportional: 1e-2}}", "dissipated", FOAM
    ),
    "bodies.beam modes": _body(
        f"{BEAM}, modes: 2, point_masses: {{start: 0.1, tip: {{mass: 0.2, inertia: 0.01}}, hand: 0.3}}"
    ),
    "bodies.beam modes damped": _body(
        f"{BEAM}, frame: chord, modes: {{up_to: 200}}, damping: {{modal_ratios: [0.1, 0.05]}}", "dissipated"
    ),
    "bodies.beam damped": _body(
        f"{BEAM}, damping: {{stiffness_proportional: 1e-2, modal_ratios: [0.1, 0.05]}}", "dissipated"
    ),
    "bodies.beam mass damped": _body(f"{BEAM}, damping: {{mass_proportional: 20}}", "dissipated"),
    "bodies.beam tapered": _body(TAPERED, more=FOAM),
    "bodies.beam rotary inertia": _body(f"{FINE}, rotary_inertia: 0.005, point_masses: {{hand: {POINT}}}"),
    "bodies.beam thick": _body(f"{BEAM}, {THICK}, frame: chord"),
    "bodies.beam thick tapered": _body(f"{TAPERED}, rotary_inertia: true, shear: true", more=FOAM),
    "bodies.beam thick lumped": _body(f"{BEAM}, {THICK}, mass: lumped"),
    "bodies.beam thick segments": _body(f"{BEAM}, {THICK}, segments: 2"),
    "bodies.beam thick modes": _body(f"{BEAM}, {THICK}, modes: 2"),
    "bodies.beam thick foreshortened": _body(f"{SHORTENING}, {THICK}"),
    "bodies.beam lumped foreshortened": _body(f"{SHORTENING}, mass: lumped"),
    "bodies.beam foreshortened segments": _body(
        f"{SHORTENING}, segments: 2, point_masses: {{tip: {{mass: 0.1, inertia: 0.02}}, hand: 0.1}}"
    ),
    "bodies.beam foreshortened modes": _body(f"{SHORTENING}, modes: 2, point_masses: {{hand: 0.1}}"),
    "bodies.beam foreshortened": _body(
        f"{SHORTENING}, point_masses: {{tip: {{mass: 0.1, inertia: 0.02}}, hand: 0.1}}"
    ),
}
