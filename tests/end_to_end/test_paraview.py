"""What ParaView reads is the motion in the archive: steps, times, places, fields, names, in both of its formats.

VTK's own readers read it here. Where ParaView's `pvpython` is installed it opens the files, too, by the script of
`postprocess/` that makes a scene of them.
"""

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import meshio
import numpy as np
import pytest
import pyvista as pv
from numpy.testing import assert_allclose, assert_array_equal
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

import fmbd
from fmbd import draw
from fmbd.cli import main
from fmbd.results.animation.solids import solid
from fmbd.results.scene import scene
from fmbd.results.vtkhdf import KINDS

ROOT = Path(__file__).parents[2]
SINGLE = {"rtol": 1e-6, "atol": 1e-6}
BAR = np.array([[x, y, z] for x in (-20, 520) for y in (-15, 15) for z in (-5, 5)], float)  # millimetres
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = [corners for a, b, c, d in FACES for corners in ([a, b, c], [a, c, d])]


@dataclass
class Frame:
    """What a reader shows at one time; fields of the points, and of each cell its kind, name and points."""

    time: float
    points: np.ndarray
    fields: dict[str, np.ndarray]
    cells: list[tuple[str, str, list[int]]]

    def of(self, kind: str, name: str) -> list[int]:
        """Points of the one cell of this kind and name."""
        (points,) = (points for own, label, points in self.cells if (own, label) == (kind, name))
        return points


def frame(time: float, data: object) -> Frame:
    cell_data, point_data = data.GetCellData(), data.GetPointData()
    names = cell_data.GetAbstractArray("name")
    if names.IsA("vtkStringArray"):
        labels = [names.GetValue(k) for k in range(data.GetNumberOfCells())]
    else:
        labels = [bytes(row).rstrip(b"\0").decode() for row in vtk_to_numpy(names).astype(np.uint8)]
    kinds = [KINDS[k] for k in vtk_to_numpy(cell_data.GetArray("kind"))]
    cells = (data.GetCell(k) for k in range(data.GetNumberOfCells()))
    points = [[cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())] for cell in cells]
    arrays = [point_data.GetArray(k) for k in range(point_data.GetNumberOfArrays())]
    return Frame(
        time,
        vtk_to_numpy(data.GetPoints().GetData()).copy(),
        {array.GetName(): vtk_to_numpy(array).copy() for array in arrays},
        list(zip(kinds, labels, points, strict=True)),
    )


def read_vtkhdf(path: Path) -> Iterator[Frame]:
    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    for time in reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS()):
        reader.UpdateTimeStep(time)
        yield frame(time, reader.GetOutputAsDataSet())


def read_pvd(path: Path) -> Iterator[Frame]:
    reader = pv.get_reader(str(path))
    for time in reader.time_values:
        reader.set_active_time_value(time)
        yield frame(time, reader.read()[0])


READERS = {".vtkhdf": read_vtkhdf, ".pvd": read_pvd}


def simulated(folder: Path, model: str, duration: float, change: Callable[[str], str] = str) -> fmbd.Run:
    """A run of a model of the gallery, perhaps with changes to its text."""
    path = folder / f"{model}.yaml"
    path.write_text(change((ROOT / "models" / f"{model}.yaml").read_text()))
    changed = fmbd.load_model(path, {"simulation.duration": duration})
    return fmbd.simulate(changed, folder / f"{model}.vtkhdf", frames=40)


@pytest.fixture(scope="module")
def five_bar(tmp_path_factory: pytest.TempPathFactory) -> fmbd.Run:
    return simulated(tmp_path_factory.mktemp("five_bar"), "five_bar", 0.1)


@pytest.fixture(scope="module")
def slider_crank(tmp_path_factory: pytest.TempPathFactory) -> fmbd.Run:
    return simulated(tmp_path_factory.mktemp("slider_crank"), "slider_crank", 1.0)


