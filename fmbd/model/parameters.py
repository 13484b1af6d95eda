"""Parameters: numbers by name that may refer to each other in any order."""

from collections.abc import Collection
from graphlib import CycleError, TopologicalSorter
from typing import Any

from fmbd.model.base import finite_number
from fmbd.model.expressions import RESERVED_NAMES, evaluate, names_in
from fmbd.model.names import described, unknown
from fmbd.model.points import checked_name
from fmbd.model.problems import AtKey, Problems


def read_parameters(data: Any, problems: Problems) -> tuple[dict[str, float], set[str]]:
    """The values by name in file order, and the names that have no value because something is wrong."""
    if data is None:
        return {}, set()
    if not isinstance(data, dict):
        problems.add(("parameters",), f"must be a mapping of names to numbers, not {described(data)}")
        return {}, set()
    references: dict[str, list[str]] = {}
    values: dict[str, float] = {}
    for name, value in data.items():
        try:
            _check_name(name)
        except ValueError as error:
            problems.add(("parameters", name), AtKey(str(error)))
        try:
            references[name] = _references(value, data) if isinstance(value, str) else []
        except ValueError as error:
            problems.add(("parameters", name), error)
    for name in _ordered(references, problems):
        if values.keys() >= set(references[name]):
            try:
                values[name] = _value(data[name], values)
            except ValueError as error:
                problems.add(("parameters", name), error)
    return {name: values[name] for name in data if name in values}, data.keys() - values.keys()


def _check_name(name: str) -> None:
    checked_name(name)
    if name in RESERVED_NAMES:
        meaning = "the time" if name == "t" else "a constant or function"
        raise ValueError(f"'{name}' is {meaning} in expressions and cannot be a parameter")


def _references(text: str, known: Collection[str]) -> list[str]:
    """The parameters in an expression; raises ValueError when one does not exist."""
    names = sorted(names_in(text) - {"t"})
    for name in names:
        if name not in known:
            raise ValueError(unknown("name", name, known))
    return names


def _ordered(references: dict[str, list[str]], problems: Problems) -> list[str]:
    """Names, each after those it refers to; when that is impossible, those that refer to none."""
    sorter = TopologicalSorter(references)
    try:
        return [name for name in sorter.static_order() if name in references]
    except CycleError as error:
        loop = error.args[1][:0:-1]
        order = {name: k for k, name in enumerate(references)}
        first = min(range(len(loop)), key=lambda k: order[loop[k]])
        loop = [*loop[first:], *loop[: first + 1]]
        problems.add(("parameters", loop[0]), f"loop {' -> '.join(loop)}")
        return [name for name, others in references.items() if not others]


def _value(value: Any, values: dict[str, float]) -> float:
    return evaluate(value, values) if isinstance(value, str) else finite_number(value)
