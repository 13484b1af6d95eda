"""Changes to a document by path, before it is read: `bodies.rod.elements`, `gravity.1`, `motors.*.joint`."""

import numbers
from collections.abc import Iterator, Mapping
from typing import Any

from fmbd.errors import ModelError
from fmbd.model.document import Document, Place, parse
from fmbd.model.fileformat import FAMILIES, ModelFile, kinds
from fmbd.model.names import unknown

# Giving one of these takes the other away.
_EXCLUSIVE = {"elements": "nodes", "nodes": "elements"}


def apply_overrides(document: Document, overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Set the values in the document; returns them as plain data, by path. Raises ModelError."""
    changes = {}
    for path, value in overrides.items():
        try:
            changes[path] = parse(value, path).data if isinstance(value, str) else _plain(value)
            steps = path.replace("[", ".").replace("]", "").split(".")
            for target in _targets(document.data, steps):
                document.data, document.root = _changed(document.data, document.root, target, changes[path])
        except ValueError as error:
            raise ModelError([f"{path}: {error}"]) from None
    return changes


def _plain(value: Any) -> Any:
    """A Python value as YAML would give it."""
    match value:
        case None | bool() | str():
            return value
        case numbers.Integral():
            return int(value)
        case numbers.Real():
            return float(value)
        case Mapping():
            return {str(key): _plain(item) for key, item in value.items()}
        case list() | tuple():
            return [_plain(item) for item in value]
    raise ValueError(f"a value of type {type(value).__name__} cannot stand in a model")


def _targets(data: Any, steps: list[str]) -> list[list[str]]:
    """The paths that `steps` means: names are checked, `*` stands for all parts that can have the rest."""
    if not isinstance(data, dict):
        raise ValueError("the model is not a mapping")
    first, *rest = steps
    if first not in ModelFile.model_fields:
        raise ValueError(unknown("key", first, ModelFile.model_fields))
    if not rest or first not in (*FAMILIES, "parameters"):
        return list(_expanded(data, steps))
    parts = data.get(first) or {}
    if not isinstance(parts, dict):
        raise ValueError(f"'{first}' is not a mapping")
    if rest[0] == "*":
        names = [name for name, part in parts.items() if len(rest) == 1 or rest[1] in _keys_of(first, part)]
        if not names:
            raise ValueError(f"no part of '{first}' can have the key '{'.'.join(rest[1:])}'")
    elif rest[0] in parts:
        names = [rest[0]]
    else:
        raise ValueError(unknown("name", rest[0], parts, f" in '{first}'"))
    return [[first, name, *more] for name in names for more in _expanded(parts[name], rest[1:])]


def _keys_of(family: str, part: Any) -> list[str]:
    """The keys that a part may have."""
    by_type = kinds(family) if family in FAMILIES else {}
    return by_type.get("") or by_type.get(str(part.get("type")) if isinstance(part, dict) else "") or []


def _expanded(data: Any, steps: list[str]) -> Iterator[list[str]]:
    if not steps:
        yield []
        return
    step, rest = _next_step(data, steps)
    if step != "*":
        for more in _expanded(_child(data, step), rest):
            yield [step, *more]
    elif isinstance(data, dict | list):
        for key in data if isinstance(data, dict) else range(len(data)):
            for more in _expanded(_child(data, str(key)), rest):
                yield [str(key), *more]


def _next_step(data: Any, steps: list[str]) -> tuple[str, list[str]]:
    """The first step and the others; a key of the data may hold dots, as `rod.end` does in `place`."""
    for count in range(len(steps), 1, -1):
        joined = ".".join(steps[:count])
        if isinstance(data, dict) and joined in data:
            return joined, steps[count:]
    return steps[0], steps[1:]


def _child(data: Any, step: str) -> Any:
    if isinstance(data, list):
        if not step.isdecimal() or int(step) >= len(data):
            raise ValueError(f"'{step}' is not a position in a list of {len(data)} values (the first is 0)")
        return data[int(step)]
    if data is not None and not isinstance(data, dict):
        raise ValueError(f"'{step}' leads nowhere: what stands before it is a plain value")
    return (data or {}).get(step)


def _changed(data: Any, place: Place, steps: list[str], value: Any) -> tuple[Any, Place]:
    """Copies of data and place along the path with the value set; aliases elsewhere keep theirs."""
    if not steps:
        return value, _outside(value, place.key)
    key: Any = int(steps[0]) if isinstance(data, list) else steps[0]
    data = list(data) if isinstance(data, list) else dict(data or {})
    place = Place(place.mark, place.key, dict(place.parts))
    old = data[key] if isinstance(data, list) else data.get(key)
    data[key], place.parts[key] = _changed(old, place.parts.get(key, Place(None)), steps[1:], value)
    if isinstance(data, dict) and len(steps) == 1:
        data.pop(_EXCLUSIVE.get(key), None)
    return data, place


def _outside(value: Any, key: tuple[int, int] | None = None) -> Place:
    """The place of a value that stands in no file."""
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return Place(None, None, {name: _outside(part) for name, part in parts})
