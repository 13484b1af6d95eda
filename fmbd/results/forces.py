"""Forces in joints, springs and motors: the equations evaluated once more at the states of a run."""

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fmbd.planar.compile import compiled
from fmbd.planar.equations import accelerations, reaction
from fmbd.planar.laws import evaluate_law
from fmbd.results.motion import Motion
from fmbd.solvers.integrate import solver_options

Array = NDArray[np.float64]


@compiled
def observe(
    sys: Any,
    work: Any,
    times: np.ndarray,
    q: np.ndarray,
    v: np.ndarray,
    z: np.ndarray,
    drag: float,
    pull: float,
    qdd: np.ndarray,
    dz: np.ndarray,
    reactions: np.ndarray,
    closing: np.ndarray,
    multipliers: np.ndarray,
    normals: np.ndarray,
    lengths: np.ndarray,
    drives: np.ndarray,
) -> None:
    """Fill, for each of nt states in modal coordinates, what the solution leaves in `work`.

    reactions (nt, bodies, 3): wrench that its joint puts on a body, about the joint's point on it
    closing (nt, constraints, 3): wrench of a constraint on the body of its first point, about that point
    multipliers (nt, constraints); normals (nt, terms, 2): direction of the force of a term on its second station
    lengths (nt, pathways, 2): value and rate; drives (nt, motors, 2): input and shaft torque
    qdd (nq,) and dz (nz,) are scratch.
    """
    for k in range(times.size):
        accelerations(sys, work, times[k], q[k], v[k], z[k], dz, qdd, drag, pull)
        for i in range(sys.bodies.size):
            row = reactions[k, i]
            row[0], row[1], row[2] = reaction(sys, work, i)
        for c in range(sys.constraints.size):
            term = sys.pathways[sys.constraints[c].pathway].term0
            multipliers[k, c] = work.reactions[c].multiplier
            force = sys.terms[term].coefficient * multipliers[k, c]
            g = work.geometry[term]
            closing[k, c, 0], closing[k, c, 1], closing[k, c, 2] = -force * g.nx, -force * g.ny, force * g.ma
        for j in range(sys.terms.size):
            normals[k, j, 0], normals[k, j, 1] = work.geometry[j].nx, work.geometry[j].ny
        for p in range(sys.pathways.size):
            lengths[k, p, 0], lengths[k, p, 1] = work.lengths[p].value, work.lengths[p].rate
        for m in range(sys.motors.size):
            drives[k, m, 0], drives[k, m, 1] = work.drives[m].input, work.drives[m].effort


