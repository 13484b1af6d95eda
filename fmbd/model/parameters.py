"""Parameters: numbers by name that may refer to each other in any order."""

from graphlib import CycleError, TopologicalSorter
from typing import Any

from fmbd.model.base import finite_number
from fmbd.model.expressions import RESERVED_NAMES, ExpressionError, evaluate, names_in
from fmbd.model.names import described
from fmbd.model.points import checked_name
from fmbd.model.problems import AtKey, Problems


def read_parameters(data: Any, problems: Problems) -> tuple[dict[str, float], set[str]]:
    """The values by name in file order, and the names that have no value because something is wrong."""
    if data is None:
        return {}, set()
    if not isinstance(data, dict):
        problems.add(("parameters",), f"must be a mapping of names to numbers, not {described(data)}")
        return {}, set()
    references: dict[str, set[str]] = {}
    values: dict[str, float] = {}
    for name, value in data.items():
        try:
            _check_name(name)
        except ValueError as error:
            problems.add(("parameters", name), AtKey(str(error)))
        try:
            references[name] = names_in(value) & data.keys() if isinstance(value, str) else set()
        except ExpressionError as error:
            problems.add(("parameters", name), error)
    for name in _ordered(references, problems):
        if references[name] <= values.keys():
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


def _ordered(references: dict[str, set[str]], problems: Problems) -> list[str]:
    """Names in an order in which each one follows those it refers to; without an order only the plain numbers."""
    known = {name: refs & references.keys() for name, refs in references.items()}
    try:
        return list(TopologicalSorter(known).static_order())
    except CycleError as error:
        loop = error.args[1][::-1]
        problems.add(("parameters", loop[0]), f"loop {' -> '.join(loop)}")
        return [name for name, refs in references.items() if not refs]


def _value(value: Any, values: dict[str, float]) -> float:
    return evaluate(value, values) if isinstance(value, str) else finite_number(value)
