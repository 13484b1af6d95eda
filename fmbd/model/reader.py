"""Reading the top-level keys of a document, one after the other, each with what was read before."""

from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fmbd.model.checks import check_model
from fmbd.model.context import Context
from fmbd.model.document import Document
from fmbd.model.fileformat import FAMILIES, FORMAT, ModelFile, adapter, kinds
from fmbd.model.names import described, unknown_key
from fmbd.model.parameters import read_parameters
from fmbd.model.points import GROUND, checked_name
from fmbd.model.problems import AtKey, Problems

# Results are asked for by these names, so that no two parts may share one.
OUTPUT_FAMILIES = ("bodies", "joints", "springs", "loads", "controllers", "motors")


def read_document(document: Document, path: Path | None, files: dict[str, str]) -> dict[str, Any]:
    """The fields of the model that a document describes; raises ModelError with all problems.

    `files` holds the text of tables read before; those that are read now are added.
    """
    problems = Problems(document)
    data = document.data
    if not isinstance(data, dict):
        problems.add((), f"a model file must be a mapping, not {described(data)}")
        problems.check()
    _check_keys(data, problems)
    context = Context(folder=path.parent if path else Path(), files=files)
    fields: dict[str, Any] = {}
    for key in ModelFile.model_fields:
        if key == "parameters":
            context.parameters, context.broken_parameters = read_parameters(data.get(key), problems)
            fields[key] = context.parameters
        elif key in FAMILIES:
            fields[key] = context.parts[key] = {}
            _read_family(key, data.get(key), context, problems)
        else:
            fields[key] = _read_value(key, data, context, problems)
        if key == GROUND:
            context.parts[GROUND] = {GROUND: fields[key]}
    fields["name"] = fields["name"] or (path.stem if path else "model")
    check_model(fields, problems)
    problems.check()
    return fields


def _check_keys(data: dict[str, Any], problems: Problems) -> None:
    for key in data:
        if key not in ModelFile.model_fields:
            problems.add((key,), AtKey(unknown_key(key, ModelFile.model_fields)))
    if "fmbd" not in data:
        problems.add((), f"missing key 'fmbd', the version of the file format: write 'fmbd: {FORMAT}'")
    if not data.get("bodies"):
        problems.add(("bodies",), "missing key 'bodies': a model has at least one body")


def _read_value(key: str, data: dict[str, Any], context: Context, problems: Problems) -> Any:
    """A top-level value that is no family; None when it failed."""
    field = ModelFile.model_fields[key]
    if data.get(key) is None:
        default: Any = None if field.is_required() else field.get_default()
        return default.resolve() if key == GROUND else default
    try:
        return adapter(key).validate_python(data[key], context=context)
    except ValidationError as error:
        problems.add((key,), error)
        return None


def _read_family(family: str, data: Any, context: Context, problems: Problems) -> None:
    """Fill context.parts[family] with parts by name, None for those that failed."""
    if data is None:
        return
    if not isinstance(data, dict):
        problems.add((family,), f"must be a mapping of names to parts, not {described(data)}")
        return
    parts = context.parts[family]
    for name, value in data.items():
        try:
            _check_name(family, name, context)
        except ValueError as error:
            problems.add((family, name), AtKey(str(error)))
        try:
            parts[name] = adapter(family).validate_python(value, context=context)
        except ValidationError as error:
            parts[name] = None
            problems.add((family, name), _with_types(error, family))


def _check_name(family: str, name: str, context: Context) -> None:
    checked_name(name)
    if family == "bodies" and name == GROUND:
        raise ValueError("'ground' is the fixed world and cannot be the name of a body")
    if family == "signals" and (name == "t" or name in context.parameters):
        raise ValueError(f"'{name}' is already {'the time' if name == 't' else 'a parameter'}")
    rivals: tuple[str, ...] = OUTPUT_FAMILIES if family in OUTPUT_FAMILIES else ()
    if family == "controllers":
        rivals += ("signals",)  # a motor's input may be either
    for other in rivals:
        if other != family and context.knows(other, name):
            raise ValueError(f"the name '{name}' is taken: it stands in '{other}', too")


def _with_types(error: ValidationError, family: str) -> ValueError:
    """The error of a part; when its type is missing, with the types there are."""
    if error.errors(include_url=False)[0]["type"] == "union_tag_not_found":
        return ValueError(f"missing key 'type' (one of: {', '.join(kinds(family))})")
    return error
