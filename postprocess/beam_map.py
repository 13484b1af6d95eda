"""Bending moment, shear force or deflection of a beam over its length and time, as a map.

    python postprocess/beam_map.py cantilever.vtkhdf ruler [--quantity bending_moment] [--from 0.5] [--to 1] [-o FILE]

Values are those at the nodes: more elements give a smoother map.
"""

import argparse
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fmbd
from fmbd.results.plots.charts import scaled
from fmbd.results.plots.style import WIDTH, save, style


def draw(run: fmbd.Run, beam: str, quantity: str, start: float, end: float) -> Figure:
    """Time to the right, position along the beam upwards, the quantity in colours about zero."""
    rows = (run.time >= start) & (run.time <= end)
    values = run[f"{beam}.{quantity}"][rows]
    largest = float(np.abs(values).max())
    factor, unit = scaled(run.units(f"{beam}.{quantity}"), largest)
    figure = Figure(figsize=(WIDTH, 2.6), layout="constrained")
    ax = figure.subplots()
    ax.grid(False)
    limit = factor * largest or 1.0
    picture = ax.pcolormesh(
        run.time[rows],
        run.model.bodies[beam].nodes,
        factor * values.T,
        cmap="RdBu_r",
        vmin=-limit,
        vmax=limit,
        shading="gouraud",
        rasterized=True,
    )
    ax.set(xlabel="time [s]", ylabel=f"position along {beam} [m]")
    figure.colorbar(picture, label=f"{quantity.replace('_', ' ')} [{unit}]", pad=0.01)
    return figure


def main() -> None:
    """Read the archive that the command line names, write the map."""
    parser = argparse.ArgumentParser(description="A quantity along a beam over time.")
    parser.add_argument("archive", type=Path)
    parser.add_argument("beam")
    parser.add_argument("--quantity", default="bending_moment")
    parser.add_argument("--from", dest="start", type=float, default=0.0, metavar="SECONDS")
    parser.add_argument("--to", dest="end", type=float, default=float("inf"), metavar="SECONDS")
    parser.add_argument("-o", "--output", type=Path, default=Path("beam_map.png"))
    options = parser.parse_args()
    run = fmbd.open_run(options.archive)
    with style():
        save(draw(run, options.beam, options.quantity, options.start, options.end), options.output)
    print(options.output)


if __name__ == "__main__":
    main()
