"""Write pictures, one after the other, into files."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]
Writer = Callable[[Path, Iterator[Image], int], None]

FORMATS = (".gif", ".mp4", ".png")
PALETTE = 128


def writer_for(suffix: str) -> Writer:
    """What writes files of a suffix; raises ValueError where something is not installed."""
    if suffix == ".mp4":
        try:
            import imageio_ffmpeg  # noqa: F401
        except ModuleNotFoundError:
            raise ValueError(
                "mp4 needs imageio-ffmpeg: pip install 'fmbd[video]'; gif needs nothing more"
            ) from None
    return {".gif": write_gif, ".mp4": write_mp4, ".png": write_png}[suffix]


def write_gif(path: Path, images: Iterator[Image], fps: int) -> None:
    """Write an animation that repeats for ever; all frames share a palette."""
    from PIL import Image as Pillow

    frames = [Pillow.fromarray(image) for image in images]
    sample = np.concatenate([np.asarray(frame)[::2, ::2] for frame in frames[:: max(1, len(frames) // 8)]])
    palette = Pillow.fromarray(sample).quantize(PALETTE)
    colours = np.array(palette.getpalette()).reshape(-1, 3)
    colours[colours.sum(axis=1).argmax()] = 255  # the paper stays white
    palette.putpalette(colours.ravel().tolist())
    reduced = [frame.quantize(palette=palette, dither=Pillow.Dither.NONE) for frame in frames]
    reduced[0].save(
        path, format="GIF", save_all=True, append_images=reduced[1:], duration=1000 // fps, loop=0
    )


def write_mp4(path: Path, images: Iterator[Image], fps: int) -> None:
    """Write a video (H.264) that players and slides show."""
    import imageio_ffmpeg

    first = next(images)
    height, width, _ = first.shape
    video = imageio_ffmpeg.write_frames(
        str(path),
        (width, height),
        fps=fps,
        codec="libx264",
        quality=7,
        macro_block_size=2,
        ffmpeg_log_level="error",
    )
    video.send(None)
    video.send(np.ascontiguousarray(first))
    for image in images:
        video.send(np.ascontiguousarray(image))
    video.close()


def write_png(path: Path, images: Iterator[Image], fps: int) -> None:
    """Write the one picture."""
    from PIL import Image as Pillow

    Pillow.fromarray(next(images)).save(path, format="PNG", optimize=True)
