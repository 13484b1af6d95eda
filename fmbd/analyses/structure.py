"""What a mechanism leaves free: degrees of freedom, and the constraints that are one too many, by name."""

from dataclasses import dataclass

import numpy as np

from fmbd.analyses.jacobians import pathway_rows
from fmbd.planar.arrays import rigid_joints
from fmbd.system import System

Array = np.ndarray

#: Share of a row of Phi_q that is not a combination of others; less counts as none.
DEPENDENT = 1e-9


@dataclass(frozen=True)
class Redundancy:
    """A constraint that others imply."""

    constraint: str
    follows_from: tuple[str, ...]


@dataclass(frozen=True)
class Mobility:
    """Counts of a mechanism at one position; at a singular one it has more freedom than nearby."""

    coordinates: int  #: nq
    independent: int  #: rank of Phi_q
    rigid: int  #: degrees of freedom with all beams straight and rotors left out
    redundant: tuple[Redundancy, ...]

    @property
    def degrees_of_freedom(self) -> int:
        """nq - rank of Phi_q, elastic coordinates and rotors included."""
        return self.coordinates - self.independent


def mobility(system: System, q: Array | None = None, t: float = 0.0) -> Mobility:
    """Degrees of freedom and redundant constraints at nodal coordinates q (nq,), default: the start."""
    planar = system.planar
    Phi_q = pathway_rows(system, system.start.q if q is None else q, t)[planar.constraints["pathway"]]
    kept = independent_rows(Phi_q)
    joints = rigid_joints(planar.bodies)
    joints = joints[joints >= 0]
    held = Phi_q[planar.held][:, joints]
    return Mobility(
        coordinates=planar.nq,
        independent=len(kept),
        rigid=joints.size - len(independent_rows(held)),
        redundant=tuple(
            _explained(system.constraint_names, Phi_q, kept, c) for c in range(len(Phi_q)) if c not in kept
        ),
    )


def independent_rows(A: Array) -> list[int]:
    """Indices of the rows of A (m, n) that are not combinations of rows before them."""
    kept: list[int] = []
    basis = np.zeros((min(A.shape), A.shape[1]))
    for k, row in enumerate(A):
        size = np.linalg.norm(row)
        if size == 0.0 or len(kept) == A.shape[1]:
            continue
        rest = row / size
        for _ in range(2):  # once more for round-off
            rest = rest - (basis[: len(kept)] @ rest) @ basis[: len(kept)]
        share = np.linalg.norm(rest)
        if share > DEPENDENT:
            basis[len(kept)] = rest / share
            kept.append(k)
    return kept


def _explained(names: list[str], Phi_q: Array, kept: list[int], c: int) -> Redundancy:
    """Of which kept constraints c is a combination."""
    before = [k for k in kept if k < c]
    share = np.linalg.lstsq(Phi_q[before].T, Phi_q[c], rcond=DEPENDENT)[0]
    share = np.abs(share) * np.linalg.norm(Phi_q[before], axis=1)
    needed = share > 1e-6 * share.max(initial=0.0)
    return Redundancy(names[c], tuple(names[k] for k, need in zip(before, needed, strict=True) if need))
