"""Prescribed motions must be such that a body can follow them."""

from typing import Any

from fmbd.system.lower import Lowered


def check_drives(lowered: Lowered, reference: Any) -> None:
    """Raise ModelError for a driven joint whose motion, or its rate, jumps during the run: a blow, not a force."""
    model = lowered.model
    for name, joint in model.joints.items():
        for signal in joint.driven.values():
            index = lowered.signals.add(signal)
            for t, before in lowered.signals.edges(signal, model.simulation.duration):
                old, new = reference.signal(index, before), reference.signal(index, t)
                for what, k in (("motion", 0), ("rate", 1)):
                    if abs(new[k] - old[k]) > 1e-6 * max(1.0, abs(old[k]), abs(new[k])):
                        raise model.error(
                            ("joints", name, "driven"),
                            f"its {what} jumps at t = {t:g} s, from {old[k]:g} to {new[k]:g}, which no finite force "
                            "can do: a smooth_step or a table with `interpolation: cubic` moves smoothly",
                        )
