"""The `/VTKHDF` group of an archive: the drawing of a moving mechanism, as ParaView reads it.

One temporal PolyData: vertices are joints, a polyline is a beam, polygons or lines are rigid bodies. How
the points are connected, and what the cells are, is written once; only the points and their fields repeat.
VTK reads no texts from such a file: the names of the cells are rows of characters. Format: VTKHDF 2.0 (https://docs.vtk.org,
"VTKHDF format specification"); ParaView opens it from version 5.13 on, once it holds a frame.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import h5py
import numpy as np
from numpy.typing import NDArray

from fmbd.results import blocks

Indices = NDArray[np.int64]

KINDS = ("joint", "beam", "rigid body", "ground point", "spring", "motor", "trail", "visual", "mass")
#: Units of the fields that points may have, and the numbers of their components.
FIELDS = {
    "displacement": ("m", 3),
    "velocity": ("m/s", 3),
    "deflection": ("m", 3),
    "force": ("N", 3),
    "bending_moment": ("N m", 1),
    "stress": ("Pa", 1),
}

TOPOLOGIES = ("Vertices", "Lines", "Polygons", "Strips")


@dataclass(frozen=True)
class Drawing:
    """What connects the points of every frame.

    Cells are numbered vertices first, then lines, then polygons.

    points_per_frame: number of points in a frame
    vertices: point indices, one vertex cell each
    lines: point indices of each polyline
    polygons: point indices of each polygon, in order round its edge
    body_id: for each cell the index of its body in `names`, shape (ncells,)
    kind: for each cell an index into KINDS, shape (ncells,)
    names: names of the bodies
    labels: for each cell the name of the part that it shows: of a body, joint or spring
    fields: those of FIELDS that the points have
    """

    points_per_frame: int
    vertices: Sequence[int] | Indices
    lines: Sequence[Sequence[int] | Indices]
    polygons: Sequence[Sequence[int] | Indices]
    body_id: Sequence[int] | Indices
    kind: Sequence[int] | Indices
    names: Sequence[str]
    labels: Sequence[str]
    fields: Sequence[str] = ()

    def __post_init__(self) -> None:
        ncells = len(self.vertices) + len(self.lines) + len(self.polygons)
        for name, values in (("body_id", self.body_id), ("kind", self.kind), ("labels", self.labels)):
            if len(values) != ncells:
                raise ValueError(f"drawing: {name} has {len(values)} values for {ncells} cells")
        _check_indices("body_id", self.body_id, len(self.names))
        _check_indices("kind", self.kind, len(KINDS))
        if ncells:
            _check_indices("a cell", np.concatenate(self.cells()), self.points_per_frame)

    def cells(self) -> list[Indices]:
        """Return the point indices of every cell, in the order of the file."""
        vertices = [[vertex] for vertex in self.vertices]
        return [np.asarray(cell, np.int64) for cell in (*vertices, *self.lines, *self.polygons)]


def _check_indices(name: str, values: Sequence[int] | Indices, limit: int) -> None:
    array = np.asarray(values, np.int64)
    if array.size and (array.min() < 0 or array.max() >= limit):
        raise ValueError(f"drawing: {name} has {array.min()}..{array.max()}, allowed are 0..{limit - 1}")


def create_drawing(file: h5py.File, drawing: Drawing) -> None:
    """Create the `/VTKHDF` group of a drawing without frames."""
    group = file.create_group("VTKHDF")
    group.attrs["Version"] = np.array([2, 0], np.int64)
    group.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", len("PolyData")))
    group["NumberOfPoints"] = np.array([drawing.points_per_frame], np.int64)
    _create_of_points(group, "Points", drawing.points_per_frame, "m", 3)
    for name in drawing.fields:
        _create_of_points(group, f"PointData/{name}", drawing.points_per_frame, *FIELDS[name])

    nv, nl = len(drawing.vertices), len(drawing.lines)
    cells = drawing.cells()
    for name, part in zip(TOPOLOGIES, (cells[:nv], cells[nv : nv + nl], cells[nv + nl :], []), strict=True):
        _create_cells(group.create_group(name), part)
    for name, values, names in (("body_id", drawing.body_id, drawing.names), ("kind", drawing.kind, KINDS)):
        dataset = group.create_dataset(
            f"CellData/{name}", data=np.asarray(values, np.int64), track_order=True
        )
        dataset.attrs["names"] = np.array(names, h5py.string_dtype())
    group["CellData/name"] = _characters(drawing.labels)

    steps = group.create_group("Steps")
    steps.attrs["NSteps"] = np.int64(0)
    blocks.create_growing(steps, "Values").attrs["units"] = "s"
    for name, shape in _offsets(drawing.fields):
        blocks.create_growing(steps, name, shape, np.int64)


def append_frames(
    file: h5py.File,
    times: NDArray[np.float64],
    points: NDArray[np.float32],
    fields: Mapping[str, NDArray[np.float32]],
) -> None:
    """Append frames: times [s], shape (k,); points [m], shape (k, npoints, 3), and every field of theirs."""
    group = file["VTKHDF"]
    steps = group["Steps"]
    start, count = len(steps["Values"]), len(times)
    npoints = int(group["NumberOfPoints"][0])
    if points.shape != (count, npoints, 3):
        raise ValueError(f"frames of shape {points.shape}, expected {(count, npoints, 3)}")
    names = _fields(group)
    rows: dict[str, NDArray[np.generic]] = {"Points": points.reshape(-1, 3)}
    for name in names:
        rows[f"PointData/{name}"] = fields[name].reshape(-1, *fields[name].shape[2:])
    for name, shape in _offsets(names):
        rows[f"Steps/{name}"] = np.zeros((count, *shape), np.int64)
    rows["Steps/NumberOfParts"] = np.ones(count, np.int64)
    for name in ("PointOffsets", *(f"PointDataOffsets/{name}" for name in names)):
        rows[f"Steps/{name}"] = npoints * np.arange(start, start + count)
    # VTK reads past its buffers when Values is longer than NSteps: each is on disk before the next.
    blocks.append([(group[name], values) for name, values in rows.items()])
    steps.attrs.modify("NSteps", np.int64(start + count))
    file.flush()
    blocks.append([(steps["Values"], times)])


def read_drawing(file: h5py.File) -> Drawing:
    """Return the drawing of an archive that has one."""
    group = file["VTKHDF"]
    vertices, lines, polygons = (_read_cells(group[name]) for name in TOPOLOGIES[:3])
    return Drawing(
        points_per_frame=int(group["NumberOfPoints"][0]),
        vertices=np.array([cell[0] for cell in vertices], np.int64),
        lines=lines,
        polygons=polygons,
        body_id=group["CellData/body_id"][:],
        kind=group["CellData/kind"][:],
        names=tuple(group["CellData/body_id"].attrs["names"]),
        labels=tuple(bytes(row).rstrip(b"\0").decode() for row in group["CellData/name"][:].view(np.uint8)),
        fields=_fields(group),
    )


def read_frames(file: h5py.File) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
    """Return the times [s], shape (k,), and the points [m], shape (k, npoints, 3), of all whole frames."""
    group = file["VTKHDF"]
    npoints = int(group["NumberOfPoints"][0])
    times = group["Steps/Values"][:]
    count = int(np.isfinite(times).sum())
    return times[:count], group["Points"][: count * npoints].reshape(count, npoints, 3)


def _fields(group: h5py.Group) -> tuple[str, ...]:
    return tuple(name for name in FIELDS if f"PointData/{name}" in group)


def _offsets(fields: Sequence[str]) -> tuple[tuple[str, tuple[int, ...]], ...]:
    """Name and row shape of the tables that say, for each step, where its data begin."""
    cells = (len(TOPOLOGIES),)
    return (
        ("PartOffsets", ()),
        ("NumberOfParts", ()),
        ("PointOffsets", ()),
        ("CellOffsets", cells),
        ("ConnectivityIdOffsets", cells),
        ("CellDataOffsets/body_id", ()),
        ("CellDataOffsets/kind", ()),
        ("CellDataOffsets/name", ()),
        *((f"PointDataOffsets/{name}", ()) for name in fields),
    )


def _create_of_points(group: h5py.Group, name: str, points: int, unit: str, components: int) -> None:
    """A dataset of so many points a frame, in chunks of whole frames up to about 64 KiB: players read by frame."""
    columns = (components,) if components > 1 else ()
    frames = max(1, 2**14 // (components * max(1, points)))
    dataset = group.create_dataset(
        name,
        shape=(0, *columns),
        maxshape=(None, *columns),
        chunks=(max(1, points) * frames, *columns),
        dtype=np.float32,
    )
    dataset.attrs["units"] = unit


def _characters(texts: Sequence[str]) -> NDArray[np.int8]:
    """Texts as rows of characters, filled up with zeros."""
    encoded = np.array([text.encode() for text in texts] or [b""], "S")
    return encoded.view(np.int8).reshape(encoded.size, -1)[: len(texts)]


def _create_cells(group: h5py.Group, cells: Sequence[Indices]) -> None:
    offsets = np.concatenate([[0], np.cumsum([len(cell) for cell in cells], dtype=np.int64)]).astype(np.int64)
    group["NumberOfCells"] = np.array([len(cells)], np.int64)
    group["NumberOfConnectivityIds"] = offsets[-1:]
    group["Offsets"] = offsets
    group["Connectivity"] = np.concatenate(cells) if cells else np.empty(0, np.int64)


def _read_cells(group: h5py.Group) -> list[Indices]:
    connectivity = group["Connectivity"][:]
    return [connectivity[start:end] for start, end in pairwise(group["Offsets"][:])]
