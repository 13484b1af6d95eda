"""Meshes for looks: a file beside the model, read once, kept as text with the model."""

import io
import math
import warnings
from collections.abc import Iterable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from pydantic import PlainValidator, ValidationInfo

from fmbd.model.base import Number, Pair, Part, Positive, Text
from fmbd.model.context import Context, context_of, reject
from fmbd.model.folder import beside
from fmbd.model.names import described

MAX_BYTES = 20_000_000
MAX_FACES = 50_000
MAX_SIZE = 1e9  # of coordinates, as written
#: What meshio reads of a single file; other formats of its may lead to further files.
FORMATS = (".stl", ".obj", ".ply", ".off", ".vtk", ".msh", ".mesh")
FACES = ("triangle", "quad", "polygon")

Points = tuple[tuple[float, float, float], ...]
Faces = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True)
class Visual:
    """A mesh in the frame of its body: points [m], and the points of each face."""

    file: str
    points: Points = field(repr=False)
    faces: Faces = field(repr=False)


class VisualFile(Part):
    """A mesh by which a body is drawn; it has no part in the mechanics."""

    file: Text
    """The file, relative to the model's folder and inside it: .stl, .obj, .ply, .off, .vtk, .msh or .mesh."""
    at: Pair = (0.0, 0.0)
    """Where the mesh's origin lies in the body's frame [m]."""
    angle: Number = 0.0
    """Angle [rad] by which the mesh is turned in the plane."""
    scale: Positive = 1.0
    """Factor of the mesh's coordinates: 0.001 for a file in millimetres."""

    def read(self, context: Context) -> Visual:
        """The mesh in the file, placed; what cannot be read is refused."""
        if self.file not in context.files:
            context.files[self.file] = self._text(context.folder)
        try:
            points, faces = from_off(context.files[self.file])
        except ValueError as error:
            reject(("file",), f"{self.file}: {error}")
        cos, sin = self.scale * math.cos(self.angle), self.scale * math.sin(self.angle)
        x0, y0 = self.at
        placed = tuple((x0 + cos * x - sin * y, y0 + sin * x + cos * y, self.scale * z) for x, y, z in points)
        return Visual(self.file, placed, faces)

    def _text(self, folder: Path) -> str:
        suffix = Path(self.file).suffix.lower()
        if suffix not in FORMATS:
            reject(("file",), f"{self.file}: a mesh for looks ends in {', '.join(FORMATS)}")
        path = beside(folder, self.file, MAX_BYTES)
        try:
            return _as_off(path)
        except ValueError as error:
            reject(("file",), f"{self.file}: {error}")


def _to_visual(value: Any, info: ValidationInfo) -> Visual:
    """A mesh from the name of its file or from a mapping."""
    if isinstance(value, Visual):
        return value
    if not isinstance(value, str | dict):
        raise ValueError(f"must be a file or a mapping, not {described(value)}")
    short = value if isinstance(value, dict) else {"file": value}
    return VisualFile.model_validate(short, context=info.context).read(context_of(info))


VisualField = Annotated[Visual, PlainValidator(_to_visual, json_schema_input_type=str | VisualFile)]


def _as_off(path: Path) -> str:
    """The faces of a mesh file, and the points that they use, in the format OFF; raises ValueError."""
    import meshio
    import numpy as np

    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            mesh = meshio.read(path)
        faces = [face for block in mesh.cells if block.type in FACES for face in block.data.tolist()]
        used = np.unique([point for face in faces for point in face]).astype(int).tolist()
        if min(used, default=0) < 0:
            raise IndexError
        points = [(*mesh.points[point].tolist(), 0.0)[:3] for point in used]
    # meshio meets a broken file with whatever error comes, or exits
    except (Exception, SystemExit):
        raise ValueError(f"cannot be read as a mesh ({path.suffix.lower()})") from None
    if not faces:
        raise ValueError("has no triangles or other faces")
    if len(faces) > MAX_FACES:
        raise ValueError(f"has {len(faces)} faces; {MAX_FACES} are allowed")
    number = {point: k for k, point in enumerate(used)}
    return to_off(points, ([number[point] for point in face] for face in faces))


def to_off(points: Iterable[Iterable[float]], faces: Iterable[Iterable[int]]) -> str:
    """Points and faces as text in the format OFF, in single precision."""
    places = [" ".join(f"{x:.9g}" for x in point) for point in points]
    rows = [" ".join(map(str, (len(face), *face))) for face in map(tuple, faces)]
    return "\n".join(["OFF", f"{len(places)} {len(rows)} 0", *places, *rows, ""])


def from_off(text: str) -> tuple[Points, Faces]:
    """Points and faces of a text that `to_off` wrote; raises ValueError for any other."""
    try:
        mark, counts, *lines = text.splitlines()
        npoints, nfaces, _ = map(int, counts.split())
        points = tuple((float(x), float(y), float(z)) for x, y, z in map(str.split, lines[:npoints]))
        faces = tuple(tuple(map(int, line.split()[1:])) for line in lines[npoints:])
    except ValueError:
        raise ValueError("is not a mesh") from None
    if mark != "OFF" or len(points) != npoints or not 0 < len(faces) == nfaces <= MAX_FACES:
        raise ValueError("is not a mesh")
    if any(len(face) < 3 or min(face) < 0 or max(face) >= npoints for face in faces):
        raise ValueError("has a face without corners")
    if not all(abs(x) <= MAX_SIZE for point in points for x in point):
        raise ValueError(f"has a coordinate that is not a number of at most {MAX_SIZE:g}")
    return points, faces
