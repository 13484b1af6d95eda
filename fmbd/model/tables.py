"""Tables that are read from a CSV file beside the model."""

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import PlainValidator

from fmbd.model.base import LARGEST, Part, Text
from fmbd.model.context import Context, reject
from fmbd.model.folder import beside
from fmbd.model.names import described, unknown

MAX_BYTES = 50_000_000


@dataclass(frozen=True, slots=True)
class Table:
    """Values [signal's unit] at strictly increasing times [s], held constant outside."""

    type: ClassVar[str] = "table"
    times: tuple[float, ...]
    values: tuple[float, ...]
    interpolation: Literal["linear", "cubic"]
    end_rates: tuple[float, float] | None = None  #: of a cubic one; left out, its ends are not-a-knot


def _to_column(value: Any) -> str | int:
    if isinstance(value, bool) or not isinstance(value, str | int):
        raise ValueError(f"must be a column's header or its number from 0, not {described(value)}")
    return value


Column = Annotated[str | int, PlainValidator(_to_column, json_schema_input_type=str | int)]


class TableFile(Part):
    """Two columns of a CSV file."""

    file: Text
    """The file, relative to the model's folder and inside it."""

    def columns(
        self, context: Context, first: str, second: str
    ) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The columns that the keys `first` and `second` name.

        A file that cannot be read, or whose first column does not increase, is refused by file and line.
        """
        if self.file not in context.files:
            context.files[self.file] = self._text(beside(context.folder, self.file, MAX_BYTES))
        rows = self._rows(context.files[self.file])
        if not rows:
            reject(("file",), f"{self.file}: the file is empty")
        header = [] if _is_number(rows[0][1][0]) else [name.strip() for name in rows[0][1]]
        columns = [self._column(key, header, len(rows[0][1])) for key in (first, second)]
        increasing: list[float] = []
        values: list[float] = []
        for line, row in rows[1 if header else 0 :]:
            x, value = (self._number(line, row, column) for column in columns)
            if increasing and x <= increasing[-1]:
                text = f"the {first} {x:g} does not increase (before: {increasing[-1]:g})"
                reject(("file",), f"{self.file}:{line}: {text}")
            increasing.append(x)
            values.append(value)
        if len(values) < 2:
            reject(("file",), f"{self.file}: a table needs at least two rows of numbers, has {len(values)}")
        return tuple(increasing), tuple(values)

    def _text(self, path: Path) -> str:
        try:
            text = path.read_bytes().decode("utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            reject(("file",), f"{self.file}: cannot be read: {error}")
        if "\0" in text:
            reject(("file",), f"{self.file}: is not a text file")
        return text

    def _rows(self, text: str) -> list[tuple[int, list[str]]]:
        """Line numbers and fields of all rows that are not blank."""
        try:
            reader = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True)
            return [(reader.line_num, row) for row in reader if any(field.strip() for field in row)]
        except csv.Error as error:
            reject(("file",), f"{self.file}: cannot be read: {error}")

    def _column(self, key: str, header: list[str], width: int) -> int:
        column: str | int = getattr(self, key)
        if isinstance(column, int):
            if not 0 <= column < width:
                reject((key,), f"{self.file} has columns 0 to {width - 1}, not {column}")
            return column
        if column not in header:
            reject((key,), f"{self.file}: {unknown('column', column, header)}")
        return header.index(column)

    def _number(self, line: int, row: list[str], column: int) -> float:
        if column >= len(row):
            reject(("file",), f"{self.file}:{line}: column {column} is missing")
        if not _is_number(row[column]) or abs(float(row[column])) > LARGEST:
            reject(
                ("file",), f"{self.file}:{line}: '{row[column][:40]}' is not a number of at most {LARGEST:g}"
            )
        return float(row[column])


class TableEntry(TableFile):
    """Values over time from a CSV file; before the first and after the last time the value stands still."""

    type: Literal["table"]
    time: Column = 0
    """Column of the times [s]: its header, or its number from 0."""
    value: Column = 1
    """Column of the values: its header, or its number from 0."""
    interpolation: Literal["linear", "cubic"] = "linear"
    """Between the rows."""

    def read(self, context: Context) -> Table:
        """The table in the file."""
        return Table(*self.columns(context, "time", "value"), self.interpolation)


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
