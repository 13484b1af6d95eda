"""Where linear theory ends: what the beams of a run, or of its start, are watched for.

Deflections at all output times; axial forces and spins, which take forces and frames, at some hundred of them. Of a
beam in segments each is watched, and the first that goes too far is told.
"""

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from fmbd.beams.limits import deflection_rows, softening_load, weight_sag
from fmbd.results.axial import axial_forces
from fmbd.results.forces import Forces
from fmbd.results.motion import Motion
from fmbd.solvers.integrate import Block
from fmbd.system import System

Array = NDArray[np.float64]

#: Share of its length that a linear beam may bend.
BENT = 0.1
#: Share of the bending stiffness that effects may have which linear theory leaves out.
SOFTENED = 0.25
#: Height over length from which a beam is thick.
THICK = 0.1
#: Lines of warnings, at most.
MOST = 10


class Watch:
    """Takes in a run block by block; `warnings` says what its linear beams cannot do.

    times: output times [s] at which forces are looked at
    """

    def __init__(self, system: System, times: Iterable[float]) -> None:
        self.system = system
        self._times = set(times)
        self._rows = {i: deflection_rows(beam) for i, beam in system.beams.items()}
        self._bent = dict.fromkeys(self._rows, (0.0, 0.0))  # largest deflection [m] and its time, by body
        self._states: list[tuple[Array, ...]] = []

    def see(self, block: Block) -> None:
        """Take in the next output times."""
        for i, rows in self._rows.items():
            own = self.system.reference.inertia.elastic[i]
            bent = np.abs(block.position[:, own] @ rows.T).max(axis=1)
            k = int(bent.argmax())
            self._bent[i] = max(self._bent[i], (float(bent[k]), float(block.time[k])))
        some = [k for k, t in enumerate(block.time) if t in self._times]
        if some and self._rows:
            arrays = (block.time, block.position, block.velocity, block.acceleration, block.states)
            self._states.append(tuple(array[some] for array in arrays))

    def warnings(self) -> list[str]:
        """One line for each limit that a beam has passed."""
        found = list(self._bends())
        if self._states:
            times, position, velocity, acceleration, states = map(
                np.concatenate, zip(*self._states, strict=True)
            )
            motion = Motion(self.system, times, position, velocity, acceleration)
            found += spins(motion)
            found += axial_loads(Forces(motion, position, velocity, states))
        return _at_most(found)

    def _bends(self) -> Iterator[str]:
        for name, bodies in bodies_of_beams(self.system).items():
            i = max(bodies, key=lambda i: self._bent[i][0] / self.system.beams[i].length)
            (bent, time), length = self._bent[i], self.system.beams[i].length
            if bent > BENT * length:
                yield (
                    f"{name}: bends by {bent:.3g} m at t = {time:.3g} s, "
                    f"{_share(bent / length, bodies, 'length')}; {_remedy(bodies, bent / length)}"
                )


def bodies_of_beams(system: System) -> dict[str, list[int]]:
    """Indices of the bodies that each beam is: one, or one for each segment."""
    index = system.lowered.body_index
    return {name: [index[s.body] for s in parts] for name, parts in system.lowered.segmentation.beams.items()}


def start_warnings(system: System) -> list[str]:
    """What can be said of a model before it runs: how far its beams sag, how thick they are, how fast they turn."""
    found = []
    g = float(np.hypot(*system.model.gravity))
    for name, bodies in bodies_of_beams(system).items():
        for i in bodies:
            beam = system.beams[i]
            sag = g * weight_sag(beam, system.lowered.psi[i], system.lowered.omega2[i]) / beam.length
            if sag > BENT:
                held = (
                    "level and held at its start" if beam.frame == "clamped" else "level and held at its ends"
                )
                found.append(
                    f"{name}: {held}, it sags under its own weight by {_share(sag, bodies, 'length')}; "
                    f"{_remedy(bodies, sag)}"
                )
                break
    found += thick(system)
    q, v = system.start.q[None], system.start.v[None]
    return _at_most(found + list(spins(Motion(system, np.zeros(1), q, v, np.zeros_like(q)))))


