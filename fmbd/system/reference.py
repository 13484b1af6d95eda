"""The kinematics a second time: whole Jacobians in nodal coordinates, in plain NumPy.

The compiled kernels go from body to body with velocities and modal coordinates; here every position carries
its gradient. The two share no formula but the geometry of a joint, so that each is a check of the other.

    q, t   generalised coordinates (nq,), the elastic ones nodal; time
    frame  dual (system.duals) of (x, y, angle), shape (..., 3, d), world axes
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from fmbd.beams import FloatingBeam, Foreshortening
from fmbd.planar.arrays import ALONG_X, ALONG_Y, ANGLE, DISTANCE, WORLD_X, WORLD_Y, Planar
from fmbd.planar.signals import evaluate_signals
from fmbd.system.duals import norm, rotate
from fmbd.system.inertia import Inertia, Moments

Array = np.ndarray


class _Level(NamedTuple):
    """Bodies equally far from the ground; `owner` and `inner_at` count within `bodies` and `stations`."""

    bodies: Array
    outer: Array
    inner: Array
    inner_at: Array
    stations: Array
    owner: Array
    sign: Array  # (bodies, 1)
    axis: Array  # angle of the joint's x axis in its first point's frame [rad]


class Reference:
    """Positions and Jacobians of a mechanism, for one configuration q (nq,) or any batch of them (..., nq).

    `beams` gives the beam of each flexible body, `shortenings` the foreshortening of those that have it. In a batch,
    all times have the same real part.
    """

    def __init__(
        self, planar: Planar, beams: Mapping[int, FloatingBeam], shortenings: Mapping[int, Foreshortening]
    ) -> None:
        self.nq = planar.nq
        self.inertia = Inertia(planar, beams, shortenings)
        self._signals, self._program, self._table = planar.signals, planar.program, planar.table
        bodies, stations = planar.bodies, planar.stations
        self._place = np.stack([stations["ax"], stations["ay"], stations["angle"]], axis=-1)
        self._shapes = np.zeros((stations.size, 3, planar.nq + 1))
        self._ground = np.flatnonzero(stations["body"] < 0)
        for i, beam in beams.items():
            own, elastic = np.flatnonzero(stations["body"] == i), self.inertia.elastic[i]
            self._shapes[own, 1, elastic] = beam.shape(stations["ax"][own])
            self._shapes[own, 2, elastic] = beam.slope(stations["ax"][own])
        self._bent = [
            (k, self.inertia.elastic[i], shortening.nodal(shortening.at(stations["ax"][k])))
            for i, shortening in shortenings.items()
            for k in np.flatnonzero(stations["body"] == i)
        ]
        self._joint_at_rest = np.zeros((bodies.size, 3))
        self._directions = np.zeros((bodies.size, 3, planar.nq + 1))
        body, direction = np.nonzero(bodies["coordinate"] >= 0)
        self._directions[body, direction, bodies["coordinate"][body, direction]] = 1.0
        self._driven = np.nonzero(bodies["driver"] >= 0)
        self._drivers = bodies["driver"][self._driven]
        self._levels = _levels(planar)
        self._terms = _terms_by_kind(planar)
        self._sum = _sum_of_terms(planar)
        self._offset = planar.pathways["offset"]  # a view: offsets may be set after this
        self.size = 3 * (bodies.size + stations.size)  #: numbers that place the mechanism
        self.stretches = _loaded_stretches(
            planar, beams, shortenings, self.inertia
        )  #: where the distributed loads act
        self.linear = _linear_pathways(planar)  #: whether a pathway is linear in q, (pathways,)

    def stations(self, q: Array, t: complex | Array = 0.0) -> tuple[Array, Array, Array]:
        """Positions (..., ns, 2) [m], angles (..., ns) [rad], and Jacobians of both (..., ns, 3, nq+1).

        The last column of a Jacobian is the partial derivative by time.
        """
        _, frames = self.frames(q, t)
        return frames[..., :2, 0], frames[..., 2, 0], frames[..., 1:]

    def pathways(self, q: Array, t: complex | Array = 0.0) -> tuple[Array, Array]:
        """Values (..., np) and Jacobians (..., np, nq+1) of all pathways."""
        lengths = self.lengths(self.frames(q, t)[1])
        return lengths[..., 0], lengths[..., 1:]

    def signals(self, t: float) -> Array:
        """Value, rate and second derivative of every signal, shape (signals, 3)."""
        values = np.zeros((self._signals.size, 3))
        evaluate_signals(self._signals, self._program, self._table, np.zeros((64, 3)), t, values)
        return values

    def signal(self, index: int, t: float) -> Array:
        """Value, rate and second derivative of one signal, shape (3,)."""
        return self.signals(t)[index]

    def frames(self, q: Array, t: complex | Array = 0.0) -> tuple[Array, Array]:
        """Duals of the frames of all bodies (..., nb, 3, d) and stations (..., ns, 3, d)."""
        q, t = np.asarray(q), np.asarray(t)
        local = self._affine(self._place, self._shapes, q, t)
        for k, own, H in self._bent:
            pull = q[..., own] @ H
            local[..., k, 0, 0] -= 0.5 * (pull * q[..., own]).sum(axis=-1)
            local[..., k, 0, 1:][..., own] -= pull
        joints = self._affine(self._joint_at_rest, self._directions, q, t)
        self._drive(joints, t)
        bodies, stations = np.empty_like(joints), np.empty_like(local)
        stations[..., self._ground, :, :] = local[..., self._ground, :, :]
        for level in self._levels:
            outer = stations[..., level.outer, :, :]
            joint = joints[..., level.bodies, :, :]
            angle = outer[..., 2, :] + level.sign * joint[..., 2, :]
            axis = np.where(level.sign > 0.0, outer[..., 2, :], angle)
            axis[..., 0] += level.axis
            end = outer[..., :2, :] + level.sign[:, None] * rotate(axis, joint[..., :2, :])
            theta = angle - local[..., level.inner, 2, :]
            arm = rotate(theta[..., level.owner, :], local[..., level.stations, :2, :])
            origin = end - arm[..., level.inner_at, :, :]
            bodies[..., level.bodies, :2, :] = origin
            bodies[..., level.bodies, 2, :] = theta
            stations[..., level.stations, :2, :] = origin[..., level.owner, :, :] + arm
            stations[..., level.stations, 2, :] = (
                theta[..., level.owner, :] + local[..., level.stations, 2, :]
            )
        return bodies, stations

    def lengths(self, stations: Array) -> Array:
        """Duals of all pathways, shape (..., np, d), from the frames of the stations."""
        terms = np.empty((*stations.shape[:-3], self._sum.shape[1], stations.shape[-1]), stations.dtype)
        for kind, (index, a, b, axis) in self._terms.items():
            between = stations[..., b, :, :] - stations[..., a, :, :]
            if kind == ANGLE:
                terms[..., index, :] = between[..., 2, :]
            elif kind in (WORLD_X, WORLD_Y):
                terms[..., index, :] = between[..., kind - WORLD_X, :]
            elif kind == DISTANCE:
                terms[..., index, :] = norm(between[..., :2, :])
            else:
                back = -stations[..., a, 2, :]
                back[..., 0] -= axis
                terms[..., index, :] = rotate(back, between[..., :2, :])[..., kind - ALONG_X, :]
        lengths = self._sum @ terms
        lengths[..., 0] += self._offset
        return lengths

    def _affine(self, constant: Array, rows: Array, q: Array, t: Array) -> Array:
        """Dual of constant + rows q: constant (n, 3), rows (n, 3, nq+1)."""
        out = np.empty((*q.shape[:-1], *constant.shape, self.nq + 2), np.result_type(q, t, float))
        out[..., 0] = constant + (q @ rows[..., :-1].reshape(constant.size, self.nq).T).reshape(
            *q.shape[:-1], *constant.shape
        )
        out[..., 1:] = rows
        return out

    def _drive(self, joints: Array, t: Array) -> None:
        """Put prescribed motions into the joints; a signal's value and rate follow an imaginary step in t."""
        if self._drivers.size:
            f, rate, second = self.signals(float(t.flat[0].real))[self._drivers].T
            step = 1j * t.imag[..., None] if np.iscomplexobj(t) else 0.0
            body, direction = self._driven
            joints[..., body, direction, 0] = f + rate * step
            joints[..., body, direction, -1] = rate + second * step


