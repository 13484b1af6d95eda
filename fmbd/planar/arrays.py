"""The flat arrays that the compiled kernels see: one record per part, one mutable state record beside it.

A mechanism is lowered to bodies joined in a tree, stations (frames fixed to bodies where things attach), pathways
(scalar functions of the configuration) with their laws, motors, loads and constraints. Bodies are numbered parents
first; index -1 is the ground. The records of ``Planar`` never change after assembly, those of ``Work`` are scratch.

Rows: a flexible body meets the rest of the mechanism only through a few rows of numbers in its modal basis, R:
row 0 is s = int S dm, row 1 is p = int x S dm, the others are the shape functions S(x), S'(x) of its stations and
the shapes of its distributed loads. What a kernel needs of the elastic acceleration is y = R eta''.
"""

from typing import Any, NamedTuple

import numpy as np

# -1 in an index field means "none".
BODY = np.dtype(
    [
        ("parent", "i8"),
        ("outer", "i8"),  # station on the parent
        ("inner", "i8"),  # station on this body
        ("rotor", "i8"),  # 1: the rotor of a motor
        ("seam", "i8"),  # 1: a joint between segments of a beam carries it: what moves there is elastic
        ("sign", "f8"),  # +1: the joint's first point is on the parent; -1: on this body
        ("axis_c", "f8"),
        ("axis_s", "f8"),  # direction of the joint's x axis in its first point's frame
        ("sliding", "i8"),  # 1: the joint has an x or y that moves
        ("coordinate", "i8", (3,)),  # index into q of the free x, y, angle
        ("driver", "i8", (3,)),  # signal that prescribes x, y, angle
        ("mass", "f8"),
        ("mx", "f8"),
        ("my", "f8"),  # first moment of mass in the body frame, undeformed
        ("J", "f8"),  # moment of inertia about the frame's origin, undeformed
        ("mode0", "i8"),
        ("nf", "i8"),  # modal coordinates: q[first_q : first_q + nf], omega2[mode0 : ...]
        ("first_q", "i8"),
        ("row0", "i8"),
        ("nrow", "i8"),
        ("matrix0", "i8"),  # offset of R (nrow, nf) in `rows`
        ("gram0", "i8"),  # offset of R R^T (nrow, nrow) in `gram`
        (
            "axial",
            "i8",
        ),  # of a beam that shortens: its row -(int H dm) eta, and next to it -(int x H dm) eta; else -1
        ("bend0", "i8"),
        ("nbend", "i8"),  # rows of it that bend
        ("bent", "i8"),  # modes, the lowest ones, that shorten it
        ("first_hung", "i8"),  # first of the bodies that hang on its rows, -1: none
        ("next_hung", "i8"),  # the next one on the same parent
        ("hang", "i8"),  # index of its record in Work.hangs if it hangs on rows, else -1
        ("hang_w0", "i8"),
        (
            "hang_s0",
            "i8",
        ),  # its offsets in Work.hang_w (3, rows of parent), Work.hang_slot (3, slots of parent)
        ("hold", "i8"),  # index of its record in Work.holds if a row of its own holds it, else -1
        ("station0", "i8"),
        ("nstation", "i8"),
        ("slot0", "i8"),
        ("nslot", "i8"),  # constraint columns that are alive in the subtree of this body
        ("closed", "i8"),  # of these, how many (the first ones) close at this body
        ("block0", "i8"),  # offset of the (nslot, nslot) block of the Schur complement
    ],
    align=True,
)

STATION = np.dtype(
    [
        ("body", "i8"),
        ("ax", "f8"),
        ("ay", "f8"),
        ("angle", "f8"),
        ("row_w", "i8"),  # rows that move it across the beam, turn it, and move it along the beam
        ("row_s", "i8"),
        ("row_u", "i8"),
    ],
    align=True,
)
# A row that bends: R = -H eta of a matrix H (bent, bent), at `matrix0` in `shortening`.
BEND = np.dtype([("row", "i8"), ("matrix0", "i8")], align=True)

