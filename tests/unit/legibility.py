"""Whether the texts of a figure can be read."""

from itertools import combinations

from matplotlib.figure import Figure
from matplotlib.text import Text


def overlaps(figure: Figure) -> list[tuple[str, str]]:
    """Texts that lie on each other, or outside the figure."""
    for _ in range(2):  # as `save` does
        figure.draw_without_rendering()
    ticks = {
        text: low - 1e-9 * abs(at) <= at <= high + 1e-9 * abs(at)
        for ax in figure.axes
        for axis in (ax.xaxis, ax.yaxis)
        for low, high in [sorted(axis.get_view_interval())]
        for minor in (False, True)
        for at, text in zip(axis.get_ticklocs(minor=minor), axis.get_ticklabels(minor=minor))
    }
    texts = [text for text in figure.findobj(Text) if text.get_visible() and text.get_text().strip()]
    boxes = [(text.get_text(), text.get_window_extent()) for text in texts if ticks.get(text, True)]
    outside = [
        (name, "the edge")
        for name, box in boxes
        if box.x0 < 0 or box.y0 < 0 or box.x1 > figure.bbox.x1 or box.y1 > figure.bbox.y1
    ]
    return outside + [(a, b) for (a, one), (b, other) in combinations(boxes, 2) if one.overlaps(other)]
