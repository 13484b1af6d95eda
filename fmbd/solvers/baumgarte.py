"""The paper's scheme: constraint accelerations stabilised after Baumgarte, integrated by an explicit Runge-Kutta pair.

Instead of Phi'' = 0 the equations ask for Phi'' + 2 delta omega Phi' + omega^2 Phi = 0 (paper, equation 24), and the
steps are not projected: what the constraints are missed by is seen in the archive. The paper eliminates the
multipliers by a null-space matrix R with R^T Phi_q^T = 0; eliminating them by the Schur complement, as the recursion
does, gives the same accelerations to round-off (tests/verification/test_baumgarte.py). Use it to reproduce the paper;
`dop853` and `rk45` with projection are as fast and keep the constraints exactly.
"""

from fmbd.solvers.rk45 import RK45

BAUMGARTE = RK45
