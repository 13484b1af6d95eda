"""What the paper's linear rods leave out: the five-bar with rods that shorten as they bend, beside it.

python postprocess/five_bar_stiffening.py [--elements 4]

Four elements a rod and light damping, so that the difference is that of the theory, not of the mesh.
"""

import argparse
from pathlib import Path

import numpy as np

import fmbd

MODEL = Path(__file__).parents[1] / "models" / "five_bar.yaml"


def five_bar(elements: int, shortens: bool) -> fmbd.Model:
    """As in the paper, or with rods that shorten, whose frames go through both ends."""
    changes = {
        "elements": elements,
        "frame": "chord" if shortens else "clamped",
        "foreshortening": shortens,
        "damping.stiffness_proportional": 5e-5,
    }
    return fmbd.load_model(MODEL, {f"bodies.*.{key}": value for key, value in changes.items()})


def tip(run: fmbd.Run, rod: str) -> np.ndarray:
    """Deflection [m] of the end of a rod from the tangent at its start, shape (nt,)."""
    along = run[f"{rod}.end.position"] - run[f"{rod}.start.position"]
    angle = run[f"{rod}.start.angle"]
    return np.cos(angle) * along[:, 1] - np.sin(angle) * along[:, 0]


def main() -> None:
    """Run both and print what differs."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--elements", type=int, default=4)
    elements = parser.parse_args().elements
    models = [five_bar(elements, shortens) for shortens in (False, True)]
    linear, second = (fmbd.simulate(model) for model in models)
    for rod in ("rod_right", "rod_left"):
        for when, take in (
            ("at most", lambda values: np.abs(values).max()),
            ("at the end", lambda values: values[-1]),
        ):
            a, b = (1e3 * take(tip(run, rod)) for run in (linear, second))
            print(f"{rod}, tip {when:10} {a:8.3f} mm linear, {b:8.3f} mm with foreshortening")
    for name, unit, scale in (("rod_right.end.position", "mm", 1e3), ("elbow_right.angle", "mrad", 1e3)):
        print(f"{name} differs by at most {scale * np.abs(linear[name] - second[name]).max():.3g} {unit}")
    a, b = (fmbd.modes(model, lock="all").frequencies[2] for model in models)
    print(f"first bending frequency, motors held: {a:.2f} Hz linear, {b:.2f} Hz with foreshortening")


if __name__ == "__main__":
    main()
