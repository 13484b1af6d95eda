"""The paper's matrices, in nodal coordinates, by Lagrange's equations on whole Jacobians, in plain NumPy.

    M q'' + C q' + D q' + K q + g = B u + f + Phi_q^T lambda,    Phi_q q'' = gamma

    x, r    coordinates (q, t) and their rates (q', 1): prescribed joints make positions depend on t
    p       momenta, mass matrix times r

Source: Hoang et al., Vietnam Journal of Mechanics 44 (4), 2022, eqs. (15)-(23). Derivatives by complex step.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from fmbd.planar.arrays import Planar, rigid_joints
from fmbd.system.applied import Paths, apply_loads, apply_motors, apply_springs
from fmbd.system.reference import Reference

Array = np.ndarray

_STEP = 1e-200  # its square vanishes: derivatives are exact to round-off
_BATCH = 4_000_000  # numbers in one batch of Jacobians
_DEPENDENT = 1e-11  # a constraint that adds less than this share is redundant
_SPARE = 1e-9  # so is for gravity compensation one that adds less than this, or a motor


class _Mechanism(Protocol):
    @property
    def planar(self) -> Planar: ...

    @property
    def reference(self) -> Reference: ...


class _System(_Mechanism, Protocol):
    @property
    def nodal_damping(self) -> Mapping[int, Array]: ...

    @property
    def coordinate_names(self) -> Sequence[str]: ...

    @property
    def constraint_names(self) -> Sequence[str]: ...

    @property
    def input_names(self) -> Sequence[str]: ...


@dataclass(frozen=True, eq=False)
class Matrices:
    """M q'' + C q' + D q' + K q + g = B u + f + Phi_q^T lambda, Phi_q q'' = gamma, at a state q, v = q'.

    SI units; elastic coordinates are nodal. Motors with inductance have their torque in f, the others are
    columns of B; f also has loads, springs that are not linear in q, rest positions, and prescribed motion.
    """

    coordinates: tuple[str, ...]
    inputs: tuple[str, ...]
    constraints: tuple[str, ...]
    q: Array  #: shape (nq,)
    v: Array  #: shape (nq,)
    M: Array  #: mass, shape (nq, nq)
    C: Array  #: Coriolis and centrifugal, by Christoffel's formula (20): M' - 2C is skew-symmetric; (nq, nq)
    D: Array  #: beams, dampers, back-emf of motors without inductance, shape (nq, nq)
    K: Array  #: beams and springs, shape (nq, nq)
    g: Array  #: gravity, shape (nq,)
    B: Array  #: shape (nq, nu)
    u: Array  #: voltages or torques, shape (nu,)
    f: Array  #: shape (nq,)
    Phi: Array  #: constraint errors, shape (nc,)
    Phi_q: Array  #: shape (nc, nq)
    gamma: Array  #: shape (nc,)

    def accelerations(self) -> tuple[Array, Array]:
        """q'' (nq,) and multipliers lambda (nc,); of redundant multipliers the smallest.

        Raises numpy.linalg.LinAlgError if a coordinate moves no mass.
        """
        force = self.B @ self.u + self.f - (self.C + self.D) @ self.v - self.K @ self.q - self.g
        # M = L L^T; Gauss: L^T q'' is the free acceleration plus the least change that meets the constraints
        L = np.linalg.cholesky(self.M)
        free = np.linalg.solve(L, force)
        columns = np.linalg.solve(L, self.Phi_q.T)
        # not only against each other: a single constraint, too, may be one that nothing can give way to
        size, freest = np.linalg.norm(columns, 2), 1.0 / np.sqrt(self.M.diagonal().min())
        inverse = np.linalg.pinv(columns, rcond=_DEPENDENT * max(1.0, freest / size) if size else 0.0)
        change = inverse.T @ (self.gamma - columns.T @ free)
        return np.linalg.solve(L.T, free + change), inverse @ change


def matrices(system: _System, q: Array, v: Array, t: float = 0.0, z: Array | None = None) -> Matrices:
    """Matrices at nodal coordinates q and v = q' (nq,), time t [s], first-order states z (nz,), or zero."""
    planar, reference = system.planar, system.reference
    n = planar.nq
    x, r = np.append(q, t), np.append(v, 1.0)
    dp, bodies, stations = _motion(reference, x, r)
    M = reference.inertia.mass_matrix(bodies, x + 1j * _STEP * r)
    C = 0.5 * (M.imag / _STEP + dp - dp.T)

    lengths = reference.lengths(stations)
    rows = lengths[:, 1:].real
    paths = Paths(lengths[:, 0].real, rows, rows @ r, reference.linear)
    signals = reference.signals(t)
    K, D, f = apply_springs(planar, paths, x, r)
    for body, damping in system.nodal_damping.items():
        own = reference.inertia.elastic[body]
        D[own, own] += damping
    z = np.zeros(2 * planar.motors.size) if z is None else np.asarray(z)
    online = (
        gravity_compensation(system, q, t) if planar.online_compensation else np.zeros(planar.motors.size)
    )
    motors = apply_motors(planar, paths, r, signals, z, online)
    f = f + motors.f + apply_loads(planar, reference, bodies.real, stations.real, x, signals) - C[:, n]

    path, driver = planar.constraints["pathway"], planar.constraints["driver"]
    drive = np.zeros((path.size, 3))
    drive[driver >= 0] = signals[driver[driver >= 0]]
    turning = lengths[path, 1:].imag / _STEP @ r
    return Matrices(
        coordinates=tuple(system.coordinate_names),
        inputs=tuple(system.input_names[k] for k in motors.inputs),
        constraints=tuple(system.constraint_names),
        q=x[:n],
        v=r[:n],
        M=M.real[:n, :n],
        C=C[:n, :n],
        D=(D + motors.D)[:n, :n],
        K=K[:n, :n] + reference.inertia.K,
        g=reference.inertia.weight(bodies.real, x, planar.gravity)[:n],
        B=motors.B[:n],
        u=motors.u,
        f=f[:n],
        Phi=paths.values[path] + drive[:, 0],
        Phi_q=rows[path, :n],
        gamma=-turning - drive[:, 2],
    )


