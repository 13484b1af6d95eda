"""Where each column of Phi_q^T lives: from the bodies that a constraint touches down to where its loop closes.

A constraint's loop closes at the lowest common ancestor of the bodies that it touches, or at the ground. Its
column is alive in every body on the way there; each (body, constraint) pair is a slot (see planar.arrays).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import numpy as np

from fmbd.planar.arrays import ANGLE, SLOT, records

GROUND = -1


def closing_body(parents: Sequence[int], touched: set[int]) -> int:
    """Lowest common ancestor of the touched bodies; GROUND (-1) if the ground is one of them."""
    paths = [_path(parents, body) for body in touched]
    shared = set(paths[0]).intersection(*paths[1:])
    return max(shared)


def _path(parents: Sequence[int], body: int) -> list[int]:
    """Body, its parent, ... down to the ground."""
    path = [body]
    while path[-1] != GROUND:
        path.append(parents[path[-1]])
    return path


def place_columns(bodies: Any, stations: Any, terms: Any, pathways: Any, constraints: Any) -> dict[str, Any]:
    """Give bodies and terms their slots, in place; return the slot arrays of `Planar`."""
    parents = [int(p) for p in bodies["parent"]]
    inertias = _inertias(bodies, stations), _borrowed(bodies, stations)
    touched = []
    for constraint in constraints:
        path = pathways[constraint["pathway"]]
        touched.append(touched_bodies(stations, terms, range(path["term0"], path["term0"] + path["nterm"])))
        constraint["freedom"] = _freedom(inertias, stations, terms, path)
    shares = share_out(parents, touched)
    bodies["slot0"], bodies["nslot"] = shares.first, shares.count
    bodies["closed"], bodies["block0"] = shares.closed, shares.block0
    slot = shares.index
    constraint_terms = {}
    for c, constraint in enumerate(constraints):
        path = pathways[constraint["pathway"]]
        for j in range(path["term0"], path["term0"] + path["nterm"]):
            constraint_terms[j] = c
    terms["slot_a"] = terms["slot_b"] = -1
    for j, c in constraint_terms.items():
        for end in "ab":
            body = int(stations[terms[j][end]]["body"])
            if body != GROUND:
                terms[j][f"slot_{end}"] = slot[body, c]
    slots = records(len(slot), SLOT)
    row0 = 0
    for (i, c), k in slot.items():
        slots[k].constraint, slots[k].row0, slots[k].parent = c, row0, shares.above(parents, i, c)
        if i != GROUND:
            slots[k].first_row = bodies[i].row0
            row0 += int(bodies[i].nrow)
    return {
        "slots": slots,
        "slot_rows": row0,
        "ground_slot0": shares.ground,
        "ground_base": shares.base,
        "ground_stride": shares.stride,
        "ground_band": shares.band,
        "block_size": shares.block_size,
    }


@dataclass
class Shares:
    """Where columns are alive: index of each (body, column) pair, by body, the ground's last; offsets of each body."""

    index: dict[tuple[int, int], int]
    first: list[int]
    count: list[int]
    closed: list[int]
    block0: list[int]
    ground: int
    base: int
    stride: int
    band: int
    block_size: int

    def above(self, parents: Sequence[int], body: int, column: int) -> int:
        """Index of the same column at the parent of a body or at the ground; -1 if it closes at the body."""
        return self.index.get((parents[body], column), -1) if body != GROUND else -1


def share_out(parents: Sequence[int], touched: Sequence[set[int]]) -> Shares:
    """The bodies in which columns that touch the given ones are alive; those that close at a body come first there."""
    closed: list[list[int]] = [[] for _ in parents]
    open_: list[list[int]] = [[] for _ in parents]
    ground: list[int] = []
    for column, bodies in enumerate(touched):
        closing = closing_body(parents, bodies)
        (ground if closing == GROUND else closed[closing]).append(column)
        for body in {body for start in bodies for body in _path(parents, start) if body > closing}:
            open_[body].append(column)
    together = [open_[i] for i, parent in enumerate(parents) if parent == GROUND]
    ground = banded(ground, together)
    mine = [first + rest for first, rest in zip(closed, open_, strict=True)]
    count = [len(columns) for columns in mine]
    squares = [0, *accumulate(n * n for n in count)]
    pairs = [(i, column) for i, columns in enumerate(mine) for column in columns]
    index = {pair: k for k, pair in enumerate(pairs + [(GROUND, column) for column in ground])}
    first = [0, *accumulate(count)][: len(parents)]
    layout = lay_out(ground, together, squares[-1])
    return Shares(index, first, count, [len(c) for c in closed], squares[:-1], len(pairs), *layout)


