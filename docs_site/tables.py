"""Tables of generated pages."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown, its cells on one line each.

    >>> print(table(("key", "allowed"), [("`a|b`", "x|y")]), end="")
    | key | allowed |
    |---|---|
    | `a|b` | x&#124;y |
    """
    lines = [_line(head), "|" + "---|" * len(head), *map(_line, rows)]
    return "\n".join(lines) + "\n"


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(map(_cell, cells)) + " |"


def _cell(text: str) -> str:
    """A cell on one line; a bar within code separates nothing."""
    parts = " ".join(text.split()).split("`")
    parts[::2] = [part.replace("|", "&#124;") for part in parts[::2]]
    return "`".join(parts)


def plain(text: str) -> str:
    """Return a text in which nothing is read as a tag or a link: `[s]` is a unit, `<column>` a place.

    >>> plain("Time [s], `[study]` of <NAME>")
    'Time \\\\[s], `[study]` of &lt;NAME>'
    """
    parts = text.split("`")
    parts[::2] = [part.replace("<", "&lt;").replace("[", r"\[").replace("*", r"\*") for part in parts[::2]]
    return "`".join(parts)
