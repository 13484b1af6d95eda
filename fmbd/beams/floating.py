"""A planar beam in its floating frame: Euler-Bernoulli, Rayleigh or Timoshenko.

The frame's origin is at the start of the beam, its x axis along the undeformed beam; the deflection is
w(x) = S(x) e. Reference conditions tie the frame to the beam: "clamped" drops w0 and slope0 (the frame
follows the start's cross-section), "chord" drops w0 and wn (the x axis passes through both ends).

S       shape functions (nf,)              s    int S dm (nf,)
e       elastic coordinates (nf,)          p    int x S dm + int psi dI (nf,)
M_w     int S^T S dm *                     K    int EI psi'^T psi' dx + int kGA gamma^T gamma dx
M       M_w + int psi^T psi dI
psi     rotations of the cross-sections (nf,): S' - gamma; gamma the shear angles, zero unless the pieces can shear
m_k, I_k, x_k   point masses: mass, moment of inertia, position; dm includes the m_k, dI the I_k
dI      includes rho I dx if the pieces have rotary inertia: cross-sections turn with frame and beam, theta' + psi e'

*  M_w is what makes the moment of inertia grow with the deflection: what turns has no part in that. Of many masses that
turn, as of rotary inertia, that is true of the lowest modes; the others' turning is left in it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fmbd.beams import modal
from fmbd.beams.hermite import Array, Side, interpolation, shear_angles
from fmbd.beams.pieces import BeamPiece, degree, element_breaks, evaluate, gauss_points
from fmbd.beams.thickness import rotary_inertia, shear_parameters

Frame = Literal["clamped", "chord"]

_MOST_TURNING = 8  # rows of what turns, and modes whose turning is told from their moving
_ROUND_OFF = 1e-9  # a position that misses the beam by less than this, in lengths, is on it


@dataclass(frozen=True, eq=False)
class FloatingBeam:
    """Constants and shape functions of a beam; its nf elastic coordinates e are nodal, in order along it.

    If `modes` are given, they are amplitudes of these instead: nodal coordinates are modes e.
    """

    pieces: tuple[BeamPiece, ...]
    nodes: Array  #: node positions [m], shape (n+1,)
    frame: Frame
    mass: float  #: [kg]
    first_moment: float  #: int x dm [kg m]
    inertia: float  #: J0 = int x^2 dm + int dI, about the start [kg m^2]
    s: Array  #: shape (nf,), [kg] for w, [kg m] for slope
    p: Array  #: shape (nf,), [kg m] for w, [kg m^2] for slope
    M: Array  #: mass matrix, shape (nf, nf)
    M_w: Array  #: the part of M that moves transversely, M - turning^T turning, shape (nf, nf)
    turning: Array  #: rows whose square is the rest of M, that of what turns, shape (at most 8, nf)
    K: Array  #: stiffness matrix, shape (nf, nf)
    shear: Array  #: Phi of each element (hermite.py), shape (n,), zeros if rigid in shear
    point_masses: Array  #: positions [m], masses [kg], inertias [kg m^2], shape (k, 3)
    modes: Array | None = None  #: of the nodal coordinates, shape (nodal coordinates, nf)

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(self.nodes[-1])

    @property
    def dof_nodes(self) -> NDArray[np.intp]:
        """Node of each nodal coordinate, integers, shape (nodal coordinates,)."""
        return _kept(self.nodes, self.frame) // 2

    @property
    def dof_kinds(self) -> tuple[str, ...]:
        """'w' [m] or 'slope' [rad] for each nodal coordinate."""
        return tuple("slope" if dof % 2 else "w" for dof in _kept(self.nodes, self.frame))

    def coordinates(self, first_node: int = 0) -> list[tuple[str, str]]:
        """(name, unit) of the elastic coordinates, such as ('w1', 'm'); `first_node` is the number of the first."""
        if self.modes is not None:
            return [(f"mode{number}", "kg^0.5 m") for number in range(1, self.modes.shape[1] + 1)]
        units = {"w": "m", "slope": "rad"}
        pairs = zip(self.dof_kinds, self.dof_nodes, strict=True)
        return [(f"{kind}{first_node + node}", units[kind]) for kind, node in pairs]

    @property
    def dof_names(self) -> tuple[str, ...]:
        """Names of the elastic coordinates, such as ('w1', 'slope1', 'w2', 'slope2')."""
        return tuple(name for name, _ in self.coordinates())

    def shape(self, x: ArrayLike) -> Array:
        """S at x [m]: shape (nf,) for a number, (points, nf) for an array. ValueError off the beam."""
        return self._evaluate(x, 0)

    @property
    def shears(self) -> bool:
        """Whether cross-sections may stay behind the slope of the axis."""
        return bool(self.shear.any())

    def slope(self, x: ArrayLike) -> Array:
        """Rotations psi of the cross-sections at x [m], S' unless the beam shears, shaped as `shape`."""
        return self._evaluate(x, 1) - self.shear_angle(x) if self.shears else self._evaluate(x, 1)

    def tangent(self, x: ArrayLike) -> Array:
        """S' at x [m], shaped as `shape`; at a node of a beam that shears that on its right."""
        return self._evaluate(x, 1)

    def shear_angle(self, x: ArrayLike, side: Side = "right") -> Array:
        """S' - psi at x [m], shaped as `shape`; at an interior node that of the element on its `side`."""
        return self._rows(x, lambda at: shear_angles(self.nodes, at, side, self.shear))

    def curvature(self, x: ArrayLike, side: Side = "right") -> Array:
        """S'' = psi' at x [m], shaped as `shape`; at an interior node that of the element on its `side`."""
        return self._evaluate(x, 2, side)

    def third_derivative(self, x: ArrayLike, side: Side = "right") -> Array:
        """S''' = psi'' at x [m], shaped as `shape`; at an interior node that of the element on its `side`."""
        return self._evaluate(x, 3, side)

    def bending_stiffness(self, x: ArrayLike) -> Array:
        """EI [N m^2] at x [m], shaped as x; at a jump that on its right. ValueError off the beam."""
        x = np.asarray(x, float)
        self._check_on_beam(x)
        return evaluate(self.pieces, "bending_stiffness", x)

    def load_moments(self, x0: float, x1: float) -> tuple[float, float, Array]:
        """x1 - x0 [m], int x dx [m^2] and int S dx, shape (nf,), over [x0, x1], where a uniform load acts.

        ValueError off the beam, or if x1 < x0.
        """
        self._check_on_beam(np.array([x0, x1]))
        if x0 > x1:
            raise ValueError(f"the load ends at {x1:g} m, before its start at {x0:g} m")
        inside = self.nodes[(self.nodes > x0) & (self.nodes < x1)]
        x, weight = gauss_points(np.concatenate(([x0], inside, [x1])), 3)
        return x1 - x0, (x1**2 - x0**2) / 2, weight @ self.shape(x)

    def modal_basis(self) -> tuple[Array, Array]:
        """Modes Psi, shape (nf, nf), one a column, and omega2 [rad^2/s^2], shape (nf,), ascending.

        Psi^T M Psi = I to round-off, Psi^T K Psi = diag(omega2); signs do not hang on round-off.
        """
        if self.modes is not None:
            return np.eye(len(self.M)), np.diag(self.K).copy()
        return modal.modal_basis(self.M, _stiffness_root(self.pieces, self.nodes, self.frame, self.shear))

    def truncated(self, count: int) -> "FloatingBeam":
        """The beam that moves in its first modes only; ValueError if it has fewer."""
        Psi, omega2 = self.modal_basis()
        if not 1 <= count <= len(omega2):
            raise ValueError(f"the beam has {len(omega2)} modes, not {count}")
        kept = Psi[:, :count]
        return replace(
            self,
            s=_constant(self.s @ kept),
            p=_constant(self.p @ kept),
            M=_constant(np.eye(count)),
            M_w=_constant(kept.T @ self.M_w @ kept),
            turning=_constant(self.turning @ kept),
            K=_constant(np.diag(omega2[:count])),
            modes=_constant(kept),
        )

    def _evaluate(self, x: ArrayLike, derivative: int, side: Side = "right") -> Array:
        return self._rows(x, lambda at: interpolation(self.nodes, at, derivative, side, self.shear))

    def _rows(self, x: ArrayLike, mesh_rows: Callable[[Array], Array]) -> Array:
        """Rows of the mesh's coordinates, given at positions (points,), as rows of e."""
        x = np.asarray(x, float)
        self._check_on_beam(x)
        values = mesh_rows(x.ravel())[:, _kept(self.nodes, self.frame)]
        if self.modes is not None:
            values = values @ self.modes
        return values.reshape(*x.shape, values.shape[-1])

    def _check_on_beam(self, x: Array) -> None:
        _check_positions(x, self.length, "position")


