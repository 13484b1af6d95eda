"""The residual of the equations of motion at motions that do not obey them: what Newton's method brings to zero.

Against Lagrange's equations on whole Jacobians (fmbd.system.matrices), which know no recursion; and its linearisation
there against differences of the residual itself.
"""

import mechanisms
import numpy as np
import pytest
from numpy.testing import assert_allclose
from physics import build
from test_two_formulations import EVERYTHING, LADEN

from fmbd.planar.residual import evaluate_residual
from fmbd.planar.tangent import solve_linearised
from fmbd.planar.tangent_arrays import allocate_tangent
from fmbd.system.couplings import couplings

MODELS = {
    "everything": EVERYTHING.replace("LIMIT", "1e3"),
    "saturated": EVERYTHING.replace("LIMIT", "0.5"),
    "laden": LADEN.format(hinge="prismatic", elements=4),
    "five_bar": mechanisms.five_bar(),
    "shaper": mechanisms.shaper(),
}


def anywhere(system, random):
    """A state, accelerations and multipliers that have nothing to do with each other."""
    n, size = system.planar.nq, np.where(system.elastic, 0.02, 0.2)
    q = system.start.q + size * random.normal(size=n)
    v, a = random.normal(size=(2, n))
    return q, v, random.normal(size=len(system.states)), a, random.normal(size=len(system.constraints))


def residual(system, t, q, v, z, a, multipliers):
    """(r, z') of the compiled inverse dynamics; modal coordinates."""
    r, dz = np.zeros(q.size), np.zeros(z.size)
    system.work.reactions["multiplier"] = multipliers
    evaluate_residual(system.planar, system.work, t, q, v, z, dz, a, r)
    return r, dz


@pytest.mark.parametrize("name", MODELS)
def test_residual_is_that_of_lagrange_s_equations(name):
    system, random = build(MODELS[name]), np.random.default_rng(11)
    modal = system.to_modal
    for t in (0.0, 0.37):
        q, v, z, a, multipliers = anywhere(system, random)
        terms = system.matrices(q, v, t, z)
        applied = terms.B @ terms.u + terms.f - (terms.C + terms.D) @ v - terms.K @ q - terms.g
        expected = applied + terms.Phi_q.T @ multipliers - terms.M @ a
        # virtual work is the same in both bases
        expected = system.to_nodal(np.eye(q.size)) @ expected
        found, _ = residual(system, t, modal(q), modal(v), z, modal(a), multipliers)
        assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("name", ["everything", "five_bar", "shaper"])
@pytest.mark.parametrize("step", [1e-3, 1e-2])
def test_newton_s_step_is_exact(name, step):
    """The linearised equations undo the residual to first order: dr = -r along the step, dz' = dz / h - rz.

    But for gravity compensation that is computed online, which they leave out.
    """
    model = MODELS[name]
    if name == "everything":
        model = model.replace("{type: gravity_compensation, computed: online}", "1")
    system, random = build(model), np.random.default_rng(5)
    planar, coupled, t = system.planar, couplings(system.planar), 0.05
    q, v, z, a, multipliers = anywhere(system, random)
    q, v, a = system.to_modal(q), system.to_modal(v), system.to_modal(a)
    tangent = allocate_tangent(planar, coupled)
    r, _ = residual(system, t, q, v, z, a, multipliers)
    rz, x, dz, nothing = random.normal(size=z.size), np.zeros(q.size), np.zeros(z.size), np.zeros(q.size)
    bq, bv = 0.25 * step**2, 0.5 * step
    weights = np.array([bq, bv, 1.0, bv])
    parts = planar, coupled, system.work, tangent
    assert solve_linearised(*parts, q, v, weights, nothing, nothing, r, rz, x, dz) == -1
    change = tangent.unknown[: multipliers.size].copy()

    def along(e):
        moved = q + e * bq * x, v + e * bv * x, z + e * dz, a + e * x, multipliers + e * change
        return np.concatenate(residual(system, t, *moved))

    def difference(e):
        return (along(e) - along(-e)) / (2.0 * e)

    e = 1e-3
    found = (4.0 * difference(e / 2.0) - difference(e)) / 3.0
    expected = np.concatenate([-r, dz / bv - rz])
    assert_allclose(found[: q.size], expected[: q.size], rtol=0, atol=1e-7 * np.abs(r).max())
    assert_allclose(found[q.size :], expected[q.size :], rtol=1e-7, atol=1e-7 * np.abs(rz).max(initial=0.0))
