"""The linearised equations of the implicit methods against finite differences of the accelerations.

(S I - J) U = R is solved by the structured elimination; S U - J U is then formed with J U by central differences of the
compiled right-hand side, extrapolated once. They share no derivative: what is differenced knows of none.
"""

import mechanisms
import numpy as np
import pytest
from parts import SAMPLES, model
from physics import build

from fmbd.planar.equations import evaluate_accelerations
from fmbd.planar.tangent import solve_linearised
from fmbd.planar.tangent_arrays import allocate_tangent
from fmbd.system.couplings import couplings

VARIANTS = {
    "as written": lambda data: data,
    "joints reversed": mechanisms.joints_reversed,
    "chord frames": mechanisms.chord_frames,
}
# the file of a table is not there; the derivative of rows that bend is left out
LONE = [name for name in SAMPLES if "table" not in name and "foreshortened" not in name]


def mismatch(system, step, seed):
    """Largest residual of (S I - J) U = R, as a share of its terms, at a random state near the start."""
    planar, random = system.planar, np.random.default_rng(seed)
    n, nz = planar.nq, system.start.z.size
    size = np.where(system.elastic, 0.02, 1.0)
    q = system.to_modal(system.start.q) + 0.2 * random.normal(size=n) * size
    v = system.to_modal(system.start.v) + 0.5 * random.normal(size=n) * size
    z, t = np.array(system.start.z), 0.05

    def f(q, v, z):
        a, dz = np.zeros(n), np.zeros(nz)
        assert evaluate_accelerations(planar, system.work, t, q, v, z, dz, a) == -1
        return np.concatenate([v, a, dz])

    def along(u):
        dq, dv, dz = np.split(u, [n, 2 * n])

        def difference(e):
            return (f(q + e * dq, v + e * dv, z + e * dz) - f(q - e * dq, v - e * dv, z - e * dz)) / (2.0 * e)

        e = 4e-3 / np.abs(u).max()
        return (4.0 * difference(e / 2.0) - difference(e)) / 3.0

    S = 1.0 / (0.2 * step)
    rq, rv, rz = random.normal(size=n) * size, random.normal(size=n), random.normal(size=nz)
    x, dz = np.zeros(n), np.zeros(nz)
    coupled = couplings(planar)
    tangent = allocate_tangent(planar, coupled)
    f(q, v, z)
    weights = np.array([1.0 / S, 1.0, S, 1.0 / S])
    failed = solve_linearised(
        planar, coupled, system.work, tangent, q, v, weights, -rq, -S * rq - rv, np.zeros(n), rz, x, dz
    )
    assert failed == -1
    u, r = np.concatenate([x / S, x - rq, dz]), np.concatenate([rq, rv, rz])
    moved = along(u)
    terms = np.abs(np.concatenate([S * u, r, moved])).max()
    return np.abs(S * u - moved - r).max() / terms


@pytest.mark.parametrize("name", mechanisms.MECHANISMS)
@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("step", [1e-4, 1e-2])
def test_mechanisms(name, variant, step):
    system = build(VARIANTS[variant](mechanisms.MECHANISMS[name]()))
    assert max(mismatch(system, step, seed) for seed in range(3)) < 1e-6


@pytest.mark.parametrize("name", LONE)
def test_every_kind_of_part(name):
    system = build(model(SAMPLES[name]))
    # the derivative of compensation computed online is left out
    if system.planar.nq and not system.planar.online_compensation:
        assert max(mismatch(system, 1e-3, seed) for seed in range(3)) < 1e-6


def test_short_steps_of_fine_beams_lose_no_digits():
    """Rods held by a row of their own: without pivoting, all digits were lost at a step of 1e-7 s."""
    data = mechanisms.chord_frames(mechanisms.five_bar())
    for name in ("rod_right", "rod_left"):
        data["bodies"][name]["elements"] = 16
    assert mismatch(build(data), 1e-6, 1) < 1e-5


def test_a_spring_without_length_pulls_from_all_sides():
    """Its tangent is k times the unit matrix: (S^2 + k / m) U_q = S R_q + R_v, for x and y alike."""
    system = build("""
        fmbd: 1
        bodies: {ball: {type: rigid, mass: 2, inertia: 1}}
        joints: {loose: {type: free, between: [ground.origin, ball.origin]}}
        springs: {tie: {type: point_to_point, between: [ground.origin, ball.origin], stiffness: 50, rest_length: 0}}
    """)
    planar, zero = system.planar, np.zeros(3)
    coupled = couplings(planar)
    tangent = allocate_tangent(planar, coupled)
    evaluate_accelerations(planar, system.work, 0.0, zero, zero, zero[:0], np.zeros(0), np.zeros(3))
    S, x = 10.0, np.zeros(3)
    weights, force = np.array([1.0 / S, 1.0, S, 1.0 / S]), np.array([3.0, 4.0, 0.0])
    no = zero[:0]
    solve_linearised(
        planar, coupled, system.work, tangent, zero, zero, weights, zero, zero, force, no, x, no.copy()
    )
    np.testing.assert_allclose(x, force / (2.0 * S + 50.0 / S), rtol=1e-14)


def test_links_are_alive_only_between_what_they_touch():
    """In a row of four-bars, no body sees more links than those of its own loop and its neighbours'."""
    coupled = couplings(build(_row_of_four_bars(30)).planar)
    assert coupled.places["nslot"].max() <= 4


def _row_of_four_bars(loops):
    ground = {f"p{k}": [k, 0] for k in range(loops + 1)}
    bar = {"type": "rigid", "mass": 1, "inertia": 0.1}
    bodies, joints = {}, {}
    for k in range(loops + 1):
        bodies[f"crank{k}"] = bar | {"points": {"tip": [0, 1]}}
        joints[f"foot{k}"] = {"type": "revolute", "between": [f"ground.p{k}", f"crank{k}.origin"]}
    for k in range(loops):
        bodies[f"bar{k}"] = bar | {"points": {"far": [1, 0]}}
        joints[f"near{k}"] = {"type": "revolute", "between": [f"crank{k}.tip", f"bar{k}.origin"]}
        joints[f"far{k}"] = {"type": "revolute", "between": [f"crank{k + 1}.tip", f"bar{k}.far"]}
    return {"fmbd": 1, "ground": {"points": ground}, "bodies": bodies, "joints": joints}
