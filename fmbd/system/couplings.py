"""Which unknowns of the linearised equations are coupled, beside the coordinates (see planar.tangent_arrays)."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from fmbd.planar.arrays import ALONG_X, ALONG_Y, ANGLE, DISTANCE, WORLD_X, WORLD_Y, Planar
from fmbd.planar.arrays import records as make
from fmbd.planar.tangent_arrays import (
    COMMAND,
    END,
    LEAN_FORCE,
    LEAN_MOMENT,
    LINK,
    LOCAL,
    MULTIPLIER,
    PIECE,
    PLACE,
    SHARE,
    TENSION,
    TURN,
    Couplings,
)
from fmbd.system.columns import GROUND, share_out, touched_bodies


def couplings(planar: Planar) -> Couplings:
    """Links, their ends, and the bodies in which they are alive."""
    local = _local_pathways(planar)
    links: list[tuple[int, int, list[tuple[int, int]]]] = []
    tension_link = np.full(planar.pathways.size, -1, np.int64)
    command_link = np.full(planar.motors.size, -1, np.int64)
    for c, constraint in enumerate(planar.constraints):
        links.append((MULTIPLIER, c, [(j, 0) for j in _terms(planar, constraint.pathway)]))
    forced = {int(p) for part in (planar.springs, planar.motors) for p in part["pathway"]}
    for path in sorted(forced):
        if local["body"][path] < 0:
            tension_link[path] = len(links)
            links.append((TENSION, path, [(j, 0) for j in _terms(planar, path)]))
    for m, motor in enumerate(planar.motors):
        if motor.controller >= 0:
            measured = int(planar.controllers[motor.controller].pathway)
            own, other = local[motor.pathway], local[measured]
            if own.body < 0 or own.body != other.body or own.direction != other.direction:
                command_link[m] = len(links)
                pieces = [(j, 0) for j in _terms(planar, motor.pathway)]
                links.append((COMMAND, m, pieces + [(j, 1) for j in _terms(planar, measured)]))
    turning = {
        path for path in forced | {int(c.pathway) for c in planar.constraints} if local["body"][path] < 0
    }
    kinds = {DISTANCE: [TURN], ALONG_X: [LEAN_FORCE, LEAN_MOMENT], ALONG_Y: [LEAN_FORCE, LEAN_MOMENT]}
    for path in sorted(turning):
        for j in _terms(planar, path):
            links += [(k, path, [(j, 0)]) for k in kinds.get(int(planar.terms[j].kind), [])]
    return _place(planar, links, local, tension_link, command_link)


def _terms(planar: Planar, path: int) -> Iterable[int]:
    record = planar.pathways[path]
    return range(int(record.term0), int(record.term0 + record.nterm))


def _local_pathways(planar: Planar) -> Any:
    """Pathways of one term that is a free coordinate of a joint of the tree."""
    out = make(planar.pathways.size, LOCAL)
    out.body = -1
    joints = {}
    for i, body in enumerate(planar.bodies):
        ends = (int(body.outer), int(body.inner))
        for d, kind in enumerate((ALONG_X, ALONG_Y, ANGLE)):
            if body.coordinate[d] >= 0:
                joints[kind, *(ends if body.sign > 0 else ends[::-1])] = i, d
    for p, path in enumerate(planar.pathways):
        term = planar.terms[int(path.term0)]
        found = joints.get((int(term.kind), int(term.a), int(term.b)))
        if path.nterm == 1 and found is not None:
            body = planar.bodies[found[0]]
            if term.kind == ANGLE or (term.axis_c == body.axis_c and term.axis_s == body.axis_s):
                out[p] = (*found, float(term.coefficient))
    return out


def _place(
    planar: Planar,
    links: list[tuple[int, int, list[tuple[int, int]]]],
    local: Any,
    tension_link: np.ndarray,
    command_link: np.ndarray,
) -> Couplings:
    """Number pieces, ends and shares."""
    bodies, stations, terms = planar.bodies, planar.stations, planar.terms
    parents = [int(p) for p in bodies["parent"]]
    touched = [touched_bodies(stations, terms, [j for j, _ in pieces]) for _, _, pieces in links]
    shares = share_out(parents, touched)
    places = make(bodies.size, PLACE)
    places.nr = np.where(bodies.nf > 0, bodies.nrow + 2, 0)
    places.row0 = np.cumsum(places.nr) - places.nr
    places.matrix0 = np.cumsum(places.nr**2) - places.nr**2
    places.slot0, places.nslot = shares.first, shares.count
    places.closed, places.block0 = shares.closed, shares.block0
    index = shares.index
    share = make(len(index), SHARE)
    row0 = 0
    for (i, link), k in index.items():
        share[k] = (link, shares.above(parents, i, link), row0)
        row0 += int(places[i].nr) if i != GROUND else 0
    ends: dict[tuple[int, int], int] = {}
    for k, (_, _, pieces) in enumerate(links):
        for j, _ in pieces:
            for station in (int(terms[j].a), int(terms[j].b)):
                if stations[station].body >= 0:
                    ends[k, station] = int(stations[station].body)
    order = sorted(ends, key=lambda pair: ends[pair])
    number = {pair: n for n, pair in enumerate(order)}
    end = make(len(order), END)
    for n, (k, station) in enumerate(order):
        end[n] = (k, station, index[ends[k, station], k])
    owners = [ends[pair] for pair in order]
    places.end0 = np.searchsorted(owners, np.arange(bodies.size), "left")
    places.nend = np.searchsorted(owners, np.arange(bodies.size), "right") - places.end0
    link, piece = make(len(links), LINK), make(sum(len(p) for _, _, p in links), PIECE)
    n = 0
    for k, (kind, what, pieces) in enumerate(links):
        link[k] = (kind, what, n, len(pieces))
        for j, measured in pieces:
            a, b = (number.get((k, int(terms[j][end])), -1) for end in "ab")
            piece[n] = (j, measured, a, b)
            n += 1
    return Couplings(
        link,
        piece,
        end,
        local,
        share,
        places,
        tension_link,
        command_link,
        shares.ground,
        shares.base,
        shares.stride,
        shares.band,
        shares.block_size,
        all(
            terms[j].kind == ANGLE or (kind == MULTIPLIER and terms[j].kind in (WORLD_X, WORLD_Y))
            for kind, _, pieces in links
            for j, _ in pieces
        ),
    )