@pytest.fixture(scope="module")
def decorated(tmp_path_factory: pytest.TempPathFactory) -> fmbd.Run:
    """The slider-crank whose crank looks like a bar of an STL file, which is gone after the run."""
    folder = tmp_path_factory.mktemp("decorated")
    meshio.write(folder / "crank.stl", meshio.Mesh(BAR, [("triangle", np.array(TRIANGLES))]), binary=True)
    point = "points: {middle: [a/2, 0], pin: [a, 0]}"
    visual = "visual: {file: crank.stl, scale: 0.001}"

    def decorate(text: str) -> str:
        assert point in text
        return text.replace(point, f"{point}\n    {visual}")

    simulated(folder, "slider_crank", 1.0, decorate)
    (folder / "crank.stl").unlink()
    return fmbd.open_run((folder / "slider_crank.vtkhdf").rename(folder / "moved.vtkhdf"))


def drawn(run: fmbd.Run, folder: Path, suffix: str, **options: object) -> tuple[list[Frame], np.ndarray]:
    """The frames of a drawing of a run, and the output times that they are at."""
    path = folder / f"drawing{suffix}"
    draw(run, path, **options)
    frames = list(READERS[suffix](path))
    rows = np.searchsorted(run.time, [each.time for each in frames])
    assert_array_equal([each.time for each in frames], run.time[rows])
    return frames, rows


def in_space(plane: np.ndarray) -> np.ndarray:
    return np.append(plane, np.zeros((*plane.shape[:-1], 1)), axis=-1)


@pytest.mark.parametrize("suffix", READERS)
def test_the_five_bar_is_where_the_archive_says_with_all_fields(
    five_bar: fmbd.Run, tmp_path: Path, suffix: str
) -> None:
    run = five_bar
    frames, rows = drawn(run, tmp_path, suffix, frames=21)
    assert len(frames) == 21 and frames[0].time == 0.0 and frames[-1].time == run.time[-1]
    fields = {"displacement", "velocity", "deflection", "force", "bending_moment", "stress"}
    for k, row in zip(frames, rows, strict=True):
        assert k.fields.keys() == fields
        rod = k.of("beam", "rod_right")
        for quantity, field in (("position", k.points), ("velocity", k.fields["velocity"])):
            expected = in_space(run[f"rod_right.end.{quantity}"])[row]
            assert_allclose(field[rod[-1]], expected, **SINGLE)
        ends = [rod[0], rod[-1]]  # its nodes
        for quantity in ("bending_moment", "stress"):
            assert_allclose(k.fields[quantity][ends], run[f"rod_right.{quantity}"][row], rtol=1e-5, atol=1e-3)
        (pin,) = k.of("joint", "effector")
        assert_allclose(k.points[pin], in_space(run["rod_right.end.position"])[row], **SINGLE)
        assert_allclose(k.fields["force"][pin], in_space(run["effector.force"])[row], rtol=1e-5, atol=1e-5)
        moved = k.points - frames[0].points
        assert_allclose(k.fields["displacement"], moved, atol=1e-6)
        crank = k.of("rigid body", "crank_left")
        assert np.isnan(k.fields["stress"][crank]).all() and not k.fields["deflection"][crank].any()
    names = {(kind, name) for kind, name, _ in frames[0].cells}
    assert {("motor", "shoulder_left"), ("joint", "elbow_left"), ("ground point", "O1")} < names
    trail = frames[-1].points[frames[-1].of("trail", "rod_right")]
    path = in_space(run["rod_right.end.position"])[rows[::-1]]
    assert_allclose(trail[: len(path)], path, **SINGLE)
    assert_allclose(trail[len(path) :], path[-1:].repeat(len(trail) - len(path), axis=0), **SINGLE)


@pytest.mark.parametrize("suffix", READERS)
def test_the_slider_crank_is_where_the_archive_says(
    slider_crank: fmbd.Run, tmp_path: Path, suffix: str
) -> None:
    run = slider_crank
    frames, rows = drawn(run, tmp_path, suffix, frames=1000)
    assert len(frames) == len(run.time) == 101
    for k, row in zip(frames, rows, strict=True):
        assert k.fields.keys() == {"displacement", "velocity", "force"}
        for part in (("joint", "slider", "rod.slider"), ("joint", "pin", "crank.pin")):
            (at,) = k.of(*part[:2])
            assert_allclose(k.points[at], in_space(run[f"{part[2]}.position"])[row], **SINGLE)
        first, last = k.of("spring", "spring")
        length = np.linalg.norm(k.points[last] - k.points[first])
        assert length == pytest.approx(run["spring.length"][row], rel=1e-5)


