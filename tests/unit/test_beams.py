"""Beams in their floating frame: integrals, statics and frequencies against closed forms and quadrature."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad_vec
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

from fmbd.beams import floating_beam, shape_functions

FRAMES = ["clamped", "chord"]


@dataclass
class Piece:
    start: float
    end: float
    mass_per_length: tuple[float, ...]
    bending_stiffness: tuple[float, ...]
    rotary_inertia: tuple[float, ...] | None = None
    shear_stiffness: tuple[float, ...] | None = None


def uniform_beam(n, frame="clamped", length=1.0, mass=1.0, EI=1.0, point_masses=()):
    pieces = [Piece(0, length, (mass / length,), (EI,))]
    return floating_beam(pieces, np.linspace(0, length, n + 1), frame, point_masses)


def stepped_tapered_beam(frame):
    """A step at 0.55 m inside an element, tapers up to quartic, uneven nodes, point masses off the nodes."""
    pieces = [
        Piece(0, 0.55, (2, -1.5, 0.3), (30, -20, 5, -1)),
        Piece(0.55, 1.3, (0.9, -0.2, 0, 0.1), (12, -9, 4, -2, 0.5)),
    ]
    return floating_beam(pieces, [0, 0.4, 0.7, 0.75, 1.3], frame, [(0.3, 0.5, 0.02), (1.0, 0.2, 0.01)])


def frequencies(beam):
    return np.sqrt(beam.modal_basis()[1])


# One element


def test_one_clamped_element_with_end_mass_has_the_closed_forms():
    """Rod of mass m and length L with m3 at its end: the integrals of the cubic shapes, done by hand."""
    m, L, m3, EI = 0.12, 0.5, 0.25, 4.8
    rod = uniform_beam(1, length=L, mass=m, EI=EI, point_masses=[(L, m3, 0)])
    exact = {"rtol": 1e-14, "atol": 0}
    assert rod.dof_names == ("w1", "slope1")
    assert_allclose(
        [rod.mass, rod.first_moment, rod.inertia], [m + m3, m * L / 2 + m3 * L, m * L**2 / 3 + m3 * L**2]
    )
    assert_allclose(rod.s, [m / 2 + m3, -m * L / 12], **exact)
    assert_allclose(rod.p, [7 / 20 * m * L + m3 * L, -m * L**2 / 20], **exact)
    assert_allclose(
        rod.M, [[13 / 35 * m + m3, -11 / 210 * m * L], [-11 / 210 * m * L, m * L**2 / 105]], **exact
    )
    assert_allclose(rod.K, EI / L**3 * np.array([[12, -6 * L], [-6 * L, 4 * L**2]]), **exact)


def test_tapered_element_matrices_equal_exact_rational_integrals():
    """Mass and stiffness of a quartic taper on [0, 1], integrated power by power in fractions."""
    mu, EI = (5, -2, 0, 1, -3), (7, -4, 1, 0, -2)
    beam = floating_beam([Piece(0, 1, mu, EI)], [0, 1])
    shapes = [(0, 0, 3, -2), (0, 0, -1, 1)]  # of w1 and slope1, ascending powers

    def integral(*polynomials):
        product = np.array([Fraction(1)], dtype=object)
        for polynomial in polynomials:
            product = np.convolve(product, np.array([Fraction(c) for c in polynomial], dtype=object))
        return float(sum(c / (power + 1) for power, c in enumerate(product)))

    curvatures = [(6, -12), (-2, 6)]
    assert_allclose(beam.M, [[integral(mu, a, b) for b in shapes] for a in shapes], rtol=1e-14)
    assert_allclose(beam.K, [[integral(EI, a, b) for b in curvatures] for a in curvatures], rtol=1e-14)
    assert_allclose(beam.s, [integral(mu, a) for a in shapes], rtol=1e-14)
    assert_allclose(beam.p, [integral(mu, a, (0, 1)) for a in shapes], rtol=1e-14)


def test_element_functions_reproduce_rigid_motions():
    h, s = 0.3, np.linspace(0, 1, 7)
    translation, rotation = [1, 0, 1, 0], [0, 1, h, 1]
    assert_allclose(shape_functions(s, h) @ translation, np.ones(7), atol=1e-15)
    assert_allclose(shape_functions(s, h) @ rotation, h * s, atol=1e-15)
    assert_allclose(shape_functions(s, h, 1) @ rotation, np.ones(7), atol=1e-14)
    assert_allclose(shape_functions(s, h, 2) @ rotation, np.zeros(7), atol=1e-13)


# Shape functions over the mesh


@pytest.mark.parametrize("frame", FRAMES)
def test_shapes_are_the_hermite_spline_through_the_nodal_values(frame):
    """SciPy's spline through the same deflections and slopes, at points that include nodes and both ends."""
    beam = stepped_tapered_beam(frame)
    e = np.random.default_rng(1).normal(size=beam.M.shape[0])
    nodal = {"w": np.zeros(len(beam.nodes)), "slope": np.zeros(len(beam.nodes))}
    for node, kind, value in zip(beam.dof_nodes, beam.dof_kinds, e, strict=True):
        nodal[kind][node] = value
    spline = CubicHermiteSpline(beam.nodes, nodal["w"], nodal["slope"])
    x = np.union1d(beam.nodes, np.linspace(0, beam.length, 23))
    for order, shapes in enumerate([beam.shape, beam.slope, beam.curvature, beam.third_derivative]):
        expected = spline(x, order)
        assert_allclose(shapes(x) @ e, expected, rtol=0, atol=1e-13 * abs(expected).max())
        assert_allclose(shapes(0.4) @ e, spline(0.4, order), rtol=1e-12)


