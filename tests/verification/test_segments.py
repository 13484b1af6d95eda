"""Beams in segments: the linear beam if it bends little, the elastica if it bends much, a beam that turns stiffens.

What is left out falls with the square of the number of segments, in even powers: twice extrapolated, h^2 and h^4 gone,
four, eight and sixteen segments give five digits and more.
"""

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fmbd
from fmbd.analyses import natural_frequencies
from fmbd.model import load_model_text

BEAM = "type: beam, length: 1, mass_per_length: 1, bending_stiffness: 1"
CANTILEVER = f"""
fmbd: 1
bodies: {{rod: {{{BEAM}, elements: 2}}}}
joints: {{root: {{type: weld, between: [ground.origin, rod.start]}}}}
simulation: {{duration: 1}}
"""


def assembled(text, segments, **changes):
    """The system of a model whose beam `rod` has so many segments of one element, or of what `changes` say."""
    model = load_model_text(
        text, overrides={"bodies.rod.elements": segments, "bodies.rod.segments": segments} | changes
    )
    return fmbd.assemble(model)


def equilibrium(system):
    """Coordinates (nq,) at which the matrices, an independent formulation, find no force."""
    q = fmbd.equilibrium(system.model).run.position[-1]
    m = system.matrices(q, np.zeros_like(q))
    assert np.abs(np.linalg.solve(m.K, m.B @ m.u + m.f - m.K @ q - m.g)).max() < 1e-12
    return q


def end_of(system, q):
    """Angle, x and y of the end of the rod."""
    position, angle, _ = system.reference.stations(q)
    k = system.station_of_place("rod.end")
    return np.array([angle[k], *position[k]])


def extrapolated(values):
    """The limit of values at h, h/2, h/4 with errors of h^2, h^4, h^6."""
    once = [(4 * fine - coarse) / 3 for coarse, fine in pairwise(values)]
    return (16 * once[1] - once[0]) / 15


# P L^2 / EI: angle, deflection, shortening of the tip, the last two by the length
ELASTICA = {
    1: (0.46135195, 0.30172077, 0.05643324),
    2: (0.78174983, 0.49345748, 0.16064172),
    5: (1.21536812, 0.71379152, 0.38762836),
    10: (1.43028554, 0.81060902, 0.55499560),
}


@pytest.mark.parametrize("order", [2, 4], ids=["linear", "foreshortened"])
@pytest.mark.parametrize("force", ELASTICA)
def test_elastica(force, order):
    """A dead force on the tip of a cantilever.

    Elliptic integrals of Bisshopp and Drucker, Quarterly of Applied Mathematics 3, 1945, pp. 272-275; the digits
    beyond theirs are those of the boundary value problem EI theta'' = -P cos(theta). Segments
    that shorten, right to second order, are right to the order 4 together.
    """
    load = {"push": {"type": "force", "at": "rod.end", "force": [0, force]}}
    angle, deflection, shortening = ELASTICA[force]
    exact = np.array([angle, 1 - shortening, deflection])
    shortening = {"bodies.rod.foreshortening": order == 4}
    systems = [assembled(CANTILEVER, k, loads=load, **shortening) for k in (4, 8, 16)]
    found = [end_of(system, equilibrium(system)) for system in systems]
    errors = np.abs(np.array(found) - exact)[:, [0, 2]]
    # with eight digits given, those of sixteen segments that shorten are too right to tell an order
    coarse = 1 if order == 2 else 0
    assert_allclose(np.log2(errors[coarse] / errors[coarse + 1]), order, atol=0.1)
    limit = extrapolated(found) if order == 2 else found[-1]
    assert_allclose(limit, exact, rtol=0, atol=1e-5)


@pytest.mark.parametrize("segments", [4, 9])
def test_an_end_moment_bends_the_beam_into_a_polygon(segments):
    """Half a circle, M = pi EI / L: the chords of k segments keep their length and are turned by pi / k each.

    The sum of k vectors of length L / k is i / (k sin(pi / 2k)), which goes to the circle's 2i / pi.
    """
    load = {"twist": {"type": "moment", "at": "rod.end", "moment": np.pi}}
    system = assembled(CANTILEVER, segments, loads=load)
    angle, x, y = end_of(system, equilibrium(system))
    assert_allclose([angle, x, y], [np.pi, 0, 1 / (segments * np.sin(np.pi / 2 / segments))], atol=1e-9)


