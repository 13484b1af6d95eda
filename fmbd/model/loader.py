"""From a model file to a validated model."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fmbd.errors import ModelError
from fmbd.model.document import MAX_BYTES, parse
from fmbd.model.model import Model
from fmbd.model.names import closest
from fmbd.model.overrides import apply_overrides
from fmbd.model.reader import read_document

#: How a file of HDF5 begins.
HDF5 = b"\x89HDF\r\n\x1a\n"


def load_model(path: str | Path, overrides: Mapping[str, Any] | None = None) -> Model:
    """The model in a YAML file; `overrides` are values by path as for `Model.with_`. Raises ModelError."""
    label = str(path)
    path = Path(path)
    try:
        if not path.exists():
            raise ModelError([f"{label}: there is no such file{_resembling(path)}"])
        if not path.is_file():
            raise ModelError([f"{label}: is not a file"])
        with path.open("rb") as file:
            if file.read(len(HDF5)) == HDF5:
                raise ModelError([f"{label}: holds results, not a model: `fmbd info {label}` says which"])
        if path.stat().st_size > MAX_BYTES:
            raise ModelError([f"{label}: has more than {MAX_BYTES} bytes"])
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ModelError([f"{label}: is not UTF-8 text (byte {error.start})"]) from None
    except (OSError, ValueError) as error:
        raise ModelError([f"{label}: cannot be read: {error}"]) from None
    return load_model_text(text, path, overrides)


def load_model_text(
    text: str,
    path: str | Path | None = None,
    overrides: Mapping[str, Any] | None = None,
    files: Mapping[str, str] | None = None,
) -> Model:
    """The model in a YAML text; `path` is the file it came from. Raises ModelError with all problems.

    Tables are looked for among `files` (text by name), then in the folder of `path`, in the working directory
    when there is none.
    """
    document = parse(text, "<text>" if path is None else str(path))
    path = None if path is None else Path(path)
    changes = apply_overrides(document, overrides or {})
    tables = dict(files or {})
    fields = read_document(document, path, tables)
    return Model(**fields, text=text, path=path, overrides=changes, document=document, files=tables)


def _resembling(path: Path) -> str:
    try:
        near = closest(path.stem, [file.stem for file in path.parent.iterdir() if file.suffix == path.suffix])
    except OSError:
        return ""
    return f", did you mean '{near}{path.suffix}'?" if near else ""
