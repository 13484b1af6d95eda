"""Validation errors in the words of the model file."""

import re
from collections.abc import Iterable, Mapping
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails, InitErrorDetails

from fmbd.errors import ModelError
from fmbd.model.document import Document
from fmbd.model.names import closest, described, did_you_mean, unknown_key

MAX_PROBLEMS = 100

Location = tuple[str | int, ...]


class Muted(ValueError):
    """Stands for a problem that is already reported where it arose."""


class AtKey(ValueError):
    """A problem of a key, not of its value."""


class Problems:
    """Collects what is wrong with a document, one line each."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.lines: dict[str, tuple[int, int]] = {}

    def add(self, path: Location, problem: str | ValueError) -> None:
        """A problem at `path`; one that is muted is left out."""
        if isinstance(problem, ValidationError):
            for details in in_words(problem).errors(include_url=False):
                self.add((*path, *details["loc"]), details["ctx"]["error"])
        elif not isinstance(problem, Muted):
            of_key = "[key]" in path or isinstance(problem, AtKey)
            line = self.document.problem(path, str(problem), of_key)
            self.lines[line] = self.document.find(path)[2].mark or (-1, -1)
            if len(self.lines) == MAX_PROBLEMS:
                self.check()

    def check(self) -> None:
        """Raise ModelError if anything was added, in the order of the file."""
        if self.lines:
            lines = sorted(self.lines, key=lambda line: self.lines[line])
            if len(lines) == MAX_PROBLEMS:
                lines.append(
                    f"{self.document.label}: there may be more: reading stops after {MAX_PROBLEMS} problems"
                )
            raise ModelError(lines)


def in_words(error: ValidationError, keys: Iterable[str] = ()) -> ValidationError:
    """The same errors with messages for people; `keys` are those that the outermost part may have.

    A key that is missing because it is misspelt is reported once, as the unknown key it is.
    """
    errors = error.errors(include_url=False)
    missing = {item["loc"][-1] for item in errors if item["type"] == "missing" and len(item["loc"]) == 1}
    given = [
        item["loc"][-1] for item in errors if item["type"] == "extra_forbidden" and len(item["loc"]) == 1
    ]
    misspelt = {closest(str(key), keys) for key in given} & missing
    kept = [item for item in errors if item["type"] != "missing" or item["loc"][-1] not in misspelt]
    return ValidationError.from_exception_data("", [_translated(item, keys) for item in kept])


def _translated(details: ErrorDetails, keys: Iterable[str]) -> InitErrorDetails:
    location = details["loc"]
    problem: ValueError
    match details["type"]:
        case "value_error":
            problem = details["ctx"]["error"]
        case "default_factory_not_called":
            problem = Muted()
        case "missing" if isinstance(location[-1], int):
            problem = ValueError(f"has too few values: number {location[-1] + 1} is missing")
            location = location[:-1]
        case "missing":
            problem = ValueError(f"missing key '{location[-1]}'")
            location = location[:-1]
        case "extra_forbidden":
            known = keys if len(location) == 1 else ()
            problem = AtKey(unknown_key(str(location[-1]), known))
        case "union_tag_not_found":
            problem = ValueError("missing key 'type'")
        case "union_tag_invalid":
            location = (*location, "type")
            problem = ValueError(_not_a_choice("unknown type", details["ctx"], "tag", "expected_tags"))
        case "literal_error":
            choices = details["ctx"] | {"given": str(details["input"])}
            problem = ValueError(_not_a_choice("unknown choice", choices, "given", "expected"))
        case _:
            problem = ValueError(_simple(details))
    return {"type": "value_error", "loc": location, "input": None, "ctx": {"error": problem}}


def _not_a_choice(what: str, context: Mapping[str, Any], given: str, expected: str) -> str:
    choices = re.findall(r"'([^']*)'", context[expected]) or [context[expected]]
    hint = did_you_mean(str(context[given]), choices)
    return f"{what} {described(context[given])}{hint} (one of: {', '.join(choices)})"


def _simple(details: ErrorDetails) -> str:
    """Messages that depend on the error's own data alone."""
    value, context = details["input"], details.get("ctx", {})
    match details["type"]:
        case "greater_than":
            return f"must be positive, is {value:g}"
        case "greater_than_equal":
            return f"must not be negative, is {value:g}"
        case "dict_type" | "model_type" | "model_attributes_type":
            return f"must be a mapping, not {described(value)}"
        case "tuple_type" | "list_type":
            return f"must be a list, not {described(value)}"
        case "too_long":
            return f"must have {context['max_length']} values, has {context['actual_length']}"
        case "bool_type":
            return f"must be true or false, not {described(value)}"
        case "string_type":
            return f"must be a text, not {described(value)} (quotes make a text)"
    return f"{details['msg'][:1].lower()}{details['msg'][1:]}"
