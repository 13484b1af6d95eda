"""Is the five-bar in Exudyn the same mechanism? Frequencies and deflections with locked rotors beside known numbers.

    python benchmarks/check_exudyn.py

The known ones are of the continuum, by a program independent of both codes; the deflections with foreshortening.
"""

from common import table
from exudyn_five_bar import ExudynFiveBar

FREQUENCIES = (17.383263, 21.528348, 28.066866, 28.502933, 111.417731, 111.931986)
DEFLECTIONS = (-1.140e-3, 1.228e-3)


def main() -> None:
    """Print a table of differences."""
    unloaded, loaded = (ExudynFiveBar(8, 0.0, locked=True, gravity=g) for g in (0.0, 9.81))
    known = [f"frequency {k} [Hz]" for k in range(1, 7)], FREQUENCIES, unloaded.frequencies()
    rows = [[what, f"{found:.4f}", f"{f:.4f}", f"{found / f - 1:+.2%}"] for what, f, found in zip(*known)]
    for side, w, found in zip(("right", "left"), DEFLECTIONS, loaded.statics()):
        rows.append([f"{side} tip [mm]", f"{1e3 * found:.4f}", f"{1e3 * w:.3f}", f"{found / w - 1:+.2%}"])
    print(table(["8 elements a link", "Exudyn", "known", "difference"], rows))


if __name__ == "__main__":
    main()
