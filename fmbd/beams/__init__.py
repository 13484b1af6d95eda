"""Beams in a floating frame: Hermite elements, inertia and stiffness integrals, modes."""

from fmbd.beams.floating import FloatingBeam, Frame, floating_beam
from fmbd.beams.foreshortening import Foreshortening
from fmbd.beams.hermite import shape_functions
from fmbd.beams.pieces import BeamPiece

__all__ = ["BeamPiece", "FloatingBeam", "Foreshortening", "Frame", "floating_beam", "shape_functions"]
