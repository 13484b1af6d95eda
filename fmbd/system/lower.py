"""Lower a validated model to the flat arrays of `planar.arrays`: polymorphic parts in, records out.

Every kind of part becomes stations, pathways and a law. Numbers that depend on the configuration at the start
(rest lengths left out, branches of cut angles, set points given as places) are filled in by `system.start`.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from fmbd.beams import BeamPiece, FloatingBeam, Foreshortening, floating_beam
from fmbd.beams.lumping import lumped
from fmbd.beams.truncation import truncate
from fmbd.model import Beam, Model, Placement
from fmbd.model.beam import UpTo
from fmbd.planar import arrays
from fmbd.planar.arrays import ANGLE, DISTANCE, WORLD_X, WORLD_Y, Planar, records
from fmbd.system.bodies import DIRECTIONS, fill, lower_bodies, place_hung
from fmbd.system.columns import place_columns
from fmbd.system.lowered import Lowered, Term
from fmbd.system.motors import has_rotor, lower_motors, motor_coordinate, rotor_term
from fmbd.system.segments import cut_beams
from fmbd.system.tree import Link, Tree, spanning_tree

#: Elements of one beam, and output times of one run.
MAX_ELEMENTS = 1000
MAX_OUTPUTS = 10_000_000


def lower(model: Model) -> Lowered:
    """Arrays and names of a model. Raises ModelError for bodies that are not tied to the ground, or too large a job."""
    _check_size(model)
    segmentation = cut_beams(model)
    whole = tree = _tree(model, [name for name, joint in model.joints.items() if joint.cut])
    if segmentation.model is not model:
        tree = _tree(segmentation.model, whole.cut)  # loops are not closed within a beam
    out = Lowered(segmentation, tree, whole)
    _name_bodies(out)
    _joints(out)
    _places(out)
    motors, controllers = lower_motors(out)
    _springs(out)
    loads, distributed = _loads(out)
    constraints = _constraints(out)
    _assemble(out, motors, controllers, loads, distributed, constraints)
    return out


def _check_size(model: Model) -> None:
    """Refuse what would fill the memory: a beam's modal basis is a dense matrix, output times are an array."""
    for name, body in model.bodies.items():
        if isinstance(body, Beam) and len(body.nodes) - 1 > MAX_ELEMENTS * body.segments:
            text = f"{len(body.nodes) - 1} elements are more than a beam can have ({MAX_ELEMENTS} a segment)"
            raise model.error(("bodies", name, "elements"), text)
    simulation = model.simulation
    if simulation.duration / simulation.output_interval > MAX_OUTPUTS:
        raise model.error(
            ("simulation", "output_interval"),
            f"{simulation.output_interval:g} s asks for more than {MAX_OUTPUTS:.0e} outputs of a run "
            f"of {simulation.duration:g} s",
        )


def _tree(model: Model, marked: Sequence[str]) -> Tree:
    joints = {n: (j.between[0].body, j.between[1].body) for n, j in model.joints.items()}
    rotors = {n: (m.joint, joints[m.joint][0]) for n, m in model.motors.items() if has_rotor(m)}
    tree, loose = spanning_tree(list(model.bodies), joints, marked, rotors)
    if loose:
        why = "once the joints marked `cut` are opened " if marked else ""
        raise model.error(
            ("bodies", loose[0]),
            f"no chain of joints ties it to the ground {why}(add a joint, for instance of type free)",
        )
    return tree


def _name_bodies(out: Lowered) -> None:
    """Number bodies and coordinates; build the beams."""
    segments = {part.body: (name, part) for name, parts in out.segmentation.beams.items() for part in parts}
    for i, link in enumerate(out.tree.links):
        out.body_index[link.name] = i
        if link.joint is None:
            out.coordinates.append((link.name, "rad"))
            continue
        joint = out.model.joints[link.joint]
        for direction in DIRECTIONS:
            if direction in joint.coordinates and direction not in joint.driven:
                out.coordinates.append((f"{link.joint}.{direction}", "rad" if direction == "angle" else "m"))
        body = out.model.bodies[link.name]
        if isinstance(body, Beam):
            name, segment = segments[link.name]
            masses = [(body.points[point], m.mass, m.inertia) for point, m in body.point_masses.items()]
            pieces: Sequence[BeamPiece] = body.pieces
            if body.mass == "lumped":
                pieces, lumps = lumped(pieces, body.nodes)
                masses += lumps
            beam = floating_beam(pieces, np.asarray(body.nodes, float), body.frame, masses)
            if body.modes != "all":
                count = _count_modes(out.model, link.name, body.modes, beam)
                out.truncations[link.name] = truncate(beam, count)
                beam = out.truncations[link.name].beam
            out.beams[i] = beam
            out.psi[i], out.omega2[i] = beam.modal_basis()
            if body.foreshortening:
                _check_frame(out, link, beam, name)
                out.shortenings[i] = Foreshortening.of(beam, out.psi[i])
            out.modal_damping[i] = _modal_damping(body.damping, out.omega2[i])
            out.first_elastic[i] = len(out.coordinates)
            out.coordinates += [
                (f"{link.name}.{own}", unit) for own, unit in beam.coordinates(segment.first_node)
            ]