# A pathway is the sum of coefficient * elementary length over its terms, plus an offset.
ALONG_X, ALONG_Y, WORLD_X, WORLD_Y, ANGLE, DISTANCE = range(6)
TERM = np.dtype(
    [
        ("kind", "i8"),
        ("a", "i8"),
        ("b", "i8"),
        ("axis_c", "f8"),
        ("axis_s", "f8"),
        ("coefficient", "f8"),
        ("slot_a", "i8"),
        ("slot_b", "i8"),
    ],
    align=True,
)
PATHWAY = np.dtype([("term0", "i8"), ("nterm", "i8"), ("offset", "f8")], align=True)
# A spring of any law (see laws.py); k and d are its linear part.
SPRING = np.dtype(
    [
        ("pathway", "i8"),
        ("k", "f8"),
        ("d", "f8"),
        ("rest", "f8"),
        ("kind", "i8"),
        ("p", "f8", (5,)),
        ("start", "i8"),  # pieces of a table: curves[start : start + count]
        ("count", "i8"),
    ],
    align=True,
)
# freedom: what a unit multiplier would accelerate the heaviest of the bodies by, were it free
CONSTRAINT = np.dtype([("pathway", "i8"), ("driver", "i8"), ("freedom", "f8")], align=True)
LOAD = np.dtype(
    [("station", "i8"), ("fx", "i8"), ("fy", "i8"), ("moment", "i8"), ("following", "i8")], align=True
)
DISTRIBUTED = np.dtype(
    [
        ("body", "i8"),
        ("length", "f8"),
        ("moment", "f8"),
        ("row", "i8"),
        ("row_u", "i8"),
        ("fx", "i8"),
        ("fy", "i8"),
        ("following", "i8"),
    ],
    align=True,
)
# A point moment of inertia on a beam turns with the slope: it is in R R^T = I, but not in eta.eta of the inertia.
INERTIA = np.dtype([("body", "i8"), ("row", "i8"), ("value", "f8")], align=True)
MOTOR = np.dtype(
    [
        ("pathway", "i8"),
        ("joint_pathway", "i8"),
        ("electric", "i8"),  # 1: the input is a voltage, 0: the input is the torque itself
        ("Km", "f8"),
        ("Ke", "f8"),
        ("Ra", "f8"),
        ("La", "f8"),
        ("state", "i8"),  # index of the current in z
        ("signal", "i8"),
        ("controller", "i8"),
    ],
    align=True,
)
CONTROLLER = np.dtype(
    [
        ("pathway", "i8"),
        ("kp", "f8"),
        ("ki", "f8"),
        ("kd", "f8"),
        ("target", "i8"),
        ("scale", "f8"),  # set point = scale * target + shift; target -1: shift alone
        ("shift", "f8"),
        ("bias", "f8"),  # constant feed-forward
        ("feedforward", "i8"),
        ("online", "i8"),  # index of the motor's torque among the online gravity compensation, -1: none
        ("gravity_gain", "f8"),  # input per unit of joint torque: Ra / (Km r)
        ("low", "f8"),
        ("high", "f8"),
        ("state", "i8"),
    ],
    align=True,
)
SIGNAL = np.dtype([("kind", "i8"), ("p", "f8", (6,)), ("start", "i8"), ("count", "i8")], align=True)