def banded(columns: list[int], together: Sequence[Sequence[int]]) -> list[int]:
    """The ground's columns in an order that keeps those that occur together close to each other."""
    if len(columns) < 16:
        return columns
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    number = {c: k for k, c in enumerate(columns)}
    pairs = [(number[a], number[b]) for group in together for a in group for b in group]
    if not pairs:
        return columns
    rows, cols = np.array(pairs).T
    graph = coo_array((np.ones(len(pairs)), (rows, cols)), shape=(len(columns), len(columns)))
    return [columns[k] for k in reverse_cuthill_mckee(graph.tocsr(), symmetric_mode=True)]


def lay_out(
    columns: Sequence[int], together: Sequence[Sequence[int]], start: int
) -> tuple[int, int, int, int]:
    """Base, stride and band of a matrix stored from `start` on: entry (m, j) at base + m stride + j; and the end.

    With stride 2 band and base start + band, the entries of a band matrix lie side by side.
    """
    n, number = len(columns), {c: k for k, c in enumerate(columns)}
    places = [[number[c] for c in group] for group in together]
    band = max((max(group) - min(group) for group in places if group), default=0)
    if 2 * band + 1 >= n:
        return start, n, n, start + n * n
    return start + band, 2 * band, band, start + n * (2 * band + 1)


def touched_bodies(stations: Any, terms: Any, indices: Iterable[int]) -> set[int]:
    """Bodies, or the ground, between which some terms act."""
    return {int(stations[int(terms[j][end])]["body"]) for j in indices for end in "ab"}


def _freedom(inertias: Sequence[np.ndarray], stations: Any, terms: Any, pathway: Any) -> float:
    """The least acceleration along a pathway that a unit force along it gives to one of its bodies, were that free.

    If these bodies have no inertia, what they borrow counts.
    """
    found: list[float] = []
    for table in inertias:
        for j in range(pathway["term0"], pathway["term0"] + pathway["nterm"]):
            for end in "ab":
                k = int(stations[terms[j][end]]["body"])
                inertia = float(table[k, int(terms[j]["kind"] == ANGLE)]) if k != GROUND else 0.0
                if inertia > 0.0:
                    found.append(float(terms[j]["coefficient"]) ** 2 / inertia)
        if found:
            break
    return min(found, default=0.0)


def _inertias(bodies: Any, stations: Any) -> np.ndarray:
    """Mass, and moment of inertia about the joint that carries the body, or more; shape (bodies, 2)."""
    inner = stations[bodies["inner"]]
    turning = bodies["J"] + bodies["mass"] * (inner["ax"] ** 2 + inner["ay"] ** 2)
    return np.stack([bodies["mass"], turning], axis=-1)


def _borrowed(bodies: Any, stations: Any) -> np.ndarray:
    """As `_inertias`; where there is none, that of the bodies carried, or else of the one that carries."""
    inertias = _inertias(bodies, stations)
    lacking = inertias == 0.0
    carried = [k for k, parent in enumerate(bodies["parent"]) if parent != GROUND]
    for k in reversed(carried):
        parent = bodies[k]["parent"]
        outer, inner = stations[bodies[k]["outer"]], stations[bodies[parent]["inner"]]
        mass, turning = inertias[k]
        turning += mass * ((outer["ax"] - inner["ax"]) ** 2 + (outer["ay"] - inner["ay"]) ** 2)
        inertias[parent] += lacking[parent] * np.array([mass, turning])
    for k in carried:
        inertias[k] += (inertias[k] == 0.0) * inertias[bodies[k]["parent"]]
    return inertias
