"""Start-up of a DC motor with inductance, its shaft rigid: Modelica Standard Library, DCPM_Start."""

import numpy as np
from numpy.testing import assert_allclose
from simulation import at, columns, simulate

# t, current, angle, speed; recomputed to convergence. The library's own result, of tolerance 1e-6, is
# 99.97434664 A, 210.2259837 rad, 149.2278453 rad/s at t = 2.
TABLE = np.array([
    [0.5, 91.91527753, 6.70804453, 51.63636997],
    [1.0, 92.52738554, 57.06912626, 149.81253737],
    [1.1, -6.93111527, 72.68921946, 158.51842197],
    [1.5, 0.0208520346, 135.558010, 157.077829],
    [1.6, 107.486324, 150.57553555, 147.67129337],
    [2.0, 99.97436343, 210.22598367, 149.22784375],
])  # fmt: skip


def test_start_up_of_a_dc_motor():
    """Ramp of voltage from 0.2 to 1 s, load torque from 1.5 s on: the steps land on the kinks."""
    run = simulate("dc_motor.yaml", {"simulation.rtol": 1e-10})
    found = columns(run, "motor.current", "shaft.angle", "shaft.angle.rate")
    # the table has 9 digits, at t = 1.5 s fewer
    assert_allclose(found[at(run, TABLE[:, 0])], TABLE[:, 1:], rtol=5e-9, atol=1e-8)


def test_rotor_turns_with_the_shaft():
    run = simulate("dc_motor.yaml")
    assert_allclose(run["motor.rotor"], run["shaft.angle"], rtol=0, atol=1e-10)