BODY_STATE = np.dtype(
    [(n, "f8") for n in ("x", "y", "angle", "c", "s", "vx", "vy", "w", "bx", "by", "bw", "ax", "ay", "aw")]
    + [(n, "f8") for n in ("px", "py", "ux", "uy", "jc", "js")]
    # first moment of mass, its rate and its second derivative at zero q'', in the body's axes; J, half of its rate
    + [(n, "f8") for n in ("mx", "my", "dmx", "dmy", "ddmx", "J", "spin")]
    + [(n, "f8") for n in ("Hxx", "Hxy", "Hxz", "Hyy", "Hyz", "Hzz", "gx", "gy", "gz")]
    + [("U", "f8", (3, 3)), ("per_D", "f8", (3,)), ("u", "f8", (3,)), ("scale", "f8", (3,))],
    align=True,
)
STATION_STATE = np.dtype(
    [(n, "f8") for n in ("x", "y", "angle", "vx", "vy", "w", "bx", "by", "bw")], align=True
)
# value, rate and second derivative at zero q''; the wrench (n, m) that a unit force along the term puts on a and b
TERM_STATE = np.dtype([(n, "f8") for n in ("nx", "ny", "ma", "mb")], align=True)
PATHWAY_STATE = np.dtype([(n, "f8") for n in ("value", "rate", "bias")], align=True)
# One row of a flexible body: R eta, R eta'; y and what it is made of, forces (see condensation.py).
# Of a row that bends: R eta / 2, R eta', R' eta'.
ROW_STATE = np.dtype(
    [(n, "f8") for n in ("value", "rate", "bias", "Vx", "Vy", "Vz", "g", "free", "y", "push")], align=True
)
# One column of Phi_q^T as an articulated body sees it, and its right-hand side; the integers are constant.
SLOT = np.dtype(
    [("constraint", "i8"), ("parent", "i8"), ("row0", "i8"), ("first_row", "i8")]
    + [(n, "f8") for n in ("gx", "gy", "gz", "rhs", "pivot", "moved")]
    + [(n, "f8", (3,)) for n in ("u", "frame", "station", "hung")],
    align=True,
)
# See hanging.py; inertance is d / (1 + d p).
HANG = np.dtype(
    [(n, "f8", (3, 3)) for n in ("L", "x", "b")]
    + [(n, "f8", (3,)) for n in ("g", "d", "phi", "inertance")]
    + [("idle", "i8", (3,))],
    align=True,
)
# See holding.py; inverse is that of H_f, AI is A times it, E becomes its inverse.
HOLD = np.dtype(
    [(n, "f8", (3, 3)) for n in ("A", "AI", "inverse", "E", "G")] + [("g", "f8", (3,)), ("c", "f8", (3,))],
    align=True,
)
CONSTRAINT_STATE = np.dtype([("target", "f8"), ("multiplier", "f8"), ("redundant", "i8")], align=True)
# input: voltage or torque asked for; effort: shaft torque; compensation: joint torque against gravity
MOTOR_STATE = np.dtype([("input", "f8"), ("effort", "f8"), ("compensation", "f8")], align=True)


class Planar(NamedTuple):
    """The constants of a mechanism (see the record types above)."""

    nq: int
    gravity: np.ndarray
    bodies: Any
    stations: Any
    terms: Any
    pathways: Any
    springs: Any
    curves: np.ndarray  # (pieces, 6): stretch, the cubic's coefficients from there on, energy there
    constraints: Any
    loads: Any
    distributed: Any
    inertias: Any
    motors: Any
    controllers: Any
    signals: Any
    program: np.ndarray  # (instructions, 2): operation and constant of the expressions in t
    table: np.ndarray  # (knots, 5): t, and the cubic's coefficients on the interval that starts there
    rows: np.ndarray  # R of all bodies, zeros where it bends
    gram: np.ndarray
    bends: Any
    shortening: np.ndarray
    omega2: np.ndarray
    modal_damping: np.ndarray
    slots: Any  # (slots,) initial values of Work.slots
    slot_rows: int  # rows of all slots together
    ground_slot0: int
    ground_base: int  # entry (m, j) of the ground's block is Work.block[ground_base + m ground_stride + j]
    ground_stride: int
    ground_band: int  # the farthest from the diagonal that it has entries
    block_size: int
    online_compensation: int  # 1: some controller asks for it
    held: np.ndarray  # constraints that hold the rigid mechanism, gears of rotors left out


