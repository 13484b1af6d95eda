"""Two mechanisms, and ways to write the same one differently: the subjects of the invariance tests.

The five-bar is the paper's. The shaper is a quick-return drive: a crank turns a flexible rocker by a pin in a slot,
a flexible link pushes a ram along a rail. Its joints are written partly against the direction in which the program
goes through them, and a weight is shaken on the crank by a driven slide.
"""

from collections.abc import Mapping
from copy import deepcopy
from math import cos, sin
from typing import Any

import yaml
from physics import MODELS

Data = dict[str, Any]

SHAPER = """
fmbd: 1
gravity: [0.4, -9.81]
ground: {points: {O: [0, 0.3], R: {at: [0, 0], angle: 0.3}, W: {at: [0.2, 0.8], angle: 0}}}
bodies:
  crank: {type: rigid, mass: 1.5, inertia: 0.02, center_of_mass: [0.03, 0.01],
          points: {tip: [0.12, 0], back: {at: [-0.05, 0], angle: 1.2}}}
  rocker: {type: beam, length: 0.7, nodes: [0, 0.3, 0.7], mass_per_length: 0.8, bending_stiffness: 60,
           points: {slot: 0.3}, damping: {stiffness_proportional: 1e-4}}
  link: {type: beam, length: 0.3, elements: 1, mass_per_length: 0.5, bending_stiffness: 20,
         point_masses: {start: 0.1, end: {mass: 0.2, inertia: 1e-3}}}
  ram: {type: rigid, mass: 2, inertia: 0.01, center_of_mass: [0.02, -0.01],
        points: {pin: [0, 0], guide: {at: [0, 0.05], angle: pi}}}
  weight: {type: rigid, mass: 0.3, inertia: 1e-3, center_of_mass: [0.01, 0.02]}
joints:
  shaft: {type: revolute, between: [crank.origin, ground.O], friction: 0.05}
  pivot: {type: revolute, between: [ground.R, rocker.start]}
  slot: {type: pin_in_slot, between: [rocker.slot, crank.tip], axis: [1, 0.05],
         friction: {x: 2, angle: 0.01}, spring: {x: {stiffness: 30, damping: 1, rest: -0.05}}}
  wrist: {type: revolute, between: [rocker.end, link.start], spring: {stiffness: 0.5, rest: -1}}
  pin: {type: revolute, between: [ram.pin, link.end],
        friction: {viscous: 0.02, coulomb: 0.05, static: 0.08, stribeck_speed: 1, transition_speed: 0.1}}
  guide: {type: prismatic, between: [ram.guide, ground.W], friction: 3}
  shake: {type: prismatic, between: [weight.origin, crank.back], driven: "0.02*sin(9*t) + 0.1*t"}
springs:
  cord: {type: point_to_point, between: [rocker.end, ground.O], stiffness: 40, damping: 1, rest_length: 0.3}
  twist: {type: torsional, between: [link.start, crank.tip], stiffness: 0.3, damping: 0.01, backlash: 0.1}
loads:
  cutting: {type: force, at: ram.pin, force: ["-4*cos(5*t)", 1], frame: fixed}
  blow: {type: force, at: rocker.end, force: [0.5, "2*t"], frame: following}
  wind: {type: distributed, "on": rocker, force: [0.3, -1.2], from: 0.1, to: 0.6}
  jet: {type: distributed, "on": link, force: [0.2, 0.7], frame: following}
  brake: {type: moment, at: rocker.slot, moment: "0.2*sin(3*t)"}
motors:
  drive: {type: dc, joint: shaft, gear_ratio: 6, rotor_inertia: 1e-3, resistance: 2, inductance: 0.05,
          torque_constant: 0.3, transmission: {stiffness: 300, damping: 0.5}, voltage: speed}
  helper: {type: torque, joint: wrist, gear_ratio: 2, rotor_inertia: 2e-4, torque: "0.02*sin(4*t)"}
controllers:
  speed: {type: pid, kp: 0.8, ki: 2, kd: 0.1, target: "-0.7 - 3*t", limit: 20, feedforward: 1}
initial:
  joints: {shaft: -0.6}
  rates: {shaft: -3}
  hints: {pivot: 1, slot: {x: 0.1, angle: -0.8}, wrist: -1, pin: -2.7, guide: 0.2}
simulation: {rtol: 1e-12, atol: 1e-14}
"""


def five_bar() -> Data:
    """The paper's robot, its arms of two elements."""
    data: Data = yaml.safe_load((MODELS / "five_bar.yaml").read_text())
    for name in ("rod_right", "rod_left"):
        data["bodies"][name]["elements"] = 2
    data["initial"]["hints"]["effector"] = -2.2
    data["simulation"] |= {"rtol": 1e-12, "atol": 1e-14}
    return data


def shaper() -> Data:
    """The quick-return drive."""
    data: Data = yaml.safe_load(SHAPER)
    return data


MECHANISMS = {"five_bar": five_bar, "shaper": shaper}
POINTS = {
    "five_bar": ["crank_right.A", "rod_right.node1", "rod_right.end", "crank_left.A", "rod_left.end"],
    "shaper": ["crank.tip", "rocker.slot", "rocker.end", "link.end", "ram.pin", "weight.center_of_mass"],
}


