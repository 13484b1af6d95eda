"""Degrees of freedom, redundant constraints, natural frequencies and the steps that they ask for."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from numpy.testing import assert_allclose
from scipy.linalg import eigh, null_space

from fmbd.analyses import longest_step, mobility, natural_frequencies
from fmbd.errors import AnalysisError
from fmbd.model import load_model, load_model_text
from fmbd.solvers.tableau import tableau
from fmbd.system import assemble

FIVE_BAR = Path(__file__).parents[2] / "models" / "five_bar.yaml"
FOUR_BARS = FIVE_BAR.with_name("four_bars.yaml")


def build(**parts):
    return assemble(load_model_text(yaml.safe_dump({"fmbd": 1, **parts}, sort_keys=False)))


def crank(length=0.5):
    return {"type": "rigid", "mass": 1, "inertia": 0.1, "points": {"end": [length, 0]}}


def revolute(a, b):
    return {"type": "revolute", "between": [a, b]}


def table_on_cranks():
    """A table on three parallel cranks of one length: two would do."""
    feet = {f"foot{k}": revolute(f"ground.F{k}", f"crank{k}.origin") for k in range(3)}
    heads = {f"head{k}": revolute(f"crank{k}.end", f"table.H{k}") for k in range(3)}
    table = {"type": "rigid", "mass": 1, "inertia": 0.1, "points": {f"H{k}": [k, 0] for k in range(3)}}
    return build(
        ground={"points": {f"F{k}": [k, 0] for k in range(3)}},
        bodies={f"crank{k}": crank() for k in range(3)} | {"table": table},
        joints=feet | heads,
        initial={"joints": {"foot0": 1.0}},
    )


def test_freedom_of_the_five_bar():
    """Four joints, two rotors and two deflections and slopes, less the two constraints of the effector. As a
    mechanism of rigid links it has two degrees of freedom (Gruebler: 3 x 4 bodies - 2 x 5 joints)."""
    found = mobility(assemble(load_model(FIVE_BAR)))
    assert found.coordinates == 10
    assert found.degrees_of_freedom == 8
    assert found.rigid == 2
    assert found.redundant == ()


def test_one_crank_too_many_is_named():
    """The third crank can only repeat what the first two say of the table's height and tilt."""
    found = mobility(table_on_cranks())
    assert found.degrees_of_freedom == 1
    [redundancy] = found.redundant
    assert redundancy.constraint == "head2.y"
    assert set(redundancy.follows_from) == {"head1.x", "head1.y", "head2.x"}


def test_a_second_weld_is_redundant_whole():
    weld = {"type": "weld", "between": ["ground.origin", "base.origin"]}
    found = mobility(
        build(
            bodies={"base": crank(), "arm": crank()},
            joints={"first": weld, "second": weld, "hinge": revolute("base.end", "arm.origin")},
        )
    )
    assert found.degrees_of_freedom == 1
    assert [(r.constraint, r.follows_from) for r in found.redundant] == [
        ("second.x", ()),
        ("second.y", ()),
        ("second.angle", ()),
    ]


def test_freedom_grows_at_a_singular_position():
    """Two parallelograms that lie flat: all x constraints are lost, and each could fold into the other mode."""
    system = assemble(load_model(FOUR_BARS))
    assert mobility(system).degrees_of_freedom == 1
    assert mobility(system, np.zeros(5)).degrees_of_freedom == 3


def bolted(point, angle):
    """A bracket bolted to a flying body that swings on a spring, at a point and angle; its own point q is where
    the flying body's origin is, q's frame along that of the point."""
    body = {"type": "rigid", "mass": 1, "inertia": 0.1}
    c, s = np.cos(angle), np.sin(angle)
    back = [float(-c * point[0] - s * point[1]), float(s * point[0] - c * point[1])]
    return {
        "carrier": body | {"points": {"p": {"at": list(point), "angle": angle}}},
        "bracket": body | {"points": {"q": {"at": back, "angle": -angle}}},
    }


