"""What `import fmbd` gives: some twenty names, each imported when it is first used."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import fmbd

ROOT = Path(__file__).parents[2]


def test_every_public_name_exists_and_is_documented() -> None:
    for name in fmbd.__all__:
        value = getattr(fmbd, name)
        assert name == "__version__" or value.__doc__, name
    assert dir(fmbd) == fmbd.__all__


def test_another_name_is_refused_as_by_any_module() -> None:
    with pytest.raises(AttributeError, match=r"module 'fmbd' has no attribute 'simulation'"):
        fmbd.simulation  # noqa: B018


def test_the_package_itself_imports_nothing_heavy() -> None:
    heavy = {"numpy", "scipy", "numba", "pydantic", "h5py", "yaml", "pyvista"}
    code = f"import sys, fmbd; sys.exit(', '.join({heavy!r} & sys.modules.keys()) or 0)"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_version_is_written_in_one_place() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert project["project"]["dynamic"] == ["version"]
    assert project["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "fmbd.__version__"}
