"""Names that people type, and what they may have meant."""

import re
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any

NAME_PATTERN = r"^[A-Za-z_][A-Za-z0-9_]*$"
_is_name = re.compile(NAME_PATTERN[:-1] + r"\Z").match


def is_name(text: str) -> bool:
    """Whether `text` can name a part or a point: letters, digits and underscores, no digit in front."""
    return _is_name(text) is not None


def closest(name: str, known: Iterable[str]) -> str | None:
    """The one of the `known` names that resembles `name` most, None when none does."""
    close = get_close_matches(name, sorted(known), n=1, cutoff=0.6) if len(name) <= 100 else []
    return close[0] if close else None


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """`, did you mean 'length'?` when one of the `known` names resembles `name`, else nothing."""
    close = closest(name, known)
    return f", did you mean '{close}'?" if close else ""


def unknown_key(name: str, known: Iterable[str]) -> str:
    """The message for a key that is not there: what it may have been, or else those that there are."""
    known = list(known)
    hint = did_you_mean(name, known) or (f" (known: {', '.join(known)})" if known else "")
    return f"unknown key '{name}'{hint}"


def unknown(kind: str, name: str, known: Iterable[str], owner: str = "") -> str:
    """The message for a reference that leads nowhere; `owner` says whose the name would be."""
    known = list(known)
    if not known:
        return f"unknown {kind} '{name}'{owner}: the model has none"
    hint = did_you_mean(name, known)
    if not hint and len(known) <= 8:
        hint = f" (known: {', '.join(known)})"
    return f"unknown {kind} '{shortened(name)}'{owner}{hint}"


def shortened(value: object, width: int = 60) -> str:
    """A value as a message shows it, in at most `width` characters and one line."""
    text = value[: width + 1] if isinstance(value, str) else repr(value)
    text = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return text if len(text) <= width else text[: width - 3] + "..."


def described(value: Any) -> str:
    """A value of a wrong kind, in the words of the file."""
    match value:
        case None:
            return "empty"
        case bool():
            return str(value).lower()
        case dict():
            return "a mapping"
        case list() | tuple():
            return "a list"
        case int() | float():
            return shortened(value)
    return f"'{shortened(value)}'"
