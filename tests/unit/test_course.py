"""How a run went, in words: the time that compiling took is told apart."""

import pytest

from fmbd.results.course import course

RAN = {
    "steps": 9,
    "rejected_steps": 1,
    "evaluations": 120,
    "wall_time": 151.2,
    "cpu_time": 150.1,
    "largest_constraint_error": 1e-12,
    "largest_energy_balance": 1e-6,
    "remarks": "",
}


@pytest.mark.parametrize(
    ("compiling", "time"),
    [
        ({"compile_time": 148.6}, "; 149 s of it to compile, once on this computer"),
        ({"compile_time": 0.0}, ""),
        ({}, ""),  # of an archive that does not know
    ],
)
def test_compiling_is_told_apart(compiling: dict[str, float], time: str) -> None:
    assert dict(course(RAN | compiling))["time"] == f"151 s on the clock, 150 s of CPU{time}"
