"""Beams with rotary inertia, shear, or lumped mass: each changes what theory says, by the theory's number."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_bvp
from scipy.linalg import eigh

import fmbd
from fmbd.beams import Foreshortening, floating_beam
from fmbd.beams.lumping import lumped
from fmbd.model import load_model_text
from fmbd.model.pieces import BeamPiece, uniform_piece
from fmbd.model.sections import Circle, IBeam, Rectangle, Tube

# Of a beam of unit length, mass and bending stiffness: radius of gyration 0.05, E / kappa G = 3.
R2 = 0.05**2
KGA = 1 / (3 * R2)
K = np.pi * np.arange(1, 4)  # wave numbers of a beam pinned at both ends


def beam(elements, frame="chord", rotary=None, kGA=None, mass="consistent"):
    nodes = np.linspace(0, 1, elements + 1)
    pieces, lumps = (uniform_piece(1.0, 1.0, 1.0, rotary, kGA),), []
    if mass == "lumped":
        pieces, lumps = lumped(pieces, nodes)
    return floating_beam(pieces, nodes, frame, lumps)


def frequencies(*args, **options):
    return np.sqrt(beam(*args, **options).modal_basis()[1])[:3]


# Frequencies


def test_rotary_inertia_lowers_frequencies_as_rayleigh_says():
    """omega^2 = k^4 / (1 + r^2 k^2), k = n pi: 1.2, 4.6 and 9.6 % lower; with order 4."""
    exact = np.sqrt(K**4 / (1 + R2 * K**2))
    errors = [frequencies(n, rotary=R2) / exact - 1 for n in (16, 32, 64)]
    assert np.all(errors[2] > 0)
    assert_allclose(errors[2], 0, atol=5e-7)
    assert_allclose(np.log2(errors[0] / errors[1]), 4, atol=0.1)


def timoshenko():
    """r^2 / kGA omega^4 - (1 + r^2 k^2 + k^2 / kGA) omega^2 + k^4 = 0, the lower root."""
    b = 1 + R2 * K**2 + K**2 / KGA
    omega2 = (b - np.sqrt(b**2 - 4 * K**4 * R2 / KGA)) / (2 * R2 / KGA)
    return np.sqrt(omega2)


def test_shear_and_rotary_inertia_lower_frequencies_as_timoshenko_says():
    """4.5, 14.7 and 25.6 % lower.

    Elements are exact but for the inertia forces within them: what a fixed element stores under their mean, the energy
    h^3 / 24 ((omega^2 w)^2 / kGA + (r^2 omega^2 psi)^2 / EI) once it is shorter than the beam is high, makes a
    frequency too high, with order 2; psi / w = k - omega^2 / (k kGA).
    """
    exact = timoshenko()
    psi2 = (K - exact**2 / (K * KGA)) ** 2
    missed = exact**2 / 24 * (1 / KGA + R2**2 * psi2) / (1 + R2 * psi2)
    assert_allclose(1 - exact / K**2, [0.045, 0.147, 0.256], atol=5e-4)
    errors = [frequencies(n, rotary=R2, kGA=KGA) / exact - 1 for n in (64, 128)]
    assert_allclose(errors[1], missed / 128**2, rtol=0.01)
    assert_allclose(np.log2(errors[0] / errors[1]), 2, atol=0.02)
    extrapolated = (4 * (1 + errors[1]) - (1 + errors[0])) / 3
    assert_allclose(extrapolated, 1, atol=1e-6)


def test_long_elements_that_shear_converge_with_order_four():
    """A slender beam, r = 0.002: elements of ten radii and more."""
    b = 1 + 4e-6 * K**2 * 4
    exact = np.sqrt((b - np.sqrt(b**2 - 4 * K**4 * 4e-6 * 1.2e-5)) / (2 * 4e-6 * 1.2e-5))
    errors = [frequencies(n, rotary=4e-6, kGA=1 / 1.2e-5) / exact - 1 for n in (4, 8, 16)]
    assert_allclose(np.log2(errors[0] / errors[1]), 4, atol=0.25)
    assert_allclose(np.log2(errors[1] / errors[2]), 4, atol=0.25)


@pytest.mark.parametrize("frame", ["clamped", "chord"])
def test_lumped_mass_converges_from_below_with_order_two_and_consistent_from_above_with_four(frame):
    exact = np.array([1.87510406871, 4.69409113297, 7.85475743824]) if frame == "clamped" else K
    for mass, sign, order in (("lumped", -1, 2), ("consistent", 1, 4)):
        errors = [frequencies(n, frame, mass=mass) / exact**2 - 1 for n in (32, 64)]
        assert np.all(sign * errors[1] > 0)
        assert_allclose(np.log2(errors[0] / errors[1]), order, atol=0.05)


def test_lumped_mass_of_a_pinned_beam():
    """Its nodes turn with h^2 / 39 of their mass: Rayleigh's (k h)^2 / 78; masses without that have order 4 here."""
    assert_allclose(1 - frequencies(64, mass="lumped") / K**2, (K / 64) ** 2 / 78, rtol=0.03)


