"""Arrays of the linearised equations: constant records that say what couples with what, and scratch beside them.

A link is one more scalar unknown beside the coordinates: the variation of a multiplier, of the force along a pathway,
of a motor's effort, or of the direction of a force. Its column is a wrench on the stations that it touches (its ends),
its row a combination of the variations of their motion. As the slots of planar.arrays, it is alive in the bodies
between those that it touches and the one where it closes. A pathway that is a coordinate of a joint of the tree needs
no link: it adds to the diagonal (LOCAL).
"""

from typing import Any, NamedTuple

import numpy as np

# What the unknown of a link is the variation of; `index` is a constraint, a pathway, or a motor.
MULTIPLIER, TENSION, COMMAND, TURN, LEAN_FORCE, LEAN_MOMENT = range(6)
LINK = np.dtype([("kind", "i8"), ("index", "i8"), ("piece0", "i8"), ("npiece", "i8")], align=True)
# One term of a pathway in a link; measured: 1 if it belongs to the pathway of a controller, which has no column.
PIECE = np.dtype([("term", "i8"), ("measured", "i8"), ("end_a", "i8"), ("end_b", "i8")], align=True)
END = np.dtype([("link", "i8"), ("station", "i8"), ("slot", "i8")], align=True)
LOCAL = np.dtype([("body", "i8"), ("direction", "i8"), ("coefficient", "f8")], align=True)
SHARE = np.dtype([("link", "i8"), ("parent", "i8"), ("row0", "i8")], align=True)
# A body's rows here are those of planar.arrays and two more, eta and eta' where the equations are linearised.
PLACE = np.dtype(
    [(n, "i8") for n in ("row0", "nr", "matrix0", "slot0", "nslot", "closed", "block0", "end0", "nend")],
    align=True,
)


class Couplings(NamedTuple):
    """Constants of the linearised equations of a mechanism."""

    links: Any
    pieces: Any
    ends: Any  # by body
    locals: Any  # of pathways; body -1: not local
    shares: Any  # (body, link) pairs in which a link is alive, the ground's last
    places: Any  # of bodies
    tension_link: np.ndarray  # of pathways, -1: none
    command_link: np.ndarray  # of motors, -1: none
    ground_share0: int
    ground_base: int  # as in planar.arrays
    ground_stride: int
    ground_band: int
    block_size: int
    narrow: bool  # no link depends on places and velocities, constraints taken by their second derivatives


def body_type(scalar: str) -> np.dtype:
    """What the linearised equations keep of a body (symbols in linearise.py)."""
    fields: list[Any] = [
        ("H", scalar, (3, 7)),
        ("W", scalar, (3,)),
        ("X", scalar, (7,)),
        ("X0", scalar, (6,)),
        ("lift", scalar, (6,)),
        ("swing", scalar, (6,)),
        ("along", scalar, (2, 6)),
        ("U", scalar, (3, 7)),
        ("V", scalar, (3, 3)),
        ("Q", scalar, (3, 3)),
        ("ratio", scalar, (3, 3)),
        ("per_D", scalar, (3,)),
        ("rhs", scalar, (3,)),
        ("own", scalar, (3,)),
        ("drag", scalar, (3,)),
        ("pull", scalar, (3,)),
        ("arm", "f8", (6,)),
        ("force", "f8", (2,)),
        ("S", "f8", (6,)),
    ]
    return np.dtype(fields, align=True)


def share_type(scalar: str) -> np.dtype:
    """What they keep of a link in one body."""
    fields: list[Any] = [
        ("g", scalar, (3,)),
        ("h", scalar, (7,)),
        ("column", scalar, (3,)),
        ("row", scalar, (3,)),
    ]
    return np.dtype([*fields, ("per_D", scalar)], align=True)


