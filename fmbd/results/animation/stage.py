"""A scene in light and depth: pyvista draws it off-screen."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from vtkmodules.vtkCommonCore import vtkLogger

from fmbd.model import Beam, Model
from fmbd.results.animation.look import BORDER, CLOCK, COLOURS, Look, pixels
from fmbd.results.animation.solids import heights, layers, moved, solid, tube
from fmbd.results.plots.charts import scaled
from fmbd.results.plots.mechanism import BEAM, INK, MOTOR, SPRING, TRAIL
from fmbd.results.scene import SYMBOL, Item, Scene

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

PAINT = {
    "body": "#b4bdc9",
    "shape": "#b4bdc9",
    "wheel": "#b4bdc9",
    "beam": BEAM,
    "spring": SPRING,
    "block": "#e8ebef",
    "rail": "#9aa4b1",
    "pin": INK,
    "motor": MOTOR,
    "ground": "#8f9aa8",
    "clamp": "#8f9aa8",
}
SHADING: Any = {"smooth_shading": True, "ambient": 0.25, "diffuse": 0.8, "specular": 0.15}
#: The bar of colours, and the share of the picture that it is left.
BAR: Any = {
    "color": INK,
    "title_font_size": 16,
    "label_font_size": 14,
    "n_labels": 3,
    "fmt": "%.3g",
    "width": 0.4,
    "height": 0.13,
    "position_x": 0.57,
    "position_y": 0.02,
}
BAR_SHARE = 0.16
TITLE_GAP = "\n "  # keeps it off the numbers
THEME = pv.themes.DocumentTheme()  # on white
VIEWS = {"front": (0.0, 0.0, 1.0), "tilted": (0.0, -0.4, 1.0)}
DEFORMING = ("beam", "spring")
FIXED = ("ground", "clamp", "rail")


class SolidStage:
    """The items of a scene as solids that move; a context manager.

    values: what colours each beam, by its name: at its nodes, (nt, nodes)
    """

    def __init__(self, scene: Scene, model: Model, look: Look, values: Mapping[str, Array]) -> None:
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
        self.scene, self.look = scene, look
        self.unit, self.layer = SYMBOL * scene.size, layers(model)
        self.nodes = {
            name: np.array(body.nodes) / body.length
            for name, body in model.bodies.items()
            if isinstance(body, Beam)
        }
        self.values, self.title, self.limit = _scaled(look.colour or "", values)
        self.plotter = pv.Plotter(off_screen=True, window_size=list(pixels(scene, look)), theme=THEME)
        self.plotter.enable_anti_aliasing("ssaa")
        self.actors = [self._add(item, 0) for item in scene.items]
        self._aim()

    def __enter__(self) -> "SolidStage":
        return self

    def __exit__(self, *_: object) -> None:
        self.plotter.close()

    def image(self, k: int, trail: str | None) -> Image:
        """The picture at the k-th time, shape (height, width, 3)."""
        for item, actor in zip(self.scene.items, self.actors):
            if item.kind in DEFORMING:
                actor.mapper.dataset = self._mesh(item, k)
            elif item.kind not in FIXED:
                actor.user_matrix = moved(item.points[0], item.points[k])
        if trail is not None:
            self._draw_trail(self.scene.tracks[trail][: k + 1], trail.partition(".")[0])
        self.plotter.add_text(
            f"t = {self.scene.time[k]:.3f} s",
            position=(14, 12),
            font_size=10,
            color=INK,
            name="clock",
            render=False,
        )
        self.plotter.camera.clipping_range = (0.5 * self.scene.size, 6.0 * self.scene.size)
        self.plotter.render()
        return np.asarray(self.plotter.screenshot(None, return_img=True))

    def still(self, ghosts: Sequence[int], k: int, trail: str | None) -> Image:
        """The picture at the k-th time, with what moves at other times as ghosts."""
        for n, row in enumerate(ghosts):
            for item in self.scene.items:
                if item.kind not in (*FIXED, "pin", "motor"):
                    self._add(item, row, opacity=0.06 + 0.16 * (n + 1) / len(ghosts))
        return self.image(k, trail)

    def _add(self, item: Item, k: int, opacity: float = 1.0) -> pv.Actor:
        mesh, sharp = self._mesh(item, k), item.kind not in DEFORMING
        look: Any = SHADING | {"opacity": opacity, "split_sharp_edges": sharp}
        if item.kind == "beam" and item.body in self.values:
            look |= {"scalars": "value", "cmap": "coolwarm", "clim": (-self.limit, self.limit)}
            return self.plotter.add_mesh(
                mesh, scalar_bar_args=BAR | {"title": self.title + TITLE_GAP}, **look
            )
        return self.plotter.add_mesh(mesh, color=PAINT[item.kind], **look)

    def _mesh(self, item: Item, k: int) -> pv.PolyData:
        mesh = solid(item, item.points[k], self.unit, self.layer)
        if item.kind == "beam" and item.body in self.values:
            along = self.values[item.body][k]
            start, end = item.points[k][[0, -1]]
            place = ((mesh.points[:, 0] + 1j * mesh.points[:, 1] - start) / (end - start)).real
            mesh["value"] = np.interp(place, self.nodes[item.body], along)
        return mesh

    def _draw_trail(self, track: NDArray[np.complex128], body: str) -> None:
        height = sum(heights(self.layer[body], self.unit)) / 2.0
        step = np.abs(np.diff(track, prepend=track[0] - 1.0)) > 1e-3 * self.unit
        if np.count_nonzero(step) > 1:
            mesh = tube(track[step], height, 0.2 * self.unit)
            self.plotter.add_mesh(
                mesh, color=TRAIL, ambient=0.4, diffuse=0.6, name="trail", reset_camera=False, render=False
            )

    def _aim(self) -> None:
        """Everything that ever moves in the picture, seen without perspective."""
        left, right, bottom, top = self.scene.extent
        width, height = pixels(self.scene, self.look)
        border = 2.0 * BORDER * self.scene.size
        direction = np.array(VIEWS[self.look.camera])
        camera = self.plotter.camera
        camera.parallel_projection = True
        share = BAR_SHARE if self.values else CLOCK / height
        half = 0.5 * max((top - bottom + border) / (1.0 - share), (right - left + border) * height / width)
        centre = np.array([0.5 * (left + right), 0.5 * (bottom + top) - share * half, 0.0])
        camera.parallel_scale = half
        camera.focal_point = tuple(centre)
        camera.position = tuple(centre + 3.0 * self.scene.size * direction)
        camera.up = (0.0, 1.0, 0.0)


def _scaled(name: str, values: Mapping[str, Array]) -> tuple[dict[str, Array], str, float]:
    """Values in a unit that reads well, what they are, and the largest."""
    largest = max((float(np.abs(each).max()) for each in values.values()), default=0.0) or 1.0
    factor, unit = scaled(COLOURS.get(name, ""), largest)
    return (
        {beam: factor * each for beam, each in values.items()},
        f"{name.replace('_', ' ')} [{unit}]",
        factor * largest,
    )
