"""How many elements a rod does the five-bar need? The figure and the table of the README.

    python postprocess/five_bar_refinement.py [--folder FOLDER] [--jobs N] [--duration SECONDS]

The controlled move of 3 s, with rods that are damped a little and with rods that are not damped at all; elements from
one, as in the paper, to 16. Errors are the largest over the move, in shares of the largest value of a quantity.
"""

import argparse
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import fmbd
from fmbd.results.plots.style import COLOURS, MARKERS, save, style

MODEL = Path(__file__).parents[1] / "models" / "five_bar.yaml"
ELEMENTS = "bodies.*.elements"
#: Stiffness-proportional damping of the rods [s].
CASES = {"damped": 5e-5, "undamped": 0.0}
TIP = "rod_right.end.deflection"
QUANTITIES = {
    TIP: "tip deflection",
    "effector.force": "force in the end joint",
    "elbow_right.angle": "passive joint angle",
    "shoulder_right.angle": "active joint angle",
    "rod_right.end.position": "end point",
}
WIDTH = 9.0  # inches
LOOKS = dict(zip(QUANTITIES, zip(COLOURS, MARKERS)))


def study(damping: float, duration: float, jobs: int) -> fmbd.Study:
    """The five-bar's rods ever finer; steps are so small that elements make the difference."""
    changes = {"simulation.rtol": 1e-8, "simulation.duration": duration, "simulation.output_interval": 1e-3}
    if damping:
        changes["bodies.*.damping.stiffness_proportional"] = damping
    return fmbd.refine(
        fmbd.load_model(MODEL, changes), {ELEMENTS: [1, 2, 4, 8, 16]}, list(QUANTITIES), jobs=jobs
    )


def vibration(ax: Axes, found: fmbd.Study) -> None:
    """The tip, with one element and with the finest."""
    for member, colour in ((found.members[0], COLOURS[1]), (found.members[-1], LOOKS[TIP][0])):
        n, measured = member.changes[ELEMENTS], member.measured
        label = "1 element, the paper's" if n == 1 else f"{n} elements"
        ax.plot(measured.time, 1e3 * measured.values[TIP], color=colour, label=label)
    ax.set(
        xlim=(0, 0.4),
        ylim=(-2.2, 0.1),
        xlabel="time [s]",
        ylabel="tip deflection [mm]",
        title="right rod, damped",
    )
    ax.legend(loc="lower right")


def errors(ax: Axes, found: fmbd.Study, title: str) -> None:
    """Differences to the finest, as full lines where they show an order, and order 4."""
    for result in found.results:
        size = result.found.size.largest
        shares = np.array([difference.largest for difference in result.found.differences]) / size
        colour, marker = LOOKS[result.quantity]
        ax.loglog(
            result.values[:-1],
            100 * shares,
            marker=marker,
            color=colour,
            linestyle="-" if result.found.is_settled else "--",
            label=QUANTITIES[result.quantity],
        )
    n = np.array(found.axes[0].values[1:-1], float)
    ax.loglog(n, 20 * (n / n[0]) ** -4.0, color="0.5", linestyle=":", label="order 4")
    ax.margins(x=0.05)
    ax.set_xticks(found.axes[0].values, [f"{value}" for value in found.axes[0].values])
    ax.minorticks_off()
    finest = found.axes[0].values[-1]
    ax.set(xlabel="elements a rod", ylabel=f"difference to {finest} elements [%]", title=title)


def table(studies: dict[str, fmbd.Study]) -> str:
    """Bounds of the errors as a Markdown table."""
    rows = [
        "| error | rods | 1 element | 2 | 4 | 8 | 16 | order |",
        "|---|---|--:|--:|--:|--:|--:|--:|",
    ]
    for title, found in studies.items():
        for result in found.results:
            about = "" if result.found.is_settled else "~"
            shares = [f"{about}{100 * share:.2g} %" for share in result.found.shares()]
            order = f"{result.found.order:.1f}" if result.found.is_settled else "-"
            rows.append(f"| {QUANTITIES[result.quantity]} | {title} | {' | '.join(shares)} | {order} |")
    return "\n".join(rows)


def main() -> None:
    """Run both studies, draw, print the table and the verdicts."""
    parser = argparse.ArgumentParser(description="How many elements a rod does the five-bar need?")
    parser.add_argument("--folder", type=Path, default=Path(), help="where the figure goes (default: here)")
    parser.add_argument("--jobs", type=int, default=2, help="runs side by side (default: 2)")
    parser.add_argument("--duration", type=float, default=3.0, help="of the move [s] (default: 3)")
    options = parser.parse_args()
    studies = {title: study(damping, options.duration, options.jobs) for title, damping in CASES.items()}
    damped, undamped = studies.values()
    with style():
        figure = Figure(figsize=(WIDTH, 3.0), layout="constrained")
        left, middle, right = figure.subplots(1, 3)
        vibration(left, damped)
        errors(middle, damped, "damped")
        errors(right, undamped, "undamped: dashed where no order shows")
        lines, labels = middle.get_legend_handles_labels()
        figure.legend(lines, labels, loc="outside lower center", ncols=len(labels))
        options.folder.mkdir(parents=True, exist_ok=True)
        path = options.folder / "five_bar_refinement.svg"
        save(figure, path)
    print(path)
    print(table(studies))
    for title, found in studies.items():
        for result in found.results:
            print(f"{title} rods, {result.verdict}")


if __name__ == "__main__":
    main()
