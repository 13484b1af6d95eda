"""The equations of motion linearised about a state, in independent coordinates.

    J      derivative of (v, q'', z') by (q, v, z): the exact tangent of the implicit methods, constraints included;
           by differences where beams shorten (dense_tangent.py)
    T      states (y, y', z) that the constraints allow, T (y, y', z) = (N y, N y' + E y, z); N^T M N = I (motions.py)
    A      x' = A x for x = (y, y', z): the motion in y = N^T M (q - q0), exact to first order
    W(S)   (S - A)^-1, the resolvent, solved body by body: vibrations of all speeds are right in it to round-off
    P, e   motions that are not allowed, by constraints or because shafts are held, and what keeps them at rest
    G, w   input of motors by gravity compensation computed online, w = G U; the kernels leave it out
E is not zero only where loops are closed and move.
Coordinates are modal, in nodal ones only where it says so.
"""

from functools import cached_property

import numpy as np

from fmbd.analyses.arrangement import Arrangement
from fmbd.analyses.dense_tangent import DenseTangent, by_differences
from fmbd.analyses.jacobians import pathway_rows
from fmbd.analyses.motions import allowed_motions, to_nodal_basis
from fmbd.errors import AnalysisError
from fmbd.planar.residual import evaluate_residual
from fmbd.planar.tangent import solve_linearised
from fmbd.planar.tangent_arrays import allocate_tangent
from fmbd.system.couplings import couplings
from fmbd.system.matrices import gravity_compensation

Array = np.ndarray

#: Where the resolvent is taken [1/s]: slower motions are right to a share 1e-16 of it, faster ones relatively.
SHIFT = 100.0
_STEP = 1e-200  # of the complex derivative
_TURN = 1e-3  # of the differences of gravity compensation [rad or m]
_DEPENDENT = 1e-10


