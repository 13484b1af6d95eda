"""What the parts of a model need to know of each other while they are read."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Never

from pydantic import PlainValidator, ValidationError, ValidationInfo

from fmbd.model.names import described, unknown
from fmbd.model.problems import Muted


@dataclass(slots=True)
class Context:
    """Parameters and the parts read so far; a part or parameter that failed is known and None."""

    parameters: Mapping[str, float] = field(default_factory=dict)
    broken_parameters: set[str] = field(default_factory=set)
    parts: dict[str, dict[str, Any]] = field(default_factory=dict)
    folder: Path = field(default_factory=Path)
    files: dict[str, str] = field(default_factory=dict)  # text of the tables, by name
    elements: int = 0  # of all beams so far

    def find(self, family: str, name: str, kind: str) -> Any:
        """The part `name` of a family; raises ValueError when there is none, Muted when it failed."""
        parts = self.parts.get(family, {})
        if name not in parts:
            raise ValueError(unknown(kind, name, parts))
        part = parts[name]
        if part is None:
            raise Muted
        return part

    def knows(self, family: str, name: str) -> bool:
        """Whether the family has a part of this name."""
        return name in self.parts.get(family, {})


def context_of(info: ValidationInfo) -> Context:
    """The context of a validation; an empty one for a part made by itself in Python."""
    return info.context if isinstance(info.context, Context) else Context()


def reject(path: tuple[str | int, ...], problem: str | ValueError) -> Never:
    """Fail a validation at `path` within the part that is being read."""
    error = problem if isinstance(problem, ValueError) else ValueError(problem)
    raise ValidationError.from_exception_data(
        "", [{"type": "value_error", "loc": path, "input": None, "ctx": {"error": error}}]
    )


def reference(family: str, kind: str) -> PlainValidator:
    """The validator of a field that names a part of `family` and holds that part."""

    def find(value: Any, info: ValidationInfo) -> Any:
        if not isinstance(value, str):
            raise ValueError(f"must be the name of a {kind}, not {described(value)}")
        return context_of(info).find(family, value, kind)

    return PlainValidator(find, json_schema_input_type=str)
