"""How far a linear beam in a floating frame may be trusted: its sag, and what axial force takes its stiffness away.

Psi, omega2   modes of the beam (fmbd.beams.modal); compliance along a row r of shape functions: r K^-1 r^T
"""

import numpy as np

from fmbd.beams.floating import FloatingBeam
from fmbd.beams.hermite import Array


def deflection_rows(beam: FloatingBeam) -> Array:
    """Shape functions at the nodes and in the middle of the elements, shape (2n + 1, nf)."""
    middles = 0.5 * (beam.nodes[1:] + beam.nodes[:-1])
    return beam.shape(np.concatenate([beam.nodes, middles]))


def weight_sag(beam: FloatingBeam, Psi: Array, omega2: Array) -> float:
    """The largest static deflection [m] from its frame under an acceleration of 1 m/s^2 across it.

    With a clamped frame that of a cantilever, with a chord that of a beam on two supports.
    """
    return float(np.abs(deflection_rows(beam) @ _given_way(beam.s, Psi, omega2)).max())


def softening_load(beam: FloatingBeam, Psi: Array, omega2: Array) -> float:
    """Axial force [N] whose left-out effect is as large as the bending stiffness; exact for uniform beams.

    With a clamped frame the tension 3 EI / L^2, at which the linear beam has no stiffness left against a force across
    its end; with a chord the buckling load pi^2 EI / L^2, which as a tension would double the stiffness.
    """
    if beam.frame == "clamped":
        tip = beam.shape(beam.length)
        return beam.length / float(tip @ _given_way(tip, Psi, omega2))
    turn = beam.slope(0.0)
    return np.pi**2 / (3.0 * beam.length * float(turn @ _given_way(turn, Psi, omega2)))


def _given_way(force: Array, Psi: Array, omega2: Array) -> Array:
    """K^-1 times a force on the elastic coordinates."""
    return Psi @ ((force @ Psi) / omega2)