class Linearisation:
    """About nodal q, v (nq,) and z (nz,); f = `freedom` motions, nx = 2 f + number of first-order states.

    inertial: whether the forces of inertia turn with what is accelerated, as they do; on the way to an equilibrium they
    are in the way.
    Raises AnalysisError if a coordinate moves no mass.
    """

    def __init__(self, arrangement: Arrangement, q: Array, v: Array, z: Array, inertial: bool = True) -> None:
        self.arrangement = arrangement
        self.system = system = arrangement.system
        planar = system.planar
        self.state, self._inertial = (q, v, z), inertial
        self.basis = to_nodal_basis(system)
        self._modal = system.to_modal(q), system.to_modal(v), np.asarray(z, float)
        self.motions = allowed_motions(system, q, arrangement.t, arrangement.held)
        self.freedom = self.motions.N.shape[1]
        self.states = arrangement.states
        self.size = 2 * self.freedom + len(self.states)
        self._couplings = couplings(planar)
        self._tangent = allocate_tangent(planar, self._couplings)
        rows = pathway_rows(system, q, arrangement.t) @ self.basis
        self._held, self._shafts = rows[arrangement.held], rows[planar.motors["pathway"]]
        self._constraints = rows[planar.constraints["pathway"]]
        self._shortening = bool((planar.bodies["axial"] >= 0).any())
        self.acceleration, self.state_rates = arrangement.rates(*self._modal)
        self._hold()
        #: generalised forces, shape (nq,), those of constraints included
        self.force = self.motions.M @ self.acceleration if inertial else self._force_at_rest()
        self._gains = {} if self._shortening else self._compensation()

    def _hold(self) -> None:
        """Feed the motors whose shafts are held with what keeps them from moving."""
        if not self._held.size:
            return
        torques = _least(self._held @ self._accelerated(self._held.T), -self._held @ self.acceleration)
        arrangement = self.arrangement
        fed = dict(zip(arrangement.constant, arrangement.inputs(), strict=True))
        more = {m: T / arrangement.gain(m) for m, T in zip(arrangement.locked, torques, strict=True)}
        arrangement.feed(more, [fed[m] + more[m] for m in more])
        self.acceleration, self.state_rates = arrangement.rates(*self._modal)

    def _force_at_rest(self) -> Array:
        """Forces without those of inertia; `work` is left as the tangent needs it, its multipliers as they are."""
        (q, v, z), planar = self._modal, self.system.planar
        force, rates = np.zeros_like(q), np.zeros_like(z)
        still = np.zeros_like(q)
        evaluate_residual(planar, self.system.work, self.arrangement.t, q, v, z, rates, still, force)
        return force

    @property
    def unbalanced(self) -> Array:
        """Accelerations and rates of the states of x, shape (nx,): 0 at an equilibrium."""
        pull = self.motions.N.T @ self.force
        return np.concatenate([np.zeros(self.freedom), pull, self.state_rates[self.states]])

    @cached_property
    def drift(self) -> Array:
        """E, how N turns with the motion, shape (nq, f)."""
        system, (q, v, _), t = self.system, self.state, self.arrangement.t
        if not self.motions.kept:
            return np.zeros_like(self.motions.N)
        _, stations = system.reference.frames(q + 1j * _STEP * v, np.asarray(t + 1j * _STEP))
        paths = np.concatenate([system.planar.constraints["pathway"], self.arrangement.held])
        turning = system.reference.lengths(stations)[paths, 1:-1].imag / _STEP @ self.basis
        return -self.motions.least(turning[self.motions.kept] @ self.motions.N)

    @cached_property
    def matrix(self) -> Array:
        """A, shape (nx, nx), right to round-off of its largest entries."""
        if not self.size:
            return np.zeros((0, 0))
        # taken as fast as the fastest motion, the resolvent can be inverted without loss
        S = max(SHIFT, 1.0 / np.abs(np.linalg.eigvals(self.resolvent)).min())
        A = S * np.eye(self.size) - np.linalg.inv(self._closed(S)[0])
        f = self.freedom
        A[:f] = np.eye(self.size)[f : 2 * f]
        return A

    @cached_property
    def resolvent(self) -> Array:
        """W(SHIFT), shape (nx, nx)."""
        return self._closed(SHIFT)[0]

    @cached_property
    def holding(self) -> Array:
        """Torques that hold the shafts, by x, shape (held, nx)."""
        W, torques = self._closed(SHIFT)
        return np.linalg.solve(W.T, torques.T).T

    def forced(self, force: Array, on_states: Array) -> tuple[Array, Array]:
        """x' (nx, k) by forces (nq, k) and rates of all states (nz, k), and the torques that then hold (held, k)."""
        a = self._accelerated(force)
        torques = np.zeros((len(self._held), force.shape[1]))
        if self._held.size:
            by_torque = self._accelerated(self._held.T)
            torques = _least(self._held @ by_torque, -self._held @ a)
            a = a + by_torque @ torques
        still = np.zeros((self.freedom, force.shape[1]))
        return np.vstack([still, self.motions.N.T @ self.motions.M @ a, on_states[self.states]]), torques

    def by_input(self, motors: list[int]) -> tuple[Array, Array]:
        """Force (nq, k) and rates of the states (nz, k) by a unit of the inputs of some motors."""
        records = self.system.planar.motors[motors]
        inductive = records["state"] >= 0
        gains = np.array([self.arrangement.gain(m) for m in motors])
        rates = np.zeros((self._modal[2].size, len(motors)))
        rates[records["state"][inductive], np.flatnonzero(inductive)] = 1.0 / records["La"][inductive]
        return (np.where(inductive, 0.0, gains)[:, None] * self._shafts[motors]).T, rates

    def directions(self, x: Array) -> tuple[Array, Array, Array]:
        """Nodal q, v (nq, k) and z (nz, k) of some x (nx, k)."""
        dq, dv, dz = (part @ x for part in self._allowed)
        z = np.zeros((self._modal[2].size, x.shape[1]), x.dtype)
        z[self.states] = dz
        return self.basis @ dq, self.basis @ dv, z

    @cached_property
    def _allowed(self) -> tuple[Array, Array, Array]:
        """T, in parts."""
        f, N = self.freedom, self.motions.N
        parts = [np.zeros((size, self.size)) for size in (len(N), len(N), self.size - 2 * f)]
        parts[0][:, :f], parts[1][:, :f], parts[1][:, f : 2 * f] = N, self.drift, N
        parts[2][:, 2 * f :] = np.eye(self.size - 2 * f)
        return parts[0], parts[1], parts[2]

    def _closed(self, S: float) -> tuple[Array, Array]:
        """W(S), and the torques that hold the shafts meanwhile, shape (held, nx).

        J leads out of T where shafts are held, and where T turns with the motion: a right-hand side P e beside T x
        keeps U in it. N^T M P = 0, so that x is not touched; M P e is the force of shafts and constraints.
        """
        motions, (Tq, Tv, Tz) = self.motions, self._allowed
        N, P, f, r = motions.N, motions.P, self.freedom, len(self.motions.kept)
        online, none = list(self._gains), np.zeros_like(motions.P)
        force, rates = self.by_input(online)
        free = np.zeros((len(N), self.size + 2 * r))
        Rq, Rv = np.hstack([Tq, none, P, 0.0 * force]), np.hstack([Tv, P, none, 0.0 * force])
        Rz = np.hstack([Tz, np.zeros((len(Tz), 2 * r)), rates[self.states]])
        Uq, Uv, Uz = self._solve(S, Rq, Rv, Rz, np.hstack([free, force]))
        to_y, out = N.T @ motions.M, P.T @ motions.M
        W = np.vstack([to_y @ Uq, to_y @ Uv, Uz])
        G = np.vstack([np.zeros((0, len(N))), *self._gains.values()])
        gaps = np.vstack([S * out @ Uq, out @ (Uv - self.drift @ W[:f]), G @ Uq])
        gaps[2 * r :, self.size + 2 * r :] -= np.eye(len(online))
        closing = np.linalg.solve(gaps[:, self.size :], -gaps[:, : self.size])
        rows = np.vstack([self._constraints, self._held])
        torques = _least(rows.T, motions.M @ P @ closing[:r])[len(self._constraints) :]
        return W[:, : self.size] + W[:, self.size :] @ closing, torques

    def _solve(self, S: float, Rq: Array, Rv: Array, Rz: Array, force: Array) -> tuple[Array, Array, Array]:
        """U of (S - J) U = R with `force` (nq, k) on the coordinates, shafts let go, no gravity compensated online."""
        rates = np.zeros((self._modal[2].size, Rq.shape[1]))
        rates[self.states] = Rz
        x, z = self._columns((1.0 / S, 1.0, S, 1.0 / S), -Rq, -S * Rq - Rv, force, rates)
        return x / S, x - Rq, z[self.states]

    def _accelerated(self, force: Array) -> Array:
        """q'' (nq, k) by forces."""
        none = np.zeros((self._modal[2].size, force.shape[1]))
        return self._columns((0.0, 0.0, 1.0, 0.0), 0.0 * force, 0.0 * force, force, none)[0]

    def _columns(
        self, weights: tuple[float, ...], v0: Array, a0: Array, force: Array, rates: Array
    ) -> tuple[Array, Array]:
        """What fmbd.planar.tangent.solve_linearised gives, or differences do: x (nq, k) and dz (nz, k)."""
        system, (q, v, z) = self.system, self._modal
        if self._shortening:
            return self._dense.columns(weights, v0, a0, force, rates)
        self.arrangement.rates(q, v, z)  # leaves in `work` what the tangent is taken of
        x, dz = np.zeros_like(v0.T), np.zeros_like(rates.T)
        if not self._inertial:
            self._force_at_rest()
        given = [np.ascontiguousarray(part.T) for part in (v0, a0, force, rates)]
        w = np.array(weights)
        for k in range(len(x)):
            columns = (part[k] for part in given)
            scratch = self._couplings, system.work, self._tangent
            if solve_linearised(system.planar, *scratch, q, v, w, *columns, x[k], dz[k]) >= 0:
                raise AnalysisError("the equations of motion cannot be solved here: the position is singular")
        return x.T, dz.T

    @cached_property
    def _dense(self) -> DenseTangent:
        scratch = self.motions.M, self._constraints, self._inertial
        return DenseTangent(self.arrangement, *self._modal, *scratch)

    def _compensation(self) -> dict[int, Array]:
        """Of motors whose gravity compensation is computed online, how their input changes with q: {motor: (nq,)}."""
        system, q, t = self.system, self.state[0], self.arrangement.t
        planar = system.planar
        found: dict[int, tuple[float, Array]] = {}
        for m, motor in enumerate(planar.motors):
            law = planar.controllers[motor.controller] if motor.controller >= 0 else None
            if law is None or law.online < 0:
                continue
            if law.low < system.work.drives[m].input < law.high:
                found[m] = law.gravity_gain, law.online
        if not found:
            return {}
        torques = np.zeros((planar.motors.size, planar.nq))
        turns = _TURN * np.eye(planar.nq)[~system.elastic]
        change = by_differences(lambda near: gravity_compensation(system, near, t), q, turns)
        torques[:, ~system.elastic] = change / _TURN
        return {m: gain * torques[online] @ self.basis for m, (gain, online) in found.items()}


def _least(A: Array, b: Array) -> Array:
    """The smallest x for which A x = b: motors that hold the same motion share it."""
    return np.linalg.lstsq(A, b, rcond=_DEPENDENT)[0]
