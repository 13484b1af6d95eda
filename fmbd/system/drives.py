"""Prescribed motions must be such that a body can follow them."""

from typing import Any

from fmbd.model.names import shortened
from fmbd.system.lowered import Lowered

#: Functions of t whose value jumps, or their rate, and how they are written. What does not depend on t is folded away.
_JUMPING = {
    "abs": ("rate", "abs()"),
    "min": ("rate", "min()"),
    "max": ("rate", "max()"),
    "sign": ("motion", "sign()"),
    "floor": ("motion", "floor()"),
    "ceil": ("motion", "ceil()"),
    "mod": ("motion", "%"),
}


def check_drives(lowered: Lowered, reference: Any) -> None:
    """Raise ModelError for a driven joint whose motion, or its rate, jumps during the run: a blow, not a force.

    The jumps of an expression are not looked for: functions that have them are refused.
    """
    model = lowered.model
    for name, joint in model.joints.items():
        for signal in joint.driven.values():
            jump = _function_that_jumps(signal) or _jump(lowered, reference, signal)
            if jump:
                raise model.error(
                    ("joints", name, "driven"),
                    f"its {jump}, which no finite force can do: "
                    "a smooth_step or a table with `interpolation: cubic` moves smoothly",
                )


def _function_that_jumps(signal: Any) -> str:
    """What jumps in an expression; empty if nothing does."""
    if signal.type == "expression":
        for operation, _ in signal.program:
            if operation in _JUMPING:
                what, written = _JUMPING[operation]
                return f"{what} can jump, by {written} of t in '{shortened(signal.text)}'"
    return ""


def _jump(lowered: Lowered, reference: Any, signal: Any) -> str:
    """The first jump of a signal at one of its breakpoints; empty if there is none."""
    index = lowered.signals.add(signal)
    for t, before in lowered.signals.edges(signal, lowered.model.simulation.duration):
        old, new = reference.signal(index, before), reference.signal(index, t)
        for what, k in (("motion", 0), ("rate", 1)):
            if abs(new[k] - old[k]) > 1e-6 * max(1.0, abs(old[k]), abs(new[k])):
                return f"{what} jumps at t = {t:g} s, from {old[k]:g} to {new[k]:g}"
    return ""