def reordered(data: Data) -> Data:
    """All parts in the opposite order of the file."""
    families = ("bodies", "joints", "springs", "loads", "motors", "controllers")
    return data | {name: dict(reversed(data[name].items())) for name in families if name in data}


def cut_at(data: Data, joints: list[str]) -> Data:
    """The loops closed by the joints named."""
    data = deepcopy(data)
    for name, joint in data["joints"].items():
        joint["cut"] = name in joints
    return data


def moved(data: Data, angle: float, x: float, y: float) -> Data:
    """The whole scene turned about the origin, then shifted."""
    data = deepcopy(data)

    def turned(vector: Any) -> list[str]:
        a, b = vector
        return [f"({a})*{cos(angle)} - ({b})*{sin(angle)}", f"({a})*{sin(angle)} + ({b})*{cos(angle)}"]

    def shifted(place: Any) -> list[str]:
        a, b = turned(place)
        return [f"{a} + {x}", f"{b} + {y}"]

    for name, point in data["ground"]["points"].items():
        given = point if isinstance(point, Mapping) else {"at": point}
        turn = f"{given.get('angle', 0)} + {angle}"
        data["ground"]["points"][name] = {"at": shifted(given["at"]), "angle": turn}
    data["gravity"] = turned(data["gravity"])
    for load in data.get("loads", {}).values():
        if load["type"] != "moment" and load.get("frame", "fixed") == "fixed":
            load["force"] = turned(load["force"])
    targets = [law["target"] for law in data["controllers"].values() if isinstance(law["target"], Mapping)]
    for places in [data["initial"], *targets]:
        for name, place in places.get("place", {}).items():
            places["place"][name] = shifted(place)
    return data


def joints_reversed(data: Data) -> Data:
    """Revolute and prismatic joints written from the other point: their coordinates change sign.

    The frames of the points of a prismatic joint are parallel, so that the axis stays. A joint with a motor stays as
    it is: its first point says on which body the motor sits.
    """
    data = deepcopy(data)

    def opposite(value: Any) -> Any:
        return {key: opposite(v) for key, v in value.items()} if isinstance(value, dict) else f"-({value})"

    kinds = ("revolute", "prismatic")
    turned = {name for name, joint in data["joints"].items() if joint["type"] in kinds}
    turned -= {motor["joint"] for motor in data["motors"].values()}
    for name in turned:
        joint = data["joints"][name]
        joint["between"].reverse()
        if "rest" in joint.get("spring", {}):
            joint["spring"]["rest"] = opposite(joint["spring"]["rest"])
        if "driven" in joint:
            joint["driven"] = opposite(joint["driven"])
    for values in (data["initial"].get(key, {}) for key in ("joints", "rates", "hints")):
        for name in turned & values.keys():
            values[name] = opposite(values[name])
    return data


def turned_round(data: Data, beams: list[str]) -> Data:
    """Beams described from their other end; their frames and those of their points are turned by pi."""
    data = deepcopy(data)
    for beam in beams:
        _turn_round(data, beam)
    return data


def _turn_round(data: Data, beam: str) -> None:
    part = data["bodies"][beam]
    length = part["length"]
    ends = {"start": "end", "end": "start"}

    def far(x: Any) -> str:
        return f"({length}) - ({x})"

    def renamed(reference: str) -> str:
        body, point = reference.split(".")
        return f"{body}.{ends.get(point, point)}" if body == beam else reference

    part["points"] = {name: far(x) for name, x in part.get("points", {}).items()}
    part["point_masses"] = {ends.get(k, k): mass for k, mass in part.get("point_masses", {}).items()}
    if "nodes" in part:
        part["nodes"] = [far(x) for x in reversed(part["nodes"])]
    initial = data["initial"]
    for name, joint in data["joints"].items():
        for end, sign in enumerate("-+"):
            if joint["between"][end].startswith(f"{beam}."):
                assert joint["type"] in ("revolute", "pin_in_slot")
                if end == 0 and joint["type"] == "pin_in_slot":
                    joint["axis"] = [f"-({number})" for number in joint.get("axis", [1, 0])]
                springs = joint.get("spring", {})
                spring = springs if joint["type"] == "revolute" else springs.get("angle", {})
                for values, key in [(initial[k], name) for k in ("joints", "hints") if k in initial] + [
                    (spring, "rest")
                ]:
                    if isinstance(values.get(key), dict):
                        values, key = values[key], "angle"
                    if key in values:
                        values[key] = f"({values[key]}) {sign} pi"
        joint["between"] = [renamed(reference) for reference in joint["between"]]
    for spring in data.get("springs", {}).values():
        spring["between"] = [renamed(reference) for reference in spring["between"]]
    for load in data.get("loads", {}).values():
        following = load.get("frame") == "following"
        if load.get("on") == beam:
            load["from"], load["to"] = far(load.get("to", length)), far(load.get("from", 0))
        elif load.get("at", "").startswith(f"{beam}."):
            load["at"] = renamed(load["at"])
        else:
            following = False
        if following:
            load["force"] = [f"-({number})" for number in load["force"]]


def chord_frames(data: Data) -> Data:
    """All beams with the frame through their ends."""
    data = deepcopy(data)
    for body in data["bodies"].values():
        if body["type"] == "beam":
            body["frame"] = "chord"
    return data
