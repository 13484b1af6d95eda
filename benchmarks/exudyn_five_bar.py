"""The five-bar robot in Exudyn, by the settings that serve it best.

What makes Exudyn fast here, each found by trying:
- its module without range checks (`sys.exudynFast`), no files, no display, no Python functions inside the loop;
- motors, gears and controllers as linear springs and dampers on coordinates, the rotors reflected to the joints: with
  gear factors in a connector its Jacobian would be wrong, and Newton's method three times slower;
- planar parts only: rigid bodies of 3 coordinates, ANCF cable elements of 4 a node with reduced integration (as exact
  here as the full one), the masses at the tips on the nodes of the beams;
- modified Newton, whose Jacobian is kept as long as it serves. A relative tolerance of 1e-5 is the fastest for rough
  runs, 1e-6 where it matters (1e-4 is no faster, and spoils the end point; a Jacobian a step doubles the time);
- generalised-alpha of index 3, spectral radius 0.9, with initial accelerations (0.6 to 0.9 cost and err alike, 1 is
  unstable at small steps; the trapezoidal rule of index 2 costs and errs alike too, but fails at large steps);
- sparse matrices of Eigen, or dense ones for a single element.

ANCF beams stretch, shorten when bent, and lose stiffness under compression; fmbd's, as the paper's, bend only. So
frequencies without load agree (check_exudyn.py), but the load lowers those of the rods by some 2 % here and raises them
by as much there, and deflections differ by a tenth: a code's error is measured against its own converged run.
"""

import contextlib
import io
import sys
from itertools import pairwise
from math import acos, atan2, cos, hypot, sin
from typing import Any

import numpy as np
from common import GaveUp
from five_bar import CRANK, HALF_BASE, LINK, Observed

sys.exudynFast = True  # type: ignore[attr-defined]
with contextlib.redirect_stdout(io.StringIO()):
    import exudyn as exu
    from exudyn import itemInterface as item
exu.config.printToConsole = False

CRANK_MASS, CRANK_INERTIA, CRANK_CENTRE = 3.0, 0.2, 0.2  # inertia about the shoulder
DENSITY, YOUNGS_MODULUS, WIDTH, HEIGHT = 2712.0, 7.102e10, 0.030, 0.003
TIP_MASS = 0.25
GEAR, ROTOR_INERTIA, RESISTANCE, TORQUE_CONSTANT, BACK_EMF = 10.0, 0.1, 3.0, 1.0, 1.0
STIFFNESS, DAMPING = 5000.0, 50.0
KP, KD = 4.0, 1.2
START, TARGET = (0.1, 0.6), (-0.1, 0.7)
#: By side, +1 right and -1 left: the voltage that holds the rigid mechanism at the target.
HOLDING = {1: 0.4399168825710753, -1: -1.3449300040449426}
AREA = WIDTH * HEIGHT
BENDING_STIFFNESS = YOUNGS_MODULUS * WIDTH * HEIGHT**3 / 12.0
SAMPLES = 300