def _levels(planar: Planar) -> list[_Level]:
    bodies, stations = planar.bodies, planar.stations
    depth = np.zeros(bodies.size, int)
    for i, parent in enumerate(bodies["parent"]):
        depth[i] = depth[parent] + 1 if parent >= 0 else 0
    levels = []
    for k in range(depth.max(initial=-1) + 1):
        members = np.flatnonzero(depth == k)
        own = np.flatnonzero(np.isin(stations["body"], members))
        inner = bodies["inner"][members]
        levels.append(
            _Level(
                bodies=members,
                outer=bodies["outer"][members],
                inner=inner,
                inner_at=np.searchsorted(own, inner),
                stations=own,
                owner=np.searchsorted(members, stations["body"][own]),
                sign=bodies["sign"][members][:, None],
                axis=np.arctan2(bodies["axis_s"][members], bodies["axis_c"][members]),
            )
        )
    return levels


def _loaded_stretches(
    planar: Planar,
    beams: Mapping[int, FloatingBeam],
    shortenings: Mapping[int, Foreshortening],
    inertia: Inertia,
) -> Moments:
    """Integrals by length over the stretches [x0, x1] of the distributed loads."""
    loads = planar.distributed
    shape = np.zeros((loads.size, planar.nq + 1))
    bent = []
    for k, load in enumerate(loads):
        middle, half = load["moment"] / load["length"], load["length"] / 2
        body = int(load["body"])
        own, x0, x1 = inertia.elastic[body], middle - half, middle + half
        shape[k, own] = beams[body].load_moments(x0, x1)[2]
        if shortening := shortenings.get(body):
            bent.append((k, own, shortening.nodal(shortening.by_length(x0, x1))))
    first = np.stack([loads["moment"], np.zeros(loads.size)], axis=-1)
    return Moments(loads["length"], first, shape, bent)


