"""Beams alone: natural frequencies for five kinds of support, static deflections, a ruler that is let go."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh, null_space
from simulation import load, simulate

import fmbd

E, WIDTH, HEIGHT, L, DENSITY = 2.1e11, 0.030, 0.002, 0.5, 7850  # cantilever.yaml
EI, MASS_PER_LENGTH = E * WIDTH * HEIGHT**3 / 12, DENSITY * WIDTH * HEIGHT
UNLOADED = {"loads": {}, "signals": {}}


def joint(kind, end):
    return {"type": kind, "between": [f"ground.{end}", f"ruler.{end}"]}


# An end that is pinned may slide along: a linear beam has no length to give.
SUPPORTS = {
    "clamped-free": {"start": joint("weld", "start")},
    "clamped-pinned": {"start": joint("weld", "start"), "end": joint("pin_in_slot", "end")},
    "clamped-clamped": {"start": joint("weld", "start"), "end": joint("prismatic", "end")},
    "pinned-pinned": {"start": joint("revolute", "start"), "end": joint("pin_in_slot", "end")},
    "free-free": {"start": joint("free", "start")},
}
# beta L: roots of the frequency equations, omega = (beta L)^2 sqrt(EI / rho A L^4)
ROOTS = {
    "clamped-free": [1.87510406871, 4.69409113297, 7.85475743824, 10.9955407349],
    "clamped-pinned": [3.92660231205, 7.06858274563, 10.2101761228, 13.3517687778],
    "clamped-clamped": [4.73004074486, 7.8532046241, 10.995607838, 14.1371654913],
    "pinned-pinned": [np.pi, 2 * np.pi, 3 * np.pi, 4 * np.pi],
    "free-free": [4.73004074486, 7.8532046241, 10.995607838, 14.1371654913],
}


@pytest.mark.parametrize("frame", ["clamped", "chord"])
@pytest.mark.parametrize("supports", SUPPORTS)
def test_frequencies_of_the_euler_bernoulli_beam(supports, frame):
    """The classical roots, whatever the floating frame, with the known error of cubic elements of length h.

    An eigenvalue is too large by the energy that interpolation misses, h^4 / 720 times its square; that is
    (beta h)^4 / 2880 of the root.
    """
    elements = 16
    changes = {
        "ground": {"points": {"start": [0, 0], "end": ["L", 0]}},
        "joints": SUPPORTS[supports],
        "bodies.ruler.elements": elements,
        "bodies.ruler.frame": frame,
    }
    m = fmbd.assemble(load("cantilever.yaml", UNLOADED | changes)).matrices()
    N = null_space(m.Phi_q)
    omega2 = eigh(N.T @ m.K @ N, N.T @ m.M @ N, eigvals_only=True)
    bending = omega2[3:7] if supports == "free-free" else omega2[:4]
    found = (bending * MASS_PER_LENGTH * L**4 / EI) ** 0.25
    exact = np.array(ROOTS[supports])
    assert_allclose(found / exact - 1, (exact / elements) ** 4 / 2880, rtol=0.06)


F, M, Q, G, a, b = 3.0, 0.4, 5.0, 9.81, 0.13, 0.37
STATICS = {
    # load, and what text books say of the deflection and slope of the tip, times EI
    "tip force": ({"type": "force", "at": "ruler.end", "force": [0, F]}, F * L**3 / 3, F * L**2 / 2),
    "force at a": (
        {"type": "force", "at": "ruler.a", "force": [0, F]},
        F * a**2 * (3 * L - a) / 6,
        F * a**2 / 2,
    ),
    "moment": ({"type": "moment", "at": "ruler.end", "moment": M}, M * L**2 / 2, M * L),
    "load over L": ({"type": "distributed", "on": "ruler", "force": [0, Q]}, Q * L**4 / 8, Q * L**3 / 6),
    "load from a to b": (
        {"type": "distributed", "on": "ruler", "force": [0, Q], "from": a, "to": b},
        Q * (4 * L * (b**3 - a**3) - (b**4 - a**4)) / 24,
        Q * (b**3 - a**3) / 6,
    ),
}


@pytest.mark.parametrize("elements", [1, 3])
@pytest.mark.parametrize("case", STATICS)
def test_static_deflection_of_the_tip(case, elements):
    """Exact at the nodes for any number of elements, also under loads that begin and end inside elements."""
    load_, deflection, slope = STATICS[case]
    changes = {"bodies.ruler.elements": elements, "bodies.ruler.points": {"a": a}, "signals": {}}
    m = fmbd.assemble(load("cantilever.yaml", changes | {"loads": {"load": load_}})).matrices()
    q = np.linalg.solve(m.K, m.f)
    assert_allclose(q[-2:] * EI, [deflection, slope], rtol=1e-11)


def test_deflection_under_its_own_weight():
    m = fmbd.assemble(load("cantilever.yaml", UNLOADED | {"gravity": [0, -G]})).matrices()
    q = np.linalg.solve(m.K, -m.g)
    weight = MASS_PER_LENGTH * G
    assert_allclose(q[-2:] * EI, [-weight * L**4 / 8, -weight * L**3 / 6], rtol=1e-11)


@pytest.mark.parametrize(
    "tip, frequencies, shape_at_tip, slope_at_tip",
    [
        ({"mass": 0.1, "inertia": 0.0005}, [2.1783, 15.9145], [0.8833, 0.0693], [2.6413, 10.8526]),
        ({"mass": 1.2, "inertia": 0.1338333}, [0.4797, 1.7966], [0.1859, 0.2151], [0.6571, 0.5604]),
    ],
)
def test_modes_of_an_arm_with_a_load(tip, frequencies, shape_at_tip, slope_at_tip):
    """The links of a two-link arm with point masses and inertias at their tips, modal masses 0.1 kg.

    A. De Luca, B. Siciliano, IEEE Transactions on Systems, Man, and Cybernetics 21 (4), 1991, pp. 826-839;
    the published values have two or three digits, the others come from the exact functions of the beam.
    """
    arm = {"type": "beam", "length": 0.5, "elements": 16, "mass_per_length": 0.2, "bending_stiffness": 1}
    changes = UNLOADED | {"bodies.ruler": arm | {"point_masses": {"end": tip}}}
    m = fmbd.assemble(load("cantilever.yaml", changes)).matrices()
    omega2, modes = eigh(m.K, m.M)
    modes *= np.sqrt(0.1)
    assert_allclose(np.sqrt(omega2[:2]) / (2 * np.pi), frequencies, atol=6e-5)
    assert_allclose(np.abs(modes[-2, :2]), shape_at_tip, atol=6e-5)
    assert_allclose(np.abs(modes[-1, :2]), slope_at_tip, atol=6e-5)


def test_a_ruler_that_is_let_go_swings_in_its_modes():
    """Each mode is an oscillator of its own, with the damping ratio of the file, 0.005."""
    run = simulate("cantilever.yaml", {"simulation.rtol": 1e-10, "simulation.output_interval": 1e-3})
    m = run.system.matrices()
    omega2, modes = eigh(m.K, m.M)
    free = run.time >= 0.6
    t = run.time[free, None] - 0.6
    eta, rate = run.position[free] @ m.M @ modes, run.velocity[free] @ m.M @ modes
    omega, ratio = np.sqrt(omega2), 0.005
    decay, damped = ratio * omega, omega * np.sqrt(1 - ratio**2)
    swing = eta[0] * np.cos(damped * t) + (rate[0] + decay * eta[0]) / damped * np.sin(damped * t)
    assert_allclose(eta, np.exp(-decay * t) * swing, rtol=0, atol=1e-9)
    # bent slowly, it was let go close to its static deflection under 1 N
    tip = run["ruler.end.deflection"][free][0]
    assert_allclose(tip, -1 * L**3 / (3 * EI), rtol=0.01)
