"""The drawing of an archive, read back by VTK itself, as ParaView would."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.typing import NDArray
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

from fmbd.results import vtkhdf
from fmbd.results.archive import ArchiveError, ArchiveWriter
from fmbd.results.reader import read_archive
from fmbd.results.vtkhdf import Drawing

# Two joints, a beam of three points between them, a triangular plate beside it.
DRAWING = Drawing(
    points_per_frame=6,
    vertices=[0, 2],
    lines=[[0, 1, 2]],
    polygons=[[3, 4, 5]],
    body_id=[0, 0, 0, 1],
    kind=[0, 0, 1, 2],
    names=["rod", "plate"],
    labels=["hinge", "tip", "rod", "plate"],
    fields=["velocity", "stress"],
)
TIMES = np.linspace(0.0, 0.4, 5)
POINTS = np.random.default_rng(44).random((5, 6, 3)).astype(np.float32)
FIELDS = {"velocity": 2 * POINTS, "stress": 1e9 * POINTS[..., 0]}


def archive_frames(path: Path, blocks: list[slice]) -> None:
    with ArchiveWriter(path, model_text="fmbd: 1\n", coordinates=[], drawing=DRAWING) as writer:
        for part in blocks:
            writer.write_frames(TIMES[part], POINTS[part], {k: values[part] for k, values in FIELDS.items()})
        writer.finish("complete", {})


def vtk_reader(path: Path) -> tuple[vtkHDFReader, tuple[float, ...]]:
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    assert reader.CanReadFile(str(path))
    reader.UpdateInformation()
    return reader, reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())


def cells_of(data: vtkPolyData) -> list[list[int]]:
    cells = (data.GetCell(i) for i in range(data.GetNumberOfCells()))
    return [[cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())] for cell in cells]


@pytest.mark.parametrize("blocks", [[slice(0, 5)], [slice(0, 1), slice(1, 4), slice(4, 5)]])
def test_vtk_sees_every_frame(tmp_path: Path, blocks: list[slice]) -> None:
    path = tmp_path / "run.vtkhdf"
    archive_frames(path, blocks)
    reader, times = vtk_reader(path)
    assert reader.GetNumberOfSteps() == 5
    np.testing.assert_array_equal(times, TIMES)
    for k, (time, points) in enumerate(zip(times, POINTS, strict=True)):
        reader.UpdateTimeStep(time)
        data = reader.GetOutput()
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData()), points)
        assert cells_of(data) == [[0], [2], [0, 1, 2], [3, 4, 5]]
        for name, values in (("body_id", [0, 0, 0, 1]), ("kind", [0, 0, 1, 2])):
            assert vtk_to_numpy(data.GetCellData().GetArray(name)).tolist() == values
        rows = vtk_to_numpy(data.GetCellData().GetArray("name")).astype(np.uint8)
        assert [bytes(row).rstrip(b"\0").decode() for row in rows] == DRAWING.labels
        for name, values in FIELDS.items():
            np.testing.assert_array_equal(vtk_to_numpy(data.GetPointData().GetArray(name)), values[k])


def test_the_drawing_comes_back(tmp_path: Path) -> None:
    path = tmp_path / "run.vtkhdf"
    archive_frames(path, [slice(0, 5)])
    archive = read_archive(path)
    times, points = archive.frames
    np.testing.assert_array_equal(times, TIMES)
    np.testing.assert_array_equal(points, POINTS)
    assert archive.drawing is not None
    assert [cell.tolist() for cell in archive.drawing.cells()] == [[0], [2], [0, 1, 2], [3, 4, 5]]
    assert archive.drawing.names == ("rod", "plate")
    assert archive.drawing.labels == ("hinge", "tip", "rod", "plate")
    assert archive.drawing.fields == ("velocity", "stress")
    assert archive.drawing.kind.tolist() == [0, 0, 1, 2]


def test_a_run_need_not_be_drawn(tmp_path: Path) -> None:
    with ArchiveWriter(tmp_path / "run.vtkhdf", model_text="", coordinates=[]) as writer:
        writer.finish("complete", {})
    archive = read_archive(tmp_path / "run.vtkhdf")
    assert archive.drawing is None
    with pytest.raises(ArchiveError, match="archived without a drawing"):
        archive.frames  # noqa: B018


def test_steps_are_announced_before_their_times(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """VTK corrupts its memory when `Steps/Values` is longer than `NSteps`, so no file may ever hold that."""
    path, on_disk = tmp_path / "run.vtkhdf", []
    flush = h5py.File.flush

    def flush_and_look(file: h5py.File) -> None:
        flush(file)
        steps = file["VTKHDF/Steps"]
        points = len(file["VTKHDF/Points"]) // DRAWING.points_per_frame
        on_disk.append((points, int(steps.attrs["NSteps"]), len(steps["Values"])))

    with ArchiveWriter(path, model_text="", coordinates=[], drawing=DRAWING) as writer:
        writer.write_frames(TIMES[:2], POINTS[:2], {k: values[:2] for k, values in FIELDS.items()})
        monkeypatch.setattr(h5py.File, "flush", flush_and_look)
        writer.write_frames(TIMES[2:], POINTS[2:], {k: values[2:] for k, values in FIELDS.items()})
        monkeypatch.undo()
        writer.finish("complete", {})
    assert on_disk == [(5, 2, 2), (5, 5, 2), (5, 5, 5)]


def test_frames_that_were_not_completed_are_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "run.vtkhdf"
    append = vtkhdf.blocks.append

    def append_but_times(rows: list[tuple[h5py.Dataset, NDArray[np.generic]]]) -> None:
        if rows[0][0].name.endswith("Values"):
            raise OSError("pulled the plug")
        append(rows)

    writer = ArchiveWriter(path, model_text="", coordinates=[], drawing=DRAWING)
    with pytest.raises(OSError, match=f"cannot write {path}: pulled the plug"), writer:
        writer.write_frames(TIMES[:2], POINTS[:2], {k: values[:2] for k, values in FIELDS.items()})
        monkeypatch.setattr(vtkhdf.blocks, "append", append_but_times)
        writer.write_frames(TIMES[2:], POINTS[2:], {k: values[2:] for k, values in FIELDS.items()})
    times, points = read_archive(path).frames
    np.testing.assert_array_equal(times, TIMES[:2])
    np.testing.assert_array_equal(points, POINTS[:2])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"lines": [[0, 6]]}, r"a cell has 0\.\.6, allowed are 0\.\.5"),
        ({"body_id": [0, 0, 0, 2]}, r"body_id has 0\.\.2, allowed are 0\.\.1"),
        ({"kind": [0, 0, 1]}, "kind has 3 values for 4 cells"),
    ],
)
def test_a_drawing_that_vtk_could_not_read_is_refused(change: dict, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Drawing(**(vars(DRAWING) | change))


def test_frames_must_have_all_points(tmp_path: Path) -> None:
    with ArchiveWriter(tmp_path / "a.vtkhdf", model_text="", coordinates=[], drawing=DRAWING) as writer:
        with pytest.raises(ValueError, match=r"frames of shape \(5, 5, 3\), expected \(5, 6, 3\)"):
            writer.write_frames(TIMES, POINTS[:, 1:], FIELDS)
        writer.finish("complete", {})
