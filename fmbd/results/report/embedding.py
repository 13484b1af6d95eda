"""A run as compact data for the page: numbers as base64 of little-endian float32, each array once."""

import base64
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fmbd.results.plots.charts import Chart, Panel, scale_of
from fmbd.results.scene import SYMBOL, Item, main_track, scene, spread

if TYPE_CHECKING:
    from fmbd.results.run import Run

#: Bytes of the mechanism's frames, and frames at most; bytes of all plots.
SCENE_BYTES = 1_600_000
FRAMES = 600
PLOT_BYTES = 1_600_000


class Arrays:
    """Arrays to embed; `add` gives the place of an array, the same for an array that was added before."""

    def __init__(self) -> None:
        self.texts: list[str] = []
        self._places: dict[bytes, int] = {}

    def add(self, values: NDArray[Any]) -> int:
        """The place of an array in `texts`."""
        raw = np.ascontiguousarray(values, dtype="<f4").tobytes()
        if raw not in self._places:
            self._places[raw] = len(self.texts)
            self.texts.append(base64.b64encode(raw).decode())
        return self._places[raw]


def embedded_scene(run: "Run", arrays: Arrays) -> dict[str, Any]:
    """The mechanism at some hundred output times; items that stand still have one frame."""
    ends = scene(run, spread(len(run.time), 2))
    numbers = 2 * (sum(item.points.shape[1] + 2 for item in ends.items) + len(ends.tracks))
    frames = int(np.clip(SCENE_BYTES / (4 * numbers), 2, FRAMES))
    shown = scene(run, spread(len(run.time), frames))
    return {
        "time": arrays.add(shown.time),
        "extent": shown.extent,
        "symbol": SYMBOL * shown.size,
        "items": [_item(item, arrays) for item in shown.items],
        "tracks": {name: arrays.add(_pairs(track[:, None])) for name, track in shown.tracks.items()},
        "trail": main_track(run, shown.tracks),
    }


def _item(item: Item, arrays: Arrays) -> dict[str, Any]:
    points = item.points if np.ptp(item.points, axis=0).any() else item.points[:1]
    found = {
        "kind": item.kind,
        "body": item.body,
        "count": points.shape[1],
        "points": arrays.add(_pairs(points)),
    }
    if item.straight is not None and item.along is not None:
        found["straight"] = arrays.add(_pairs(item.straight))
        found["along"] = item.along.tolist()
    return found


def _pairs(points: NDArray[np.complex128]) -> NDArray[np.float64]:
    """x and y after each other, frame by frame."""
    return np.stack([points.real, points.imag], axis=-1).ravel()


def embedded_charts(charts: Iterable[Chart], arrays: Arrays) -> list[dict[str, Any]]:
    """Charts with their curves; long ones as the extremes of intervals, which look the same."""
    charts = list(charts)
    curves = sum(len(panel.curves) for chart in charts for panel in chart.panels)
    most = PLOT_BYTES // (4 * max(1, curves))
    return [
        {
            "title": chart.title,
            "across": chart.across,
            "logarithmicAcross": chart.logarithmic_across,
            "rows": [[_panel(panel, most, arrays) for panel in row] for row in chart.rows],
        }
        for chart in charts
    ]


def _panel(panel: Panel, most: int, arrays: Arrays) -> dict[str, Any]:
    factor, unit = scale_of(panel)
    curves = []
    for curve in panel.curves:
        x, y = envelope(curve.x, curve.y, most)
        places = {"x": arrays.add(x), "y": arrays.add(factor * y)}
        curves.append({"label": curve.label, "look": curve.look, **places})
    return {
        "quantity": panel.quantity,
        "unit": unit,
        "title": panel.title,
        "logarithmic": panel.logarithmic,
        "family": panel.together == "family",
        "curves": curves,
    }


def envelope(
    x: NDArray[np.float64], y: NDArray[np.float64], most: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """At most so many points of a curve: the lowest and the highest of each interval, in their order."""
    if x.size <= most:
        return x, y
    per = -(-2 * x.size // most)
    whole = x.size // per * per
    parts = y[:whole].reshape(-1, per)
    low, high = parts.argmin(axis=1), parts.argmax(axis=1)
    pairs = np.sort(np.stack([low, high], axis=1), axis=1) + per * np.arange(len(parts))[:, None]
    kept = np.unique(np.concatenate([[0], pairs.ravel(), [x.size - 1]]))
    return x[kept], y[kept]


def embedded(run: "Run", charts: Iterable[Chart]) -> dict[str, Any]:
    """All data of a page."""
    arrays = Arrays()
    scene, plots = embedded_scene(run, arrays), embedded_charts(charts, arrays)
    return {"scene": scene, "charts": plots, "arrays": arrays.texts}
