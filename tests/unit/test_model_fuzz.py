"""Whatever the text: it is a model, or ModelError says in plain lines why not."""

import copy
import json
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from fmbd.model import ModelError, load_model_text
from fmbd.model.document import parse

FIVE_BAR = (Path(__file__).parents[2] / "models" / "five_bar.yaml").read_text()
DATA = parse(FIVE_BAR, "five_bar.yaml").data

WORDS = """
    a t pi 1/0 sin(t) 2**2**99 crank_left crank_left.A ground.origin . .. rod_left.node1 gravity_compensation
    rigid beam revolute weld free sine table expression pd null ~ true .inf -.nan 1e999 0x10
    & * ! | > % @ - ? : # {} [] "" ../x /etc/passwd drive.csv
"""
KEYS = """
    type from to at spring driven friction limit shape section nodes elements points point_masses target place
    start end until about value inertia mass parameters signals initial simulation ground name x angle
"""
words = st.sampled_from(WORDS.split())
keys = st.sampled_from(KEYS.split())
values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | words | st.text(max_size=10),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys | words, inner, max_size=3),
    max_leaves=6,
)


def loads_or_explains(text):
    try:
        load_model_text(text, "five_bar.yaml")
    except ModelError as error:
        assert error.problems
        for line in error.problems:
            assert line.startswith("five_bar.yaml:")
            assert "\n" not in line
            assert len(line) < 1000


def places(data):
    """All (container, key) within plain data."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield data, key
        yield from places(value)


@given(st.text())
def test_any_text(text):
    loads_or_explains(text)


@settings(max_examples=300)
@given(st.data())
def test_a_model_with_damaged_characters(draw):
    text = FIVE_BAR
    for _ in range(draw.draw(st.integers(1, 4))):
        start = draw.draw(st.integers(0, len(text)))
        end = start + draw.draw(st.integers(0, 30))
        text = text[:start] + draw.draw(words | st.text(max_size=3)) + text[end:]
    loads_or_explains(text)


@settings(max_examples=400)
@given(st.data())
def test_a_model_with_exchanged_values(draw):
    data = copy.deepcopy(DATA)
    for _ in range(draw.draw(st.integers(1, 3))):
        container, key = draw.draw(st.sampled_from(list(places(data))))
        if isinstance(container, dict) and draw.draw(st.booleans()):
            container[draw.draw(keys)] = draw.draw(values)
        else:
            container[key] = draw.draw(values)
    loads_or_explains(json.dumps(data))
