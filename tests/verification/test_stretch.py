"""Beams that stretch: axial flexibility lumped where their segments meet, against extensible rods and beams.

A joint between two segments has what the halves beside it would stretch by: all converges with the square of the
number of segments, and what pulls evenly along the beam stretches it exactly.
"""

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fmbd
from fmbd.analyses import natural_frequencies
from fmbd.analyses.structure import mobility
from fmbd.errors import ModelError
from fmbd.model import load_model_text
from fmbd.system.matrices import gravity_compensation

ROOT = "{root: {type: weld, between: [ground.origin, rod.start]}}"


def rod(segments, EA=2.0e5, EI=50.0, length=2.0, m=3.0, joints=ROOT, shear="false", more=""):
    """A beam in so many segments of one element, held at its start."""
    return load_model_text(f"""
fmbd: 1
bodies:
  rod: {{type: beam, length: {length}, elements: {segments}, segments: {segments}, mass_per_length: {m},
         bending_stiffness: {EI}, stretch: {EA}, shear: {shear}, foreshortening: true,
         damping: {{stiffness_proportional: 1e-4}}}}
joints: {joints}
{more}
simulation: {{duration: 1}}
""")


def end_at_rest(model, **how):
    """Displacement of the end of the rod at rest, along and across [m]."""
    return fmbd.equilibrium(model, **how)["rod.end.position"] - [model.bodies["rod"].length, 0.0]


def orders(values, exact):
    """Observed order in h from one number of segments to twice as many."""
    errors = np.abs(np.array(values) - exact)
    return [np.log2(coarse / fine) for coarse, fine in pairwise(errors)]


@pytest.mark.parametrize("segments", [2, 3, 7])
def test_an_even_pull_is_exact(segments):
    """F L / E A, whatever the number of segments; and that is the force that is found in the beam."""
    pull = "loads: {pull: {type: force, at: rod.end, force: [700, 0]}}"
    rest = fmbd.equilibrium(rod(segments, more=pull))
    assert_allclose(rest["rod.end.position"], [2.0 + 700 * 2 / 2e5, 0.0], atol=1e-10)
    assert_allclose(rest["rod.axial_force"], 700.0, rtol=1e-9)