class Tangent(NamedTuple):
    """The linearised equations, factored, and scratch for right-hand sides; all of one scalar type."""

    width: tuple[
        int, ...
    ]  # as long as X has columns that count, which compiles them: 7, or 3 if no link needs p and u
    bodies: Any
    relative: np.ndarray  # (stations, 6): r, r', r'' from the frame of its body
    turn: np.ndarray  # (stations, 6): how a station moves as its body turns
    N: np.ndarray  # (nr, nr) of each body, flat
    A: np.ndarray
    P: np.ndarray
    PX: np.ndarray  # (rows, 7)
    YX: np.ndarray  # (rows, 7)
    HY: np.ndarray  # (rows, 3)
    swapped: np.ndarray  # of rows: with which one to swap in turn, partial pivoting of A
    y: np.ndarray  # of rows
    y0: np.ndarray
    phi: np.ndarray
    rate0: np.ndarray
    acc0: np.ndarray
    per_D: np.ndarray  # of modes
    eta: np.ndarray  # (2, modes)
    free: np.ndarray  # of modes
    weights: np.ndarray  # (links, 2, 3): of l, l', l'' along the own and the measured pathway
    diagonal: np.ndarray  # of links
    rhs: np.ndarray  # of links
    unknown: np.ndarray  # of links
    redundant: np.ndarray  # of links
    scale: np.ndarray  # of links: what a unit would do to a free body
    tension: np.ndarray  # of pathways
    columns: np.ndarray  # (ends, 3)
    rows: np.ndarray  # (ends, 9): of theta (by l, l', l''), a, p, u
    shares: Any
    share_row0: np.ndarray  # of shares: where their rows begin in the next three
    share_g: np.ndarray
    share_h: np.ndarray
    share_y: np.ndarray
    block: np.ndarray
    effort: np.ndarray  # (motors, 3): per unit of input, of the rates of current and integral
    gains: (
        np.ndarray
    )  # (motors, 4): input per unit of l, l' measured, of the integral's rate; 1 if it integrates


def allocate_tangent(system: Any, couplings: Couplings, level: int = 2, scalar: str = "f8") -> Tangent:
    """Arrays of the linearised equations of `system` (a Planar).

    level: 0, 1, 2 for constraints by their place, rate or second derivative; scalar "c16": at complex weights.
    """
    places, links = couplings.places, couplings.links
    rows = int(places["nr"].sum())
    squares = int((places["nr"] ** 2).sum())
    share_rows = int((places["nr"] * places["nslot"]).sum())

    def zeros(*shape: int) -> np.ndarray:
        return np.zeros(shape, scalar)

    return Tangent(
        width=(0,) * (3 if level == 2 and couplings.narrow else 7),
        bodies=np.zeros(places.size, body_type(scalar)).view(np.recarray),
        relative=np.zeros((system.stations.size, 6)),
        turn=zeros(system.stations.size, 6),
        N=zeros(squares),
        A=zeros(squares),
        P=zeros(squares),
        PX=zeros(rows, 7),
        YX=zeros(rows, 7),
        HY=zeros(rows, 3),
        swapped=np.zeros(rows, np.int64),
        y=zeros(rows),
        y0=zeros(rows),
        phi=zeros(rows),
        rate0=zeros(rows),
        acc0=zeros(rows),
        per_D=zeros(system.omega2.size),
        eta=np.zeros((2, system.omega2.size)),
        free=zeros(system.omega2.size),
        weights=zeros(links.size, 2, 3),
        diagonal=zeros(links.size),
        rhs=zeros(links.size),
        unknown=zeros(links.size),
        redundant=np.zeros(links.size, np.int64),
        scale=np.array([system.constraints[k.index].freedom if k.kind == MULTIPLIER else 1.0 for k in links]),
        tension=np.zeros(system.pathways.size),
        columns=np.zeros((couplings.ends.size, 3)),
        rows=zeros(couplings.ends.size, 9),
        shares=np.zeros(couplings.shares.size, share_type(scalar)).view(np.recarray),
        share_row0=np.array(couplings.shares["row0"]),
        share_g=zeros(share_rows),
        share_h=zeros(share_rows),
        share_y=zeros(share_rows),
        block=zeros(couplings.block_size),
        effort=zeros(system.motors.size, 3),
        gains=zeros(system.motors.size, 4),
    )