def thick(system: System) -> Iterator[str]:
    """Beams of so much height, if it is known, that rotary inertia and shear matter, and leave them out.

    On two supports, they lower the first frequency of a rectangular one by (pi h / L)^2 / 24 (1 + E / kappa G), the
    ratio about 3.
    """
    for name in bodies_of_beams(system):
        beam = system.model.bodies[name]
        left_out = {"rotary_inertia": 1.0, "shear": 3.0}
        left_out = {option: share for option, share in left_out.items() if not getattr(beam, option)}
        if not left_out or any(piece.height is None for piece in beam.pieces):
            continue
        height = max(
            float(np.polyval(p.height[::-1], x)) for p in beam.pieces for x in (0.0, p.end - p.start)
        )
        if height > THICK * beam.length:
            lower = (np.pi * height / beam.length) ** 2 / 24.0 * sum(left_out.values())
            switches = " and ".join(f"`{option}: true`" for option in left_out)
            yield (
                f"{name}: is only {beam.length / height:.3g} times as long as high; "
                f"give it {switches}, without which a first frequency may be too high by some {lower:.0%}"
            )


def spins(motion: Motion) -> Iterator[str]:
    """Beams that turn so fast that centrifugal forces matter to their bending, and leave them out."""
    lowered = motion.system.lowered
    names = [link.name for link in lowered.tree.links]
    for name, bodies in _without_shortening(motion.system):
        for i in bodies:
            omega = float(np.sqrt(lowered.omega2[i][0]))
            spin = np.abs(motion.frame(names[i]).angle[1])
            k = int(spin.argmax())
            if spin[k] ** 2 > SOFTENED * omega**2:
                yield (
                    f"{name}: turns at {spin[k]:.3g} rad/s at t = {motion.time[k]:.3g} s, "
                    f"{_share(spin[k] / omega, bodies, 'first frequency')}, and should stiffen; {_stiffening(bodies)}"
                )
                break


def axial_loads(forces: Forces) -> Iterator[str]:
    """Beams whose axial force should change their stiffness, and does not."""
    system = forces.system
    for name, bodies in _without_shortening(system):
        before, after = axial_forces(forces, name, np.array(system.model.bodies[name].nodes))
        within = np.maximum(np.abs(after[:, :-1]), np.abs(before[:, 1:]))  # of each element
        for i, largest in zip(bodies, np.split(within, len(bodies), axis=1), strict=True):
            limit = softening_load(system.beams[i], system.lowered.psi[i], system.lowered.omega2[i])
            load = largest.max(axis=1)
            k = int(load.argmax())
            if load[k] > SOFTENED * limit:
                yield (
                    f"{name}: carries {load[k]:.3g} N along it at t = {forces.motion.time[k]:.3g} s; "
                    f"{limit:.3g} N should count as much as its bending stiffness; {_stiffening(bodies)}"
                )
                break


def _share(share: float, bodies: list[int], what: str) -> str:
    its = "its" if len(bodies) == 1 else "a segment's"
    return f"{share:.0%} of {its} {what}" if share < 10 else f"{share:,.0f} times {its} {what}"


def _without_shortening(system: System) -> Iterator[tuple[str, list[int]]]:
    """The beams that leave out what axial forces do to them, as `bodies_of_beams`."""
    for name, bodies in bodies_of_beams(system).items():
        if not system.model.bodies[name].foreshortening:
            yield name, bodies


def _remedy(bodies: list[int], bent: float) -> str:
    doubt = "is it so soft (stiffness in Pa or N m^2)? " if bent > 0.5 else ""
    return f"{doubt}linear theory leaves that out: give it {_segments(bodies)}"


def _stiffening(bodies: list[int]) -> str:
    return f"linear theory leaves that out: give it `foreshortening: true`, or {_segments(bodies)}"


def _segments(bodies: list[int]) -> str:
    return "more segments" if len(bodies) > 1 else "segments"


def _at_most(found: list[str]) -> list[str]:
    return found if len(found) <= MOST else [*found[:MOST], f"... {len(found) - MOST} more"]