@pytest.mark.parametrize("n", [1, 3])
def test_invariants_of_the_whole_beam(n):
    """Mass and centre stay; rotary inertia adds rho I L to the moment of inertia; lumps m L^2 (1/6 + 1/39) / n^2."""
    for rotary, mass, more in (
        (None, "consistent", 0),
        (0.04, "consistent", 0.04),
        (0.04, "lumped", 0.04 + (1 / 6 + 1 / 39) / n**2),
    ):
        whole = beam(n, "clamped", rotary, mass=mass)
        assert_allclose([whole.mass, whole.first_moment, whole.inertia], [1, 0.5, 1 / 3 + more], rtol=1e-14)


def test_lumps_of_a_tapered_beam_keep_its_mass_and_centre():
    """Mass per length 3 - 2 x, uneven elements, one stepped inside: 2 kg and 5/6 kg m on [0, 1], by hand."""
    nodes = [0.0, 0.2, 0.55, 1.0]
    pieces = [
        BeamPiece(0.0, 0.3, (3.0, -2.0), (1.0,), None, (0.1,)),
        BeamPiece(0.3, 1.0, (2.4, -2.0), (2.0,), None, (0.1,)),
    ]
    light, lumps = lumped(pieces, nodes)
    places, masses, inertias = np.array(lumps).T
    assert_allclose([masses.sum(), masses @ places], [2, 5 / 6], rtol=1e-14)
    own = masses @ np.array([0.2, 0, 0, 0.45]) ** 2 / 39  # of the first and the last node
    assert 0.1 + own < inertias.sum() < 0.1 + 2 * 0.45**2 / 39
    whole = floating_beam(light, nodes, "clamped", lumps)
    assert_allclose([whole.mass, whole.first_moment], [2, 5 / 6], rtol=1e-14)


SPINNING = """
fmbd: 1
gravity: [0, 0]
bodies: {arm: {type: beam, length: 1, elements: 12, mass_per_length: 1, bending_stiffness: 1, rotary_inertia: 0.0025,
               foreshortening: true}}
joints: {root: {type: revolute, between: [ground.origin, arm.start], driven: 8*t}}
"""


def test_centrifugal_forces_do_not_act_on_what_turns():
    """(K + W^2 (int x H dm - int S^T S dm) - w^2 M) e = 0: rho I psi^T psi is in M only, S^T S of a beam without it.

    To the finite differences by which beams that shorten are linearised.
    """
    thin, rotary = (beam(12, "clamped", r2) for r2 in (None, R2))
    shortening = Foreshortening.of(rotary, rotary.modal_basis()[0])
    stiffness = rotary.K + 64 * (shortening.nodal(shortening.by_moment()) - thin.M)
    exact = np.sqrt(eigh(stiffness, rotary.M, eigvals_only=True)[:3])
    found = 2 * np.pi * fmbd.modes(load_model_text(SPINNING), moving=True).frequencies[:3]
    assert_allclose(found, exact, rtol=1e-7)


