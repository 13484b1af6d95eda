"""A scene drawn as figures are: for machines that cannot draw in three dimensions, and for who likes it."""

from collections.abc import Sequence

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fmbd.results.animation.look import CLOCK, Look, pixels
from fmbd.results.plots.mechanism import INK, TRAIL, draw_pose, frame
from fmbd.results.plots.style import style
from fmbd.results.scene import Scene

Image = NDArray[np.uint8]

DPI = 150


class FlatStage:
    """The items of a scene on paper; as `stage.Stage`."""

    def __init__(self, scene: Scene, look: Look) -> None:
        self.scene = scene
        width, height = pixels(scene, look)
        self.figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
        self.clock = CLOCK / height
        self.canvas = FigureCanvasAgg(self.figure)

    def __enter__(self) -> "FlatStage":
        return self

    def __exit__(self, *_: object) -> None:
        self.figure.clear()

    def image(self, k: int, trail: str | None) -> Image:
        """The picture at the k-th time, shape (height, width, 3)."""
        return self.still((), k, trail)

    def still(self, ghosts: Sequence[int], k: int, trail: str | None) -> Image:
        """The picture at the k-th time, with what moves at other times as ghosts."""
        self.figure.clear()
        with style():
            ax = self.figure.add_axes((0.0, self.clock, 1.0, 1.0 - self.clock))
            frame(ax, self.scene)
            ax.set_axis_off()
            if trail is not None:
                track = self.scene.tracks[trail][: k + 1]
                ax.plot(track.real, track.imag, color=TRAIL, linewidth=1.0, zorder=1.5)
            for n, row in enumerate(ghosts):
                draw_pose(ax, self.scene, row, opacity=0.1 + 0.25 * n / len(ghosts))
            draw_pose(ax, self.scene, k)
            self.figure.text(0.015, 0.02, f"t = {self.scene.time[k]:.3f} s", color=INK)
            self.canvas.draw()
        return np.asarray(self.canvas.buffer_rgba())[..., :3].copy()
