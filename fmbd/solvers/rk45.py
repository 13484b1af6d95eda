"""The explicit Runge-Kutta method of order 5 by Dormand and Prince (1980), the pair behind ode45.

Coefficients: J. R. Dormand, P. J. Prince, A family of embedded Runge-Kutta formulae, J. Comput. Appl. Math. 6 (1980);
dense output: L. F. Shampine (1986), as in Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, code
DOPRI5. Use it at loose tolerances, and to compare with what others computed by ode45.
"""

from fmbd.solvers.tableau import tableau

C = (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0)
A = (
    (),
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
B = (*A[-1], 0.0)
E = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)
D = (
    (
        -12715105075 / 11282082432,
        0.0,
        87487479700 / 32700410799,
        -10690763975 / 1880347072,
        701980252875 / 199316789632,
        -1453857185 / 822651844,
        # the stage at the end of the step is f(y1) itself, the last column
        0.0,
        69997945 / 29380423,
    ),
)

RK45 = tableau(5, C, A, B, (E,), (), D)