@pytest.mark.parametrize("suffix", READERS)
def test_a_mesh_for_looks_moves_with_its_body_and_needs_no_file(
    decorated: fmbd.Run, tmp_path: Path, suffix: str
) -> None:
    frames, rows = drawn(decorated, tmp_path, suffix, frames=11)
    angles = decorated["crank.angle"][rows]
    for k, angle in zip(frames, angles, strict=True):
        cells = [points for kind, name, points in k.cells if (kind, name) == ("visual", "crank")]
        assert len(cells) == len(TRIANGLES)
        turned = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        expected = 1e-3 * BAR[np.ravel(TRIANGLES)] @ turned.T
        assert_allclose(k.points[np.ravel(cells)], expected, **SINGLE)
        assert not any(kind == "rigid body" and name == "crank" for kind, name, _ in k.cells)


def test_animations_show_the_mesh_where_the_body_is(decorated: fmbd.Run) -> None:
    """The solid that `fmbd animate` draws, at the second of two times."""
    shown = scene(decorated, [0, len(decorated.time) - 1])
    (item,) = (item for item in shown.items if item.body == "crank" and item.mesh is not None)
    corners = solid(item, item.points[1], unit=0.01, layer={"crank": 1}).points
    turn = np.exp(1j * decorated["crank.angle"][-1])
    expected = 1e-3 * (BAR[:, 0] + 1j * BAR[:, 1]) * turn
    for corner in expected:
        assert np.abs(corners[:, 0] + 1j * corners[:, 1] - corner).min() < 1e-6


def test_the_archive_itself_plays(decorated: fmbd.Run) -> None:
    """Forty frames of 101 outputs, the first and the last among them."""
    frames = list(read_vtkhdf(decorated.source.path))
    assert len(frames) == 40 and frames[-1].time == 1.0
    (pin,) = frames[-1].of("joint", "pin")
    assert_allclose(frames[-1].points[pin], in_space(decorated["crank.pin.position"])[-1], **SINGLE)


