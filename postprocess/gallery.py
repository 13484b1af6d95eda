"""Draw the picture of every model that models/README.md shows.

    python postprocess/gallery.py [MODEL ...] [--folder models/pictures]

Without names: all models of models/ and models/verification/. A picture shows the mechanism at the end of its run, and
at five times before as ghosts.
"""

import argparse
from pathlib import Path

from PIL import Image

import fmbd
from fmbd.results.animation.look import Look
from fmbd.results.plots.style import save

MODELS = Path(__file__).resolve().parents[1] / "models"
SIZE = (480, 320)
COLOURS = 256  # so that a picture takes about fifteen kilobytes

#: What is not drawn as the others are.
LOOKS = {
    "cantilever": {"deflection": 10.0},
    "five_bar": {"deflection": 10.0},
    "andrews": {"trail": "K1.F"},
}
#: Models whose motion says less than their curves.
FIGURES = {"dc_motor": ["motor.current", "shaft.angle.rate"]}
#: Seconds of runs that are too long, or too short, for a picture.
DURATIONS = {"four_bars": 1.2, "slider_crank": 5.0, "double_pendulum": 1.0, "pendulum": 0.9, "door": 2.0}


def picture(path: Path, folder: Path) -> Path:
    """Run a model and draw it."""
    changes = {"simulation.duration": DURATIONS[path.stem]} if path.stem in DURATIONS else {}
    run = fmbd.simulate(fmbd.load_model(path, changes))
    out = folder / f"{path.stem}.png"
    if path.stem in FIGURES:
        (figure,) = fmbd.figures({path.stem: run}, FIGURES[path.stem], width=4.0).values()
        save(figure, out)
    else:
        fmbd.animate(run, out, Look(size=SIZE, **LOOKS.get(path.stem, {})))
    with Image.open(out) as drawn:
        drawn.thumbnail((SIZE[0], SIZE[0]))
        drawn.convert("RGB").quantize(COLOURS).save(out, optimize=True)
    return out


def main() -> None:
    """Draw the models that the command line names."""
    parser = argparse.ArgumentParser(description="Pictures of models.")
    parser.add_argument("models", nargs="*", type=Path, metavar="MODEL", help="YAML files (default: all)")
    parser.add_argument("--folder", type=Path, default=MODELS / "pictures")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    every = set(MODELS.rglob("*.yaml")) - set(MODELS.rglob("*.case.yaml"))
    for path in options.models or sorted(every):
        print(picture(path, options.folder))


if __name__ == "__main__":
    main()