class Work(NamedTuple):
    """Scratch of one evaluation; nothing in it outlives a call, so each thread needs its own."""

    frames: Any  # of bodies
    points: Any  # of stations
    geometry: Any  # of terms
    lengths: Any  # of pathways
    rows: Any
    R: np.ndarray  # `rows` and `gram` of Planar, with the rows that bend
    gram: np.ndarray
    N: np.ndarray  # per body (nrow, nrow), flat
    f_eta: np.ndarray
    holds: Any  # of bodies held by rows
    hangs: Any  # of bodies that hang on rows
    hang_w: np.ndarray
    hang_slot: np.ndarray
    slots: Any
    slot_y: np.ndarray
    slot_v: np.ndarray
    block: np.ndarray
    reactions: Any  # of constraints
    drives: Any  # of motors
    signal: np.ndarray  # (signals, 3): value and two time derivatives
    stack: np.ndarray
    rigid_q: np.ndarray
    rigid_v: np.ndarray
    wrench: np.ndarray  # (bodies, 3)
    holding: np.ndarray  # (motors + held + 1, joint coordinates)
    mix: np.ndarray  # (motors, motors)


def allocate(system: Planar) -> Work:
    """Scratch arrays for `system`; the frames of ground stations are set here, once."""
    hung = system.bodies[system.bodies["hang"] >= 0]
    carriers = system.bodies[hung["parent"]]
    moving = rigid_joints(system.bodies)
    joint_coordinates = int((moving >= 0).sum()) if system.online_compensation else 0
    holding = system.motors.size + system.held.size + 1
    work = Work(
        frames=records(system.bodies.size, BODY_STATE),
        points=records(system.stations.size, STATION_STATE),
        geometry=records(system.terms.size, TERM_STATE),
        lengths=records(system.pathways.size, PATHWAY_STATE),
        rows=records(int(system.bodies["nrow"].sum()), ROW_STATE),
        R=system.rows.copy(),
        gram=system.gram.copy(),
        N=np.zeros(system.gram.size),
        f_eta=np.zeros(system.omega2.size),
        holds=records(int((system.bodies["hold"] >= 0).sum()), HOLD),
        hangs=records(hung.size, HANG),
        hang_w=np.zeros(3 * int(carriers["nrow"].sum())),
        hang_slot=np.zeros(3 * int(carriers["nslot"].sum())),
        slots=system.slots.copy(),
        slot_y=np.zeros(system.slot_rows),
        slot_v=np.zeros(system.slot_rows),
        block=np.zeros(system.block_size),
        reactions=records(system.constraints.size, CONSTRAINT_STATE),
        drives=records(system.motors.size, MOTOR_STATE),
        signal=np.zeros((system.signals.size, 3)),
        stack=np.zeros((64, 3)),
        rigid_q=np.zeros(system.nq),
        rigid_v=np.zeros(system.nq),
        wrench=np.zeros((system.bodies.size, 3)),
        holding=np.zeros((holding, joint_coordinates)),
        mix=np.zeros((system.motors.size, system.motors.size)),
    )
    for k, station in enumerate(system.stations):
        if station["body"] < 0:
            work.points[k].x, work.points[k].y = station["ax"], station["ay"]
            work.points[k].angle = station["angle"]
    return work


def rigid_joints(bodies: Any) -> np.ndarray:
    """Coordinates (n, 3) of the joints of the rigid mechanism, -1: none; rotors and beams that stretch left out."""
    return np.asarray(bodies["coordinate"][(bodies["rotor"] == 0) & (bodies["seam"] == 0)])


def records(count: int, dtype: np.dtype) -> Any:
    """A zeroed array of `count` records whose fields read as attributes, compiled or not."""
    return np.zeros(count, dtype).view(np.recarray)
