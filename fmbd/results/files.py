"""Numbers with names in files of other programs: JSON, CSV, HDF5, NumPy, MATLAB."""

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

Data = Mapping[str, Any]


def write_data(file: BinaryIO, suffix: str, data: Data, table: Iterable[Sequence[Any]]) -> None:
    """Write data by name: numbers, arrays, texts, lists of texts, and mappings of these; as CSV, the rows of a table.

    suffix: .json, .csv, .h5, .npz or .mat. Complex numbers are pairs [real, imaginary] in JSON; the names in .npz and
    .mat are those of the first level, which has no mappings there.
    """
    match suffix:
        case ".json":
            file.write(json.dumps(_plain(data), indent=1).encode() + b"\n")
        case ".csv":
            text = io.TextIOWrapper(file, encoding="utf-8", newline="")
            csv.writer(text, lineterminator="\n").writerows(table)
            text.flush()
            text.detach()  # the file is not ours to close
        case ".h5":
            import h5py

            memory = io.BytesIO()  # HDF5 reads while it writes
            with h5py.File(memory, "w") as root:
                _group(root, data)
            file.write(memory.getvalue())
        case ".npz":
            np.savez(file, **{name: np.asarray(value) for name, value in data.items()})  # type: ignore[arg-type]
        case ".mat":
            from scipy.io import savemat

            cells = {name: np.array(v, object) if _is_texts(v) else v for name, v in data.items()}
            savemat(file, cells, oned_as="column")  # type: ignore[arg-type]
        case _:
            raise ValueError(f"cannot write '{suffix}'")


def save_data(path: str | Path, data: Data, table: Iterable[Sequence[Any]], known: Sequence[str]) -> None:
    """The same to a path, by its suffix. Raises ValueError for one that is not among the known ones."""
    suffix = Path(path).suffix.lower()
    if suffix not in known:
        raise ValueError(f"'{path}' does not end in {', '.join(known)}")
    with Path(path).open("wb") as file:
        write_data(file, suffix, data, table)


def _is_texts(value: Any) -> bool:
    return isinstance(value, list | tuple) and all(isinstance(item, str) for item in value)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        if np.iscomplexobj(value):
            value = np.stack([value.real, value.imag], axis=-1)
        return _plain(value.tolist())
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


def _group(group: Any, data: Data) -> None:
    for name, value in data.items():
        if isinstance(value, Mapping):
            _group(group.create_group(name), value)
        else:
            group[name] = value
