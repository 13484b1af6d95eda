"""What can be chosen about a moving picture, and how its frames are picked."""

from dataclasses import dataclass
from math import floor, log10

import numpy as np
from numpy.typing import NDArray

from fmbd.results.scene import Scene

#: Seconds that an animation takes when no speed is given.
LASTS = 6.0
WIDTH = 800
BORDER = 0.08
CLOCK = 34  # pixels, below the mechanism
#: What can colour beams, and its unit.
COLOURS = {"stress": "Pa", "bending_moment": "N m", "shear_force": "N", "deflection": "m", "slope": "rad"}


@dataclass(frozen=True)
class Look:
    """
    speed: seconds of the run in one second of the picture; None for about six seconds in all
    size: width and height [pixels]; None for 800 wide and as high as the mechanism asks for
    trail: the point that leaves a trail, `body.point`; empty for none; None for one that suits
    deflection: factor of the deflections of beams
    colour: what colours the beams: `stress`, `bending_moment`, `shear_force`, `deflection` or `slope`
    camera: `tilted` or `front`
    flat: draw as figures are drawn, without light and depth
    fps: frames a second
    """

    speed: float | None = None
    size: tuple[int, int] | None = None
    trail: str | None = None
    deflection: float = 1.0
    colour: str | None = None
    camera: str = "tilted"
    flat: bool = False
    fps: int = 25


def rounded(value: float) -> float:
    """1, 2 or 5 times a power of ten near a positive value."""
    power = 10.0 ** floor(log10(value))
    lead = value / power
    return float(f"{(1 if lead < 1.5 else 2 if lead < 3.5 else 5 if lead < 7.5 else 10) * power:.0e}")


def frame_rows(time: NDArray[np.float64], look: Look) -> NDArray[np.int64]:
    """The output times nearest to those of the frames."""
    duration = float(time[-1] - time[0])
    speed = look.speed or rounded(duration / LASTS)
    count = max(2, round(look.fps * duration / speed) + 1)
    wanted = np.linspace(time[0], time[-1], count)
    after = np.clip(np.searchsorted(time, wanted), 1, time.size - 1)
    return np.where(wanted - time[after - 1] < time[after] - wanted, after - 1, after)


def pixels(scene: Scene, look: Look) -> tuple[int, int]:
    """Width and height, both even, as video needs them."""
    if look.size is not None:
        width, height = look.size
    else:
        left, right, bottom, top = scene.extent
        border = 2.0 * BORDER * scene.size
        ratio = (top - bottom + border) / (right - left + border)
        width, height = WIDTH, round(WIDTH * float(np.clip(ratio, 0.4, 1.0))) + CLOCK
    return width - width % 2, height - height % 2