IN_PLANE = {
    2: (3.62179696, 22.52631118),
    6: (4.26322542, 26.12904247),
    12: (5.42704928, 35.63697598),
}


@pytest.mark.parametrize("speed", IN_PLANE)
def test_a_turning_beam_stiffens(speed):
    """In-plane frequencies of a cantilever that turns about its root, no hub, in units of sqrt(EI / rho A L^4).

    Those across the plane, of A. D. Wright et al., Journal of Applied Mechanics 49, 1982, pp. 197-202, are higher by
    the speed in the square: omega_in^2 = omega_out^2 - speed^2. One linear beam gives sqrt(3.516^2 - speed^2).
    """
    turning = {
        "root": {"type": "revolute", "between": ["ground.origin", "rod.start"], "driven": f"{speed}*t"}
    }
    found, step = [], 1e-6
    for segments in (4, 8, 16):
        system = assembled(CANTILEVER, segments, joints=turning, **{"bodies.rod.elements": 16})
        still = np.zeros(system.planar.nq)
        changes = [
            system.accelerations(step * e, still)[0] - system.accelerations(-step * e, still)[0]
            for e in np.eye(still.size)
        ]
        squares = np.linalg.eigvals(-np.array(changes).T / (2 * step)).real
        found.append(np.sqrt(np.sort(squares)[:2]))
    assert_allclose(extrapolated(found), IN_PLANE[speed], rtol=1e-4)


TWO_BEAMS = """
fmbd: 1
gravity: [0, -1e-5]
materials: {foam: {density: 500, youngs_modulus: 1e7}}
sections:
  thick: {type: rectangle, width: 0.08, height: 0.04}
  thin: {type: rectangle, width: 0.08, height: 0.02}
bodies:
  rod: {type: beam, length: 0.8, nodes: [0, 0.1, 0.3, 0.35, 0.55, 0.7, 0.8], material: foam,
        section: [{until: 0.25, section: {start: thick, end: thin}}, {section: thin}],
        points: {holder: 0.3, middle: 0.5}, point_masses: {middle: {mass: 0.1, inertia: 1e-3}}}
  stick: {type: beam, length: 0.4, elements: 2, mass_per_length: 0.5, bending_stiffness: 2}
joints:
  hinge: {type: revolute, between: [ground.origin, rod.holder], spring: {stiffness: 3}}
  knee: {type: revolute, between: [rod.middle, stick.start]}
loads:
  wind: {type: distributed, "on": rod, force: [0, 1e-5], from: 0.15, to: 0.75}
simulation: {duration: 0.5, rtol: 1e-10, atol: 1e-16, output_interval: 0.05}
"""


@pytest.fixture(scope="module")
def runs():
    """Small motions of one mechanism: the beam whole and in segments, with both frames."""
    changes = {
        (segments, frame): {"bodies.rod.segments": segments, "bodies.rod.frame": frame}
        for segments in (1, 2, 3, 6)
        for frame in ("clamped", "chord")
    }
    return {
        key: fmbd.simulate(load_model_text(TWO_BEAMS, overrides=change)) for key, change in changes.items()
    }


@pytest.mark.parametrize("frame", ["clamped", "chord"])
@pytest.mark.parametrize("segments", [2, 3, 6])
def test_small_motions_are_those_of_the_whole_beam(runs, segments, frame):
    """Welded segments are the same finite elements: equal frequencies, and all outputs by their names.

    Deflections are 1e-7 of the length, and what differs is of the second order.
    """
    whole, cut = runs[1, frame], runs[segments, frame]
    f, g = natural_frequencies(whole.system), natural_frequencies(cut.system)
    assert_allclose(g[f > 0], f[f > 0], rtol=1e-9)
    for name in (
        *("rod.deflection", "rod.slope", "rod.bending_moment", "rod.shear_force", "rod.stress", "rod.angle"),
        *("rod.frame.position", "rod.frame.velocity", "rod.frame.acceleration", "rod.angular_acceleration"),
        *("rod.node3.position", "rod.end.velocity", "rod.middle.acceleration", "rod.middle.bending_moment"),
        *("rod.middle.angle", "hinge.angle", "hinge.force", "hinge.moment", "knee.force", "knee.angle.rate"),
    ):
        assert cut.columns(name) == whole.columns(name)
        assert cut.units(name) == whole.units(name)
        size = np.abs(whole[name]).max()
        assert_allclose(cut[name], whole[name], rtol=0, atol=1e-4 * size + 1e-14, err_msg=name)
    assert np.abs(whole["rod.deflection"]).max() > 1e-8


