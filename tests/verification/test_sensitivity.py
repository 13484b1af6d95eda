"""Derivatives of `fmbd.sensitivity` against closed forms, and over time against the variational equation."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from simulation import model, revolute

import fmbd

G, LENGTH = 9.81, 1.2


def pendulum():
    """A mass on a massless bar, released from the horizontal."""
    return model(
        parameters={"length": LENGTH},
        gravity=[0, -G],
        bodies={"bob": {"type": "rigid", "mass": 2, "inertia": 0, "center_of_mass": ["length", 0]}},
        joints={"pivot": revolute("ground.origin", "bob.origin", friction={"viscous": 0.4})},
        simulation={"duration": 3, "output_interval": 0.01},
    )


def test_a_pendulum_over_time():
    """theta'' = -g cos(theta) / l - d theta' / (m l^2); the derivatives by l and d by SciPy, to 1e-12."""
    m, d = 2.0, 0.4

    def rates(t, y):
        angle, rate, by_l, rate_by_l, by_d, rate_by_d = y
        k, c = G / LENGTH, d / (m * LENGTH**2)

        def varied(s, ds):
            return k * np.sin(angle) * s - c * ds

        return [
            rate,
            -k * np.cos(angle) - c * rate,
            rate_by_l,
            varied(by_l, rate_by_l) + (k * np.cos(angle) + 2 * c * rate) / LENGTH,
            rate_by_d,
            varied(by_d, rate_by_d) - rate / (m * LENGTH**2),
        ]

    to = ["parameters.length", "joints.pivot.friction.viscous"]
    found = fmbd.sensitivity(pendulum(), to, ["pivot.angle"])
    exact = solve_ivp(rates, (0, 3), np.zeros(6), "DOP853", found.time, rtol=1e-12, atol=1e-12).y
    for path, expected, rate in zip(to, exact[2::2], exact[3::2], strict=True):
        one = found["pivot.angle", path]
        assert_allclose(one.derivative, expected, rtol=0, atol=1e-6)
        assert (np.abs(one.derivative - expected) <= one.error + 1e-9).all()
        assert one.error.max() < 1e-4
        assert_allclose(one.numbers["end"].derivative, expected[-1], rtol=0, atol=1e-6)
        # the deepest swing is at the rate zero, where only the angle changes
        k = np.abs(exact[0]).argmax()
        at_peak = expected[k] - rate[k] * exact[1, k] / (-G * np.cos(exact[0, k]) / LENGTH)
        assert_allclose(one.numbers["peak"].derivative, np.sign(exact[0, k]) * at_peak, rtol=0, atol=1e-4)
        rms = np.sqrt((exact[0] ** 2).mean())
        assert_allclose(one.numbers["RMS"].derivative, (exact[0] * expected).mean() / rms, rtol=0, atol=1e-6)


def test_the_modes_of_a_pendulum():
    """Where it hangs: f = sqrt(g / l) / 2 pi and the damping ratio d / (2 m l^2 sqrt(g / l)), by powers of l and g."""
    to = {"parameters.length": LENGTH, "gravity.1": -G}
    found = fmbd.sensitivity(pendulum(), list(to), ["frequency.1", "damping_ratio.1"], "modes")
    f = np.sqrt(G / LENGTH) / (2 * np.pi)
    ratio = 0.4 / (2 * 2 * LENGTH**2 * 2 * np.pi * f)
    assert_allclose(found["frequency.1", "gravity.1"].values, f, rtol=1e-10)
    assert_allclose(found["damping_ratio.1", "gravity.1"].values, ratio, rtol=1e-10)
    for path, of_frequency, of_ratio in (("parameters.length", -1 / 2, -3 / 2), ("gravity.1", 1 / 2, -1 / 2)):
        assert_close(found["frequency.1", path], of_frequency * f / to[path])
        assert_close(found["damping_ratio.1", path], of_ratio * ratio / to[path])


CANTILEVER = {
    "materials": {"steel": {"density": 7800, "youngs_modulus": 2e11}},
    "sections": {"bar": {"type": "rectangle", "width": 0.02, "height": 0.01}},
    "bodies": {"rod": {"type": "beam", "length": 0.8, "elements": 2, "material": "steel", "section": "bar"}},
    "joints": {"root": {"type": "weld", "between": ["ground.origin", "rod.start"]}},
    "loads": {"pull": {"type": "force", "at": "rod.end", "force": [0, 3]}},
}


@pytest.mark.parametrize("analysis", ["modes", "frequencies"])
def test_the_frequency_of_a_cantilever(analysis):
    """It grows with the root of E and with the height, falls with the root of the density and the square of l."""
    built = model(**CANTILEVER)
    to = {
        "materials.steel.youngs_modulus": (2e11, 1 / 2),
        "materials.steel.density": (7800, -1 / 2),
        "sections.bar.height": (0.01, 1),
        "bodies.rod.length": (0.8, -2),
    }
    found = fmbd.sensitivity(built, list(to), ["frequency.1"], analysis)
    for path, (p, power) in to.items():
        one = found["frequency.1", path]
        assert_close(one, power * one.values / p)


def test_the_deflection_of_a_cantilever():
    """w = F l^3 / 3 EI, of I = b h^3 / 12, and the moment that clamps it, F l."""
    built = model(**CANTILEVER)
    to = ["loads.pull.force.1", "bodies.rod.length", "sections.bar.height", "materials.steel.youngs_modulus"]
    found = fmbd.sensitivity(built, to, ["rod.end.deflection", "root.moment", "rod.end.position"], "statics")
    w = 3 * 0.8**3 / (3 * 2e11 * 0.02 * 0.01**3 / 12)
    expected = [w / 3, 3 * w / 0.8, -3 * w / 0.01, -w / 2e11]
    for path, change in zip(to, expected, strict=True):
        assert_close(found["rod.end.deflection", path], change)
    assert_close(found["root.moment", "bodies.rod.length"], np.sign(found.derivatives[1].values) * 3)
    place = found["rod.end.position", "bodies.rod.length"]
    assert_allclose(place.derivative, [[1, expected[1]]], rtol=1e-8)
    assert_allclose(place.numbers["x value"].derivative, 1, rtol=1e-8)


def assert_close(found, expected):
    """To eight digits, and within the error that is claimed, which is small."""
    assert_allclose(found.derivative, expected, rtol=1e-8)
    assert abs(found.derivative - expected) <= found.error
    assert found.error < 1e-5 * abs(expected)
