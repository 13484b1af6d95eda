"""JSON Schema of the model file, for editors that complete and check YAML."""

import ast
import inspect
import json
import textwrap
from collections.abc import Iterator
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from fmbd.model.base import Part
from fmbd.model.fileformat import ModelFile


def json_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of the model file; wherever a number stands, an expression string may stand."""
    schema = ModelFile.model_json_schema()
    for part in _subclasses(Part):
        target = schema if part is ModelFile else schema["$defs"].get(part.__name__)
        if target is not None:
            for key, text in descriptions(part).items():
                target["properties"][key]["description"] = text
    return {"$schema": GenerateJsonSchema.schema_dialect, **_simplified(schema)}


def schema_text() -> str:
    """The schema as JSON text, as `fmbd schema` prints it."""
    return json.dumps(json_schema(), indent=2) + "\n"


def descriptions(part: type[Part]) -> dict[str, str]:
    """What the keys of a part mean: the strings below its fields."""
    meanings: dict[str, str] = {}
    for base in reversed(part.__mro__):
        if issubclass(base, Part) and base is not Part:
            body = ast.parse(textwrap.dedent(inspect.getsource(base))).body[0]
            assert isinstance(body, ast.ClassDef)
            for field, below in zip(body.body, body.body[1:], strict=False):
                match field, below:
                    case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(
                        value=ast.Constant(value=str(text))
                    ):
                        meanings[part.model_fields[name].alias or name] = text
    return meanings


def _subclasses(part: type[Part]) -> Iterator[type[Part]]:
    for child in part.__subclasses__():
        yield child
        yield from _subclasses(child)


def _simplified(schema: Any) -> Any:
    """Without titles and nulls, which say nothing in YAML, and with names checked."""
    if isinstance(schema, list):
        return [_simplified(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    plain = {key: _simplified(value) for key, value in schema.items() if not _is_noise(key, value)}
    if "patternProperties" in plain:
        plain["additionalProperties"] = False
    choices = [choice for choice in plain.pop("anyOf", []) if choice != {"type": "null"}]
    if (
        len(choices) == 2
        and choices[1] == {"type": "string"}
        and choices[0].get("type") in ("number", "integer")
    ):
        return plain | choices[0] | {"type": [choices[0]["type"], "string"]}
    if len(choices) == 1:
        return plain | choices[0]
    return plain | {"anyOf": choices} if choices else plain


def _is_noise(key: str, value: Any) -> bool:
    return (key == "title" and isinstance(value, str)) or (key == "default" and value is None)
