"""Data flows one way: a package imports from those to its left only."""

import ast
from pathlib import Path

import pytest

import fmbd

ORDER = ["errors", "model", "beams", "planar", "system", "solvers", "results", "analyses", "studies", "cli"]
PACKAGE = Path(fmbd.__file__).parent
FILES = sorted(path for path in PACKAGE.rglob("*.py") if path.parent != PACKAGE or path.stem == "errors")


def layer(name: str) -> int:
    return ORDER.index(name)


def imported(path: Path) -> set[str]:
    """Names of the fmbd packages that a file imports, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        modules = []
        if isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            modules = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            modules = [alias.name for alias in node.names]
        for parts in (module.split(".") for module in modules):
            if parts[0] == "fmbd" and len(parts) > 1 and parts[1] in ORDER:
                found.add(parts[1])
    return found


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_nothing_is_imported_from_the_right(path: Path) -> None:
    own = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
    assert all(layer(name) <= layer(own) for name in imported(path))


def test_every_package_has_its_place() -> None:
    folders = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    assert folders <= set(ORDER)
