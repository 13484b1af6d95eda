"""Figures 4, 5 and 6 of Hoang et al. (2022) from an archive of the five-bar.

    python postprocess/five_bar_figures.py five_bar.vtkhdf [--folder FOLDER] [--format png|pdf|svg]

Figure 4: rotors and joints, positions and rates. Figure 5: deflection and slope at the tips of the rods.
Figure 6: error of the loop closure, equation (22) of the paper.
"""

import argparse
from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import fmbd

# two columns of a journal; colours that also colour-blind readers tell apart (Okabe and Ito)
WIDTH = 6.7  # inches
STYLE = {
    "font.family": "serif",
    "font.serif": ["STIXGeneral"],
    "mathtext.fontset": "stix",
    "font.size": 9,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "legend.frameon": False,
    "lines.linewidth": 1.0,
    "savefig.dpi": 300,
    "svg.fonttype": "none",
}
ARMS = {"right": {"color": "#0072B2"}, "left": {"color": "#D55E00", "linestyle": "--"}}
JOINTS = {
    "motor_{}.rotor": r"rotor $\varphi$",
    "shoulder_{}.angle": r"crank $\theta_1$",
    "elbow_{}.angle": r"rod $\theta_2$",
}

Run = Mapping[str, np.ndarray]


def joints(run: Run) -> Figure:
    """Figure 4: positions on the left, rates on the right."""
    figure = Figure(figsize=(WIDTH, 5.0), layout="constrained")
    axes = figure.subplots(len(JOINTS), 2, sharex=True)
    for row, (name, label) in zip(axes, JOINTS.items(), strict=True):
        for arm, style in ARMS.items():
            coordinate = name.format(arm)
            row[0].plot(run["time"], run[coordinate], label=f"{arm} arm", **style)
            row[1].plot(run["time"], run[f"{coordinate}.rate"], **style)
        row[0].set_ylabel(f"{label} [rad]")
        row[1].set_ylabel(label.replace(r"$\varphi$", r"$\dot\varphi$").replace(r"\theta", r"\dot\theta") + " [rad/s]")
    finish(figure, axes[-1])
    return figure


def deflections(run: Run) -> Figure:
    """Figure 5: one column an arm, deflection above, slope below."""
    figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
    axes = figure.subplots(2, len(ARMS), sharex=True, sharey="row")
    for column, (arm, style) in zip(axes.T, ARMS.items(), strict=True):
        for ax, quantity in zip(column, ("deflection", "slope"), strict=True):
            ax.plot(run["time"], 1e3 * run[f"rod_{arm}.end.{quantity}"], color=style["color"], linewidth=0.7)
        column[0].set_title(f"{arm} rod", fontsize="medium")
    axes[0, 0].set_ylabel("tip deflection $e_3$ [mm]")
    axes[1, 0].set_ylabel("tip slope $e_4$ [mrad]")
    finish(figure, axes[-1])
    return figure


def closure(run: Run) -> Figure:
    """Figure 6: what the two ends of the rods miss each other by."""
    figure = Figure(figsize=(WIDTH, 2.6), layout="constrained")
    ax = figure.subplots()
    gap = np.abs(run["rod_right.end.position"] - run["rod_left.end.position"])
    for component, color, label in zip(gap.T, ("#0072B2", "#D55E00"), ("x", "y"), strict=True):
        ax.semilogy(run["time"], component, color=color, linewidth=0.7, label=rf"$|\Phi_{label}|$")
    ax.set_ylabel("constraint error [m]")
    finish(figure, [ax])
    return figure


def finish(figure: Figure, bottom: "np.ndarray | list[Axes]") -> None:
    """Time axes and one legend above."""
    for ax in bottom:
        ax.set_xlabel("time [s]")
        ax.margins(x=0.0)
    figure.legend(loc="outside upper center", ncols=2) if figure.axes[0].get_legend_handles_labels()[0] else None


def main() -> None:
    """Read the archive that the command line names, write the three figures."""
    parser = argparse.ArgumentParser(description="Figures 4, 5 and 6 of the five-bar paper from an archive.")
    parser.add_argument("archive", type=Path)
    parser.add_argument("--folder", type=Path, default=Path(), help="where the figures go (default: here)")
    parser.add_argument("--format", choices=["png", "pdf", "svg"], default="png")
    options = parser.parse_args()
    run = fmbd.open_run(options.archive)
    options.folder.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context(STYLE):
        for name, draw in {"joints": joints, "deflections": deflections, "closure": closure}.items():
            path = options.folder / f"five_bar_{name}.{options.format}"
            draw(run).savefig(path)
            print(path)


if __name__ == "__main__":
    main()
