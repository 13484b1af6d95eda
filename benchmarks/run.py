"""All benchmarks from one command.

    python benchmarks/run.py [--quick] [SUBJECT ...] [--results FOLDER]

Measures, prints tables, and writes a JSON file and a plot for every subject. A full run of all subjects also renews
the speed section of the project's README, between its markers. `--quick` is for trying: a minute, few repetitions,
results in a folder of their own. The first run of all compiles the kernels, which takes minutes more.
"""

import argparse
import json
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import common

HERE = Path(__file__).parent
SUBJECTS = ("speed", "work_precision", "scaling", "sweeps")
PLOTTED = SUBJECTS[1:]
README = HERE.parent / "README.md"
BEGIN, END = "<!-- speed: written by benchmarks/run.py -->", "<!-- end of speed -->"


def main() -> None:
    """Parse the command line and run the subjects."""
    parser = argparse.ArgumentParser(description="Benchmarks of fmbd.")
    parser.add_argument("subjects", nargs="*", metavar="SUBJECT", help=", ".join(SUBJECTS))
    parser.add_argument("--quick", action="store_true", help="a minute, for trying")
    parser.add_argument("--results", type=Path, help="where JSON and plots go")
    given = parser.parse_args()
    if unknown := set(given.subjects) - set(SUBJECTS):
        parser.error(f"no such subject: {', '.join(unknown)} (there are {', '.join(SUBJECTS)})")
    folder = given.results or HERE / "results" / ("quick" if given.quick else "")
    folder.mkdir(parents=True, exist_ok=True)
    if not common.HAS_EXUDYN:
        print(common.EXUDYN_MISSING)

    common.pin()
    for name in given.subjects or SUBJECTS:
        subject = import_module(name)
        start = time.perf_counter()
        print(f"\n{subject.TITLE}", flush=True)
        data = subject.measure(given.quick)
        print(f"\n{subject.tables(data)}\n({time.perf_counter() - start:.0f} s)", flush=True)
        common.write_json(folder / f"{name}.json", data)
        if name in PLOTTED:
            draw(subject, data, folder / f"{name}.svg")
    if not given.quick:
        renew_readme(folder)


def draw(subject: Any, data: dict[str, Any], path: Path) -> None:
    """Draw in the style of all figures of fmbd."""
    from fmbd.results.plots.style import save, style

    with style():
        save(subject.draw(data), path)


def renew_readme(folder: Path) -> None:
    """Write summaries and plots of all results in the folder between the markers of the project's README."""
    text = README.read_text()
    if BEGIN not in text or END not in text:
        return
    parts = [BEGIN]
    for name in SUBJECTS:
        if (folder / f"{name}.json").exists():
            subject, data = import_module(name), json.loads((folder / f"{name}.json").read_text())
            picture = (folder / f"{name}.svg").relative_to(README.parent)
            parts += [
                f"### {subject.TITLE}",
                subject.summary(data),
                f"![{subject.TITLE}]({picture})",
                _where(data),
            ]
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    README.write_text(before + "\n\n".join([*parts, END]) + after)


def _where(data: dict[str, Any]) -> str:
    told = dict(data["where"])
    date, processor = told.pop("date"), told.pop("processor")
    return f"*{date}, {processor}; {', '.join(f'{key} {value}' for key, value in told.items())}.*"


if __name__ == "__main__":
    main()
