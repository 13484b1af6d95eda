"""The JSON Schema with which editors complete and check model files."""

import json
from pathlib import Path

import jsonschema
import pytest

from fmbd.model.document import parse
from fmbd.model.schema import json_schema, schema_text

MODELS = Path(__file__).parents[2] / "models"
FILES = sorted(set(MODELS.rglob("*.yaml")) - set(MODELS.rglob("*.case.yaml")))
SCHEMA = json_schema()
validator = jsonschema.Draft202012Validator(SCHEMA)


def data(path):
    return parse(path.read_text(), path.name).data


def test_the_committed_schema_is_up_to_date():
    """Otherwise: fmbd schema > models/fmbd.schema.json."""
    assert (MODELS / "fmbd.schema.json").read_text() == schema_text()


def test_it_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_model_names_the_schema_and_follows_it(path):
    first = path.read_text().splitlines()[0]
    named = first.removeprefix("# yaml-language-server: $schema=")
    assert (path.parent / named).resolve() == MODELS / "fmbd.schema.json"
    assert [error.message for error in validator.iter_errors(data(path))] == []


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (["bodies", "rod_left", "lenght"], 1),
        (["bodies", "rod_left", "length"], 0),
        (["bodies", "rod_left", "length"], True),
        (["bodies", "rod_left", "frame"], "clampd"),
        (["bodies", "rod_left", "type"], "beem"),
        (["bodies", "rod-left"], {"type": "rigid", "mass": 1, "inertia": 1}),
        (["joints", "effector", "between"], ["rod_left.end"]),
        (["motors", "motor_left", "voltage"], {"type": "sine"}),
        (["simulation", "method"], "euler"),
        (["fmbd"], 2),
    ],
)
def test_mistakes_are_underlined_in_the_editor(path, value):
    model = data(MODELS / "five_bar.yaml")
    part = model
    for key in path[:-1]:
        part = part[key]
    part[path[-1]] = value
    assert list(validator.iter_errors(model))


def test_every_key_of_every_part_is_explained():
    silent = [
        f"{name}.{key}"
        for name, part in {"": SCHEMA, **SCHEMA["$defs"]}.items()
        for key, meaning in part.get("properties", {}).items()
        if key != "type" and not meaning.get("description")
    ]
    assert silent == []


def test_it_is_plain_json():
    assert json.loads(schema_text()) == json.loads(json.dumps(SCHEMA))
