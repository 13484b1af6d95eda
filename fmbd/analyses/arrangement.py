"""A system as an analysis sees it: inputs that stand still, motors that are held, or fed with a constant input."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np

from fmbd.errors import AnalysisError, UnknownQuantity
from fmbd.model.names import unknown
from fmbd.planar.arrays import SIGNAL, allocate, records
from fmbd.planar.equations import evaluate_accelerations
from fmbd.planar.signals import CONSTANT
from fmbd.system import System
from fmbd.system.reference import Reference

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Arrangement:
    """A system at a time, changed as `arrange` says; its motors keep their names and numbers."""

    system: System
    t: float
    locked: list[int]  #: motors whose shafts are held
    constant: list[int]  #: motors whose inputs are constants, the locked ones among them
    first: int  #: signal of the first of these constants

    @property
    def held(self) -> Array:
        """Pathways of the shafts that are held."""
        return np.asarray(self.system.planar.motors["pathway"][self.locked])

    @property
    def states(self) -> list[int]:
        """First-order states that there still are."""
        planar = self.system.planar
        used = {*planar.motors["state"], *planar.controllers["state"][self.controlling]}
        return sorted(int(k) for k in used if k >= 0)

    @property
    def controlling(self) -> list[int]:
        """Controllers that still have a motor."""
        return [int(k) for k in self.system.planar.motors["controller"] if k >= 0]

    def gain(self, motor: int) -> float:
        """Torque on the shaft per unit of the input, without inductance."""
        record = self.system.planar.motors[motor]
        return float(record.Km / record.Ra) if record.electric else 1.0

    def inputs(self) -> Array:
        """The constant inputs, in the order of `constant`."""
        return np.array(self.system.planar.signals["p"][self.first :, 0])

    def feed(self, motors: Iterable[int], values: Iterable[float]) -> None:
        """Set constant inputs."""
        for motor, value in zip(motors, values, strict=True):
            self.system.planar.signals[self.first + self.constant.index(motor)].p[0] = value

    def rates(self, q: Array, v: Array, z: Array) -> tuple[Array, Array]:
        """q'' (nq,) and z' (nz,) at modal q and v; `system.work` is left as the linearisation needs it.

        Raises AnalysisError where a joint has no inertia or a signal no value.
        """
        planar = self.system.planar
        a, dz = np.zeros(planar.nq), np.zeros(z.size)
        failed = evaluate_accelerations(planar, self.system.work, self.t, q, v, z, dz, a)
        if failed >= 0:
            link = self.system.tree.links[failed]
            raise AnalysisError(
                f"joint {link.joint or link.motor} has no inertia to move: give body {link.name} a mass"
            )
        if not (np.all(np.isfinite(a)) and np.all(np.isfinite(dz))):
            raise AnalysisError(
                f"the accelerations at t = {self.t:g} s are not numbers: a signal has no value there"
            )
        return a, dz


def arrange(
    system: System, t: float, locked: Collection[str], constant: Collection[str] = (), standing: bool = False
) -> Arrangement:
    """The system at time t with the motors in `locked` held; those in `constant` are fed with constants, 0 at first.

    Neither has a controller any more; a motor that is held induces nothing.
    standing: all signals keep the value that they have at t, and have no rate: driven joints stand still.
    """
    names = list(system.model.motors)
    planar = system.planar
    fed = [k for k, name in enumerate(names) if name in locked or name in constant]
    signals = records(planar.signals.size + len(fed), SIGNAL)
    signals[: planar.signals.size] = planar.signals
    if standing:
        values = system.reference.signals(t)[:, 0]
        signals["kind"][: values.size] = CONSTANT
        signals["p"][: values.size, 0] = values
    motors = planar.motors.copy()
    for n, k in enumerate(fed):
        signals[planar.signals.size + n].kind = CONSTANT
        motors[k].controller, motors[k].signal = -1, planar.signals.size + n
        if names[k] in locked:
            motors[k].Ke, motors[k].state = 0.0, -1
    changed = planar._replace(signals=signals, motors=motors)
    lowered = replace(system.lowered, planar=changed)
    reference = Reference(changed, system.beams, lowered.shortenings)
    variant = replace(system, lowered=lowered, reference=reference, work=allocate(changed))
    held = [k for k in fed if names[k] in locked]
    return Arrangement(variant, t, held, fed, planar.signals.size)


def motor_names(system: System, wanted: str | Iterable[str]) -> list[str]:
    """`all`, `none`, or names of motors; raises UnknownQuantity for a name that no motor has."""
    motors = list(system.model.motors)
    if isinstance(wanted, str):
        wanted = {"all": motors, "none": []}.get(wanted, [wanted])
    wanted = list(wanted)
    for name in wanted:
        if name not in motors:
            raise UnknownQuantity(unknown("motor", name, motors))
    return wanted
