"""Files that a model names: in its own folder, and nowhere else."""

from pathlib import Path

from fmbd.model.context import reject


def beside(folder: Path, name: str, largest: int) -> Path:
    """The file that the key `file` of a part names, inside the model's folder, of at most so many bytes."""
    try:
        root = folder.resolve()
        path = (root / name).resolve()
        if not path.is_relative_to(root):
            reject(("file",), f"{name}: the file must lie in the model's folder")
        if not path.is_file():
            reject(("file",), f"{name}: there is no such file in the model's folder")
        if path.stat().st_size > largest:
            reject(("file",), f"{name}: the file has more than {largest} bytes")
    except (OSError, RuntimeError) as error:
        reject(("file",), f"{name!r}: cannot be read: {error}")
    return path