def test_a_taper_stretches_by_its_compliance():
    """int dx / E A of a bar whose area grows linearly from A to 3 A: L ln 3 / (2 E A)."""
    model = load_model_text("""
fmbd: 1
materials: {foam: {density: 100, youngs_modulus: 1e7}}
sections:
  thin: {type: rectangle, width: 0.01, height: 0.1}
  wide: {type: rectangle, width: 0.03, height: 0.1}
bodies:
  rod: {type: beam, length: 2, elements: 6, segments: 3, material: foam, stretch: true,
        section: {start: thin, end: wide}}
joints: {root: {type: weld, between: [ground.origin, rod.start]}}
loads: {pull: {type: force, at: rod.end, force: [5, 0]}}
simulation: {duration: 1}
""")
    assert_allclose(end_at_rest(model), [5 * 2 * np.log(3) / (2 * 1e4), 0.0], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("segments", [2, 5])
def test_a_rod_under_its_own_weight(segments):
    """m g L^2 / (2 E A) at the end, exact since the errors of the first and the last joint cancel."""
    found = end_at_rest(rod(segments, more="gravity: [9.81, 0]"))[0]
    assert_allclose(found, 3.0 * 9.81 * 2.0**2 / (2 * 2e5), rtol=1e-9)


def test_axial_frequencies():
    """(2 k - 1) pi / 2 sqrt(E A / m) / L of a rod fixed at one end, order 2 or better; damped by beta omega / 2."""
    exact = (2 * np.arange(1, 3) - 1) * np.pi / 2 * np.sqrt(2e5 / 3) / 2.0 / (2 * np.pi)
    found = []
    for n in (8, 16, 32):
        # so stiff against bending that what is slow moves along
        frequencies = natural_frequencies(fmbd.assemble(rod(n, EI=1e9)))
        found.append(frequencies[frequencies > 0][:2])
    for series, frequency in zip(np.transpose(found), exact, strict=True):
        assert min(orders(series, frequency)) > 1.9
    assert_allclose(found[-1], exact, rtol=3e-3)
    first = fmbd.modes(rod(32, EI=1e9), about="start")
    lowest = np.argmin(np.where(first.frequencies > 0, first.frequencies, np.inf))
    assert_allclose(first.damping_ratios[lowest], 1e-4 / 2 * 2 * np.pi * first.frequencies[lowest], rtol=1e-6)


def test_a_rod_that_spins_stretches():
    """u(L) = tan(a L) / a - L with a = W sqrt(m / E A), the force following what is stretched already.

    code_aster V3.04.104, centrifugal stretch with the stretched radius.
    """
    spin = '{root: {type: revolute, between: [ground.origin, rod.start], driven: "40*t"}}'
    found = [end_at_rest(rod(n, EI=1e4, joints=spin), moving=True)[0] for n in (4, 8, 16, 32)]
    a = 40 * np.sqrt(3.0 / 2e5)
    exact = np.tan(2 * a) / a - 2
    assert exact > 0.01
    assert_allclose(orders(found, exact)[-1], 2.0, atol=0.1)
    assert_allclose((4 * found[-1] - found[-2]) / 3, exact, rtol=2e-4)


EI, EA = 2.07e11 * 0.1 * 0.5**3 / 12, 2.07e11 * 0.05
# length, EI, EA, kappa G A (0: rigid), force; displacements of the end along and across
CANTILEVERS = {
    # J. Gerstmayr, H. Irschik, Journal of Sound and Vibration 318, 2008, pp. 461-487, as Exudyn's tests have it
    "Gerstmayr-Irschik": (2.0, 1.725e6, 2.07e9, 0, 1.29375e6, (-0.5085373043259, -1.2072398545498)),
    # M. Geradin, A. Cardona, Flexible Multibody Dynamics, 2001: 2.159 and 0.596; the boundary value problem solved, and
    # without shear
    "Geradin-Cardona, shear": (5.0, 9.346e6, 4.8e8, 3.231e8, 6e5, (-0.5964713, -2.1596939)),
    "Geradin-Cardona": (5.0, 9.346e6, 4.8e8, 0, 6e5, (-0.5938804, -2.1537615)),
    # K. Nachbagauer, A. Pechstein, H. Irschik, J. Gerstmayr, Multibody System Dynamics 26, 2011: the boundary value
    # problem solved with kappa = 10 (1 + nu) / (12 + 11 nu), nu = 0.3, and without shear
    "Nachbagauer, shear": (
        2.0,
        EI,
        EA,
        EA / 2 * 10 / (12 + 11 * 0.3),
        6.25e7,
        (-0.1509711442, -0.7105685979),
    ),
    "Nachbagauer": (2.0, EI, EA, 0, 6.25e7, (-0.1413466116, -0.6825717949)),
}


@pytest.mark.parametrize("name", CANTILEVERS)
def test_large_deflections_of_extensible_cantilevers(name):
    """A dead force across the tip, extrapolated."""
    length, EI, EA, kGA, force, exact = CANTILEVERS[name]
    shear = f"{{shear_stiffness: {kGA}}}" if kGA else "false"
    push = f"loads: {{push: {{type: force, at: rod.end, force: [0, {-force}]}}}}"
    # where a beam shears, segments much shorter than its height have hardly a mass of their own
    finest = 8 if name == "Nachbagauer, shear" else 32
    found = [end_at_rest(rod(n, EA, EI, length, shear=shear, more=push)) for n in (finest // 2, finest)]
    at = (8 / finest) ** 2 * 1.6e-5 * length
    assert_allclose((4 * found[-1] - found[-2]) / 3, exact, rtol=0, atol=at)
    assert_allclose(found[-1], exact, rtol=0, atol=4 * at)
    # what does not stretch is elsewhere
    stiff = end_at_rest(rod(finest, 1e6 * EA, EI, length, shear=shear, more=push))
    assert np.abs(stiff - exact).max() > 2e-4 * length


def test_energy_of_a_rod_let_go():
    """Pulled by gravity that sets in at once: it swings along by twice its sag, and no energy is lost."""
    model = rod(8, more="gravity: [9.81, 0]").with_("bodies.rod.damping.stiffness_proportional", 0.0)
    run = fmbd.simulate(model.with_("simulation.duration", 0.05).with_("simulation.rtol", 1e-9))
    assert np.abs(run["energy.balance"]).max() < 1e-8 * run["energy.elastic"].max()
    sag = end_at_rest(model)[0]
    assert_allclose((run["rod.end.position"][:, 0] - 2.0).max(), 2 * sag, rtol=0.05)


def test_it_needs_segments():
    with pytest.raises(ModelError, match=r"bodies\.rod\.stretch: .*needs 'segments', 2 or more"):
        rod(1)


FOUR_BAR = """
fmbd: 1
gravity: [0, -9.81]
bodies:
  crank: {{type: beam, length: 0.5, {how}}}
  rod: {{type: beam, length: 2, {how}}}
  rocker: {{type: beam, length: 1, {how}}}
joints:
  a: {{type: revolute, between: [ground.origin, crank.start]}}
  b: {{type: revolute, between: [crank.end, rod.start]}}
  c: {{type: revolute, between: [rod.end, rocker.end]}}
  d: {{type: revolute, between: [ground.pivot, rocker.start]}}
ground: {{points: {{pivot: [2, 0]}}}}
motors: {{m: {{type: torque, joint: a, torque: 0}}}}
initial: {{joints: {{a: 1.0}}, rates: {{a: 2.0}}}}
simulation: {{duration: 0.01}}
"""


def test_a_loop_starts_as_if_nothing_stretched():
    """Loops are closed by joints, not by beams; so are torques against gravity found."""
    how = "elements: 2, segments: 2, mass_per_length: 1, bending_stiffness: 100, stretch: "
    stiff, soft = (fmbd.assemble(load_model_text(FOUR_BAR.format(how=how + EA))) for EA in ("false", "1e6"))
    places = [system.reference.stations(system.start.q)[0] for system in (stiff, soft)]
    assert_allclose(places[1], places[0], atol=1e-9)
    slides = [k for k, name in enumerate(soft.coordinate_names) if ".stretch" in name]
    assert len(slides) == 3
    assert_allclose(soft.start.q[slides], 0.0, atol=1e-15)
    assert_allclose(soft.start.v[slides], 0.0, atol=1e-15)
    torques = [gravity_compensation(system, system.start.q) for system in (stiff, soft)]
    assert_allclose(torques[1], torques[0], rtol=1e-9)
    assert mobility(soft).rigid == mobility(stiff).rigid == 1


@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_momentum_of_a_beam_that_flies_and_stretches(mass):
    """Momenta stay what they were, with a mass where segments meet and slide; nothing pulls at the free end."""
    model = load_model_text(f"""
fmbd: 1
bodies:
  rod: {{type: beam, length: 2, elements: 4, segments: 4, mass_per_length: 3, bending_stiffness: 50, stretch: 2000,
         foreshortening: true, mass: {mass}, points: {{seam: 1}}, point_masses: {{seam: 2}}}}
joints: {{float: {{type: free, between: [ground.origin, rod.start]}}}}
initial: {{rates: {{float: {{x: 1, y: 2, angle: 3}}}}}}
simulation: {{duration: 0.5, rtol: 1e-10}}
""")
    run = fmbd.simulate(model)
    assert np.ptp(run["rod.stretch2.x"]) > 1e-3
    for quantity in ("rod.momentum", "rod.angular_momentum"):
        values = run[quantity]
        assert_allclose(values, values[[0] * len(values)], rtol=0, atol=2e-6)
    if mass == "consistent":
        assert np.abs(run["rod.start.axial_force"]).max() < 1e-6 * np.abs(run["rod.axial_force"]).max()
