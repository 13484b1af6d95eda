"""Beams that move in their first modes only, and what that leaves out.

Gamma   participation s^T Psi of the modes in an acceleration across the beam; Gamma^2 are effective masses
r       shape functions where the compliance is measured; that of a mode is (r Psi)^2 / omega^2
"""

from dataclasses import dataclass

import numpy as np

from fmbd.beams.floating import FloatingBeam


@dataclass(frozen=True)
class Truncation:
    """A truncated beam, how many modes it had, and the shares of what it keeps of the whole."""

    beam: FloatingBeam
    modes: int
    effective_mass: float  #: share of the effective masses of all modes across the beam
    compliance: float  #: share of the static compliance at the end, with a chord frame in the middle
    next_frequency: float  #: of the first mode left out [Hz]; infinite if there is none


def truncate(beam: FloatingBeam, count: int) -> Truncation:
    """The first modes of a beam; ValueError if it has fewer."""
    Psi, omega2 = beam.modal_basis()
    masses = (beam.s @ Psi) ** 2
    at = beam.length if beam.frame == "clamped" else 0.5 * beam.length
    compliances = (beam.shape(at) @ Psi) ** 2 / omega2
    return Truncation(
        beam.truncated(count),
        omega2.size,
        float(masses[:count].sum() / masses.sum()),
        float(compliances[:count].sum() / compliances.sum()),
        float(np.sqrt(omega2[count])) / (2.0 * np.pi) if count < omega2.size else np.inf,
    )