class Forces:
    """Forces of a system at times [s] (nt,), at nodal q, q' (nt, nq) and first-order states z (nt, nz).

    `motion` is that of the same times.
    """

    def __init__(self, motion: Motion, position: Array, velocity: Array, states: Array) -> None:
        self.motion = motion
        self.system = system = motion.system
        planar, options = system.planar, solver_options(system)
        nt = len(motion.time)
        self._reactions = np.zeros((nt, planar.bodies.size, 3))
        self._closing = np.zeros((nt, planar.constraints.size, 3))
        self._multipliers = np.zeros((nt, planar.constraints.size))
        self._normals = np.zeros((nt, planar.terms.size, 2))
        self._lengths = np.zeros((nt, planar.pathways.size, 2))
        self._drives = np.zeros((nt, planar.motors.size, 2))
        observe(
            planar,
            system.work,
            np.ascontiguousarray(motion.time),
            system.to_modal(position),
            system.to_modal(velocity),
            np.ascontiguousarray(states),
            options.drag,
            options.pull,
            np.zeros(planar.nq),
            np.zeros(len(system.states)),
            self._reactions,
            self._closing,
            self._multipliers,
            self._normals,
            self._lengths,
            self._drives,
        )

    @property
    def held(self) -> NDArray[np.complex128]:
        """Force [N] of its joint's constraints on each body of the tree, shape (nt, bodies)."""
        return self._reactions[..., 0] + 1j * self._reactions[..., 1]

    @property
    def directions(self) -> NDArray[np.complex128]:
        """Direction of the force of each term of a pathway on its second station, shape (nt, terms)."""
        return self._normals[..., 0] + 1j * self._normals[..., 1]

    @cached_property
    def along(self) -> Array:
        """Force [N or N m] along each pathway, positive where it lengthens it, shape (nt, pathways)."""
        planar = self.system.planar
        along = np.zeros(self._lengths.shape[:2])
        for k, path in enumerate(planar.springs["pathway"]):
            along[:, path] -= self._spring(k)[2]
        for k, path in enumerate(planar.motors["pathway"]):
            along[:, path] += self._drives[:, k, 1]
        for k, path in enumerate(planar.constraints["pathway"]):
            along[:, path] += self._multipliers[:, k]
        return along

    def joint(self, name: str) -> tuple[NDArray[np.complex128], Array]:
        """Force [N], fx + i fy in the world, and moment [N m] about the first point, on its body."""
        constraints = self.system.constraint_names
        if name in self.system.tree.cut:
            own = [k for k, constraint in enumerate(constraints) if constraint.startswith(f"{name}.")]
            fx, fy, moment = self._closing[:, own].sum(axis=1).T
            return fx + 1j * fy, moment
        index = next(i for i, link in enumerate(self.system.tree.links) if link.joint == name)
        fx, fy, moment = self._reactions[:, index].T
        force = fx + 1j * fy
        if not self.system.tree.links[index].forward:
            return force, moment
        return -force, -(moment + cross(self._arm(name), force))

    def driving(self, name: str, direction: str) -> Array:
        """Force [N] or moment [N m] that moves a driven coordinate of a joint, positive along it."""
        force, moment = self.joint(name)
        if direction == "angle":
            return cross(self._arm(name), force) - moment
        joint = self.system.model.joints[name]
        axis = np.exp(1j * self.motion.point(*joint.between[0]).angle[0]) * complex(*joint.axis)
        along = -force * axis.conj()
        return along.real if direction == "x" else along.imag

    def spring(self, name: str) -> Array:
        """Length or angle, its rate, and the tension or moment against both, shape (3, nt)."""
        return self._spring(self.system.lowered.springs.names.index(name))

    def _spring(self, index: int) -> Array:
        planar = self.system.planar
        length, rate = self._lengths[:, planar.springs[index].pathway].T.copy()
        values = np.zeros((length.size, 5))
        evaluate_law(planar.springs, planar.curves, index, length, rate, values)
        return np.stack([length, rate, -values[:, 0]])

    def motor(self, name: str) -> Array:
        """Input [V or N m] and torque on the shaft [N m], shape (2, nt)."""
        return self._drives[:, list(self.system.model.motors).index(name)].T

    def transmission(self, name: str) -> Array:
        """Torque that the transmission of a motor puts on the joint [N m], or force [N] on a sliding one."""
        motor = self.system.model.motors[name]
        if motor.transmission is not None:
            return self.spring(f"{name}.transmission")[2]
        gear = f"{name}.gear"
        if gear in self.system.constraint_names:
            c = self.system.constraint_names.index(gear)
            # the constraint is phi - r theta = 0; the first body of its first term, phi, is the stator
            return motor.gear_ratio * self._closing[:, c, 2]
        return motor.gear_ratio * self.motor(name)[1]

    def _arm(self, name: str) -> NDArray[np.complex128]:
        """From the first to the second point of a joint [m]."""
        first, second = (self.motion.point(*ref).place[0] for ref in self.system.model.joints[name].between)
        return second - first


def cross(arm: NDArray[np.complex128], force: NDArray[np.complex128]) -> Array:
    """Moment of a force at the end of an arm."""
    return (arm.conj() * force).imag
