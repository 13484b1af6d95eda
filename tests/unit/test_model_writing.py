"""A changed model, written as YAML, is read back as the same model."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fmbd.model import load_model, load_model_text
from fmbd.model.document import parse
from fmbd.model.writing import yaml_text

FOLDER = Path(__file__).parents[2] / "models"
MODELS = sorted(set(FOLDER.rglob("*.yaml")) - set(FOLDER.rglob("*.case.yaml")))

names = st.text(st.characters(codec="ascii", categories=["L"]), min_size=1, max_size=6)
values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**15) + 1, 10**15 - 1)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text()
    | st.sampled_from(
        [
            "1e-6",
            "on",
            "null",
            "~",
            "1_000",
            "0x10",
            "12:30",
            "2026-01-01",
            "- a",
            "a: b",
            "#",
            "\x85",
            "a\u2028b",
        ]
    ),
    lambda parts: st.lists(parts, max_size=3) | st.dictionaries(names, parts, max_size=3),
    max_leaves=10,
)


@given(st.dictionaries(names, values, min_size=1, max_size=4))
def test_plain_data_survive(data: dict[str, object]) -> None:
    """Text stays text, whatever it looks like, and numbers stay what they are to the last digit."""
    assert parse(yaml_text(data), "text").data == data


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_a_model_with_an_override_survives(path: Path) -> None:
    model = load_model(path).with_("simulation.rtol", "1e-7/3")
    again = load_model_text(model.yaml(), path)
    assert not again.overrides
    assert again.simulation.rtol == 1e-7 / 3
    for part in ("parameters", "bodies", "joints", "springs", "loads", "motors", "controllers", "initial"):
        assert getattr(again, part) == getattr(model, part), part


@pytest.mark.parametrize("path", MODELS[:1], ids=lambda path: path.stem)
def test_an_unchanged_model_is_its_own_text(path: Path) -> None:
    assert load_model(path).yaml() == path.read_text()
