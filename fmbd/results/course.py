"""How a run went, in words."""

from collections.abc import Mapping
from typing import Any

#: Seconds of compiling that are worth a word.
NOTED = 0.1


def course(statistics: Mapping[str, Any]) -> list[tuple[str, str]]:
    """How a run went, from the statistics that it leaves when it ends."""
    s = statistics
    if not s:
        return []
    compiling = s.get("compile_time", 0.0)
    once = f"; {compiling:.3g} s of it to compile, once on this computer" if compiling >= NOTED else ""
    return [
        ("steps", f"{s['steps']}, and {s['rejected_steps']} rejected; {s['evaluations']} evaluations"),
        ("time", f"{s['wall_time']:.3g} s on the clock, {s['cpu_time']:.3g} s of CPU{once}"),
        ("constraint error", f"at most {s['largest_constraint_error']:.1e}"),
        ("energy balance", f"within {s['largest_energy_balance']:.1e} J"),
        *(("remark", remark) for remark in s["remarks"].splitlines()),
        *(("warning", warning) for warning in s.get("warnings", "").splitlines()),
    ]