def test_reference_conditions_and_coordinate_names():
    clamped, chord = uniform_beam(2), uniform_beam(2, "chord")
    assert clamped.dof_names == ("w1", "slope1", "w2", "slope2")
    assert chord.dof_names == ("slope0", "w1", "slope1", "slope2")
    assert not clamped.shape(0).any()
    assert not clamped.slope(0).any()
    assert not chord.shape([0, 1]).any()


# Integrals


@pytest.mark.parametrize("frame", FRAMES)
def test_integrals_of_a_stepped_tapered_beam_agree_with_adaptive_quadrature(frame):
    beam = stepped_tapered_beam(frame)
    S, slope, curvature = beam.shape, beam.slope, beam.curvature

    def mass_per_length(x):
        xi = x - 0.55
        return 2 - 1.5 * x + 0.3 * x**2 if x < 0.55 else 0.9 - 0.2 * xi + 0.1 * xi**3

    def EI(x):
        xi = x - 0.55
        return (
            30 - 20 * x + 5 * x**2 - x**3 if x < 0.55 else 12 - 9 * xi + 4 * xi**2 - 2 * xi**3 + 0.5 * xi**4
        )

    def integral(f):
        return quad_vec(f, 0, 1.3, points=[0.4, 0.55, 0.7, 0.75], epsabs=1e-13, epsrel=1e-13)[0]

    def over_mass(f):
        return integral(lambda x: mass_per_length(x) * f(x)) + 0.5 * f(0.3) + 0.2 * f(1.0)

    def over_inertia(f):
        return 0.02 * f(0.3) + 0.01 * f(1.0)

    exact = {"rtol": 1e-12, "atol": 1e-12}
    assert_allclose(beam.mass, over_mass(lambda x: 1), **exact)
    assert_allclose(beam.first_moment, over_mass(lambda x: x), **exact)
    assert_allclose(beam.inertia, over_mass(lambda x: x**2) + over_inertia(lambda x: 1), **exact)
    assert_allclose(beam.s, over_mass(S), **exact)
    assert_allclose(beam.p, over_mass(lambda x: x * S(x)) + over_inertia(slope), **exact)
    rotary = over_inertia(lambda x: np.outer(slope(x), slope(x)))
    assert_allclose(beam.M, over_mass(lambda x: np.outer(S(x), S(x))) + rotary, **exact)
    stiffness = integral(lambda x: EI(x) * np.outer(curvature(x), curvature(x)))
    assert_allclose(beam.K, stiffness, rtol=1e-12, atol=1e-14 * stiffness.max())
    assert_allclose(beam.bending_stiffness([0.2, 0.55, 1.3]), [EI(0.2), EI(0.55), EI(1.3)], **exact)


