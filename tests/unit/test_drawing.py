"""The drawing in an archive shows bodies where the named outputs say that they are."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

import fmbd
from fmbd.model import load_model_text
from fmbd.results.drawing import convex_hull
from fmbd.results.vtkhdf import KINDS

SHAPES = """
fmbd: 1
gravity: [0, -9.81]
ground: {points: {W: [0.5, 0.5]}}
bodies:
  plate: {type: rigid, density: 7700, points: {e: [0.5, 0.1]},
          shape: {type: box, length: 0.5, height: 0.06, width: 0.06, center: [0.25, 0], angle: 0.2}}
  bar: {type: rigid, density: 7700, points: {e: [0.4, -0.2]},
        shape: {type: rod, length: 0.5, diameter: 0.02, angle: -0.5}}
  disc: {type: rigid, density: 7700, shape: {type: disc, radius: 0.1, thickness: 0.02, center: [0.05, 0]}}
  stick: {type: rigid, mass: 1, inertia: 1, points: {a: [0.1, 0], b: [0.3, 0.2], middle: [0.2, 0.1]}}
  spring: {type: beam, length: 0.6, elements: 3, mass_per_length: 1, bending_stiffness: 5}
joints:
  p: {type: revolute, between: [ground.origin, plate.origin]}
  q: {type: revolute, between: [plate.e, bar.origin]}
  r: {type: revolute, between: [bar.e, disc.origin]}
  s: {type: free, between: [ground.W, stick.a]}
  t: {type: weld, between: [stick.b, spring.start]}
springs: {k: {type: point_to_point, between: [ground.W, bar.e], stiffness: 10}}
simulation: {duration: 0.3, output_interval: 0.01}
"""


class Picture:
    """The frames of an archived run and the output times that they belong to."""

    def __init__(self, run: fmbd.Run) -> None:
        self.run = run
        self.drawing, (times, self.points) = run.source.drawing, run.source.frames
        self.rows = np.searchsorted(run.time, times)
        assert_allclose(run.time[self.rows], times)

    def cells(self, body: str, kind: str) -> list[np.ndarray]:
        """Points of the cells of a body, each of shape (frames, n, 2)."""
        wanted = self.drawing.names.index(body), KINDS.index(kind)
        labels = zip(self.drawing.body_id, self.drawing.kind, strict=True)
        cells = zip(labels, self.drawing.cells(), strict=True)
        return [self.points[:, cell, :2] for label, cell in cells if label == wanted]

    def place(self, name: str) -> np.ndarray:
        return self.run[f"{name}.position"][self.rows]


@pytest.fixture(scope="module")
def picture(tmp_path_factory: pytest.TempPathFactory) -> Picture:
    path = tmp_path_factory.mktemp("drawing") / "run.vtkhdf"
    return Picture(fmbd.simulate(load_model_text(SHAPES), path))


def area_and_centroid(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of polygons (frames, n, 2), by the shoelace formula."""
    after = np.roll(corners, -1, axis=1)
    twice = corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0]
    area = twice.sum(axis=1) / 2.0
    return area, ((corners + after) * twice[..., None]).sum(axis=1) / (6.0 * area[:, None])


@pytest.mark.parametrize(
    ("body", "area"),
    [("plate", 0.5 * 0.06), ("bar", 0.5 * 0.02), ("disc", 24 * 0.1**2 * np.sin(2 * np.pi / 48))],
)
def test_shapes_have_their_size_and_lie_about_the_centre_of_mass(
    picture: Picture, body: str, area: float
) -> None:
    """A disc is drawn with 48 corners."""
    (corners,) = picture.cells(body, "rigid body")
    drawn, centroid = area_and_centroid(corners.astype(float))
    assert_allclose(drawn, area, rtol=1e-5)
    assert_allclose(centroid, picture.place(f"{body}.center_of_mass"), atol=1e-6)


def test_a_body_without_a_shape_connects_its_points(picture: Picture) -> None:
    """Points on a line give a line, from the first to the last."""
    (ends,) = picture.cells("stick", "rigid body")
    assert_allclose(ends[:, 0], picture.place("stick.a"), atol=1e-6)
    assert_allclose(ends[:, 1], picture.place("stick.b"), atol=1e-6)


def test_beams_are_curves_through_their_nodes(picture: Picture) -> None:
    (curve,) = picture.cells("spring", "beam")
    assert curve.shape[1] == 25
    for k in range(4):
        assert_allclose(curve[:, 8 * k], picture.place(f"spring.node{k}"), atol=1e-6)


def test_joints_ground_points_and_springs_are_drawn(picture: Picture) -> None:
    """A free joint is no part that could be seen."""
    (pin,) = picture.cells("plate", "joint")
    assert_allclose(pin[:, 0], picture.place("plate.e"), atol=1e-6)
    (wall,) = picture.cells("ground", "ground point")
    assert_allclose(wall[:, 0], picture.place("ground.W"), atol=1e-6)
    (spring,) = picture.cells("ground", "spring")
    assert_allclose(spring[:, 1], picture.place("bar.e"), atol=1e-6)
    assert len(picture.cells("ground", "joint")) == 1


def test_vtk_plays_the_archive(picture: Picture) -> None:
    """What ParaView reads at the last time: the points of the last frame."""
    reader = vtkHDFReader()
    reader.SetFileName(str(picture.run.source.path))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    assert_allclose(times, picture.run.time[picture.rows])
    reader.UpdateTimeStep(times[-1])
    points = vtk_to_numpy(reader.GetOutputAsDataSet().GetPoints().GetData())
    np.testing.assert_array_equal(points, picture.points[-1])


def test_frames_are_as_many_as_asked_for_and_reach_from_start_to_end(tmp_path: Path) -> None:
    run = fmbd.simulate(load_model_text(SHAPES), tmp_path / "run.vtkhdf", frames=7)
    times, _ = run.source.frames
    assert_allclose(times, np.linspace(0.0, 0.3, 7))
    assert fmbd.simulate(load_model_text(SHAPES), tmp_path / "none.vtkhdf", frames=0).source.drawing is None


def test_the_convex_hull_leaves_out_points_inside_and_on_edges() -> None:
    square = np.array([0, 1, 1 + 1j, 1j, 0.5, 0.5 + 0.5j, 1 + 0.25j, 0])
    np.testing.assert_array_equal(convex_hull(square), [0, 1, 1 + 1j, 1j])
    np.testing.assert_array_equal(convex_hull(np.array([2 + 2j, 0, 1 + 1j])), [0, 2 + 2j])
