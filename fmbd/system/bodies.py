"""Body and station records, and the rows through which a flexible body meets the rest (see planar.arrays)."""

from collections.abc import Sequence
from itertools import accumulate
from typing import Any

import numpy as np

from fmbd.planar import arrays
from fmbd.planar.arrays import records

DIRECTIONS = ("x", "y", "angle")


class Rows:
    """Collects the rows of one flexible body; a row of zeros (a clamped end) is left out and called -1."""

    def __init__(self, first: int, psi: np.ndarray) -> None:
        self.first = first
        self.psi = psi
        self.rows: list[np.ndarray] = []
        self.bends: list[tuple[int, np.ndarray]] = []

    def add(self, nodal: np.ndarray) -> int:
        """Index of a row given in nodal coordinates, shape (nf,)."""
        if not np.any(nodal):
            return -1
        self.rows.append(nodal @ self.psi)
        return self.first + len(self.rows) - 1

    def bend(self, H: np.ndarray) -> int:
        """Index of a row -H eta, H of the lowest modes."""
        if not np.any(H):
            return -1
        self.rows.append(np.zeros(self.psi.shape[1]))
        self.bends.append((self.first + len(self.rows) - 1, H))
        return self.bends[-1][0]


def lower_bodies(out: Any, distributed: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Records of bodies and stations, point inertias and distributed loads, with R, R R^T and the modes, flat."""
    bodies = records(len(out.tree.links), arrays.BODY)
    stations = records(len(out.stations), arrays.STATION)
    bodies.coordinate = bodies.driver = bodies.outer = bodies.inner = -1
    bodies.hold = bodies.hang = bodies.first_hung = bodies.next_hung = bodies.axial = -1
    coordinate = {name: k for k, (name, _) in enumerate(out.coordinates)}
    flat: list[np.ndarray] = [np.zeros(0)]
    gram: list[np.ndarray] = [np.zeros(0)]
    inertias: list[tuple[int, int, float]] = []
    loads: list[dict[str, Any]] = []
    bends: list[tuple[int, np.ndarray]] = []
    n_rows = n_modes = n_flat = n_gram = 0
    of_body: dict[str, list[tuple[str, int]]] = {}
    for (name, point), k in out.stations.items():
        of_body.setdefault(name, []).append((point, k))
    for point, k in of_body.get("ground", []):
        place = out.model.ground.points[point]
        stations[k] = (-1, *place.at, place.angle, -1, -1, -1)
    for i, link in enumerate(out.tree.links):
        body = bodies[i]
        _hold(out, link, body, coordinate)
        points = of_body[link.name]
        body.station0, body.nstation = points[0][1], len(points)
        if link.motor is not None:
            body.rotor = 1
            body.J = out.model.motors[link.motor].rotor_inertia
            stations[points[0][1]] = (i, 0.0, 0.0, 0.0, -1, -1, -1)
            continue
        part = out.model.bodies[link.name]
        if part.type == "rigid":
            x, y = part.center_of_mass
            body.mass, body.mx, body.my = part.mass, part.mass * x, part.mass * y
            body.J = part.inertia + part.mass * (x * x + y * y)
            for point, k in points:
                place = part.points[point]
                stations[k] = (i, *place.at, place.angle, -1, -1, -1)
            continue
        beam = out.beams[i]
        body.mass, body.mx, body.J = beam.mass, beam.first_moment, beam.inertia
        rows = Rows(n_rows, out.psi[i])
        rows.rows = [beam.s @ rows.psi, beam.p @ rows.psi]
        shortening = out.shortenings.get(i)
        if shortening:
            body.axial = rows.bend(shortening.by_mass())
            rows.bend(shortening.by_moment())
        for point, k in points:
            x = part.points[point]
            slope = rows.add(beam.slope(x)) if (link.name, point) in out.turning else -1
            across = rows.add(beam.shape(x))
            along = rows.bend(shortening.at(x)) if shortening else -1
            stations[k] = (i, x, 0.0, 0.0, across, slope, along)
        for turning in beam.turning:
            row = rows.add(turning)
            if row >= 0:
                inertias.append((i, row, 1.0))
        for load in distributed:
            if load["on"] == link.name:
                length, moment, shape = beam.load_moments(load["from"], load["to"])
                places = {"body": i, "length": length, "moment": moment, "row": rows.add(shape), "row_u": -1}
                if shortening:
                    places["row_u"] = rows.bend(shortening.by_length(load["from"], load["to"]))
                loads.append(places | load)
        R = np.array(rows.rows)
        body.nrow, body.nf = R.shape
        body.row0, body.mode0, body.matrix0, body.gram0 = n_rows, n_modes, n_flat, n_gram
        body.first_q = out.first_elastic[i]
        body.bend0, body.nbend = len(bends), len(rows.bends)
        body.bent = shortening.count if shortening else 0
        bends += rows.bends
        flat.append(R.ravel())
        gram.append((R @ R.T).ravel())
        n_rows += body.nrow
        n_modes += body.nf
        n_flat += R.size
        n_gram += int(body.nrow) ** 2
    _mark_rows(bodies, stations)
    return {
        "bodies": bodies,
        "stations": stations,
        "rows": np.concatenate(flat),
        "gram": np.concatenate(gram),
        "bends": fill(
            arrays.BEND,
            [
                {"row": row, "matrix0": at}
                for (row, _), at in zip(
                    bends, accumulate((H.size for _, H in bends), initial=0), strict=False
                )
            ],
        ),
        "shortening": np.concatenate([np.zeros(0), *(H.ravel() for _, H in bends)]),
        "inertias": fill(
            arrays.INERTIA, [dict(zip(("body", "row", "value"), i, strict=True)) for i in inertias]
        ),
        "distributed": fill(arrays.DISTRIBUTED, loads),
        "omega2": np.concatenate([np.zeros(0), *(out.omega2[i] for i in out.beams)]),
        "modal_damping": np.concatenate([np.zeros(0), *(out.modal_damping[i] for i in out.beams)]),
    }


def _hold(out: Any, link: Any, body: Any, coordinate: dict[str, int]) -> None:
    """The joint that carries a body."""
    body.parent = out.body_index.get(link.parent, -1)
    body.outer = out.stations[out.outer_point(link)]
    body.inner = out.stations[out.inner_point(link)]
    body.sign = 1.0 if link.forward else -1.0
    body.axis_c = 1.0
    if link.motor is not None:
        body.coordinate[2] = coordinate[link.name]
        return
    joint = out.model.joints[link.joint]
    body.seam = int(link.joint in out.segmentation.seams)
    body.axis_c, body.axis_s = joint.axis
    for d, direction in enumerate(DIRECTIONS):
        if direction in joint.driven:
            body.driver[d] = out.signals.add(joint.driven[direction])
        elif direction in joint.coordinates:
            body.coordinate[d] = coordinate[f"{link.joint}.{direction}"]
        if direction != "angle" and direction in joint.coordinates:
            body.sliding = 1


def _mark_rows(bodies: Any, stations: Any) -> None:
    """Which bodies hang on rows of their parents, and which are held by rows of their own."""
    moving = (stations["row_w"] >= 0) | (stations["row_s"] >= 0) | (stations["row_u"] >= 0)
    held = np.flatnonzero(moving[bodies["inner"]])
    bodies.hold[held] = np.arange(held.size)
    hung = np.flatnonzero((bodies["parent"] >= 0) & moving[bodies["outer"]])
    bodies.hang[hung] = np.arange(hung.size)
    for i in hung[::-1]:
        # a list in ascending order, hence pushed from the last
        parent = bodies[bodies[i].parent]
        bodies[i].next_hung, parent.first_hung = parent.first_hung, i


def place_hung(bodies: Any) -> None:
    """Give the bodies that hang on rows their room in Work.hang_w and Work.hang_slot, in place."""
    w0 = s0 = 0
    for i in np.flatnonzero(bodies["hang"] >= 0):
        parent = bodies[bodies[i].parent]
        bodies[i].hang_w0, bodies[i].hang_s0 = w0, s0
        w0 += 3 * int(parent.nrow)
        s0 += 3 * int(parent.nslot)


def fill(dtype: np.dtype, rows: Sequence[dict[str, Any]]) -> Any:
    """Records from dictionaries; keys that are no field are skipped."""
    out = records(len(rows), dtype)
    for record, row in zip(out, rows, strict=True):
        for key in dtype.names or ():
            if key in row:
                record[key] = row[key]
    return out
