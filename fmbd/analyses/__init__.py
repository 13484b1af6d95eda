"""What can be said of a system without running it."""

from fmbd.analyses.frequencies import longest_step, natural_frequencies
from fmbd.analyses.structure import Mobility, Redundancy, mobility

__all__ = ["Mobility", "Redundancy", "longest_step", "mobility", "natural_frequencies"]