def test_both_frames_describe_the_same_beam():
    """One motion, in the clamped frame at rest and in the chord frame that turns, has the same energies."""
    clamped, chord = stepped_tapered_beam("clamped"), stepped_tapered_beam("chord")
    e = np.random.default_rng(2).normal(size=len(clamped.s))
    turn = clamped.shape(clamped.length) @ e / clamped.length
    x = chord.nodes[chord.dof_nodes]
    w, slope = clamped.shape(x) @ e - turn * x, clamped.slope(x) @ e - turn
    e_chord = np.where(np.array(chord.dof_kinds) == "w", w, slope)
    kinetic = chord.inertia * turn**2 + 2 * turn * chord.p @ e_chord + e_chord @ chord.M @ e_chord
    assert_allclose(kinetic, e @ clamped.M @ e, rtol=1e-12)
    assert_allclose(e_chord @ chord.K @ e_chord, e @ clamped.K @ e, rtol=1e-12)


# Statics


@pytest.mark.parametrize("n", [1, 3])
def test_cantilever_under_an_end_force_is_exact(n):
    """w = F x^2 (3L - x) / 6EI: a cubic, which any mesh holds exactly."""
    L, EI, F = 0.8, 3.0, 2.0
    beam = uniform_beam(n, length=L, EI=EI)
    e = np.linalg.solve(beam.K, F * beam.shape(L))
    x = np.linspace(0, L, 9)
    assert_allclose(beam.shape(x) @ e, F * x**2 * (3 * L - x) / (6 * EI), atol=1e-14)
    assert_allclose(EI * beam.curvature(x) @ e, F * (L - x), atol=1e-12)
    assert_allclose(EI * beam.third_derivative(x) @ e, np.full(9, -F), rtol=1e-11)


def test_cantilever_under_a_uniform_load_on_part_of_it_has_exact_end_deflection():
    """Sum of end deflections F a^2 (3L - a) / 6EI over a in [x0, x1]; cubic elements are exact at nodes."""
    L, EI, x0, x1 = 0.8, 3.0, 0.15, 0.7
    beam = uniform_beam(3, length=L, EI=EI)
    length, moment, S = beam.load_moments(x0, x1)
    assert_allclose([length, moment], [x1 - x0, (x1**2 - x0**2) / 2])
    deflection = ((L * x1**3 - x1**4 / 4) - (L * x0**3 - x0**4 / 4)) / (6 * EI)
    assert_allclose(beam.shape(L) @ np.linalg.solve(beam.K, S), deflection, rtol=1e-13)


# Frequencies and modes

CLAMPED_FREE = [1.87510406871, 4.69409113297, 7.85475743824, 10.9955407349]  # roots of cos z cosh z = -1


@pytest.mark.parametrize(
    ("frame", "exact"), [("clamped", CLAMPED_FREE), ("chord", np.pi * np.arange(1, 5))], ids=FRAMES
)
def test_frequencies_are_those_of_the_cantilever_and_of_the_pinned_beam(frame, exact):
    """omega = (beta L)^2 sqrt(EI / mu L^4); the elements add the relative error (beta h)^4 / 1440."""
    L, mass, EI = 0.8, 0.3, 5.0
    omega = frequencies(uniform_beam(32, frame, L, mass, EI))[:4]
    relative_error = omega / (np.square(exact) * np.sqrt(EI / (mass * L**3))) - 1
    assert_allclose(relative_error, np.array(exact) ** 4 / 32**4 / 1440, rtol=0.03)


@pytest.mark.parametrize(
    ("frame", "exact"), [("clamped", CLAMPED_FREE), ("chord", np.pi * np.arange(1, 5))], ids=FRAMES
)
def test_frequencies_converge_with_order_four(frame, exact):
    errors = [frequencies(uniform_beam(n, frame))[:2] / np.square(exact[:2]) - 1 for n in (8, 16)]
    order = np.log2(errors[0] / errors[1])
    assert np.all((order > 3.9) & (order < 4.1)), order


def test_cantilever_with_an_end_mass_has_the_exact_frequency():
    """1 + cos z cosh z + r z (cos z sinh z - sin z cosh z) = 0 with r the end mass over the beam's mass."""
    r = 2.5
    z = brentq(
        lambda z: 1 + np.cos(z) * np.cosh(z) + r * z * (np.cos(z) * np.sinh(z) - np.sin(z) * np.cosh(z)),
        0.5,
        1.8,
    )
    omega = frequencies(uniform_beam(16, point_masses=[(1, r, 0)]))
    assert_allclose(omega[0], z**2, rtol=1e-8)


