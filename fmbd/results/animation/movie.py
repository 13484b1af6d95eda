"""Animations of runs: GIF, MP4, and PNG for a still with ghosts."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from fmbd.errors import UnknownQuantity
from fmbd.model import Beam
from fmbd.model.names import unknown
from fmbd.results.animation.files import FORMATS, writer_for
from fmbd.results.animation.look import COLOURS, Look, frame_rows
from fmbd.results.animation.probe import ADVICE, can_render
from fmbd.results.scene import Scene, main_track, scene, spread

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fmbd.results.run import Run

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

GHOSTS = 5
STILL_ROWS = 400


class Stage(Protocol):
    """What draws a scene: `stage.SolidStage` or `flat.FlatStage`."""

    def __enter__(self) -> Self: ...

    def __exit__(self, *_: object) -> None: ...

    def image(self, k: int, trail: str | None) -> Image:
        """The picture at the k-th time, shape (height, width, 3)."""

    def still(self, ghosts: "Sequence[int]", k: int, trail: str | None) -> Image:
        """The picture at the k-th time, with what moves at other times as ghosts."""


def animate(
    run: "Run",
    path: str | Path,
    look: Look | None = None,
    on_frame: Callable[[int, int], None] = lambda done, count: None,
    on_remark: Callable[[str], None] = lambda remark: None,
) -> int:
    """Draw a run into a file, .gif or .mp4, or .png for a still with ghosts; returns the number of pictures.

    on_frame: called with the frames done and their number; on_remark: with what a user should know

    Raises ValueError for what cannot be drawn, UnknownQuantity for a colour or trail that the run does not have.
    """
    path, look = Path(path), look or Look()
    if path.suffix.lower() not in FORMATS:
        raise ValueError(f"the file must end in {', '.join(FORMATS)}, not in '{path.suffix}'")
    if len(run.time) < 2:
        raise ValueError("there is nothing to animate: the run has fewer than two outputs")
    write = writer_for(path.suffix.lower())
    still = path.suffix.lower() == ".png"
    rows = spread(len(run.time), STILL_ROWS) if still else frame_rows(run.time, look)
    shown = scene(run, rows).exaggerated(look.deflection)
    trail = _trail(run, shown, look)
    with _stage(run, shown, look, _colours(run, rows, look), on_remark) as stage:
        if still:
            *ghosts, last = spread(len(rows), GHOSTS + 1).tolist()
            write(path, iter([stage.still(ghosts, last, trail)]), look.fps)
            return 1

        def images() -> Iterator[Image]:
            for k in range(len(rows)):
                yield stage.image(k, trail)
                on_frame(k + 1, len(rows))

        write(path, images(), look.fps)
    return len(rows)


def _stage(
    run: "Run", shown: Scene, look: Look, values: Mapping[str, Array], on_remark: Callable[[str], None]
) -> Stage:
    from fmbd.results.animation.flat import FlatStage

    if look.flat:
        return FlatStage(shown, look)
    if not can_render():
        on_remark(f"{ADVICE}: it is drawn flat")
        return FlatStage(shown, look)
    from fmbd.results.animation.stage import SolidStage

    return SolidStage(shown, run.model, look, values)


def _trail(run: "Run", shown: Scene, look: Look) -> str | None:
    if look.trail is None:
        return main_track(run, shown.tracks)
    if look.trail and look.trail not in shown.tracks:
        raise UnknownQuantity(unknown("moving point", look.trail, shown.tracks))
    return look.trail or None


def _colours(run: "Run", rows: NDArray[np.int64], look: Look) -> dict[str, Array]:
    """Values at the nodes of each beam that has them, by its name."""
    if look.colour is None:
        return {}
    if look.flat:
        raise ValueError("colours of beams are not drawn flat")
    if look.colour not in COLOURS:
        raise UnknownQuantity(unknown("colour", look.colour, COLOURS))
    beams = [name for name, body in run.model.bodies.items() if isinstance(body, Beam)]
    return {name: run[f"{name}.{look.colour}"][rows] for name in beams}
