"""Mass lumped at the nodes: the beam between them is elastic and weighs nothing.

An element of mass m and length h gives its ends what puts its centre where it is, m / 2 each if it is uniform, so that
mass and centre of a beam are exact. Each part m_i turns with its node, of inertia m_i h^2 / 39: without any the slopes
would move no mass. The moment of inertia of n equal elements is too large by m L^2 (1 / 6 + 1 / 39) / n^2.

E. Hinton, T. Rock, O. C. Zienkiewicz, A note on mass lumping and related processes in the finite element method,
Earthquake Engineering and Structural Dynamics 4 (1976): the diagonal of the consistent matrix, scaled to the mass.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from fmbd.beams.pieces import BeamPiece, degree, element_breaks, evaluate, gauss_points, has

_TURNING = 1 / 39  # 4 h^2 over 156, the diagonal of the consistent matrix


def lumped(
    pieces: Sequence[BeamPiece], nodes: ArrayLike
) -> tuple[tuple[BeamPiece, ...], list[tuple[float, float, float]]]:
    """Pieces without mass, and point masses at the nodes: (position [m], mass [kg], moment of inertia [kg m^2]).

    pieces, nodes: as of `floating_beam`; rotary inertia of the pieces, if any, goes to the nodes, too.
    """
    nodes = np.asarray(nodes, float)
    rotary = has(pieces, "rotary_inertia")
    most = max(degree(pieces, name) for name in ("mass_per_length", *["rotary_inertia"] * rotary))
    x, dx = gauss_points(element_breaks(pieces, nodes), 1 + most)
    element = np.searchsorted(nodes, x) - 1
    h = np.diff(nodes)[element]
    mass, inertia = np.zeros(len(nodes)), np.zeros(len(nodes))
    for node, share in ((element, (nodes[element + 1] - x) / h), (element + 1, (x - nodes[element]) / h)):
        dm = share * dx * evaluate(pieces, "mass_per_length", x)
        np.add.at(mass, node, dm)
        np.add.at(inertia, node, dm * h**2 * _TURNING)
        if rotary:
            np.add.at(inertia, node, share * dx * evaluate(pieces, "rotary_inertia", x))
    light = tuple(replace(piece, mass_per_length=(0.0,), rotary_inertia=None) for piece in pieces)
    return light, list(zip(nodes.tolist(), mass.tolist(), inertia.tolist(), strict=True))
