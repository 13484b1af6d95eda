"""Figures 4, 5 and 6 of Hoang et al. (2022) from an archive of the five-bar.

    python postprocess/five_bar_figures.py five-bar.vtkhdf [--folder FOLDER] [--format png|pdf|svg]

Figure 4: rotors and joints, positions and rates. Figure 5: deflection and slope at the tips of the rods.
Figure 6: error of the loop closure, equation (22) of the paper.
"""

import argparse
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fmbd
from fmbd.results.plots.style import COLOURS, WIDTH, save, style

ARMS = dict(zip(("right", "left"), COLOURS))
JOINTS = {
    "motor_{}.rotor": (r"$\varphi$", r"$\dot\varphi$"),
    "shoulder_{}.angle": (r"$\theta_1$", r"$\dot\theta_1$"),
    "elbow_{}.angle": (r"$\theta_2$", r"$\dot\theta_2$"),
}


def joints(run: fmbd.Run) -> Figure:
    """Figure 4: rotor, crank and rod of each arm; positions on the left, rates on the right."""
    figure = Figure(figsize=(WIDTH, 4.8), layout="constrained")
    axes = figure.subplots(len(JOINTS), 2, sharex=True)
    for row, (name, (position, rate)) in zip(axes, JOINTS.items(), strict=True):
        for arm, color in ARMS.items():
            row[0].plot(run.time, run[name.format(arm)], color=color, label=f"{arm} arm")
            row[1].plot(run.time, run[name.format(arm) + ".rate"], color=color)
        row[0].set_ylabel(f"{position} [rad]")
        row[1].set_ylabel(f"{rate} [rad/s]")
    finish(figure, axes)
    return figure


def deflections(run: fmbd.Run) -> Figure:
    """Figure 5: deflection and slope at the tip of each rod."""
    figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
    axes = figure.subplots(2, 1, sharex=True, squeeze=False)
    for arm, color in ARMS.items():
        axes[0, 0].plot(run.time, 1e3 * run[f"rod_{arm}.end.deflection"], color=color, label=f"{arm} rod")
        axes[1, 0].plot(run.time, 1e3 * run[f"rod_{arm}.end.slope"], color=color)
    axes[0, 0].set_ylabel("tip deflection $e_3$ [mm]")
    axes[1, 0].set_ylabel("tip slope $e_4$ [mrad]")
    finish(figure, axes)
    return figure


def closure(run: fmbd.Run) -> Figure:
    """Figure 6: what the ends of the two rods miss each other by."""
    figure = Figure(figsize=(WIDTH, 2.2), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True, squeeze=False)
    gap = run["rod_right.end.position"] - run["rod_left.end.position"]
    for ax, component, label in zip(axes[0], gap.T, "xy", strict=True):
        ax.semilogy(run.time, np.abs(component), color="0.3", linewidth=0.6)
        ax.set_ylabel(rf"$|\Phi_{label}|$ [m]")
        ax.yaxis.set_tick_params(labelleft=True)
    finish(figure, axes)
    return figure


def finish(figure: Figure, axes: np.ndarray) -> None:
    """Name the time axes of the bottom row, put the legend above all."""
    for ax in axes[-1]:
        ax.set_xlabel("time [s]")
    figure.align_ylabels(axes)
    lines, labels = axes[0, 0].get_legend_handles_labels()
    if labels:
        figure.legend(lines, labels, loc="outside upper center", ncols=len(labels))


def main() -> None:
    """Read the archive that the command line names, write the three figures."""
    parser = argparse.ArgumentParser(description="Figures 4, 5 and 6 of the five-bar paper from an archive.")
    parser.add_argument("archive", type=Path)
    parser.add_argument("--folder", type=Path, default=Path(), help="where the figures go (default: here)")
    parser.add_argument("--format", choices=["png", "pdf", "svg"], default="png")
    options = parser.parse_args()
    run = fmbd.open_run(options.archive)
    options.folder.mkdir(parents=True, exist_ok=True)
    with style():
        for name, draw in {"joints": joints, "deflections": deflections, "closure": closure}.items():
            path = options.folder / f"five_bar_{name}.{options.format}"
            save(draw(run), path)
            print(path)


if __name__ == "__main__":
    main()
