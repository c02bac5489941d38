"""Tables and notes as text for a terminal, as Markdown and as CSV; pages are in `page`."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from textwrap import wrap
from typing import Any

from rich import box
from rich.cells import cell_len
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table as Grid
from rich.text import Text

from waxstudy.report.table import Column, Table
from waxstudy.study.visible import visible

WIDEST = 1000  # columns that no table needs
FIRST = 3  # of a list, in the terminal


def csv_text(table: Table[Any]) -> str:
    """A line per row, under the columns' keys."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerows([[column.key for column in table.columns], *table.texts])
    return out.getvalue()


def markdown(title: str, tables: Sequence[Table[Any]], notes: Sequence[str]) -> str:
    """Pipe tables, then the notes."""
    parts = [f"# {visible(title)}\n"]
    for table in _filled(tables):
        lines = [table.names, ["---"] * len(table.columns), *table.texts]
        parts.append(f"## {visible(table.heading)}\n\n" + "".join(map(_pipes, lines)))
    if notes:
        parts.append("## Notes\n\n" + "".join(f"- {visible(note)}\n" for note in notes))
    return "\n".join(parts)


def _pipes(texts: Sequence[str]) -> str:
    return "| " + " | ".join(visible(text).replace("|", "\\|") for text in texts) + " |\n"


def _filled(tables: Sequence[Table[Any]]) -> list[Table[Any]]:
    return [table for table in tables if table.rows]


def terminal(tables: Sequence[Table[Any]], notes: Sequence[str], width: int, colour: bool) -> str:
    """Tables and notes for a terminal of a given width; one too narrow for the figures wraps lines, but hides none."""
    out = io.StringIO()
    printer = console(out, WIDEST, colour)
    for table in _filled(tables):
        printer.print(table.title, style="bold", width=width)
        grid = _grid(table)
        least = Measurement.get(printer, printer.options, grid).minimum
        if least > width:
            grid = _grid(table, is_narrow=True)
            least = Measurement.get(printer, printer.options, grid).minimum
        printer.print(grid, width=max(width, least), crop=False)
    for note in notes:
        printer.print(f"note: {note}", width=width)
    return out.getvalue()


class _Terminal(Console):
    """Every word that it prints goes through here: colours are its own, none comes with a name."""

    def render_str(self, text: str, **options: Any) -> Text:
        return super().render_str(visible(text), **options)


def console(out: io.StringIO, width: int, colour: bool) -> Console:
    """Return what prints for a terminal, words as they are."""
    return _Terminal(file=out, width=width, force_terminal=colour, highlight=False, markup=False, emoji=False)


def _grid(table: Table[Any], is_narrow: bool = False) -> Grid:
    """A table; a narrow one has headings no wider than its cells and words, and no space about its plus-minuses."""
    edges = {"show_edge": False, "padding": 0} if is_narrow else {"padding": (0, 1, 0, 0)}
    grid = Grid(box=box.SIMPLE_HEAD, pad_edge=False, **edges)
    texts_of = [
        [_shown(column, text, is_narrow) for column, text in zip(table.columns, texts, strict=True)]
        for texts in table.texts
    ]
    for place, column in enumerate(table.columns):
        cells = [texts[place] for texts in texts_of]
        can_wrap = column.kind in ("prose", "list")
        words = [column.name]
        if is_narrow:
            least = max(map(cell_len, (*column.name.split(" "), *cells)))
            words = wrap(column.name, least, break_long_words=False, break_on_hyphens=False) or [""]
        whole = (*words, *cells)
        kept = [word for each in whole for word in each.split()] if can_wrap else whole  # what is never cut
        grid.add_column(
            Text("\n".join(map(visible, words))),
            justify="left" if column.is_left else "right",
            style="dim" if column.kind == "theirs" else None,
            no_wrap=not can_wrap,
            min_width=max(map(cell_len, kept)),
        )
    for texts in texts_of:
        grid.add_row(*texts)
    return grid


def _shown(column: Column[Any], text: str, is_narrow: bool) -> str:
    text = _first(text) if column.kind == "list" else text
    return _tight(text) if is_narrow else text


def _tight(text: str) -> str:
    """
    >>> _tight("0.05 ± 0.01")
    '0.05±0.01'
    """
    return text.replace(" ± ", "±")


def _first(text: str) -> str:
    """
    >>> _first("1 K; 2 K; 3 K"), _first("1 K; 2 K; 3 K; 4 K; 5 K")
    ('1 K; 2 K; 3 K', '1 K; 2 K; 3 K; 2 more in --format html')
    """
    figures = text.split("; ")
    more = len(figures) - FIRST
    return text if more <= 0 else "; ".join([*figures[:FIRST], f"{more} more in --format html"])