# Statics

THICK = """
fmbd: 1
materials: {steel: {density: 7850, youngs_modulus: 2.07e11, poissons_ratio: 0.3}}
sections: {block: {type: rectangle, width: 0.1, height: 0.5}, thin: {type: rectangle, width: 0.1, height: 0.25}}
bodies: {rod: {type: beam, length: 2, elements: 4, material: steel, section: block, shear: true, frame: FRAME}}
joints: {root: {type: weld, between: [ground.origin, rod.start]}}
loads: {push: {type: force, at: rod.end, force: [0, -62500]}}
simulation: {duration: 1e-3, output_interval: 2.5e-4, rtol: 1e-9}
"""
L, A, EI = 2.0, 0.05, 2.07e11 * 0.1 * 0.5**3 / 12
SHEARED = 10 * 1.3 / (12 + 11 * 0.3) * 2.07e11 / 2.6 * A


def thick(frame="clamped", **changes):
    return load_model_text(THICK.replace("FRAME", frame), overrides=changes)


@pytest.mark.parametrize("frame", ["clamped", "chord"])
@pytest.mark.parametrize("elements", [1, 3])
def test_a_thick_cantilever(frame, elements):
    """F L^3 / 3 EI + F L / kGA; Nachbagauer et al., 2011, at their small load: 8.09903e-4 m.

    The cross-section at the root does not turn, the one at the tip by F L^2 / 2 EI.
    """
    F = -62500
    rest = fmbd.equilibrium(thick(frame, **{"bodies.rod.elements": elements}))
    tip = F * L**3 / (3 * EI) + F * L / SHEARED
    # the chord turns the whole beam, and with it its length
    assert_allclose(rest["rod.end.position"][1], tip, rtol=1e-6)
    assert_allclose(tip, -8.099032540e-4, rtol=2e-6)
    assert_allclose(rest["rod.end.angle"], F * L**2 / (2 * EI), rtol=1e-6)
    assert_allclose(rest["rod.start.angle"], 0, atol=1e-15)
    assert_allclose(rest["rod.shear_force"], -F, rtol=1e-6)
    assert_allclose(rest["rod.start.bending_moment"], F * L, rtol=1e-6)
    assert_allclose(rest["rod.start.stress"], -F * L * 0.25 / (EI / 2.07e11), rtol=1e-6)


def test_a_thick_cantilever_under_a_load_along_it():
    """q L^4 / 8 EI + q L^2 / 2 kGA, exact at the nodes."""
    q = -1000.0
    rest = fmbd.equilibrium(thick(loads={"wind": {"type": "distributed", "on": "rod", "force": [0, q]}}))
    assert_allclose(rest["rod.end.deflection"], q * L**4 / (8 * EI) + q * L**2 / (2 * SHEARED), rtol=1e-9)


def test_a_thick_tapered_cantilever():
    """int F (L - x)^2 / EI(x) dx + int F / kGA(x) dx of a height that halves; the shear force is F everywhere.

    Of order 2: the functions of the elements are those of uniform ones.
    """
    F = -62500
    taper = {"start": "block", "end": "thin"}
    t, w = np.polynomial.legendre.leggauss(40)
    x, dx = 1 + t, w
    share = 1 - x / (2 * L)
    exact = (F * (L - x) ** 2 / (EI * share**3) + F / (SHEARED * share)) @ dx
    errors = []
    for n in (16, 32, 64):
        rest = fmbd.equilibrium(thick(**{"bodies.rod.section": taper, "bodies.rod.elements": n}))
        errors.append(rest["rod.end.deflection"] / exact - 1)
    assert_allclose(np.log2(errors[1] / errors[2]), 2, atol=0.05)
    assert abs(4 * errors[2] - errors[1]) / 3 < 1e-5
    assert_allclose(rest["rod.shear_force"], -F, rtol=0.03)


