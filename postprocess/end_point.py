"""How an end point goes to its target: its path, its distance from the target, when it has settled.

python postprocess/end_point.py five-bar.vtkhdf rod_right.end --target -0.1 0.7 [--within 0.001] [-o FILE]
"""

import argparse
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fmbd
from fmbd.results.plots.style import COLOURS, WIDTH, save, style


def settled(time: np.ndarray, distance: np.ndarray, within: float) -> float:
    """When the distance falls below a bound [m] for good; nan if it never does."""
    outside = np.flatnonzero(distance > within)
    last = outside[-1] if outside.size else -1
    return float(time[last + 1]) if last + 1 < time.size else float("nan")


def draw(run: fmbd.Run, point: str, target: tuple[float, float], within: float) -> Figure:
    """Path on the left, distance on the right."""
    path = run[f"{point}.position"]
    distance = np.linalg.norm(path - target, axis=1)
    figure = Figure(figsize=(WIDTH, 2.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(*path.T, color=COLOURS[0])
    left.plot(*target, "+", color=COLOURS[3], markersize=9)
    left.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", xmargin=0.1)
    left.margins(0.1)
    left.annotate("target", target, xytext=(6, 6), textcoords="offset points", color=COLOURS[3])
    right.semilogy(run.time, 1e3 * distance, color=COLOURS[0])
    right.axhline(1e3 * within, color="0.5", linestyle="--", linewidth=0.8)
    right.set(xlabel="time [s]", ylabel="distance from the target [mm]")
    moment = settled(run.time, distance, within)
    when = "never" if np.isnan(moment) else f"{moment:.3f} s"
    print(f"within {1e3 * within:g} mm for good: {when}; at the end: {1e3 * distance[-1]:.3g} mm")
    return figure


def main() -> None:
    """Read the archive that the command line names, write the figure."""
    parser = argparse.ArgumentParser(description="The way of an end point to its target.")
    parser.add_argument("archive", type=Path)
    parser.add_argument("point", help="body.point")
    parser.add_argument("--target", type=float, nargs=2, required=True, metavar=("X", "Y"), help="[m]")
    parser.add_argument("--within", type=float, default=1e-3, help="[m], default 0.001")
    parser.add_argument("-o", "--output", type=Path, default=Path("end_point.png"))
    options = parser.parse_args()
    run = fmbd.open_run(options.archive)
    with style():
        save(draw(run, options.point, tuple(options.target), options.within), options.output)
    print(options.output)


if __name__ == "__main__":
    main()
