"""The look of all figures of fmbd, and how they are written. No display is needed."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import matplotlib as mpl
from matplotlib.figure import Figure

WIDTH = 6.7  # inches, two columns of a journal

STYLE: Any = {
    "font.family": "serif",
    "font.serif": ["STIXGeneral", "DejaVu Serif"],
    "mathtext.fontset": "stix",
    "font.size": 9,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "axes.grid": True,
    "axes.linewidth": 0.6,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.xmargin": 0.0,
    "figure.titlesize": 10,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "legend.title_fontsize": 8,
    "lines.linewidth": 0.9,
    "lines.markersize": 3.5,
    "lines.solid_joinstyle": "round",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "savefig.dpi": 300,
    "savefig.facecolor": "white",
    "pdf.fonttype": 42,  # outlines that journals accept
    "svg.hashsalt": "fmbd",
}
# Okabe and Ito's without yellow and black: colour-blind readers and grey prints tell them apart.
COLOURS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9")
DASHES: Any = ("-", (0, (5, 2)), (0, (1, 1.5)))
MARKERS = "osD^vPX*"
#: So many curves have looks of their own.
TOLD_APART = len(COLOURS) * len(DASHES)


@contextmanager
def style() -> Iterator[None]:
    """The look of all figures."""
    with mpl.rc_context(STYLE):
        yield


def told_apart(k: int) -> dict[str, Any]:
    """Colour and dashes of the k-th curve among others."""
    return {"color": COLOURS[k % len(COLOURS)], "linestyle": DASHES[k // len(COLOURS) % len(DASHES)]}


def graded(k: int, count: int) -> tuple[float, float, float, float]:
    """The colour of the k-th of so many curves in an order: a map of colours from dark to light."""
    return mpl.colormaps["viridis"](0.9 * k / max(1, count - 1))


def save(figure: Figure, file: str | Path | BinaryIO, suffix: str = "") -> None:
    """Write a figure in the format of a suffix (default: the file's), the same bytes for the same figure.

    Raises OSError with the name of the file.
    """
    suffix = suffix or Path(str(file)).suffix.lower()
    undated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
    with style():
        figure.draw_without_rendering()  # a first layout may change the ticks, the second fits them
        figure.savefig(file, format=suffix[1:], metadata=undated.get(suffix))