def floating_beam(
    pieces: Sequence[BeamPiece],
    nodes: ArrayLike,
    frame: Frame = "clamped",
    point_masses: Sequence[tuple[float, float, float]] = (),
) -> FloatingBeam:
    """Integrate a beam's inertia and stiffness over its mesh, exactly for polynomial properties.

    pieces: in order along the beam, without gaps; their boundaries need not be nodes.
    nodes: increasing positions from 0 to the length [m], shape (n+1,).
    point_masses: (position [m], mass [kg], moment of inertia [kg m^2]) anywhere on the beam.
    Raises ValueError for input that does not make a beam, or that leaves an elastic coordinate without mass.
    """
    pieces, nodes = tuple(pieces), np.array(nodes, float)
    _check_mesh(pieces, nodes, frame)
    x_k, m_k, I_k = np.array(point_masses, float).reshape(-1, 3).T
    _check_positions(x_k, float(nodes[-1]), "point mass")

    kept, shear = _kept(nodes, frame), shear_parameters(pieces, nodes)
    x, weight = gauss_points(element_breaks(pieces, nodes), 6 + degree(pieces, "mass_per_length"))
    dm = np.concatenate((weight * evaluate(pieces, "mass_per_length", x), m_k))
    x = np.concatenate((x, x_k))
    x_I, dI = rotary_inertia(pieces, nodes)
    x_I, dI = np.concatenate((x_I, x_k)), np.concatenate((dI, I_k))
    if min(dm.min(), dI.min(initial=0)) < 0:
        raise ValueError("a beam's mass per length, point masses and inertias must not be negative")
    x_I, dI = x_I[dI > 0.0], dI[dI > 0.0]
    S = interpolation(nodes, x, shear=shear)[:, kept]
    psi = (interpolation(nodes, x_I, 1, shear=shear) - shear_angles(nodes, x_I, "right", shear))[:, kept]
    moving, turning = S * np.sqrt(dm)[:, None], psi * np.sqrt(dI)[:, None]
    M, G = _square(np.concatenate((moving, turning))), _stiffness_root(pieces, nodes, frame, shear)
    _check_mass(M)
    few = _few(turning, M, G)
    return FloatingBeam(
        pieces=pieces,
        nodes=_constant(nodes),
        frame=frame,
        mass=float(dm.sum()),
        first_moment=float(dm @ x),
        inertia=float(dm @ x**2 + dI.sum()),
        s=_constant(dm @ S),
        p=_constant((dm * x) @ S + dI @ psi),
        M=_constant(M),
        M_w=_constant(_square(moving) if few is turning else M - _square(few)),
        turning=_constant(few),
        K=_constant(_square(G)),
        shear=_constant(shear),
        point_masses=_constant(np.stack([x_k, m_k, I_k], axis=-1)),
    )


