"""Prescribed motions must be such that a body can follow them."""

from collections.abc import Callable
from typing import Any

import numpy as np

from fmbd.model.names import shortened
from fmbd.system.lowered import Lowered
from fmbd.system.signals import SignalTable

#: What to do about a motion that jumps.
SMOOTHLY = "a smooth_step or a table with `interpolation: cubic` moves smoothly"

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
    """Raise ModelError for a driven joint whose motion, or its rate, jumps during the run: a blow, not a force."""
    model = lowered.model
    end = model.simulation.duration
    for name, joint in model.joints.items():
        for signal in joint.driven.values():
            lowered.signals.add(signal)
            jump = jump_of(signal, lowered.signals, reference.signal, end)
            if jump:
                raise model.error(
                    ("joints", name, "driven"), f"its {jump}, which no finite force can do: {SMOOTHLY}"
                )


def jump_of(signal: Any, table: SignalTable, evaluate: Callable[[int, float], np.ndarray], end: float) -> str:
    """What in a signal of a table, or in its rate, jumps before the end [s]; empty if nothing does.

    The jumps of an expression are not looked for: functions that have them are refused.
    """
    return _function_that_jumps(signal) or _jump(signal, table, evaluate, end)


def _function_that_jumps(signal: Any) -> str:
    """What jumps in an expression; empty if nothing does."""
    if signal.type == "expression":
        for operation, _ in signal.program:
            if operation in _JUMPING:
                what, written = _JUMPING[operation]
                return f"{what} can jump, by {written} of t in '{shortened(signal.text)}'"
    return ""


def _jump(signal: Any, table: SignalTable, evaluate: Callable[[int, float], np.ndarray], end: float) -> str:
    """The first jump of a signal at one of its breakpoints; empty if there is none."""
    index = table.find(signal)
    for t, before in table.edges(signal, end):
        old, new = evaluate(index, before), evaluate(index, t)
        for what, k in (("motion", 0), ("rate", 1)):
            if abs(new[k] - old[k]) > 1e-6 * max(1.0, abs(old[k]), abs(new[k])):
                return f"{what} jumps at t = {t:g} s, from {old[k]:g} to {new[k]:g}"
    return ""
