"""YAML text as plain data, with the line and column of every key and value."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Never

import yaml

from fmbd.errors import ModelError
from fmbd.model.names import shortened

MAX_BYTES = 50_000_000
MAX_DEPTH = 64
MAX_ALIASED = 100_000  # values that aliases may add to a file

Path = Sequence[str | int]
Mark = tuple[int, int]  # line and column, from 0

_INTEGER = re.compile(r"[-+]?[0-9]{1,15}\Z")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?\Z")
_WORDS: dict[str, Any] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
    **{sign + word: float(sign + "inf") for sign in ("", "+", "-") for word in (".inf", ".Inf", ".INF")},
}


@dataclass(slots=True)
class Place:
    """Where a value and its key stand (None: set from outside), with the places of its parts.

    `size` counts the values within, aliases expanded.
    """

    mark: Mark | None
    key: Mark | None = None
    parts: dict[str | int, "Place"] = field(default_factory=dict)
    size: int = 1


@dataclass(slots=True)
class _Collection:
    """A mapping or list that is being built; `key` is the one whose value comes next."""

    data: Any
    place: Place
    anchor: str | None
    key: str | None = None
    key_mark: Mark | None = None

    def awaits_key(self) -> bool:
        return self.key is None and isinstance(self.data, dict)


@dataclass(slots=True)
class Document:
    """Plain data with its places; `label` names the file in messages."""

    data: Any
    root: Place
    label: str

    def find(self, path: Path) -> tuple[list[str | int], Any, Place]:
        """The part of `path` that the file contains, with the data and the place it leads to.

        Steps that are not in the file are left out: long forms of what is written short, and the type of a
        part that validation puts behind its name.
        """
        steps: list[str | int] = []
        data, place = self.data, self.root
        for step in path:
            is_type = isinstance(data, dict) and step == data.get("type")
            if step in place.parts and not is_type:
                data, place = data[step], place.parts[step]
                steps.append(step)
            elif len(steps) < 2:
                break
        return steps, data, place

    def locate(self, path: Path) -> str:
        """`file:line:column` of the value at `path`; `file` alone when it was set from outside."""
        return self._at(self.find(path)[2].mark)

    def problem(self, path: Path, message: str, of_key: bool = False) -> str:
        """One line that says where and what is wrong with a value or, `of_key`, with its key.

        The place of a problem of a whole mapping is that of its key.
        """
        steps, data, place = self.find(path)
        mark = place.key if place.key and (of_key or isinstance(data, dict)) else place.mark
        where = written(steps[:-1] if of_key else steps)
        return f"{self._at(mark)}: {where + ': ' if where else ''}{shortened(message, 500)}"

    def _at(self, mark: Mark | None) -> str:
        return f"{self.label}:{mark[0] + 1}:{mark[1] + 1}" if mark else self.label


def written(path: Path) -> str:
    """A path as people write it: `joints.elbow.between[0]`."""
    text = "".join(f"[{step}]" if isinstance(step, int) else f".{shortened(step)}" for step in path)
    return text.removeprefix(".")


def parse(text: str, label: str) -> Document:
    """Read YAML text; raises ModelError.

    Scalars follow the YAML 1.2 core schema (`on` and `yes` are text, `1e-6` is a number). Tags, repeated keys
    and a second document are refused, and so are too deep nesting and aliases that expand to too much.
    """
    try:
        size = len(text.encode())
    except UnicodeEncodeError:
        raise ModelError([f"{label}: is not valid Unicode text"]) from None
    if size > MAX_BYTES:
        raise ModelError([f"{label}: has {size} bytes; at most {MAX_BYTES} are read"])
    try:
        return _Builder(label).build(text)
    except yaml.YAMLError as error:
        raise ModelError([_syntax_problem(error, label)]) from None


def _syntax_problem(error: yaml.YAMLError, label: str) -> str:
    if isinstance(error, yaml.MarkedYAMLError) and error.problem_mark:
        mark = error.problem_mark
        context = f" ({error.context})" if error.context else ""
        return f"{label}:{mark.line + 1}:{mark.column + 1}: not valid YAML: {error.problem}{context}"
    if isinstance(error, yaml.reader.ReaderError):
        where = f"at position {error.position}"
        return f"{label}: not valid YAML: character {error.character!r} {where} is not allowed"
    return f"{label}: not valid YAML: {' '.join(str(error).split())}"


class _Builder:
    """Builds data and places from parser events with a stack of its own, so that depth is under control."""

    def __init__(self, label: str) -> None:
        self.label = label
        self.problems: list[str] = []
        self.root: tuple[Any, Place] | None = None
        self.open: list[_Collection] = []
        self.anchors: dict[str, tuple[Any, Place] | None] = {}  # None: the collection is still open
        self.aliased = 0

    def build(self, text: str) -> Document:
        """All events of the text, then the document."""
        events: Iterable[Any] = yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
        for event in events:
            mark = (event.start_mark.line, event.start_mark.column)
            if isinstance(event, yaml.CollectionEndEvent):
                self._close()
            elif isinstance(event, yaml.NodeEvent):
                self._take(event, mark)
            elif isinstance(event, yaml.DocumentStartEvent) and self.root is not None:
                self._fail(mark, "a second document begins here: a model is one document")
        if self.root is None:
            raise ModelError([f"{self.label}: is empty"])
        if self.problems:
            raise ModelError(self.problems)
        return Document(*self.root, self.label)

    def _take(self, event: Any, mark: Mark) -> None:
        """A scalar, an alias or the start of a collection."""
        is_key = bool(self.open) and self.open[-1].awaits_key()
        if is_key and not isinstance(event, yaml.ScalarEvent):
            self._fail(mark, "a key must be a plain name")
        if isinstance(event, yaml.AliasEvent):
            self._attach(*self._aliased(str(event.anchor), mark))
            return
        if event.tag:
            self._fail(mark, f"the tag '{shortened(event.tag)}' is refused: a model holds plain values only")
        if isinstance(event, yaml.ScalarEvent):
            self._scalar(event, mark, is_key)
        else:
            self._collection(event, mark)

    def _scalar(self, event: Any, mark: Mark, is_key: bool) -> None:
        place = Place(mark)
        data = event.value if is_key else scalar(event.value, quoted=not event.implicit[0])
        if event.anchor:
            self.anchors[event.anchor] = (data, place)
        if not is_key:
            self._attach(data, place)
            return
        collection = self.open[-1]
        if data in collection.data:
            first = collection.place.parts[data].key or (0, 0)
            message = f"the key '{shortened(data)}' is given twice, first in line {first[0] + 1}"
            self.problems.append(self._problem(mark, message))
        collection.key, collection.key_mark = data, mark

    def _collection(self, event: Any, mark: Mark) -> None:
        if len(self.open) == MAX_DEPTH:
            self._fail(mark, f"is nested more than {MAX_DEPTH} levels deep")
        data: Any = {} if isinstance(event, yaml.MappingStartEvent) else []
        place = Place(mark)
        self._attach(data, place)
        self.open.append(_Collection(data, place, event.anchor))
        if event.anchor:
            self.anchors[event.anchor] = None

    def _close(self) -> None:
        closed = self.open.pop()
        closed.place.size += sum(part.size for part in closed.place.parts.values())
        if closed.anchor:
            self.anchors[closed.anchor] = (closed.data, closed.place)

    def _attach(self, data: Any, place: Place) -> None:
        """Put a value into the collection that is open."""
        if not self.open:
            self.root = (data, place)
            return
        collection = self.open[-1]
        if isinstance(collection.data, list):
            collection.place.parts[len(collection.data)] = place
            collection.data.append(data)
        else:
            assert collection.key is not None
            place.key = collection.key_mark
            collection.data[collection.key] = data
            collection.place.parts[collection.key] = place
            collection.key = None

    def _aliased(self, anchor: str, mark: Mark) -> tuple[Any, Place]:
        if anchor not in self.anchors:
            self._fail(mark, f"the alias '*{anchor}' has no anchor '&{anchor}' before it")
        target = self.anchors[anchor]
        if target is None:
            self._fail(mark, f"the alias '*{anchor}' stands within its own anchor")
        data, place = target
        self.aliased += place.size
        if self.aliased > MAX_ALIASED:
            self._fail(mark, f"aliases expand to more than {MAX_ALIASED} values")
        return data, Place(mark, None, place.parts, place.size)

    def _problem(self, mark: Mark, message: str) -> str:
        return f"{self.label}:{mark[0] + 1}:{mark[1] + 1}: {message}"

    def _fail(self, mark: Mark, message: str) -> Never:
        raise ModelError([*self.problems, self._problem(mark, message)])


def scalar(text: str, quoted: bool = False) -> Any:
    """The value of a scalar: None, a bool, an int, a float or the text itself."""
    if quoted:
        return text
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.match(text):
        return int(text)
    return float(text) if _FLOAT.match(text) else text