# Large deflections


def exact_tip(F, EI, kGA, L):
    """Tip (x, y) and angle of a cantilever under a dead force F across it, by Reissner's beam without axial strain.

    EI psi'' = -F (cos psi - gamma sin psi), gamma = F cos(psi) / kGA, r' = e(psi) + gamma e(psi + pi/2).
    """

    def rates(s, y):
        c, s = np.cos(y[0]), np.sin(y[0])
        gamma = F * c / kGA
        return np.stack([y[1] / EI, -F * (c - gamma * s), c - gamma * s, s + gamma * c])

    def ends(a, b):
        return np.array([a[0], b[1], a[2], a[3]])

    found = solve_bvp(rates, ends, np.linspace(0, L, 41), np.zeros((4, 41)), tol=1e-10, max_nodes=100_000)
    assert found.success
    angle, _, x, y = found.y[:, -1]
    return np.array([x, y, angle])


LARGE = """
fmbd: 1
bodies: {rod: {type: beam, length: 5, elements: 4, segments: 4, mass_per_length: 1, bending_stiffness: 9.346e6,
               shear: {shear_stiffness: 3.231e8}, foreshortening: true}}
joints: {root: {type: weld, between: [ground.origin, rod.start]}}
loads: {push: {type: force, at: rod.end, force: [0, 6e5]}}
"""


def test_a_cantilever_that_shears_and_bends_far():
    """Geradin and Cardona's: a drop of 2.157 m of 5, 0.006 of it by shear, which segments follow with order 4.

    Published with axial strain: 2.159, 0.596, 0.672.
    """
    exact = exact_tip(6e5, 9.346e6, 3.231e8, 5.0)
    errors = []
    for n in (4, 8):
        model = load_model_text(LARGE, overrides={"bodies.rod.elements": n, "bodies.rod.segments": n})
        rest = fmbd.equilibrium(model)
        errors.append(np.append(rest["rod.end.position"], rest["rod.end.angle"]) - exact)
    assert_allclose(errors[1], 0, atol=1e-5)
    assert abs(errors[0][1] / errors[1][1]) > 12


# Stability


def test_a_column_that_shears_buckles_under_haringx_load():
    """P = kGA / 2 (sqrt(1 + 4 P_E / kGA) - 1), P_E = pi^2 EI / L^2: 6.5 % below Euler's."""
    exact, errors = KGA / 2 * (np.sqrt(1 + 4 * np.pi**2 / KGA) - 1), []
    for n in (6, 12):
        column = beam(n, kGA=KGA)
        shortening = Foreshortening.of(column, column.modal_basis()[0])
        H = shortening.nodal(shortening.at(1.0))
        errors.append(1 / eigh(H, column.K, eigvals_only=True)[-1] / exact - 1)
    assert_allclose(np.log2(errors[0] / errors[1]), 2, atol=0.05)
    assert abs(4 * errors[1] - errors[0]) / 3 < 2e-5


# Motion

SWING = """
fmbd: 1
gravity: [0, -9.81]
bodies:
  rod: {type: beam, length: 0.8, elements: 1, mass_per_length: 3, bending_stiffness: 40, rotary_inertia: 0.05,
        shear: {shear_stiffness: 4000}, frame: FRAME, points: {POINTS}}
joints: {hinge: {type: revolute, between: [ground.origin, rod.start]}}
loads: {kick: {type: force, at: rod.end, force: [0, "20*cos(25*t)"]}}
simulation: {duration: 0.3, output_interval: 0.02, rtol: 1e-10, atol: 1e-12}
"""
GAUSS, WEIGHTS = (
    0.4 * (1 + np.polynomial.legendre.leggauss(5)[0]),
    0.4 * np.polynomial.legendre.leggauss(5)[1],
)


