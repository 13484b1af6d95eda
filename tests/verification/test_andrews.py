"""Andrews' squeezing mechanism: Test Set for IVP Solvers (F. Mazzia, C. Magherini), problem ANDREWS.

Angles and rates are those of another program, run to convergence: the published ones (PSIDE) agree with them
to 1e-10 and 1e-6. Accelerations and multipliers are the published ones, good to about 1e-6 of themselves.
"""

import pytest
from numpy.testing import assert_allclose
from simulation import at, columns, simulate

ANGLES = ["beta", "theta", "gamma", "phi", "delta", "omega", "epsilon"]
AT_30_MS = [
    15.81077119515403, -15.75637105841272, 0.04082224011963, -0.5347301163421,
    0.5244099658799517, 0.5347301163421, 1.048080741041948,
]  # fmt: skip
RATES_AT_30_MS = [
    1139.920302259102, -1424.379295177516, 11.03291191070, 19.29337410537,
    0.573569914840, -19.29337410537, 0.323179149254,
]  # fmt: skip
ACCELERATIONS_AT_30_MS = [
    -24631.76316945196, 51850.37701610329, 324102.5686413781, 566749.3645176213,
    16743.62929479361, -566749.3645176222, 9826.520791458422,
]  # fmt: skip
MULTIPLIERS_AT_30_MS = [
    199.175333373191, -29.75531228015052, 23.06654119098399,
    31.45271365475927, 22.64249232082739, 11.61740700019673,
]  # fmt: skip


@pytest.fixture(scope="module")
def run():
    return simulate("verification/andrews.yaml", {"simulation.rtol": 1e-12})


def values(run, suffix, time):
    return columns(run, *(f"{name}.angle{suffix}" for name in ANGLES))[at(run, time)]


def test_angles_and_rates_at_30_ms(run):
    assert_allclose(values(run, "", 0.03), AT_30_MS, rtol=0, atol=1e-11)
    assert_allclose(values(run, ".rate", 0.03), RATES_AT_30_MS, rtol=0, atol=1e-7)
    assert_allclose(values(run, ".acceleration", 0.03), ACCELERATIONS_AT_30_MS, rtol=2e-6)


def test_end_of_the_iftomm_library_s_run(run):
    """Problem A03 of that library is the same mechanism, for 50 ms."""
    found = dict(zip(ANGLES, values(run, "", 0.05)))
    published = {"beta": 33.82586777, "gamma": 0.11339507, "phi": -0.40785287, "epsilon": 1.05690243}
    assert_allclose([found[name] for name in published], list(published.values()), rtol=0, atol=1e-8)
    place_of_F = run["K1.F.position"][at(run, 0.05)]
    assert_allclose(place_of_F, [-0.005208504722, 0.004676695260], rtol=0, atol=1e-12)


def test_start(run):
    """Accelerations and multipliers at rest: only the torque and the spring act."""
    assert_allclose(values(run, ".acceleration", 0)[:2], [14222.44391995411, -10666.83293996559], rtol=1e-12)
    assert_allclose(values(run, ".acceleration", 0)[2:], 0, atol=1e-8)
    assert_allclose(run.multipliers[0], [98.56687039624104, -6.122688344255666, 0, 0, 0, 0], atol=1e-11)


def test_loop_forces_at_30_ms(run):
    """The multipliers are the forces at E on K3, K4 and K6."""
    assert_allclose(run.multipliers[at(run, 0.03)], MULTIPLIERS_AT_30_MS, rtol=2e-6)
