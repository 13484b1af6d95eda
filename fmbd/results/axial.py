"""The axial force along a beam, by Newton's law on what lies beyond a cross-section.

    N = Re(conj(e) (sum F + sum int q dx + int (g - a) dm)),    e = exp(i angle(x)), tension positive

over the part from x to the end: F on its points, q distributed, a of its points as they moved. What beams stretch
by, if they do, is known where segments meet alone. Points of the plane are complex numbers, x + iy.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from fmbd.beams.pieces import degree, evaluate, gauss_points
from fmbd.results.forces import Forces
from fmbd.results.motion import Motion

Array = NDArray[np.float64]
Plane = NDArray[np.complex128]


def axial_force(forces: Forces, name: str, x: Array) -> Array:
    """Axial force [N] at positions x [m] (n,) of a beam, tension positive, shape (nt, n).

    Where a force acts on the beam it is the mean of both sides; at an end, that of the inside.
    """
    before, after = axial_forces(forces, name, x)
    length = forces.system.model.bodies[name].length
    before[:, x <= 0.0] = after[:, x <= 0.0]
    after[:, x >= length] = before[:, x >= length]
    return 0.5 * (before + after)


def axial_forces(forces: Forces, name: str, x: Array) -> tuple[Array, Array]:
    """Axial force just before and just after positions x [m] (n,) of a beam, each of shape (nt, n)."""
    motion = forces.motion
    beyond = _weight_less_inertia(motion, name, x) + _distributed(motion, name, x)
    before, after = beyond, beyond.copy()
    for at, force in _point_masses(motion, name):
        _add(before, after, x, at, force)
    for at, force in point_forces(forces, name):
        _add(before, after, x, at, force)
    along = np.exp(-1j * (motion.frame(name).angle[0][:, None] + motion.slope(name, x)))
    return (along * before).real, (along * after).real


def point_forces(forces: Forces, name: str) -> Iterator[tuple[float, Plane]]:
    """Position [m] and force [N] (nt,) of all that joints, springs, motors, loops and loads put on a beam."""
    system, motion = forces.system, forces.motion
    planar = system.planar
    offset = {system.lowered.body_index[s.body]: s.start for s in system.lowered.segmentation.beams[name]}
    owner, place = planar.stations["body"], planar.stations["ax"]

    def held(station: int, force: Plane) -> Iterator[tuple[float, Plane]]:
        body = int(owner[station])
        if body in offset:
            yield offset[body] + float(place[station]), force

    for i, body in enumerate(planar.bodies):
        if (i in offset) != (int(body.parent) in offset):
            yield from held(int(body.inner), forces.held[:, i])
            yield from held(int(body.outer), -forces.held[:, i])
    for p, path in enumerate(planar.pathways):
        for j in range(int(path.term0), int(path.term0 + path.nterm)):
            term = planar.terms[j]
            if int(owner[term.a]) in offset or int(owner[term.b]) in offset:
                push = term.coefficient * forces.along[:, p] * forces.directions[:, j]
                yield from held(int(term.b), push)
                yield from held(int(term.a), -push)
    points = list(system.lowered.stations)
    for load in planar.loads:
        if load.fx >= 0 and int(owner[load.station]) in offset:
            force = motion.signals[:, load.fx, 0] + 1j * motion.signals[:, load.fy, 0]
            if load.following:
                force = force * np.exp(1j * motion.point(*points[load.station]).angle[0])
            yield from held(int(load.station), force)


def _add(before: Plane, after: Plane, x: Array, at: float, force: Plane) -> None:
    """Add a force at a position to the sums of what lies beyond x."""
    before[:, x <= at] += force[:, None]
    after[:, x < at] += force[:, None]


def _point_masses(motion: Motion, name: str) -> Iterator[tuple[float, Plane]]:
    """Position [m] and weight less inertia [N] (nt,) of the point masses of a beam, those of lumped mass included."""
    lowered, gravity = motion.system.lowered, complex(*motion.system.model.gravity)
    for segment in lowered.segmentation.beams[name]:
        x, masses, _ = motion.system.beams[lowered.body_index[segment.body]].point_masses.T
        forces = masses * (gravity - motion.segment_points(segment.body, x)[2])
        for at, force in zip(x, forces.T, strict=True):
            yield segment.start + float(at), force


def _weight_less_inertia(motion: Motion, name: str, x: Array) -> Plane:
    """int (g - a) dm from x to the end, point masses left out, shape (nt, n)."""
    beam = motion.system.model.bodies[name]
    if beam.mass == "lumped":
        return np.zeros((len(motion.time), x.size), complex)
    breaks = np.unique(np.concatenate([beam.nodes, [piece.start for piece in beam.pieces[1:]], x]))
    # the shortening is of degree 5 within an element
    points, weights = gauss_points(breaks, 5 + degree(beam.pieces, "mass_per_length"))
    dm = weights * evaluate(beam.pieces, "mass_per_length", points)
    per_mass = complex(*motion.system.model.gravity) - motion.beam_points(name, points)[2]
    pieces = (per_mass * dm).reshape(len(motion.time), breaks.size - 1, -1).sum(axis=2)
    beyond = np.zeros((len(motion.time), breaks.size), complex)
    beyond[:, :-1] = np.cumsum(pieces[:, ::-1], axis=1)[:, ::-1]
    return beyond[:, np.searchsorted(breaks, x)]


def _distributed(motion: Motion, name: str, x: Array) -> Plane:
    """int q dx from x to the end, shape (nt, n)."""
    lowered = motion.system.lowered
    total = np.zeros((len(motion.time), x.size), complex)
    for segment in lowered.segmentation.beams[name]:
        for load in motion.system.planar.distributed:
            if load.body != lowered.body_index[segment.body]:
                continue
            q = motion.signals[:, load.fx, 0] + 1j * motion.signals[:, load.fy, 0]
            if load.following:
                q = q * np.exp(1j * motion.frame(segment.body).angle[0])
            middle = segment.start + load.moment / load.length
            covered = np.clip(middle + load.length / 2 - x, 0.0, load.length)
            total += q[:, None] * covered
    return total