def _count_modes(model: Model, name: str, modes: int | UpTo, beam: FloatingBeam) -> int:
    """How many modes of a beam are kept."""
    if isinstance(modes, int):
        return modes
    frequencies = np.sqrt(beam.modal_basis()[1]) / (2.0 * np.pi)
    count = int((frequencies <= modes.up_to).sum())
    if count == 0:
        text = f"no mode is left: the first has {frequencies[0]:.4g} Hz"
        raise model.error(("bodies", name, "modes", "up_to"), text)
    return count


def _check_frame(out: Lowered, link: Link, beam: FloatingBeam, name: str) -> None:
    """Refuse a frame that turns with a cross-section of next to no inertia: inertia to second order loses it."""
    clamped = beam.frame == "clamped"
    body, point = out.inner_point(link)
    turning = beam.inertia - beam.p @ np.linalg.solve(beam.M, beam.p)
    if clamped and out.model.bodies[body].points[point] == 0.0:
        turning += _inertia_before(out, link)
    if turning < 0.01 * beam.inertia:
        text = (
            "a beam whose start may turn by itself needs `frame: chord` for it: "
            "a clamped frame follows the cross-section at the start, which has no inertia"
            if clamped
            else "the elements are too small for it: a chord follows the ends of the beam, or of its segments, "
            "which have next to no inertia; give it fewer elements, or more segments"
        )
        raise out.model.error(("bodies", name, "foreshortening"), text)


def _inertia_before(out: Lowered, link: Link) -> float:
    """Moment of inertia that turns with the inner side of the joint of a body: of what it is fixed to, rigid bodies."""
    joint = out.model.joints[str(link.joint)]
    if "angle" in joint.driven:
        return np.inf
    if "angle" in joint.coordinates:
        return 0.0
    if link.parent not in out.body_index:
        return np.inf
    parent = out.model.bodies[link.parent]
    if isinstance(parent, Beam):
        return 0.0
    return float(parent.inertia) + _inertia_before(out, out.tree.links[out.body_index[link.parent]])


def _modal_damping(damping: Any, omega2: np.ndarray) -> np.ndarray:
    """Damping of each mode [1/s]: alpha + beta omega^2 + 2 zeta omega."""
    ratios = np.zeros(omega2.size)
    given = np.atleast_1d(np.asarray(damping.modal_ratios, float))
    if np.ndim(damping.modal_ratios) == 0:
        ratios[:] = given[0]
    else:
        ratios[: given.size] = given[: omega2.size]
    return (
        damping.mass_proportional + damping.stiffness_proportional * omega2 + 2.0 * ratios * np.sqrt(omega2)
    )


def _joints(out: Lowered) -> None:
    """Stations of all joints; springs, friction and stops in them."""
    for name, joint in out.model.joints.items():
        for ref in joint.between:
            out.station(ref.body, ref.point)
        for direction in sorted({*joint.spring, *joint.friction, *joint.limits}):
            path, coordinate = out.joint_pathway(name, direction), f"{name}.{direction}"
            if spring := joint.spring.get(direction):
                out.springs.add_spring(f"{coordinate}.spring", path, spring, spring.rest)
            if friction := joint.friction.get(direction):
                out.springs.add_friction(f"{coordinate}.friction", path, friction)
            if limits := joint.limits.get(direction):
                out.springs.add_stops(f"{coordinate}.stop", path, limits)


def _places(out: Lowered) -> None:
    """Stations of the points that the start or a controller's target places in the plane."""
    targets = [
        law.target.places for law in out.model.controllers.values() if isinstance(law.target, Placement)
    ]
    for places in (out.model.initial.place, *targets):
        for name in places:
            out.station(*out.place_point(name))


def _springs(out: Lowered) -> None:
    for name, spring in out.model.springs.items():
        a, b = (out.station(ref.body, ref.point) for ref in spring.between)
        if spring.type == "torsional":
            kind, rest = ANGLE, spring.rest_angle
        else:
            kind, rest = DISTANCE, spring.rest_length
        terms: list[Term] = [(kind, a, b, (1.0, 0.0), 1.0)]
        if rest is None:
            out.rest_at_start.append(len(out.springs))
        if kind == ANGLE and rest is not None and _through_loop(out, a[0], b[0]):
            out.rest_nearby.append(len(out.springs))
            path = out.own_pathway(terms)
        else:
            path = out.pathway(terms)
        out.springs.add_spring(name, path, spring, rest or 0.0)