def _terms_by_kind(planar: Planar) -> dict[int, tuple[Array, Array, Array, Array]]:
    """Kind -> (index, station a, station b, angle of the axis) of its terms."""
    terms = planar.terms
    axis = np.arctan2(terms["axis_s"], terms["axis_c"])
    out = {}
    for kind in np.unique(terms["kind"]):
        index = np.flatnonzero(terms["kind"] == kind)
        out[int(kind)] = index, terms["a"][index], terms["b"][index], axis[index]
    return out


def _sum_of_terms(planar: Planar) -> Array:
    """Coefficients, shape (pathways, terms)."""
    out = np.zeros((planar.pathways.size, planar.terms.size))
    for k, path in enumerate(planar.pathways):
        own = slice(path["term0"], path["term0"] + path["nterm"])
        out[k, own] = planar.terms["coefficient"][own]
    return out


def _linear_pathways(planar: Planar) -> Array:
    """Angles are linear in q, and so are the displacements in the joints of the tree."""
    coordinates = set()
    for body in planar.bodies:
        ends = (body["outer"], body["inner"]) if body["sign"] > 0.0 else (body["inner"], body["outer"])
        coordinates |= {(kind, *ends, body["axis_c"], body["axis_s"]) for kind in (ALONG_X, ALONG_Y)}
    curved = [
        term["kind"] != ANGLE
        and tuple(term[k] for k in ("kind", "a", "b", "axis_c", "axis_s")) not in coordinates
        for term in planar.terms
    ]
    return ~((_sum_of_terms(planar) != 0.0) & np.array(curved, bool)).any(axis=1)
