"""The drawing of a run by itself, in files for ParaView: .vtkhdf, .pvd with a folder of .vtu, one .vtu."""

import io
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from fmbd.results import blocks, vtkhdf
from fmbd.results.frames import Frames
from fmbd.results.scene import spread

if TYPE_CHECKING:
    from fmbd.results.run import Run

SUFFIXES = (".vtkhdf", ".pvd", ".vtu")
FRAMES = 300


def draw(
    run: "Run",
    path: str | Path,
    frames: int | None = None,
    deflection: float = 1.0,
    on_frame: Callable[[int, int], None] = lambda done, count: None,
) -> int:
    """Write the drawing of a run; returns the number of frames.

    path: .vtkhdf (ParaView 5.13 or newer), .pvd (older ones, too; the frames are in a folder beside it, named like
    it), or .vtu, which holds the last output time only
    frames: how many of the output times, evenly; 300 when not given, and fewer of a drawing of many points
    deflection: factor by which the deflection of beams is exaggerated
    on_frame: called with the frames done and their number

    Raises ValueError for another suffix and for a run without outputs, OSError when a file cannot be written.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"the file must end in {', '.join(SUFFIXES)}, not in '{path.suffix}'")
    if not len(run.time):
        raise ValueError("there is nothing to draw: the run has no outputs")
    drawn = Frames(run.system, deflection)
    rows = spread(len(run.time), frames or drawn.most(FRAMES))
    write = {".vtkhdf": _write_vtkhdf, ".pvd": _write_pvd, ".vtu": _write_vtu}[suffix]
    done = 0
    with write(path, drawn.drawing, len(rows)) as frame:
        results = (run.time, run.position, run.velocity, run.acceleration, run.states)
        for times, points, fields in drawn.draw(*(values[rows] for values in results)):
            frame(times, points, fields)
            on_frame(done := done + len(times), len(rows))
    return len(rows)
