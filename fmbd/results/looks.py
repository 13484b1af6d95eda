"""Whether the meshes for looks are as large as the mechanism that they are drawn on."""

from collections.abc import Iterator

import numpy as np

from fmbd.model import RigidBody
from fmbd.results.motion import Motion
from fmbd.system import System

#: A mesh so many times as large as the mechanism, or so many times smaller, is hardly in metres.
STRANGE = 20.0


def visuals(system: System) -> Iterator[tuple[str, str]]:
    """A fact about each body with a mesh: its file and extent; a warning if that does not fit the mechanism."""
    meshes = {
        name: body.visual
        for name, body in system.model.bodies.items()
        if isinstance(body, RigidBody) and body.visual is not None
    }
    whole = _extent(system) if meshes else 0.0
    for name, visual in meshes.items():
        sides = np.ptp(np.array(visual.points), axis=0)
        yield "visual", f"{name}: {visual.file}, {' x '.join(f'{side:.3g}' for side in sides)} m"
        largest = sides.max()
        if whole > 0.0 and not whole / STRANGE <= largest <= whole * STRANGE:
            question = (
                "is the file in millimetres? scale: 0.001" if largest > whole else "is its scale right?"
            )
            yield (
                "warning",
                f"{name}: the mesh is {largest:.3g} m large, the mechanism {whole:.3g} m: {question}",
            )


def _extent(system: System) -> float:
    """The largest side of the box around all points at the start [m]."""
    q, v = system.start.q[None], system.start.v[None]
    motion = Motion(system, np.zeros(1), q, v, np.zeros_like(q))
    bodies = system.model.bodies
    points = np.array([motion.point(name, at).place[0, 0] for name in bodies for at in bodies[name].points])
    return float(max(np.ptp(points.real), np.ptp(points.imag)))
