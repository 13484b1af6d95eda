"""What an archive holds before the first step: groups, datasets, their names and units, and who writes it.

    /model                                      YAML text, with the parameters as run
    /model_files/<n>                            text of the n-th table that the model names, attribute `name`
    /results/time                               (nt,)
    /results/position, velocity, acceleration   (nt, nq)
    /results/multipliers                        (nt, nc)
    /results/states                             (nt, nz)
    /results/energy/<name>                      (nt,), names in ENERGIES
    /results/<extra>                            (nt,)
    /statistics                                 attributes
    /VTKHDF                                     the drawing, see vtkhdf.py

The dimension scales `time` and, with names and units of the columns, `coordinate`, `constraint` and `state`
let xarray open the group `results` as it is. The datasets repeat `names` and `units` as attributes (up to
4000 columns).
"""

import hashlib
import importlib.metadata
import os
import platform
import shlex
import sys
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from fmbd import __version__
from fmbd.results import blocks

# The column scale of each matrix, and what the units of the columns are divided by.
MATRICES = {
    "position": ("coordinate", ""),
    "velocity": ("coordinate", "/s"),
    "acceleration": ("coordinate", "/s^2"),
    "multipliers": ("constraint", ""),
    "states": ("state", ""),
}
ENERGIES = ("kinetic", "potential", "elastic", "dissipated", "work", "balance")

# HDF5 keeps the attributes of a growing dataset in 64 KiB.
ATTRIBUTE_STRINGS = 4000

Columns = Sequence[tuple[str, str]]
Value = str | int | float


def describe_run(
    file: h5py.File, model_text: str, model_files: Mapping[str, str], attributes: Mapping[str, Value]
) -> None:
    """Write the model and the root attributes; `attributes` override those recorded by default."""
    file["model"] = model_text
    tables = file.create_group("model_files")
    for number, (name, text) in enumerate(model_files.items()):
        tables[str(number)] = text
        tables[str(number)].attrs["name"] = name
    file.create_group("statistics")
    file.attrs.update(
        {
            **provenance(model_text),
            "status": "running",
            "writer": process_identity(os.getpid()),
            "wall_time": np.nan,
            **attributes,
        }
    )


def provenance(model_text: str) -> dict[str, Value]:
    """What tells from where a file is: model, versions, command and time [UTC]."""
    return {
        "fmbd_version": __version__,
        "model_sha256": hashlib.sha256(model_text.encode()).hexdigest(),
        "command": shlex.join(sys.argv),
        "started": datetime.now(UTC).isoformat(timespec="milliseconds"),
        "python": platform.python_version(),
        "platform": platform.platform(),
        **{f"{name}_version": _version(name) for name in ("numpy", "scipy", "numba", "h5py")},
    }


def process_identity(pid: int) -> str:
    """Return what tells a process from all others: host, number and, on Linux, its start in clock ticks.

    The start is `gone` when no such process runs, and `unknown` where the platform does not tell.
    """
    start = "unknown"
    if Path("/proc/self/stat").exists():
        try:
            # The command, in parentheses, may hold blanks; then come the state and, as the 20th, the start.
            fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
            start = "gone" if fields[0] in "ZX" else fields[19]
        except OSError:
            start = "gone"
    return f"{platform.node()} {pid} {start}"


def is_gone(identity: str) -> bool:
    """Say whether a process certainly runs no more; never so of a process on another host."""
    host, pid, _ = identity.rsplit(" ", 2)
    now = process_identity(int(pid))
    return host == platform.node() and not now.endswith("unknown") and now != identity


def create_results(
    file: h5py.File, coordinates: Columns, constraints: Columns, states: Columns, extra: Columns
) -> None:
    """Create the group `results` without steps; the columns are (name, unit)."""
    results = file.create_group("results")
    time = _create(results, "time", (), "time", "s")
    time.make_scale("time")
    columns_of = {"coordinate": coordinates, "constraint": constraints, "state": states}
    for name, columns in columns_of.items():
        _create_scale(results, name, columns)
    for name, (scale, per) in MATRICES.items():
        names = [column for column, _ in columns_of[scale]]
        units = [unit + per for _, unit in columns_of[scale]]
        dataset = _create(results, name, (len(names),), names, units)
        dataset.dims[0].attach_scale(time)
        dataset.dims[1].attach_scale(results[scale])
    for name, unit in (*((f"energy/{name}", "J") for name in ENERGIES), *extra):
        _create(results, name, (), name.rpartition("/")[2], unit).dims[0].attach_scale(time)


def growing_datasets(results: h5py.Group) -> dict[str, h5py.Dataset]:
    """Return the datasets of `/results` that have one row a step, by their path in the group."""
    found = {name: results[name] for name in results if name != "energy"}
    found |= {f"energy/{name}": dataset for name, dataset in results["energy"].items()}
    return {name: dataset for name, dataset in found.items() if dataset.maxshape[0] is None}


def units_of(results: h5py.Group, name: str) -> str | tuple[str, ...]:
    """Return the unit of a dataset of `/results`, or the units of its columns."""
    if name not in MATRICES:
        return str(results[name].attrs["units"])
    scale, per = MATRICES[name]
    return tuple(unit + per for unit in results[scale].attrs["units"])


def _create_scale(results: h5py.Group, name: str, columns: Columns) -> None:
    # Tracked order lifts the limit on attributes. It brings checksums, which a kill can leave wrong:
    # only for datasets that never change.
    scale = results.create_dataset(name, data=_strings([column for column, _ in columns]), track_order=True)
    scale.attrs["units"] = _strings([unit for _, unit in columns])
    scale.make_scale(name)


def _create(
    results: h5py.Group, name: str, shape: tuple[int, ...], names: str | list[str], units: str | list[str]
) -> h5py.Dataset:
    dataset = blocks.create_growing(results, name, shape)
    if len(units) <= ATTRIBUTE_STRINGS:
        dataset.attrs["names"] = names if isinstance(names, str) else _strings(names)
        dataset.attrs["units"] = units if isinstance(units, str) else _strings(units)
    return dataset


def _strings(values: list[str]) -> NDArray[np.object_]:
    return np.array(values, h5py.string_dtype())


def _version(distribution: str) -> str:
    try:
        return importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"
