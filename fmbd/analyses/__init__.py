"""What can be said of a system without running it."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fmbd.analyses.statics import Equilibrium, equilibrium
    from fmbd.analyses.frequencies import longest_step, natural_frequencies
    from fmbd.analyses.vibrations import Modes, modes
    from fmbd.analyses.structure import Mobility, Redundancy, mobility

_HOMES = {
    "Equilibrium": "statics",
    "Mobility": "structure",
    "Redundancy": "structure",
    "Modes": "vibrations",
    "equilibrium": "statics",
    "modes": "vibrations",
    "longest_step": "frequencies",
    "mobility": "structure",
    "natural_frequencies": "frequencies",
}
__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'fmbd.analyses' has no attribute '{name}'")
    return getattr(import_module(f"fmbd.analyses.{_HOMES[name]}"), name)
