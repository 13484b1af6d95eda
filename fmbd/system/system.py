"""A system: a model assembled into arrays, with its start. `assemble` is the one way to make it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from fmbd.beams import FloatingBeam
from fmbd.planar.arrays import Planar, Work, allocate
from fmbd.system.closure import RigidMechanism
from fmbd.system.drives import check_drives
from fmbd.system.lower import lower
from fmbd.system.lowered import Lowered
from fmbd.system.matrices import Matrices, matrices
from fmbd.system.reference import Reference
from fmbd.system.start import Start, set_targets, solve_start
from fmbd.system.tree import Tree

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class System:
    """Generalised coordinates, arrays and start of a mechanism.

    Outside the kernels all elastic coordinates are nodal; `to_modal` and `to_nodal` change the basis. Bodies are
    those of `tree`: a beam in segments is several of them (see system.segments).
    """

    model: Any
    lowered: Lowered
    reference: Reference
    start: Start
    work: Work = field(repr=False)

    @property
    def planar(self) -> Planar:
        """The arrays that the kernels see."""
        return self.lowered.planar

    @property
    def tree(self) -> Tree:
        """Spanning tree and cut joints."""
        return self.lowered.tree

    @property
    def beams(self) -> dict[int, FloatingBeam]:
        """Beams by body index."""
        return self.lowered.beams

    @property
    def coordinates(self) -> list[tuple[str, str]]:
        """(name, unit) of the generalised coordinates q."""
        return self.lowered.coordinates

    @property
    def constraints(self) -> list[tuple[str, str]]:
        """(name, unit) of the Lagrange multipliers."""
        return self.lowered.constraints

    @property
    def states(self) -> list[tuple[str, str]]:
        """(name, unit) of the first-order states z."""
        return self.lowered.states

    @property
    def coordinate_names(self) -> list[str]:
        """Names of the generalised coordinates."""
        return [name for name, _ in self.coordinates]

    @property
    def constraint_names(self) -> list[str]:
        """Names of the constraints."""
        return [name for name, _ in self.constraints]

    @property
    def input_names(self) -> list[str]:
        """Names of the motors' inputs."""
        units = {"dc": "voltage", "torque": "torque"}
        return [f"{name}.{units[motor.type]}" for name, motor in self.model.motors.items()]

    @cached_property
    def elastic(self) -> Array:
        """True where a coordinate is elastic, shape (nq,)."""
        mask = np.zeros(self.planar.nq, bool)
        for body in self.planar.bodies:
            mask[body.first_q : body.first_q + body.nf] = body.nf > 0
        return mask

    @cached_property
    def nodal_damping(self) -> dict[int, Array]:
        """Damping matrix of each beam in nodal coordinates: M Psi diag(d) Psi^T M."""
        out = {}
        for i, beam in self.beams.items():
            left = beam.M @ self.lowered.psi[i]
            out[i] = (left * self.lowered.modal_damping[i]) @ left.T
        return out

    def station_of_place(self, name: str) -> int:
        """Station index of a joint's first point or of body.point."""
        return self.lowered.stations[self.lowered.place_point(name)]

    def to_modal(self, q: Array) -> Array:
        """Nodal to modal elastic coordinates: eta = Psi^T M e; shape (..., nq)."""
        out = np.array(q, float)
        for i, beam in self.beams.items():
            part = self._elastic_part(i)
            out[..., part] = out[..., part] @ (beam.M @ self.lowered.psi[i])
        return out

    def to_nodal(self, q: Array) -> Array:
        """Modal to nodal elastic coordinates: e = Psi eta; shape (..., nq)."""
        out = np.array(q, float)
        for i in self.beams:
            part = self._elastic_part(i)
            out[..., part] = out[..., part] @ self.lowered.psi[i].T
        return out

    def _elastic_part(self, body: int) -> slice:
        record = self.planar.bodies[body]
        return slice(int(record.first_q), int(record.first_q + record.nf))

    def matrices(
        self, q: Array | None = None, v: Array | None = None, t: float = 0.0, z: Array | None = None
    ) -> Matrices:
        """M, C, D, K, g, B, Phi, Phi_q of the paper at a state (default: the start)."""
        return matrices(
            self,
            self.start.q if q is None else q,
            self.start.v if v is None else v,
            t,
            self.start.z if z is None else z,
        )

    def accelerations(
        self, q: Array, v: Array, t: float = 0.0, z: Array | None = None
    ) -> tuple[Array, Array]:
        """q'' (nq,) and Lagrange multipliers (nc,) from the compiled recursion, in nodal coordinates."""
        from fmbd.planar.equations import evaluate_accelerations

        z = self.start.z if z is None else np.asarray(z, float)
        qdd = np.zeros(self.planar.nq)
        modal_q, modal_v = self.to_modal(q), self.to_modal(v)
        evaluate_accelerations(self.planar, self.work, t, modal_q, modal_v, z, np.zeros(z.size), qdd)
        return self.to_nodal(qdd), np.array(self.work.reactions["multiplier"])


def assemble(
    model: Any, shafts: Mapping[str, Any] = MappingProxyType({}), points: Iterable[str] = ()
) -> System:
    """Lower a model, solve its start, set its targets. Raises ModelError, with the place in the file.

    shafts: signals of motors whose motion is prescribed, the start in agreement; points: whose stations are wanted
    (see lower.py)
    """
    lowered = lower(model, shafts, points)
    reference = Reference(lowered.planar, lowered.beams, lowered.shortenings)
    check_drives(lowered, reference)
    start = solve_start(lowered, reference)
    system = System(model, lowered, reference, start, allocate(lowered.planar))
    set_targets(system, RigidMechanism(lowered, reference))
    return system