def test_a_drawing_of_many_points_has_fewer_frames(
    decorated: fmbd.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """About a million points in all, unless more are asked for; and they are worked out some at a time."""
    monkeypatch.setattr("fmbd.results.frames.POINTS", 2000)
    monkeypatch.setattr("fmbd.results.frames.AT_ONCE", 200)
    few, _ = drawn(decorated, tmp_path, ".vtkhdf")
    assert len(few) == 2000 // len(few[0].points)
    whole, _ = drawn(decorated, tmp_path, ".vtkhdf", frames=90)
    assert len(whole) == 90
    (pin,) = whole[-1].of("joint", "pin")
    assert_allclose(whole[-1].points[pin], in_space(decorated["crank.pin.position"])[-1], **SINGLE)


def test_deflections_are_exaggerated(five_bar: fmbd.Run, tmp_path: Path) -> None:
    """By 20: the rods, held at both ends, stay attached and their middles go 20 times as far; so does Warp By
    Vector with what the field `deflection` says."""
    plain, _ = drawn(five_bar, tmp_path, ".vtkhdf", frames=5)
    bent, _ = drawn(five_bar, tmp_path, ".vtkhdf", frames=5, deflection=20.0)
    for before, after in zip(plain, bent, strict=True):
        rod = before.of("beam", "rod_left")
        straight = np.linspace(before.points[rod[0]], before.points[rod[-1]], len(rod))
        off = before.points[rod] - straight
        assert_allclose(before.fields["deflection"][rod], off, atol=1e-6)
        assert_allclose(after.points[rod], straight + 20.0 * off, atol=2e-5)
    assert np.abs(bent[-1].points[rod] - plain[-1].points[rod]).max() > 1e-3


def test_one_vtu_is_the_last_output(five_bar: fmbd.Run, tmp_path: Path) -> None:
    assert draw(five_bar, tmp_path / "end.vtu") == 1
    end = frame(0.1, pv.read(tmp_path / "end.vtu"))
    (pin,) = end.of("joint", "effector")
    assert_allclose(end.points[pin], in_space(five_bar["rod_right.end.position"])[-1], **SINGLE)


def test_the_file_of_a_running_simulation_opens(tmp_path: Path) -> None:
    """Each time that progress is reported, vtk reads what the file holds by then."""
    path = tmp_path / "run.vtkhdf"
    model = fmbd.load_model(ROOT / "models" / "pendulum.yaml", {"simulation.output_interval": 1e-3})
    seen = []

    def look(reached: float) -> None:
        if fmbd.open_run(path).source.frames[0].size:
            assert fmbd.open_run(path).status == "running"
            seen.append([each.time for each in read_vtkhdf(path)])

    run = fmbd.simulate(model, path, look, frames=50)
    assert seen and 0 < len(seen[0]) < 50
    assert all(times[-1] <= run.time[-1] for times in seen)


def test_drawings_at_the_command_line(
    five_bar: fmbd.Run, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    archive, drawing = str(five_bar.source.path), str(tmp_path / "five-bar.pvd")
    assert main(["export", archive, drawing, "--frames", "9"]) == 0
    assert main(["export", archive, drawing, "--frames", "4", "--deflection", "10"]) == 0
    assert len(list(read_pvd(Path(drawing)))) == 4
    assert len(list((tmp_path / "five-bar_frames").iterdir())) == 4  # those of before are gone
    assert "wrote" in capsys.readouterr().out
    for arguments, message in (
        ([archive, archive], "is the archive of a run: name another file"),
        ([archive, drawing, "--every", "2"], "--every is for .csv"),
        ([archive, drawing.replace("pvd", "csv"), "--frames", "2"], "--frames is for .vtkhdf, .pvd, .vtu"),
        ([archive, str(tmp_path / "none" / "a.vtkhdf")], "a.vtkhdf: No such file or directory"),
    ):
        assert main(["export", *arguments]) == 2
        assert message in capsys.readouterr().err


def test_an_archive_without_a_drawing(tmp_path: Path) -> None:
    """It is smaller, and can be drawn later."""
    path = tmp_path / "plain.vtkhdf"
    model = str(ROOT / "models" / "pendulum.yaml")
    assert main(["run", model, "-o", str(path), "--duration", "0.1", "--no-drawing", "--quiet"]) == 0
    run = fmbd.open_run(path)
    assert run.source.drawing is None
    assert len(drawn(run, tmp_path, ".vtkhdf")[0]) == len(run.time)


def pvpython() -> list[str]:
    """The command that runs ParaView's Python where it can draw; empty where there is none."""
    found = shutil.which("pvpython")
    if found is None:
        return []
    display = [] if os.environ.get("DISPLAY") else [shutil.which("xvfb-run") or "", "-a", "--wait=60"]
    return [*display, found] if "" not in display else []


@pytest.mark.skipif(not pvpython(), reason="needs ParaView's pvpython, and a display or xvfb-run")
def test_paraview_makes_a_scene(five_bar: fmbd.Run, decorated: fmbd.Run, tmp_path: Path) -> None:
    """Of what its version opens: archives from 5.13 on, .pvd before."""
    script = ROOT / "postprocess" / "paraview_animation.py"
    version = subprocess.run([*pvpython(), "--version"], capture_output=True, text=True)
    numbers = [int(part) for part in (version.stdout + version.stderr).split()[-1].split(".")[:2]]
    for run, name in ((five_bar, "five_bar"), (decorated, "decorated")):
        path = run.source.path
        if numbers < [5, 13]:
            path = tmp_path / f"{name}.pvd"
            draw(run, path, frames=5)
        picture = tmp_path / f"{name}.png"
        environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        done = subprocess.run(
            [*pvpython(), str(script), str(path), str(picture)],
            env=environment,
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, done.stderr
        drawing = pv.read(picture)["PNGImage"]
        blue, grey = (
            drawing[:, 2].astype(int) - drawing[:, 0],
            np.ptp(drawing[:, :3].astype(int), axis=1) < 12,
        )
        assert (grey & (drawing[:, 0] < 220)).sum() > 1000  # links
        assert name == "decorated" or (np.abs(blue) > 60).sum() > 1000  # beams coloured by their moment
