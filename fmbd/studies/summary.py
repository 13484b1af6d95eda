"""What the file of a study says at a glance, read without what computes it."""

import json
from collections.abc import Iterator
from pathlib import Path

import h5py

from fmbd.results.archive import ArchiveError


def is_study(path: str | Path) -> bool:
    """Whether a file is a study."""
    try:
        with h5py.File(path) as file:
            return "members" in file and "axes" in file.attrs
    except OSError:
        return False


def summary(path: Path) -> list[tuple[str, str]]:
    """Labels and facts: from where it is, what is refined, what failed, the verdicts; raises ArchiveError."""
    try:
        with h5py.File(path) as file:
            return list(_facts(file))
    except (OSError, KeyError) as error:
        raise ArchiveError(f"{path}: damaged study: {error}") from None


def _facts(file: h5py.File) -> Iterator[tuple[str, str]]:
    about, members = file.attrs, [file[f"members/{k}"].attrs for k in range(len(file["members"]))]
    yield "model", about["model_file"]
    yield "command", about["command"]
    yield "started", f"{about['started'][:19].replace('T', ' ')} UTC, by fmbd {about['fmbd_version']}"
    yield "analysis", about["analysis"]
    for axis in json.loads(about["axes"]):
        yield "refined", f"{axis['path']} = {', '.join(f'{value:g}' for value in axis['values'])}"
    complete = sum(member["status"] == "complete" for member in members)
    interrupted = ", interrupted" if about["is_interrupted"] else ""
    yield "members", f"{len(members)}, {complete} of them complete{interrupted}"
    for member in members:
        if member["status"] != "complete":
            changes = ", ".join(f"{path} = {value}" for path, value in json.loads(member["changes"]).items())
            yield "left out", f"{changes}: {member['status']}"
    for paths in file.get("results", {}).values():
        for result in paths.values():
            yield "verdict", result.attrs["verdict"]