class ExudynFiveBar:
    """The mechanism with `elements` a link, damping proportional to stiffness [s]; rotors free or locked."""

    def __init__(
        self, elements: int, damping: float, kp: float = KP, locked: bool = False, gravity: float = 9.81
    ) -> None:
        self.elements, self.damping, self.kp, self.locked, self.gravity = (
            elements,
            damping,
            kp,
            locked,
            gravity,
        )
        self.container = exu.SystemContainer()
        self.mbs = self.container.AddSystem()
        self.ground = self.mbs.AddObject(item.ObjectGround())
        self.fixed = self._coordinate(self.mbs.AddNode(item.NodePointGround()), 0)
        # sensors and reference coordinates of root and tip: right, left
        self.observed: list[tuple[int, np.ndarray]] = []
        tips = [self._arm(side) for side in (1, -1)]
        self.mbs.AddObject(item.ObjectJointRevolute2D(markerNumbers=tips))
        self.mbs.Assemble()

    def solve(self, steps: int, tolerance: float, duration: float = 3.0) -> Observed:
        """Integrate over equal steps (a multiple of 300). Raises GaveUp if Newton's method fails."""
        settings = _settings()
        integration = settings.timeIntegration
        integration.numberOfSteps, integration.endTime = steps, duration
        integration.newton.useModifiedNewton = True
        integration.newton.relativeTolerance = tolerance
        integration.generalizedAlpha.spectralRadius = 0.9
        integration.generalizedAlpha.computeInitialAccelerations = True
        settings.solution.sensors.writePeriod = duration / SAMPLES
        solvers = exu.LinearSolverType
        settings.linearSolverType = solvers.EXUdense if self.elements == 1 else solvers.EigenSparse
        try:
            self.mbs.SolveDynamic(settings)
        except (RuntimeError, ValueError) as error:
            raise GaveUp(str(error)) from None
        return self._observe()

    def statics(self) -> np.ndarray:
        """Deflections of the tips at rest [m], shape (2,)."""
        self.mbs.SolveStatic(_settings())
        return self._observe().tip[-1]

    def frequencies(self) -> np.ndarray:
        """Natural frequencies of the start [Hz], ascending."""
        return np.sort(self.mbs.ComputeODE2Eigenvalues(convert2Frequencies=True)[0])

    def _arm(self, side: int) -> int:
        """Motor, crank and link of one side; returns the marker of the tip."""
        mbs, x0 = self.mbs, side * HALF_BASE
        shoulder, rod = _angles(START, side)
        elbow = np.array([x0 + CRANK * cos(shoulder), CRANK * sin(shoulder)])
        centre = [x0 + CRANK_CENTRE * cos(shoulder), CRANK_CENTRE * sin(shoulder)]
        node = mbs.AddNode(item.NodeRigidBody2D(referenceCoordinates=[*centre, shoulder]))
        inertia = CRANK_INERTIA - CRANK_MASS * CRANK_CENTRE**2
        crank = mbs.AddObject(item.ObjectRigidBody2D(mass=CRANK_MASS, inertia=inertia, nodeNumber=node))
        self._weight(crank)
        self._hinge(self._point(self.ground, x0), self._point(crank, -CRANK_CENTRE))
        self._motor(side, self._coordinate(node, 2))

        direction = np.array([cos(rod), sin(rod)])
        references = [
            np.append(elbow + s * direction, direction) for s in np.linspace(0, LINK, self.elements + 1)
        ]
        nodes = [mbs.AddNode(item.NodePoint2DSlope1(referenceCoordinates=list(r))) for r in references]
        for first, last in pairwise(nodes):
            self._weight(mbs.AddObject(self._element(first, last)))
        self._weight(mbs.AddObject(item.ObjectMassPoint2D(mass=TIP_MASS, nodeNumber=nodes[-1])))
        root, tip = (mbs.AddMarker(item.MarkerNodePosition(nodeNumber=nodes[k])) for k in (0, -1))
        self._hinge(self._point(crank, CRANK - CRANK_CENTRE), root)
        for k in (0, -1):
            coordinates = exu.OutputVariableType.Coordinates
            sensor = item.SensorNode(nodeNumber=nodes[k], storeInternal=True, outputVariableType=coordinates)
            self.observed.append((mbs.AddSensor(sensor), references[k]))
        return tip

    def _element(self, first: int, last: int) -> Any:
        return item.ObjectANCFCable2D(
            length=LINK / self.elements,
            massPerLength=DENSITY * AREA,
            bendingStiffness=BENDING_STIFFNESS,
            axialStiffness=YOUNGS_MODULUS * AREA,
            bendingDamping=self.damping * BENDING_STIFFNESS,
            axialDamping=self.damping * YOUNGS_MODULUS * AREA,
            nodeNumbers=[first, last],
            useReducedOrderIntegration=1,
        )

    def _motor(self, side: int, crank: int) -> None:
        """U = kp (phi_d - phi) - kd phi' + U_g on a rotor that turns as the joint does, elastically connected."""
        rotor = self.fixed
        if not self.locked:
            node = self.mbs.AddNode(item.Node1D(referenceCoordinates=[0.0]))
            self.mbs.AddObject(item.ObjectMass1D(mass=GEAR**2 * ROTOR_INERTIA, nodeNumber=node))
            rotor = self._coordinate(node, 0)
            turn = _angles(TARGET, side)[0] - _angles(START, side)[0]
            torque_per_volt = GEAR * TORQUE_CONSTANT / RESISTANCE
            stiffness = torque_per_volt * self.kp * GEAR
            offset = turn + torque_per_volt * HOLDING[side] / stiffness
            self._spring(self.fixed, rotor, stiffness, torque_per_volt * (KD + BACK_EMF) * GEAR, offset)
        self._spring(rotor, crank, STIFFNESS, DAMPING)

    def _spring(self, first: int, last: int, stiffness: float, damping: float, offset: float = 0.0) -> None:
        self.mbs.AddObject(
            item.ObjectConnectorCoordinateSpringDamper(
                markerNumbers=[first, last], stiffness=stiffness, damping=damping, offset=offset
            )
        )

    def _hinge(self, first: int, last: int) -> None:
        self.mbs.AddObject(item.ObjectJointRevolute2D(markerNumbers=[first, last]))

    def _weight(self, body: int) -> None:
        marker = self.mbs.AddMarker(item.MarkerBodyMass(bodyNumber=body))
        self.mbs.AddLoad(item.LoadMassProportional(markerNumber=marker, loadVector=[0, -self.gravity, 0]))

    def _point(self, body: int, x: float) -> int:
        return self.mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=body, localPosition=[x, 0, 0]))

    def _coordinate(self, node: int, k: int) -> int:
        return self.mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=k))

    def _observe(self) -> Observed:
        """End point, and deflections from the tangents at the roots, as in a clamped floating frame."""
        nodes = [
            self.mbs.GetSensorStoredData(sensor)[:, 1:] + reference for sensor, reference in self.observed
        ]
        tips = []
        for root, tip in (nodes[:2], nodes[2:]):
            (dx, dy), (sx, sy) = (tip[:, :2] - root[:, :2]).T, root[:, 2:].T
            tips.append((sx * dy - sy * dx) / np.hypot(sx, sy))
        return Observed(nodes[1][:, :2], np.stack(tips, axis=1))


def _settings() -> Any:
    """Settings of a solver that is silent and writes no files."""
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    settings.timeIntegration.verboseMode = settings.staticSolver.verboseMode = 0
    return settings


def _angles(end: tuple[float, float], side: int) -> tuple[float, float]:
    """Angles of crank and link that put their end there."""
    x0 = side * HALF_BASE
    reach = hypot(end[0] - x0, end[1])
    inner = acos((CRANK**2 + reach**2 - LINK**2) / (2.0 * CRANK * reach))
    shoulder = atan2(end[1], end[0] - x0) - side * inner
    return shoulder, atan2(end[1] - CRANK * sin(shoulder), end[0] - x0 - CRANK * cos(shoulder))
