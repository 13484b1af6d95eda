"""The drawing of a run by itself, in files for ParaView: .vtkhdf, .pvd with a folder of .vtu, one .vtu."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

import h5py
import numpy as np
from numpy.typing import NDArray

from fmbd.results import blocks, vtkhdf
from fmbd.results.frames import Fields, Frames
from fmbd.results.scene import spread

if TYPE_CHECKING:
    import pyvista as pv

    from fmbd.results.run import Run

Array = NDArray[np.float64]
Put = Callable[[Array, NDArray[np.float32], Fields], None]

SUFFIXES = (".vtkhdf", ".pvd", ".vtu")
FRAMES = 300


def draw(
    run: "Run",
    path: str | Path,
    frames: int | None = None,
    deflection: float = 1.0,
    on_progress: Callable[[float], None] | None = None,
) -> int:
    """Write the drawing of a run into files of its own; returns the number of frames.

    path: .vtkhdf (ParaView 5.13 or newer), .pvd (older ones, too; its frames are in the folder NAME_frames beside it),
    or .vtu, which holds the last output time only
    frames: how many of the output times, evenly; 300 when not given, and fewer of a drawing of many points
    deflection: factor by which the deflection of beams is exaggerated
    on_progress: called with the share that is done

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
    results = (run.time, run.position, run.velocity, run.acceleration, run.states)
    done = 0
    with {".vtkhdf": _vtkhdf, ".pvd": _pvd, ".vtu": _vtu}[suffix](path, drawn.drawing) as put:
        for drawn_frames in drawn.draw(*(values[rows] for values in results)):
            put(*drawn_frames)
            done += len(drawn_frames[0])
            if on_progress is not None:
                on_progress(done / len(rows))
    return 1 if suffix == ".vtu" else len(rows)


@contextmanager
def _vtkhdf(path: Path, drawing: vtkhdf.Drawing) -> Iterator[Put]:
    with _beginning(path) as beginning, h5py.File(beginning, "w", libver=blocks.LIBVER) as file:
        vtkhdf.create_drawing(file, drawing)
        yield lambda times, points, fields: vtkhdf.append_frames(file, times, points, fields)
        blocks.trim(file)


@contextmanager
def _pvd(path: Path, drawing: vtkhdf.Drawing) -> Iterator[Put]:
    """The list of the frames comes last; frames that an earlier list has left behind go."""
    grid, folder = _grid(drawing), path.with_name(f"{path.stem}_frames")
    folder.mkdir(exist_ok=True)
    written: list[tuple[float, str]] = []

    def put(times: Array, points: NDArray[np.float32], fields: Fields) -> None:
        for k, time in enumerate(times):
            name = f"{path.stem}_{len(written):05d}.vtu"
            _save(grid, folder / name, points[k], {field: values[k] for field, values in fields.items()})
            written.append((float(time), f"{folder.name}/{name}"))

    yield put
    rows = [f'<DataSet timestep="{time!r}" file={quoteattr(name)}/>' for time, name in written]
    head = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n<Collection>\n'
    with _beginning(path) as beginning:
        beginning.write_text(head + "\n".join(rows) + "\n</Collection>\n</VTKFile>\n", encoding="utf-8")
    kept = {Path(name).name for _, name in written}
    for old in folder.glob("*.vtu"):
        if old.name.startswith(f"{path.stem}_") and old.name not in kept:
            old.unlink()


@contextmanager
def _vtu(path: Path, drawing: vtkhdf.Drawing) -> Iterator[Put]:
    last: list[tuple[NDArray[np.float32], Fields]] = []

    def put(times: Array, points: NDArray[np.float32], fields: Fields) -> None:
        last[:] = [(points[-1], {field: values[-1] for field, values in fields.items()})]

    yield put
    with _beginning(path) as beginning:
        _save(_grid(drawing), beginning, *last[0])


def _grid(drawing: vtkhdf.Drawing) -> "pv.UnstructuredGrid":
    """The cells of a drawing, with what is written once in the other format."""
    import pyvista as pv

    vertices, lines, polygons = len(drawing.vertices), len(drawing.lines), len(drawing.polygons)
    kinds = (
        [pv.CellType.VERTEX] * vertices + [pv.CellType.POLY_LINE] * lines + [pv.CellType.POLYGON] * polygons
    )
    cells = [number for cell in drawing.cells() for number in (len(cell), *cell)]
    points = np.zeros((drawing.points_per_frame, 3), np.float32)
    grid = pv.UnstructuredGrid(np.array(cells), np.array(kinds), points)
    grid.cell_data["body_id"] = np.asarray(drawing.body_id)
    grid.cell_data["kind"] = np.asarray(drawing.kind)
    grid.cell_data["name"] = list(drawing.labels)
    return grid


def _save(grid: "pv.UnstructuredGrid", path: Path, points: NDArray[np.float32], fields: Fields) -> None:
    grid.points = points
    for field, values in fields.items():
        grid.point_data[field] = values
    path.open("wb").close()  # vtk only prints what is wrong
    grid.save(path)


@contextmanager
def _beginning(path: Path) -> Iterator[Path]:
    """A file that takes the place of `path` when it is complete."""
    beginning = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix.lower()}")
    try:
        yield beginning
        beginning.replace(path)
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else error
        raise OSError(f"cannot write {path}: {reason}") from None
    finally:
        beginning.unlink(missing_ok=True)
