"""A table: what of a row each column shows, and how heading and figures are written; `formats` does the rest."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

from waxstudy.report.words import capital

Row = TypeVar("Row")
Kind = Literal["figure", "theirs", "text", "prose", "list", "verdict"]


@dataclass(frozen=True)
class Column(Generic[Row]):
    """What stands in a column: the row's attribute `key` or what `value` returns, written as `form` says.

    `key` is its name in CSV, `form` a format specification such as ".2f". Words are written as they are; None and NaN
    leave a cell empty. Of the kinds, a figure ends at the right, and so does one of theirs, which is dim. All others
    begin at the left: text; prose, which a narrow terminal breaks into lines; a list joined by "; ", of which the
    terminal shows the first parts; and a verdict, which a page marks.
    """

    key: str
    value: Callable[[Row], Any] | None = None
    form: str = ""
    heading: str = ""  # by default the key
    unit: str = ""
    kind: Kind = "figure"

    @property
    def name(self) -> str:
        """What stands above it."""
        return f"{self.heading or self.key} {self.unit}".rstrip()

    @property
    def is_left(self) -> bool:
        """Whether it is not of figures."""
        return self.kind not in ("figure", "theirs")

    def text(self, row: Row) -> str:
        """What stands in a row's cell."""
        value = self.value(row) if self.value else getattr(row, self.key)
        if value is None or (isinstance(value, float) and math.isnan(value)):
            return ""
        return value if isinstance(value, str) else format(value, self.form)


def text(key: str, value: Callable[[Row], Any] | None = None, kind: Kind = "text", heading: str = "") -> Column[Row]:
    """Return a column of words."""
    return Column(key, value, heading=heading, kind=kind)


@dataclass(frozen=True)
class Table(Generic[Row]):
    """Rows, each shown by every column, under a title that begins small."""

    title: str
    columns: Sequence[Column[Row]]
    rows: Sequence[Row]

    @property
    def heading(self) -> str:
        """The title as a heading of its own."""
        return capital(self.title)

    @property
    def names(self) -> list[str]:
        """What stands above the columns."""
        return [column.name for column in self.columns]

    @property
    def texts(self) -> list[list[str]]:
        """What stands in the cells, row by row."""
        return [[column.text(row) for column in self.columns] for row in self.rows]
