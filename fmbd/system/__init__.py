"""From a validated model to a system of equations: tree, numbering, flat arrays, start, the paper's matrices."""

from fmbd.system.system import System, assemble

__all__ = ["System", "assemble"]