@pytest.mark.parametrize("frame", FRAMES)
@pytest.mark.parametrize("grading", [1, 3], ids=["even", "graded"])
def test_modal_basis_of_256_elements_is_orthonormal_and_keeps_the_low_frequencies(frame, grading):
    """Highest and lowest omega^2 are a factor 1e11 (even) or 1e19 (graded) apart."""
    nodes = np.linspace(0, 1, 257) ** grading
    beam = floating_beam([Piece(0, 1, (1,), (1,))], nodes, frame)
    Psi, omega2 = beam.modal_basis()
    assert abs(Psi.T @ beam.M @ Psi - np.eye(512)).max() < 1e-12
    assert abs(Psi.T @ beam.K @ Psi - np.diag(omega2)).max() < 1e-13 * omega2[-1]
    assert np.all(np.diff(omega2) > 0)
    if grading == 1:
        exact = CLAMPED_FREE[0] if frame == "clamped" else np.pi
        assert_allclose(np.sqrt(omega2[0]), exact**2, rtol=1e-9)


def test_modal_signs_do_not_hang_on_round_off():
    """Modes of a symmetric beam have largest values of both signs; a mass of 1e-13 on one side flips none."""
    beam = uniform_beam(12, "chord")
    Psi, _ = beam.modal_basis()
    for x in (0.1, 0.9):
        nudged, _ = uniform_beam(12, "chord", point_masses=[(x, 1e-13, 0)]).modal_basis()
        assert_allclose(np.diag(Psi.T @ beam.M @ nudged), np.ones(24), rtol=1e-12)


# Any mesh

nodes_of_any_mesh = st.lists(st.floats(0.05, 1), min_size=1, max_size=8).map(lambda h: np.cumsum([0.0, *h]))


@settings(deadline=None)
@given(
    nodes=nodes_of_any_mesh,
    frame=st.sampled_from(FRAMES),
    step=st.floats(0.05, 0.95),
    taper=st.floats(-0.9, 2),
)
def test_matrices_are_symmetric_positive_definite_on_any_mesh(nodes, frame, step, taper):
    end = nodes[-1]
    middle = step * end
    pieces = [Piece(0, middle, (1, taper / end), (3, taper / end)), Piece(middle, end, (0.1,), (20,))]
    beam = floating_beam(pieces, nodes, frame)
    for matrix in (beam.M, beam.K):
        assert np.array_equal(matrix, matrix.T)
        d = 1 / np.sqrt(np.diag(matrix))
        assert np.linalg.eigvalsh(matrix * np.outer(d, d)).min() > 0
    Psi, omega2 = beam.modal_basis()
    assert omega2.min() > 0
    assert_allclose(Psi.T @ beam.M @ Psi, np.eye(len(beam.s)), atol=1e-12)


# Bad input

steel = Piece(0, 1, (1,), (1,))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([Piece(0, 1, (0,), (1,))], [0, 1]), "needs a positive mass per length"),
        (([Piece(0, 1, (0,), (1,))], [0, 1], "clamped", [(1, 2, 0)]), "needs a positive mass per length"),
        (([Piece(0, 1, (1, -2), (1,))], [0, 1]), "must not be negative"),
        (([Piece(0, 1, (1,), (0,))], [0, 1]), "bending stiffness must be positive"),
        (([Piece(0, 1, (1,), (1,), None, (0,))], [0, 1]), "shear stiffness must be positive"),
        (
            ([Piece(0, 1, (1,), (1,), (0.1,)), Piece(1, 2, (1,), (1,))], [0, 2]),
            "must have rotary inertia, or none",
        ),
        (([steel], [0, 0.7, 0.6, 1]), "increasing positions"),
        (([steel], [0.1, 1]), "the first of them 0"),
        (([steel], [0, 2]), "without gaps"),
        (([Piece(0, 0.4, (1,), (1,)), Piece(0.5, 1, (1,), (1,))], [0, 1]), "without gaps"),
        (([steel], [0, 1], "hinged"), "clamped, chord, not 'hinged'"),
        (([steel], [0, 1], "clamped", [(1.2, 1, 0)]), "point mass 1.2 m is not on the beam"),
    ],
)
def test_what_is_not_a_beam_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        floating_beam(*arguments)


def test_positions_off_the_beam_are_refused():
    beam = uniform_beam(2)
    for x in (-0.1, 1.1, float("nan")):
        with pytest.raises(ValueError, match="not on the beam"):
            beam.shape(x)
    with pytest.raises(ValueError, match="before its start"):
        beam.load_moments(0.6, 0.4)