def gravity_compensation(system: _Mechanism, q: Array, t: float = 0.0) -> Array:
    """Joint torques of the motors (motors,) that hold the rigid mechanism at q (nq,) against gravity.

    Least squares on the joint coordinates, rotors left out: g = J^T tau + Phi_q^T lambda, all beams straight; of all
    torques that do, the least.
    """
    planar, reference = system.planar, system.reference
    x = np.append(q, t)
    for own in reference.inertia.elastic.values():
        x[own] = 0.0
    seams = planar.bodies["coordinate"][planar.bodies["seam"] == 1]
    x[seams[seams >= 0]] = 0.0
    bodies, stations = reference.frames(x[:-1], t)
    joints = rigid_joints(planar.bodies)
    joints = joints[joints >= 0]
    rows = reference.lengths(stations)[:, 1:][:, joints]
    J, Phi_q = rows[planar.motors["joint_pathway"]], rows[planar.constraints["pathway"][planar.held]]
    weight = reference.inertia.weight(bodies, x, planar.gravity)[joints]
    # J less what lies along Phi_q; the constraints do that part for nothing
    little = _SPARE * np.linalg.norm(np.vstack([J, Phi_q]), axis=1).max(initial=0.0)
    _, size, held = np.linalg.svd(Phi_q, full_matrices=False)
    held = held[size > little]
    mix, size, pull = np.linalg.svd(J - J @ held.T @ held, full_matrices=False)
    kept = size > little
    return mix[:, kept] @ (pull[kept] @ weight / size[kept])


def _motion(reference: Reference, x: Array, r: Array) -> tuple[Array, Array, Array]:
    """dp/dx, shape (nq+1, nq+1), and the frames of bodies and stations a complex step along r."""
    directions = np.vstack([r, np.eye(x.size)])
    count = max(1, _BATCH // (reference.size * x.size))
    gradient = []
    for start in range(0, x.size + 1, count):
        stepped = x + 1j * _STEP * directions[start : start + count]
        bodies, stations = reference.frames(stepped[:, :-1], stepped[:, -1])
        gradient.append(reference.inertia.momenta(bodies, stepped, r).imag / _STEP)
        if start == 0:
            along = bodies[0], stations[0]
    return np.concatenate(gradient)[1:].T, *along
