"""Which frequencies a quantity vibrates with, and when: a spectrogram.

python postprocess/spectrogram.py five-bar.vtkhdf rod_right.end.deflection [--window 0.25] [--up-to 200] [-o FILE]
"""

import argparse
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.signal import ShortTimeFFT, detrend

import fmbd
from fmbd.results.plots.charts import typeset
from fmbd.results.plots.style import WIDTH, save, style

DECADES = 5  # of amplitude that the colours span


def draw(run: fmbd.Run, name: str, window: float, up_to: float) -> Figure:
    """Amplitudes in windows of some length [s], by their middle and by frequency [Hz]."""
    step = run.time[1] - run.time[0]
    width = max(8, round(window / step))
    transform = ShortTimeFFT(np.hanning(width), hop=max(1, width // 16), fs=1.0 / step, scale_to="magnitude")
    values = detrend(run[name])
    # windows that lie in the run as a whole
    whole = {"p0": transform.lower_border_end[1], "p1": transform.upper_border_begin(values.size)[1]}
    if whole["p1"] < whole["p0"] + 2:
        raise SystemExit(f"the run is too short for windows of {window:g} s: choose a shorter --window")
    amplitudes = 2.0 * np.abs(transform.stft(values, **whole))
    inside = transform.f <= up_to
    figure = Figure(figsize=(WIDTH, 2.8), layout="constrained")
    ax = figure.subplots()
    ax.grid(False)
    levels = np.log10(np.maximum(amplitudes[inside], 1e-300))
    picture = ax.pcolormesh(
        run.time[0] + transform.t(values.size, **whole),
        transform.f[inside],
        levels,
        cmap="cividis",
        vmin=levels.max() - DECADES,
        vmax=levels.max(),
        shading="gouraud",
        rasterized=True,
    )
    ax.set(xlabel="time [s]", ylabel="frequency [Hz]", xlim=(run.time[0], run.time[-1]))
    figure.colorbar(picture, label=f"log10 of the amplitude [{typeset(run.units(name))}]", pad=0.01)
    return figure


def main() -> None:
    """Read the archive that the command line names, write the spectrogram."""
    parser = argparse.ArgumentParser(description="Frequencies of a quantity over time.")
    parser.add_argument("archive", type=Path)
    parser.add_argument("name", help="a quantity as `fmbd info ARCHIVE --names` lists them")
    parser.add_argument("--window", type=float, default=0.25, help="[s], default 0.25")
    parser.add_argument("--up-to", type=float, default=200.0, help="[Hz], default 200")
    parser.add_argument("-o", "--output", type=Path, default=Path("spectrogram.png"))
    options = parser.parse_args()
    run = fmbd.open_run(options.archive)
    with style():
        save(draw(run, options.name, options.window, options.up_to), options.output)
    print(options.output)


if __name__ == "__main__":
    main()