@pytest.mark.parametrize("turn", [0, 0.1, 0.4, 0.9, 2])
@pytest.mark.parametrize("point", [(0.1, 0.05), (0.3, 0.1), (0.6, 0.35)])
def test_round_off_is_no_constraint(point, turn):
    """Carrier and bracket are one body that hangs on a spring along x: a slot between them holds nothing, although
    5e-17 is left in its row. Motions: omega^2 = k (1/m + y^2 / J) of a body pulled at y from its centre of mass, and
    twice 0."""
    system = build(
        ground={"points": {"far": [-3, 0]}},
        bodies=bolted(point, 0.7),
        joints={
            "fly": {"type": "free", "between": ["ground.origin", "carrier.origin"]},
            "bolt": {"type": "weld", "between": ["carrier.p", "bracket.origin"]},
            "slot": {"type": "pin_in_slot", "between": ["carrier.origin", "bracket.q"], "cut": True},
        },
        springs={
            "s": {"type": "point_to_point", "between": ["ground.far", "carrier.origin"], "stiffness": 18}
        },
        initial={"joints": {"fly": {"x": 0.2, "angle": turn}}},
    )
    found = mobility(system)
    assert found.degrees_of_freedom == 3
    assert [(r.constraint, r.follows_from) for r in found.redundant] == [("slot.y", ())]
    y = (point[0] * np.sin(turn) + point[1] * np.cos(turn)) / 2
    J = 0.2 + (point[0] ** 2 + point[1] ** 2) / 2
    omega = np.sqrt(18 * (1 / 2 + y**2 / J))
    assert_allclose(2 * np.pi * natural_frequencies(system), [0, 0, omega], atol=1e-12)


@pytest.mark.parametrize("turn", [0, 0.1, 0.4, 0.9, 2])
def test_a_hinge_that_is_there_twice(turn):
    """The bracket comes back to the carrier's hinge: a second hinge there has levers of round-off, and holds nothing.

    omega^2 = k / J about the hinge; J = 2 I + m |p|^2, of which the bracket's mass is at p.
    """
    system = build(
        bodies=bolted((0.3, 0.4), 0.7),
        joints={
            "hinge": revolute("ground.origin", "carrier.origin") | {"spring": {"stiffness": 9}},
            "bolt": {"type": "weld", "between": ["carrier.p", "bracket.origin"]},
            "again": revolute("ground.origin", "bracket.q") | {"cut": True},
        },
        initial={"joints": {"hinge": turn}},
    )
    found = mobility(system)
    assert found.degrees_of_freedom == 1
    assert [r.constraint for r in found.redundant] == ["again.x", "again.y"]
    assert_allclose(2 * np.pi * natural_frequencies(system), np.sqrt(9 / (0.2 + 0.25)), rtol=1e-12)


@pytest.mark.parametrize("elements", [1, 3])
def test_frequencies_are_those_of_mass_and_stiffness_matrix(elements):
    """Generalised eigenvalues of K and M on the motions that Phi_q allows; two motions are free."""
    system = assemble(load_model(FIVE_BAR, {"bodies.*.elements": elements}))
    m = system.matrices()
    N = null_space(m.Phi_q)
    omega2 = eigh(N.T @ m.K @ N, N.T @ m.M @ N, eigvals_only=True)
    found = natural_frequencies(system)
    assert_allclose(found[2:], np.sqrt(omega2[2:]) / (2 * np.pi), rtol=1e-10)
    assert_allclose(found[:2], 0, atol=0)


def test_low_frequencies_survive_high_ones():
    """Rotors locked, 100 elements a rod, whose highest frequency is 1.4 MHz: the first are those of the continuum.

    The discretisation leaves 5e-10 Hz in the lowest; eigenvalues of K and M would miss it by 1e-7 Hz. Source of the
    numbers: exact functions of the beam, computed for this project by another program.
    """
    spring = {"stiffness": 5000}
    locked = {
        "motors": {},
        "controllers": {},
        "joints.shoulder_right.spring": spring,
        "joints.shoulder_left.spring": spring,
        "bodies.*.elements": 100,
    }
    found = natural_frequencies(assemble(load_model(FIVE_BAR, locked)))
    continuum = [17.3832634601, 21.5283483340, 28.0668659431, 28.5029329125, 111.4177309997, 111.9319859889]
    assert_allclose(found[:6], continuum, rtol=2e-8)
    assert_allclose(found[0], continuum[0], rtol=0, atol=1e-9)


def test_a_mass_on_two_springs():
    """omega^2 = k/m along each of two springs at right angles; turning is free."""
    springs = {"along": ([2, 0], 50.0), "across": ([0, 3], 8.0)}
    system = build(
        ground={"points": {name: at for name, (at, _) in springs.items()}},
        bodies={"disc": {"type": "rigid", "mass": 2.0, "inertia": 0.1}},
        joints={"loose": {"type": "free", "between": ["ground.origin", "disc.origin"]}},
        springs={
            name: {"type": "point_to_point", "between": [f"ground.{name}", "disc.origin"], "stiffness": k}
            for name, (_, k) in springs.items()
        },
    )
    assert_allclose(2 * np.pi * natural_frequencies(system), [0, 2, 5], atol=1e-12)


