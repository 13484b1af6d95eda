"""Frequency responses as Bode plots: a column for each input, gain and phase of outputs, those of a unit together."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from fmbd.analyses.sampling import sampled
from fmbd.errors import AnalysisError
from fmbd.results.plots.charts import typeset
from fmbd.results.plots.style import TOLD_APART, WIDTH, graded, style, told_apart

if TYPE_CHECKING:
    from fmbd.analyses.state_space import StateSpace

Array = np.ndarray

COLUMNS = 3
ROW = 1.35  # inches
#: Gains below this share of the largest of their panel are round-off.
NOTHING = 1e-12
TURNS = (15.0, 30.0, 45.0, 90.0, 180.0, 360.0, 720.0)  # degrees, between marks
LEGEND_NAMES = 3  # side by side


def draw(space: "StateSpace", frequencies: Array, width: float = WIDTH) -> Figure:
    """Gain and phase from the lowest to the highest frequency [Hz]; raises AnalysisError without input or output."""
    if not space.inputs or not space.outputs:
        raise AnalysisError("there is no response to draw: the state space has no inputs or no outputs")
    at = sampled(space, float(np.min(frequencies)), float(np.max(frequencies)))
    response = space.frequency_response(at)
    units = list(dict.fromkeys(unit for _, unit in space.outputs))
    blocks = -(-len(space.inputs) // COLUMNS)
    columns = -(-len(space.inputs) // blocks)
    rows = 2 * len(units)
    with style():
        lines = -(-len(space.outputs) // LEGEND_NAMES)
        height = ROW * rows * blocks + 0.17 * lines + 0.6
        figure = Figure(figsize=(width, height), layout="constrained")
        axes = figure.subplots(rows * blocks, columns, sharex=True, sharey="row", squeeze=False)
        for k, (name, unit_in) in enumerate(space.inputs):
            block, column = divmod(k, columns)
            own = axes[rows * block : rows * (block + 1), column]
            own[0].set_title(f"by {name}")
            for (gain, phase), unit in zip(own.reshape(-1, 2), units):
                chosen = [j for j, (_, other) in enumerate(space.outputs) if other == unit]
                _draw_response(gain, phase, at, response[:, chosen, k], [_look(space, j) for j in chosen])
                if not column or unit_in != space.inputs[k - 1][1]:
                    gain.set_ylabel(f"gain [{_quotient(unit, unit_in)}]")
                    phase.set_ylabel("phase [°]")
            own[-1].set_xlabel("frequency [Hz]")
            own[-1].xaxis.set_tick_params(labelbottom=True)
        for ax in axes[rows * (blocks - 1) :, len(space.inputs) - columns * (blocks - 1) :].flat:
            ax.set_axis_off()
        handles = [Line2D([], [], **_look(space, j)) for j in range(len(space.outputs))]
        names = [name for name, _ in space.outputs]
        figure.legend(handles, names, loc="outside upper center", ncols=LEGEND_NAMES)
        figure.align_ylabels()
        return figure


def _draw_response(gain: Axes, phase: Axes, f: Array, response: Array, looks: list[dict[str, Any]]) -> None:
    """Curves of outputs, the columns of the response."""
    size = np.abs(response)
    seen = size > NOTHING * size.max(initial=0.0)
    for j, look in enumerate(looks):
        degrees = np.degrees(np.unwrap(np.angle(response[:, j])))
        gain.loglog(f, np.where(seen[:, j], size[:, j], np.nan), **look)
        phase.semilogx(f, np.where(seen[:, j], degrees, np.nan), **look)
    low, high = phase.get_ylim()
    step = next((step for step in TURNS if high - low < 5 * step), TURNS[-1])
    phase.yaxis.set_major_locator(MultipleLocator(step))


def _look(space: "StateSpace", j: int) -> dict[str, Any]:
    """The line of the j-th output."""
    count = len(space.outputs)
    return told_apart(j) if count <= TOLD_APART else {"color": graded(j, count)}


def _quotient(unit: str, by: str) -> str:
    """rad/V, m/(N m)."""
    return f"{typeset(unit)}/{f'({by})' if ' ' in by else by}"
