"""The cases of models/verification, each against its published numbers; `fmbd verify` shows the same.

What a case is compared with, where that is from, and how closely it must agree stand in its file.
"""

import re
from pathlib import Path

import pytest

import fmbd
from fmbd.studies.verify import find_cases, markdown

ROOT = Path(__file__).parents[2]


def assert_holds(case, changes=None):
    failed = [found for found in fmbd.verify([case], changes) if not found.holds]
    assert not failed, "\n".join(map(str, failed))


@pytest.mark.parametrize("path", find_cases(), ids=lambda path: path.name.partition(".")[0])
def test_case(path):
    assert_holds(path)


@pytest.mark.parametrize("method", ["rk45", "baumgarte"])
def test_every_method_gives_all_digits_of_the_slider_crank(method):
    assert_holds("slider_crank", {"simulation.method": method})


def test_the_matrix_of_the_tests_is_up_to_date():
    """Otherwise: fmbd verify --markdown, into tests/README.md."""
    matrix = (ROOT / "tests" / "README.md").read_text()
    shown = re.search(r"<!-- cases -->\n(.*)\n<!-- end of cases -->", matrix, flags=re.DOTALL)
    assert shown and shown[1].strip() == markdown()