@pytest.mark.parametrize("frame", ["clamped", "chord"])
@pytest.mark.parametrize("shear", [False, {"shear_stiffness": 4000}])
def test_energy_and_angular_momentum_are_those_of_all_cross_sections(frame, shear):
    """1/2 int mu v^2 + 1/2 int rho I (theta' + psi')^2; L changes by the moments about the hinge."""
    points = ", ".join(f"g{k}: {x!r}" for k, x in enumerate(GAUSS.tolist()))
    text = SWING.replace("FRAME", frame).replace("POINTS", points)
    run = fmbd.simulate(load_model_text(text, overrides={"bodies.rod.shear": shear}))
    places, speeds, accelerations = (
        np.stack([run[f"rod.g{k}.{name}"] for k in range(5)], axis=-1)
        for name in ("position", "velocity", "acceleration")
    )
    turning, changing = (
        np.stack([run[f"rod.g{k}.angular_{name}"] for k in range(5)], axis=-1)
        for name in ("velocity", "acceleration")
    )
    kinetic = (1.5 * (speeds**2).sum(axis=1) + 0.025 * turning**2) @ WEIGHTS
    assert_allclose(kinetic, run["energy.kinetic"], rtol=1e-12)
    assert_allclose(run["energy.balance"], 0, atol=1e-8)
    rate = (
        3 * (places[:, 0] * accelerations[:, 1] - places[:, 1] * accelerations[:, 0]) + 0.05 * changing
    ) @ WEIGHTS
    moment = run["rod.end.position"][:, 0] * 20 * np.cos(25 * run.time) - 9.81 * 3 * places[:, 0] @ WEIGHTS
    assert_allclose(rate, moment, atol=1e-8 * np.abs(moment).max())


@pytest.mark.parametrize("shear", [False, {"shear_stiffness": 4000}])
def test_shear_force_at_the_root_is_that_of_the_joint(shear):
    """Of a beam that swings with the ground: (EI w'')' - rho I psi'', or -kGA gamma, as the elements get shorter."""
    misses = []
    for n in (8, 16):
        changes = {
            "loads.kick.force": [0, "20*sin(8*t)**4"],
            "bodies.rod.shear": shear,
            "bodies.rod.elements": n,
            "joints.hinge.type": "weld",
            "gravity": [0, 0],
        }
        text = SWING.replace("FRAME", "clamped").replace("POINTS", "")
        run = fmbd.simulate(load_model_text(text, overrides=changes))
        expected = -run["hinge.force"][:, 1]
        misses.append(np.abs(run["rod.start.shear_force"] - expected).max() / np.abs(expected).max())
    assert misses[1] < 0.007
    assert misses[0] / misses[1] > 1.8


# Sections and materials


@pytest.mark.parametrize(
    ("section", "kappa"),
    [
        (Rectangle(type="rectangle", width=1, height=2), 13 / 15.3),
        (Circle(type="circle", diameter=1), 7.8 / 8.8),
        (Tube(type="tube", outer_diameter=1, inner_diameter=1 - 1e-9), 2.6 / 4.9),
        (IBeam(type="i_beam", height=2, flange_width=1, flange_thickness=1e-9, web_thickness=1), 13 / 15.3),
    ],
)
def test_shear_coefficients(section, kappa):
    """Cowper's table, nu = 0.3: 0.850, 0.886, a thin tube 2 (1 + nu) / (4 + 3 nu), a web without flanges."""
    assert_allclose(section.shear_coefficient(0.3), kappa, rtol=1e-6)


def test_shear_modulus_and_coefficient_as_given():
    """Softer than an isotropic material would be, with a coefficient of its own."""
    soft = {"density": 500, "youngs_modulus": 2.07e11, "shear_modulus": 1e9}
    changes = {"materials.steel": soft, "bodies.rod.shear": {"shear_coefficient": 0.7}}
    rest = fmbd.equilibrium(thick(**changes))
    assert_allclose(rest["rod.end.deflection"], -62500 * (L**3 / (3 * EI) + L / (0.7 * 1e9 * A)), rtol=1e-9)
