"""Draw a mechanism by Matplotlib: one pose in full, others as ghosts, symbols as mechanics books have them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from numpy.typing import NDArray

from fmbd.results.plots.style import WIDTH, style
from fmbd.results.scene import SYMBOL, Item, Scene

BODY, BODY_EDGE, BEAM, SPRING, INK, MOTOR, TRAIL = (
    "#c3cad3",
    "#6b7787",
    "#0072B2",
    "#009E73",
    "#2b323c",
    "#E69F00",
    "#D55E00",
)
COILS = 6
FIXED = ("ground", "clamp", "rail")
BORDER = 0.08  # of the scene, for symbols


def snapshots(
    scene: Scene,
    rows: Sequence[int] | NDArray[np.int64],
    trail: str | None = None,
    width: float = WIDTH,
) -> Figure:
    """The poses of a scene at some of its times, the last in full, others as ghosts, and the trail of a point."""
    left, right, bottom, top = scene.extent
    border = BORDER * scene.size
    ratio = (top - bottom + 2.0 * border) / (right - left + 2.0 * border)
    with style():
        figure = Figure(figsize=(width, float(np.clip(ratio, 0.2, 1.1)) * width + 0.35), layout="constrained")
        ax = figure.subplots()
        ax.set(xlabel="x [m]", ylabel="y [m]")
        frame(ax, scene)
        if trail is not None:
            track = scene.tracks[trail]
            ax.plot(track.real, track.imag, color=TRAIL, linewidth=1.0, zorder=1.5)
        *before, last = rows
        for k, row in enumerate(before):
            draw_pose(ax, scene, row, opacity=0.12 + 0.25 * k / len(before))
        draw_pose(ax, scene, last)
        return figure


def frame(ax: Axes, scene: Scene) -> None:
    """Equal scales, room for all that the scene ever shows."""
    left, right, bottom, top = scene.extent
    border = BORDER * scene.size
    ax.set_aspect("equal")
    ax.set_xlim(left - border, right + border)
    ax.set_ylim(bottom - border, top + border)


def draw_pose(ax: Axes, scene: Scene, k: int, opacity: float = 1.0) -> None:
    """Draw the items of a scene at its k-th time; ghosts, below full opacity, come without what stands still."""
    size = SYMBOL * scene.size
    for item in scene.items:
        if opacity == 1.0 or item.kind not in FIXED:
            _draw_item(ax, item, item.points[k], size, opacity)


def _draw_item(ax: Axes, item: Item, points: np.ndarray, size: float, opacity: float) -> None:
    base: dict[str, Any] = {"zorder": 2.0 if opacity < 1.0 else 3.0, "alpha": opacity}
    line = base | {"solid_capstyle": "round", "solid_joinstyle": "round"}
    match item.kind:
        case "body" if points.size == 2:
            _line(ax, points, color=BODY_EDGE, linewidth=6.0, **line)
            _line(ax, points, color=BODY, linewidth=4.4, **line)
        case "body" | "shape":
            inside, edge = to_rgba(BODY, 0.85 * opacity), to_rgba(BODY_EDGE, opacity)
            corners = np.stack([points.real, points.imag], axis=1)
            ax.add_patch(
                Polygon(
                    corners,
                    facecolor=inside,
                    edgecolor=edge,
                    linewidth=1.2,
                    joinstyle="round",
                    zorder=base["zorder"],
                )
            )
        case "wheel":
            rim = points[0] + np.abs(points[1] - points[0]) * np.exp(2j * np.pi * np.linspace(0, 1, 49))
            ax.fill(rim.real, rim.imag, facecolor=BODY, edgecolor=BODY_EDGE, linewidth=1.2, **base)
            _line(ax, points, color=BODY_EDGE, linewidth=1.5, **line)
        case "beam":
            _line(ax, points, color=BEAM, linewidth=2.2, **line)
        case "spring":
            _line(ax, coil(points, size), color=SPRING, linewidth=1.1, **line)
        case "rail":
            _line(ax, points, color="0.6", linewidth=0.8, linestyle=(0, (6, 3)), **(base | {"zorder": 1.0}))
        case "block":
            ax.fill(points.real, points.imag, facecolor="white", edgecolor=INK, linewidth=1.2, **base)
        case "ground" | "clamp":
            _ground(ax, item.kind, points, size, base)
        case "pin" | "motor":
            fill = MOTOR if item.kind == "motor" else "white"
            radius = 7.5 if item.kind == "motor" else 4.6
            ax.plot(
                points.real,
                points.imag,
                "o",
                color=fill,
                markeredgecolor=INK,
                markersize=radius,
                markeredgewidth=1.0,
                **(base | {"zorder": base["zorder"] + 0.5}),
            )


def _line(ax: Axes, points: np.ndarray, **look: Any) -> None:
    ax.plot(points.real, points.imag, **look)


def coil(ends: np.ndarray, size: float) -> np.ndarray:
    """Points of a spring between two ends: straight at both, a zigzag between."""
    start, end = ends
    length = abs(end - start)
    if length == 0.0:
        return ends
    along = (end - start) / length
    swing = np.tile([1.0, -1.0], COILS) * 0.6 * size
    s = np.linspace(0.2, 0.8, 2 * COILS)
    zigzag = start + along * (s * length + 1j * swing)
    return np.array([start, start + 0.17 * (end - start), *zigzag, start + 0.83 * (end - start), end])


def ground_symbol(kind: str, points: np.ndarray, size: float) -> tuple[np.ndarray, list[np.ndarray]]:
    """Outline of the support, and its hatching: a triangle under a pin, a wall behind what is clamped."""
    at = points[0]
    if kind == "ground":
        wall, down = at - 1j * 1.7 * size, -1j
        outline = np.array([at, wall - size, wall + size, at])
    else:
        away = (points[1] - points[0]) / abs(points[1] - points[0])
        wall, down = at, -away
        outline = np.array([at + 1j * away * 2.2 * size, at - 1j * away * 2.2 * size])
    side, half = 1j * down, (1.7 if kind == "ground" else 2.2) * size
    feet = wall + side * np.linspace(-half, half, 6)
    hatching = [np.array([wall - side * half, wall + side * half])]
    hatching += [np.array([foot, foot + (down - side) * 0.55 * size]) for foot in feet]
    return outline, hatching


def _ground(ax: Axes, kind: str, points: np.ndarray, size: float, base: dict[str, Any]) -> None:
    outline, hatching = ground_symbol(kind, points, size)
    below = base | {"zorder": 1.2}
    if kind == "ground":
        ax.fill(outline.real, outline.imag, facecolor="white", edgecolor=INK, linewidth=1.0, **below)
    for stroke in hatching:
        _line(ax, stroke, color=INK, linewidth=0.8, **below)