def _through_loop(out: Lowered, first: str, second: str) -> bool:
    """Whether the way from one body to another goes through a joint of a closed loop."""
    parents = {link.name: link.parent for link in out.tree.links}

    def way(a: str, b: str) -> set[str]:
        """The bodies whose joints lie between a and b."""
        paths = []
        for body in (a, b):
            path = set()
            while body in parents:
                path.add(body)
                body = parents[body]
            paths.append(path)
        return paths[0] ^ paths[1]

    between = way(first, second)
    loops = (out.model.joints[joint].between for joint in out.tree.cut)
    return any(between & way(a.body, b.body) for a, b in loops)


def _loads(out: Lowered) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    loads, distributed = [], []
    for load in out.model.loads.values():
        record: dict[str, Any] = {"fx": -1, "fy": -1, "moment": -1, "following": 0}
        if load.type != "moment":
            record |= {
                "fx": out.signals.add(load.force[0]),
                "fy": out.signals.add(load.force[1]),
                "following": int(load.frame == "following"),
            }
        if load.type == "distributed":
            del record["moment"]
            distributed.append(record | {"on": load.on, "from": load.from_, "to": load.to})
            continue
        if load.type == "moment" or load.frame == "following":
            out.turning.add((load.at.body, load.at.point))
        if load.type == "moment":
            record["moment"] = out.signals.add(load.moment)
        loads.append(record | {"station": out.station(load.at.body, load.at.point)})
    return loads, distributed


def _constraints(out: Lowered) -> list[tuple[int, int]]:
    """(pathway, driver) of each constraint: cut joints, as first minus second point, then rigid gears."""
    constraints = []
    for name in out.tree.cut:
        joint = out.model.joints[name]
        fixed = [d for d in DIRECTIONS if d not in joint.coordinates or d in joint.driven]
        a, b = (out.station(ref.body, ref.point) for ref in joint.between)
        for direction in fixed:
            if direction != "angle" and {"x", "y"} <= set(fixed) and not joint.driven:
                # both displacements are held: world axes, so that the multipliers are the force in the world
                kind = WORLD_X if direction == "x" else WORLD_Y
                terms = [(kind, a, b, (1.0, 0.0), -1.0)]
            else:
                terms = [out.joint_term(name, direction, -1.0)]
            path = out.own_pathway(terms)
            driver = out.signals.add(joint.driven[direction]) if direction in joint.driven else -1
            constraints.append((path, driver))
            out.constraints.append((f"{name}.{direction}", "N m" if direction == "angle" else "N"))
            if direction == "angle":
                out.cut_angles.append((path, name))
    for name, motor in out.model.motors.items():
        if has_rotor(motor) and motor.transmission is None:
            rotor = rotor_term(out, name, motor)
            direction = motor_coordinate(out.model, motor)
            gear = out.own_pathway([rotor, out.joint_term(motor.joint, direction, -motor.gear_ratio)])
            constraints.append((gear, -1))
            out.constraints.append((f"{name}.gear", "N m"))
            out.relaxed.append(gear)
    return constraints


def _assemble(
    out: Lowered,
    motors: Sequence[dict[str, Any]],
    controllers: Sequence[dict[str, Any]],
    loads: Sequence[dict[str, Any]],
    distributed: Sequence[dict[str, Any]],
    constraints: Sequence[tuple[int, int]],
) -> None:
    """Number the stations and fill the records."""
    for link in out.tree.links:
        out.turning |= {out.station(*out.outer_point(link)), out.station(*out.inner_point(link))}
    order = sorted(out.stations, key=lambda key: out.body_index.get(key[0], -1))
    out.stations = {key: k for k, key in enumerate(order)}
    parts = lower_bodies(out, distributed)
    pathways = records(len(out.terms), arrays.PATHWAY)
    terms = records(sum(map(len, out.terms)), arrays.TERM)
    flat = [(p, term) for p, group in enumerate(out.terms) for term in group]
    for j, (p, (kind, a, b, axis, coefficient)) in enumerate(flat):
        if pathways[p].nterm == 0:
            pathways[p].term0 = j
        pathways[p].nterm += 1
        terms[j] = (kind, out.stations[a], out.stations[b], *axis, coefficient, -1, -1)
    rows = [{"pathway": p, "driver": s} for p, s in constraints]
    parts["constraints"] = fill(arrays.CONSTRAINT, rows)
    parts |= place_columns(parts["bodies"], parts["stations"], terms, pathways, parts["constraints"])
    place_hung(parts["bodies"])
    parts["loads"] = fill(arrays.LOAD, [load | {"station": out.stations[load["station"]]} for load in loads])
    springs, curves = out.springs.lower()
    signals, program, table = out.signals.lower()
    out.planar = Planar(
        nq=len(out.coordinates),
        gravity=np.array(out.model.gravity, float),
        terms=terms,
        pathways=pathways,
        springs=springs,
        curves=curves,
        motors=fill(arrays.MOTOR, motors),
        controllers=fill(arrays.CONTROLLER, controllers),
        signals=signals,
        program=program,
        table=table,
        online_compensation=int(any(c["online"] >= 0 for c in controllers)),
        held=np.array(
            [c for c, (name, _) in enumerate(out.constraints) if not name.endswith(".gear")], np.int64
        ),
        **parts,
    )
