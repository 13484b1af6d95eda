"""Mode shapes drawn on the mechanism: at rest, and moved by the shape, both ways where it swings.

p(q)   points of the drawing at coordinates q: beams, corners of bodies, joints
dp     their displacements p'(q0) Re(s exp(i phi)) for a shape s, to first order in the shape, so that loops stay
       closed in the picture, however much it is exaggerated; phi is where they are largest in the mean
"""

from dataclasses import replace
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fmbd.errors import AnalysisError
from fmbd.results.layout import ENERGIES
from fmbd.results.plots.mechanism import BORDER, draw_pose, frame
from fmbd.results.plots.style import WIDTH, style
from fmbd.results.recording import Recording
from fmbd.results.run import Run
from fmbd.results.scene import Item, Scene, scene

if TYPE_CHECKING:
    from fmbd.analyses.vibrations import Modes

Array = np.ndarray

COLUMNS = 3
#: Longest displacement, in shares of the size of the mechanism.
REACH = 0.09
#: Largest turn of a body [rad].
TURN = 0.35
LETTERS = 14  # an inch, of the heading
_STEP = 1e-6  # of the differences, of the largest coordinate [rad or m]
_UNMOVED = 1e-12
_REST, _BACK = 0.16, 0.4  # opacities


def draw(modes: "Modes", number: int, width: float = WIDTH) -> Figure:
    """The first modes, each in a panel with its frequency and damping; raises AnalysisError where nothing moves."""
    count = min(number, modes.poles.size)
    if not count:
        raise AnalysisError("nothing can move: there are no modes to draw")
    scenes = [_moved(modes, k) for k in range(count)]
    extent = _around([each.extent for each in scenes])
    columns = min(COLUMNS, count)
    rows = -(-count // columns)
    with style():
        left, right, bottom, top = extent
        border = 2.0 * BORDER * max(right - left, top - bottom)
        height = min((top - bottom + border) / (right - left + border), 1.3) * (width - 0.6) / columns
        figure = Figure(figsize=(width, rows * (height + 0.36) + 0.6), layout="compressed")
        axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
        for k, ax in enumerate(axes.flat):
            if k < count:
                _draw_mode(ax, replace(scenes[k], extent=extent), modes, k)
            else:
                ax.set_axis_off()
        for ax in axes.flat[max(0, count - columns) : count]:
            ax.set_xlabel("x [m]")
            ax.xaxis.set_tick_params(labelbottom=True)
        for ax in axes[:, 0]:
            ax.set_ylabel("y [m]")
        name = modes.base.linearisation.system.model.name
        about = f"{name}: modes about {modes.base.place}, exaggerated; pale: at rest, half a period later"
        figure.suptitle(fill(about, round(width * LETTERS)), fontsize="medium")
        return figure


def _draw_mode(ax: Axes, scene: Scene, modes: "Modes", k: int) -> None:
    frame(ax, scene)
    draw_pose(ax, scene, 0, _REST)
    if modes.frequencies[k] > 0.0:
        draw_pose(ax, scene, 2, _BACK)
    draw_pose(ax, scene, 1)
    ax.set_title(_title(modes, k))


def _around(extents: list[tuple[float, float, float, float]]) -> tuple[float, float, float, float]:
    """What holds all: left, right, bottom, top."""
    left, right, bottom, top = zip(*extents)
    return min(left), max(right), min(bottom), max(top)


def _title(modes: "Modes", k: int) -> str:
    """Number, frequency and damping of a mode."""
    if modes.poles[k] == 0.0:
        return f"{k + 1}: free"
    time, ratio = modes.decay_times[k], modes.damping_ratios[k]
    if modes.frequencies[k] == 0.0:
        return f"{k + 1}: {'decays' if time > 0.0 else 'grows'} in {abs(time):.3g} s"
    damping = "undamped" if np.isinf(time) else f"ζ = {ratio:.2g}"
    return f"{k + 1}: {modes.frequencies[k]:.4g} Hz, {damping}"


def _moved(modes: "Modes", k: int) -> Scene:
    """The mechanism at rest, moved by a shape, and moved the other way."""
    a, b = modes.shapes[k].real, modes.shapes[k].imag
    drawn = scene(_at(modes, _STEP * np.array([np.zeros_like(a), a, -a, b, -b])), np.arange(5))
    real = [(item.points[1] - item.points[2]) / (2.0 * _STEP) for item in drawn.items]
    imaginary = [(item.points[3] - item.points[4]) / (2.0 * _STEP) for item in drawn.items]
    phase = _largest(np.concatenate(real), np.concatenate(imaginary))
    moves = [np.cos(phase) * x - np.sin(phase) * y for x, y in zip(real, imaginary)]
    scale = _scale(drawn, moves)
    places = [_displaced(item, scale * move) for item, move in zip(drawn.items, moves)]
    items = tuple(replace(item, points=points, straight=None) for item, points in zip(drawn.items, places))
    every = np.concatenate([points.ravel() for points in places])
    left, right, bottom, top = every.real.min(), every.real.max(), every.imag.min(), every.imag.max()
    return Scene(drawn.time[:3], items, {}, (float(left), float(right), float(bottom), float(top)))


def _at(modes: "Modes", steps: Array) -> Run:
    """Steps (k, nq) away from where the modes are about, as a run."""
    lin = modes.base.linearisation
    system, count = lin.system, len(steps)
    recording = Recording(system.coordinates, system.constraints, system.states, [])
    none = {name: np.zeros(count) for name in ENERGIES}
    rates, multipliers = np.zeros_like(steps), np.zeros((count, len(system.constraints)))
    states = np.tile(lin.state[2], (count, 1))
    time = np.full(count, lin.arrangement.t)
    recording.write(time, lin.state[0] + steps, rates, rates, multipliers, states, none, {})
    recording.finish("complete", {})
    return Run(recording, lambda: system.model, lambda: system)


def _largest(a: Array, b: Array) -> float:
    """The phase at which a cos - b sin is largest in the mean."""
    return 0.5 * float(np.arctan2(-2.0 * (a * b.conj()).sum().real, (abs(a) ** 2 - abs(b) ** 2).sum()))


def _scale(scene: Scene, moves: list[Array]) -> float:
    """What displacements are drawn at: as far as REACH, turning no body by more than TURN."""
    farthest, fastest = 0.0, 0.0
    for item, move in zip(scene.items, moves):
        if item.kind == "wheel":
            farthest = max(farthest, abs(move[0]))
            continue
        farthest = max(farthest, np.abs(move).max())
        if item.points.shape[1] > 1:
            along = item.points[0, -1] - item.points[0, 0]
            fastest = max(fastest, abs(((move[-1] - move[0]) / along).imag) if along else 0.0)
    if farthest < _UNMOVED:
        return 1.0
    return min(REACH * scene.size / farthest, TURN / max(fastest, 1e-300))


def _displaced(item: Item, move: Array) -> Array:
    """Points at rest, moved, moved the other way, shape (3, n); wheels turn and keep their size."""
    signs = np.array([[0.0], [1.0], [-1.0]])
    points = item.points[0] + signs * move
    if item.kind == "wheel":
        spoke = item.points[0, 1] - item.points[0, 0]
        turn = ((move[1] - move[0]) / spoke).imag
        points[:, 1] = points[:, 0] + spoke * np.exp(1j * signs[:, 0] * turn)
    return points