PENDULUM = f"""
fmbd: 1
gravity: [0, -9.81]
bodies: {{rod: {{{BEAM}, elements: 4, segments: 4}}}}
joints: {{hinge: {{type: revolute, between: [ground.origin, rod.start]}}}}
simulation: {{duration: 1, rtol: 1e-10, atol: 1e-10, output_interval: 5e-4}}
"""


def test_a_rope_like_pendulum_keeps_its_energy():
    """A beam that falls from the horizontal and bends to a fifth of its length; lost is what the method loses."""
    run = fmbd.simulate(load_model_text(PENDULUM))
    assert np.abs(run["rod.deflection"]).max() > 0.2
    assert np.ptp(run["energy.kinetic"]) > 1
    assert np.abs(run["energy.balance"]).max() < 1e-9


@pytest.mark.parametrize("frame", ["clamped", "chord"])
def test_frame_of_a_bent_beam(frame):
    """It passes through the start along the tangent, or through both ends; its rates are those of its place."""
    changes = {"bodies.rod.frame": frame, "simulation.output_interval": 1e-4}
    run = fmbd.simulate(load_model_text(PENDULUM, overrides=changes))
    assert_allclose(run["rod.frame.position"], run["rod.start.position"], atol=1e-15)
    deflection, slope = run["rod.deflection"], run["rod.slope"]
    zero = slope[:, 0] if frame == "clamped" else deflection[:, -1]
    assert_allclose(deflection[:, 0], 0, atol=1e-12)
    assert_allclose(zero, 0, atol=1e-12)
    assert np.abs(slope).max() > 0.2
    angle, rate = run["rod.angle"], run["rod.angular_velocity"]
    for value, change in ((angle, rate), (rate, run["rod.angular_acceleration"])):
        assert_allclose(np.gradient(value, run.time)[2:-2], change[2:-2], atol=1e-3 * np.abs(change).max())


FOUR_BAR = """
fmbd: 1
gravity: [0, -9.81]
ground: {points: {A: [0, 0], B: [1, 0]}}
bodies:
  left: {type: beam, length: 0.5, elements: 3, mass_per_length: 1, bending_stiffness: 50}
  bridge: {type: beam, length: 1, elements: 3, mass_per_length: 1, bending_stiffness: 50}
  right: {type: beam, length: 0.5, elements: 3, mass_per_length: 1, bending_stiffness: 50}
joints:
  A: {type: revolute, between: [ground.A, left.start]}
  C: {type: revolute, between: [left.end, bridge.start]}
  D: {type: revolute, between: [bridge.end, right.end]}
  B: {type: revolute, between: [right.start, ground.B]}
initial: {place: {bridge.node3: ["1 + 0.5*cos(1.3)", "0.5*sin(1.3)"]}, hints: {A: 1.3, C: -1.3}, rates: {A: 1}}
simulation: {duration: 0.01, rtol: 1e-10, atol: 1e-12}
"""


def test_loops_are_closed_where_the_model_says():
    """Beams in segments leave the tree as it is: the same joint is cut, no weld is, and points can be placed."""
    model = load_model_text(FOUR_BAR)
    whole, cut = (fmbd.simulate(m) for m in (model, model.with_("bodies.*.segments", 3)))
    assert cut.system.constraint_names == whole.system.constraint_names
    assert cut.system.tree.cut == whole.system.tree.cut
    assert cut["A.angle"][0] == pytest.approx(1.3)
    for name in (
        "bridge.end.acceleration",
        "C.force",
        "D.force",
        "A.angle.acceleration",
        "right.start.acceleration",
    ):
        assert_allclose(cut[name][0], whole[name][0], rtol=1e-9, atol=1e-9)
