"""Signals: value, rate and second derivative belong together, and runs stop and start again exactly where they jump."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from parts import SAMPLES
from physics import build, run

from fmbd.errors import ModelError
from fmbd.model.expressions import FUNCTIONS

H = 1e-4


def wheel(signal: Any, family: str = "loads", simulation: str = "{rtol: 1e-6}"):
    """A wheel of unit inertia, turned by a moment, or driven."""
    part = {"loads": "loads: {m: {type: moment, at: w.origin, moment: s}}", "driven": ""}[family]
    drive = ", driven: s" if family == "driven" else ""
    return build(f"""
fmbd: 1
bodies: {{w: {{type: rigid, mass: 1, inertia: 1}}}}
joints: {{axis: {{type: revolute, between: [ground.origin, w.origin]{drive}}}}}
signals: {{s: {signal}}}
{part}
simulation: {simulation}
""")


@pytest.fixture(autouse=True)
def table(tmp_path, monkeypatch):
    """The file that the table signals read."""
    (tmp_path / "drive.csv").write_text("t,u\n0,0.2\n0.1,1\n0.25,-0.5\n0.4,0.6\n0.7,0\n")
    monkeypatch.chdir(tmp_path)


EXPRESSIONS = [
    *(f"{name}(0.3 + 0.4*sin(3*t))" for name in sorted(FUNCTIONS - {"atan2", "hypot", "min", "max", "log10"})),
    "log10(2 + t)", "atan2(sin(t) + 2, t - 0.5)", "hypot(1 + t, cos(2*t))", "min(t, 0.2 + t*t, 1)",
    "max(sin(t), cos(t))",
    "(1 + t)**2.5", "(2 + sin(t))**t", "2**t", "(t - 3)**3", "t % 0.37", "-t/(1 + t*t)", "(t*3 - 1) % -0.9",
]  # fmt: skip


def check(signal: str) -> None:
    """Central differences, of order 4, at times away from jumps and kinks."""
    reference = wheel(signal).reference
    times = np.arange(0.0123, 0.9, 0.0717)
    checked = 0
    for t in times:
        stencil = np.array([reference.signals(t + k * H)[0] for k in (-2, -1, 0, 1, 2)])
        value, rate = (stencil[:, k] @ [1, -8, 0, 8, -1] / (12 * H) for k in (0, 1))
        if np.abs(np.diff(stencil[:, :2], axis=0)).max() > 0.05:
            continue  # a jump lies inside the stencil
        assert_allclose(stencil[2, 1:], [value, rate], rtol=1e-6, atol=1e-6)
        checked += 1
    assert checked >= 10


@pytest.mark.parametrize("name", [name for name in SAMPLES if name.startswith("signals.")])
def test_rates_are_derivatives(name):
    """The signals of parts.py."""
    check(str(SAMPLES[name].changes["signals"]["s"]))


@pytest.mark.parametrize("text", EXPRESSIONS)
def test_expressions_and_their_derivatives(text):
    """Value as Python computes it; rate and second derivative by differences."""
    check(f'"{text}"')
    names = {name: getattr(math, name) for name in dir(math)} | {"abs": abs, "min": min, "max": max}
    names["sign"] = lambda x: math.copysign(1.0, x)
    for t in (0.11, 0.58):
        expected = eval(text, names | {"t": t})
        assert wheel(f'"{text}"').reference.signals(t)[0, 0] == pytest.approx(expected, rel=1e-14, abs=1e-15)


PULSES = "{type: pulse, start: 0.1, width: 0.05, period: 0.1, amplitude: 3, offset: -1}"
TURNED = {
    "{type: step, at: 0.3, before: 1, after: -2}": lambda t: t**2 / 2 - 3 * np.maximum(t - 0.3, 0) ** 2 / 2,
    "{type: ramp, start: 0.1, end: 0.7, from: 1, to: 4}": lambda t: (
        t**2 / 2 + 5 / 6 * (np.maximum(t - 0.1, 0) ** 3 - np.maximum(t - 0.7, 0) ** 3)
    ),
    PULSES: lambda t: (
        -(t**2) / 2
        + 1.5
        * sum(np.maximum(t - k / 10, 0) ** 2 - np.maximum(t - k / 10 - 0.05, 0) ** 2 for k in range(1, 40))
    ),
}


@pytest.mark.parametrize("method", ["dop853", "rk45"])
@pytest.mark.parametrize("signal", TURNED)
def test_steps_end_where_a_signal_jumps(signal, method):
    """Between jumps the angle is a polynomial that the methods integrate exactly: so it is over 3 s and 60 jumps.

    A step across a jump, or one stage of it on the wrong side, would show as an error of the order of rtol.
    """
    system = wheel(signal, simulation=f"{{rtol: 1e-4, method: {method}}}")
    times = np.linspace(0.0, 3.0, 61)
    angle = run(system, times).position[:, 0]
    assert_allclose(angle, TURNED[signal](times), rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "signal, what",
    [
        ("{type: step, at: 0.3, after: 1}", "motion jumps at t = 0.3 s, from 0 to 1"),
        ("{type: ramp, start: 0.1, end: 0.5, to: 2}", "rate jumps at t = 0.1 s, from 0 to 5"),
        (PULSES, "motion jumps"),
        ("{type: table, file: drive.csv}", "rate jumps at t = 0.1 s, from 8 to -10"),
        ("{type: table, file: drive.csv, interpolation: cubic}", "rate jumps at t = 0.7 s"),
        ('"max(0, t - 0.3)"', r"rate can jump, by max\(\) of t in 'max\(0, t - 0.3\)', which no"),
        ('"2 * min(t, 0.5, 3)"', r"rate can jump, by min\(\)"),
        ('"abs(sin(4*t)) * abs(-2)"', r"rate can jump, by abs\(\)"),
        ('"sign(t - 0.5)"', r"motion can jump, by sign\(\)"),
        ('"floor(t + 0.5)"', r"motion can jump, by floor\(\)"),
        ('"ceil(t)"', r"motion can jump, by ceil\(\)"),
        ('"1 + t % 0.5"', "motion can jump, by %"),
    ],
)
def test_a_drive_that_jumps_is_refused(signal, what):
    """No finite force moves a body so; to go on as if nothing were would break the balance of momentum."""
    with pytest.raises(ModelError, match=f"joints.axis.driven: its {what}"):
        wheel(signal, "driven")


@pytest.mark.parametrize(
    "signal",
    [
        "{type: smooth_step, start: 0.1, end: 0.5, to: 2}",
        "{type: ramp, end: 2, to: 3}",  # from 0 on, and beyond the end of the run
        "{type: sine, amplitude: 1, frequency: 2}",
        '"max(1, abs(-2), floor(2.5)) * sin(3*t) + 7 % 3"',  # of constants they are constants
    ],
)
def test_a_smooth_drive_is_followed(signal):
    """The wheel turns as its drive says, and the work of the drive is its kinetic energy."""
    block = run(wheel(signal, "driven", "{rtol: 1e-10}"), np.linspace(0, 1, 7))
    assert block.energy["kinetic"].max() > 0.5
    assert np.abs(block.energy["balance"]).max() < 1e-8