@pytest.mark.parametrize("rest", [{"rest_length": 0}, {}])
def test_a_spring_without_length(rest):
    """It pulls with k times the vector between its points, which coincide: omega^2 = k/m in both directions, also
    when the rest length is left to the start."""
    system = build(
        bodies={"disc": {"type": "rigid", "mass": 2.0, "inertia": 0.1}},
        joints={"loose": {"type": "free", "between": ["ground.origin", "disc.origin"]}},
        springs={
            "s": {"type": "point_to_point", "between": ["ground.origin", "disc.origin"], "stiffness": 50}
            | rest
        },
    )
    assert_allclose(2 * np.pi * natural_frequencies(system), [0, 5, 5], atol=1e-12)
    q = np.array([-3e-3, 4e-3, 0.7])
    assert_allclose(system.accelerations(q, 0 * q)[0], [25 * 3e-3, -25 * 4e-3, 0], rtol=1e-14, atol=1e-18)
    assert_allclose(system.accelerations(0 * q, 0 * q)[0], 0, atol=0)


def test_a_spring_of_no_rest_length_is_as_stiff_across():
    """Stretched along x, it holds its end back along y by the same k: omega^2 = k/m twice."""
    system = build(
        ground={"points": {"far": [3, 0]}},
        bodies={"disc": {"type": "rigid", "mass": 2.0, "inertia": 0.1}},
        joints={"loose": {"type": "free", "between": ["ground.origin", "disc.origin"]}},
        springs={
            "s": {
                "type": "point_to_point",
                "between": ["ground.far", "disc.origin"],
                "stiffness": 50,
                "rest_length": 0,
            }
        },
    )
    assert_allclose(2 * np.pi * natural_frequencies(system), [0, 5, 5], atol=1e-12)


@pytest.mark.parametrize(
    ("law", "start", "stiffness"),
    [
        ({"spring": {"stiffness": 50, "backlash": 0.2}}, 0.05, 0),
        ({"spring": {"stiffness": 50, "backlash": 0.2}}, 0.3, 50),
        ({"limits": {"upper": 0.1, "stiffness": 50}}, 0.1, 25),
        ({"spring": {"force_table": [[0, 0], [0.1, 5], [0.2, 0]]}}, 0.3, 0),
        ({"spring": {"force_table": [[0, 0], [0.1, 8]]}, "friction": {"coulomb": 1}}, 0.3, 80),
    ],
)
def test_other_laws_count_with_their_tangent(law, start, stiffness):
    """Free in the gap; half the stiffness in the middle of a transition; a force that falls holds nothing."""
    joint = {"type": "prismatic", "between": ["ground.origin", "disc.origin"]}
    system = build(
        bodies={"disc": {"type": "rigid", "mass": 2.0, "inertia": 0.1}},
        joints={"rail": joint | law},
        initial={"joints": {"rail": start}},
    )
    assert_allclose((2 * np.pi * natural_frequencies(system)) ** 2, stiffness / 2, rtol=1e-12)


def test_a_start_behind_a_stop_is_remarked():
    stops = {"lower": 0.1, "stiffness": 50}
    joint = {"type": "prismatic", "between": ["ground.origin", "disc.origin"], "limits": stops}
    disc = {"type": "rigid", "mass": 2.0, "inertia": 0.1}
    system = build(bodies={"disc": disc}, joints={"rail": joint})
    assert system.start.remarks == ("rail.x starts behind its stop, at 0",)


def test_a_coordinate_without_mass_has_no_frequency():
    massless = {"type": "rigid", "mass": 0, "inertia": 0}
    system = build(bodies={"ghost": massless}, joints={"hinge": revolute("ground.origin", "ghost.origin")})
    with pytest.raises(AnalysisError, match="moves no mass"):
        natural_frequencies(system)


def test_longest_step_of_the_classical_runge_kutta_method():
    """It is stable on the imaginary axis up to h omega = 2 sqrt 2 (Hairer, Wanner II, section IV.2)."""
    stages = ((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0))
    classical = tableau(4, (0, 0.5, 0.5, 1), stages, (1 / 6, 1 / 3, 1 / 3, 1 / 6), [(0,) * 4], (), ())
    assert_allclose(2 * np.pi * longest_step(classical, 1.0), 2 * np.sqrt(2), atol=0.005)