def _kept(nodes: Array, frame: Frame) -> NDArray[np.intp]:
    """Mesh coordinates that the reference conditions leave."""
    mesh = np.arange(2 * len(nodes))
    return mesh[2:] if frame == "clamped" else np.delete(mesh, [0, -2])


def _stiffness_root(pieces: Sequence[BeamPiece], nodes: Array, frame: Frame, shear: Array) -> Array:
    """G with K = G^T G: curvatures, shear angles at the Gauss points times sqrt(EI dx), sqrt(kGA dx), (points, nf)."""
    x, weight = gauss_points(element_breaks(pieces, nodes), 2 + degree(pieces, "bending_stiffness"))
    EI = evaluate(pieces, "bending_stiffness", x)
    if EI.min() <= 0:
        raise ValueError("a beam's bending stiffness must be positive")
    G = interpolation(nodes, x, 2, shear=shear) * np.sqrt(EI * weight)[:, None]
    if shear.any():
        x, weight = gauss_points(element_breaks(pieces, nodes), degree(pieces, "shear_stiffness"))
        dx = weight * evaluate(pieces, "shear_stiffness", x)
        G = np.concatenate((G, shear_angles(nodes, x, "right", shear) * np.sqrt(dx)[:, None]))
    return G[:, _kept(nodes, frame)]


def _square(factor: Array) -> Array:
    """factor^T factor, exactly symmetric."""
    return factor.T @ factor


def _few(turning: Array, M: Array, G: Array) -> Array:
    """A few rows in place of many, whose square is theirs on the lowest modes, and never more."""
    if len(turning) <= _MOST_TURNING:
        return turning
    Psi, _ = modal.modal_basis(M, G)
    spanned, _ = np.linalg.qr(turning @ Psi[:, :_MOST_TURNING])
    return np.asarray(spanned.T @ turning)


def _constant(array: Array) -> Array:
    array.setflags(write=False)
    return array


def _check_mesh(pieces: Sequence[BeamPiece], nodes: Array, frame: Frame) -> None:
    if frame not in get_args(Frame):
        raise ValueError(f"the frame of a beam is one of {', '.join(get_args(Frame))}, not {frame!r}")
    if nodes.ndim != 1 or len(nodes) < 2 or nodes[0] != 0 or not np.all(np.diff(nodes) > 0):
        raise ValueError("the nodes of a beam must be at least two increasing positions, the first of them 0")
    ends = [0.0, *(piece.end for piece in pieces)]
    starts = [*(piece.start for piece in pieces), nodes[-1]]
    if not np.allclose(starts, ends, rtol=0, atol=_ROUND_OFF * nodes[-1]):
        raise ValueError("the pieces of a beam must cover it from the first node to the last without gaps")


def _check_positions(x: Array, length: float, what: str) -> None:
    off = ~((x >= -_ROUND_OFF * length) & (x <= (1 + _ROUND_OFF) * length))
    if off.any():
        raise ValueError(
            f"{what} {x[off].flat[0]:g} m is not on the beam, which reaches from 0 to {length:g} m"
        )


def _check_mass(M: Array) -> None:
    try:
        np.linalg.cholesky(M)
    except np.linalg.LinAlgError:
        message = "a beam needs a positive mass per length, else some of its elastic coordinates move no mass"
        raise ValueError(message) from None
