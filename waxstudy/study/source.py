"""A study file as text: its values, and the line of every key."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

from waxstudy.plugin.files import read_file
from waxstudy.study.lines import DEEPEST, KeyPath, key_lines
from waxstudy.study.problems import Problem, StudyError

LARGEST = 2**63 - 1
TOO_DEEP = f"tables and lists may be nested {DEEPEST} deep"
TOO_LARGE = f"whole numbers go up to {LARGEST}"

# the start of the parser's message -> ours
SYNTAX = {
    "Cannot overwrite": "this key is given twice, or is both a key and a table",
    "Cannot declare": "this table is given twice",
    "Cannot redefine": "this table is given twice",
    "Cannot mutate": "this table was finished further up; keys cannot be added to it here",
    "Duplicate inline": "this key is given twice",
    "Invalid value": "a value is expected here: texts need quotes, numbers a digit before and after the point; "
    "or a list further up is not closed",
    "Expected newline": "something follows the value: one key per line, texts in quotes, numbers without a unit",
    "Expected '=' after": "'=' is expected after a key",
    "Expected ']": "this table heading is not closed, or not made of letters, digits, '_' and '-'",
    "Invalid initial": "a key is expected here: no comma before '}', and quotes around unusual characters",
    "Invalid statement": "a key or a [table] is expected here",
    "Unclosed array": "a comma is missing in this list, or it is not closed with ']'",
    "Unclosed inline": "a comma is missing in this table, it spans lines, or it is not closed with '}'",
    "Unterminated": "a text is not closed",
    "Unescaped": "a backslash in a text: double it, or use 'single quotes'",
    "Invalid hex": "a backslash in a text: double it, or use 'single quotes'",
    "Escaped character": "a backslash in a text: double it, or use 'single quotes'",
    'Expected "\'"': "a text is not closed",
    "Found invalid": "a text is not closed on its line, or there is a control character",
    "Illegal character": "a text is not closed on its line, or there is a control character",
    "Invalid date": "there is no such date or time",
}


@dataclass(frozen=True)
class Source:
    """What a file holds."""

    file: str
    folder: Path
    values: dict[str, Any]
    lines: dict[KeyPath, int]

    def line(self, path: KeyPath) -> int:
        """Return the line of a key, or of the nearest table around it."""
        while path not in self.lines and path:
            path = path[:-1]
        return self.lines.get(path, 1)


def source_of(values: Mapping[str, Any]) -> Source:
    """Return what a mapping holds as if a file did, without lines; paths in it are seen from here.

    Raises `StudyError` for what no file can hold.
    """
    path = Path("study")
    try:
        plain = tomllib.loads(tomli_w.dumps(dict(values)))
    except TypeError as error:
        raise StudyError([_problem(path, 0, f"a value that no study file can hold: {error}")]) from None
    source = Source(str(path), Path.cwd(), plain, {(): 0})
    _refuse_extremes(path, source)
    return source


def read_source(path: Path) -> Source:
    """Read a TOML file; raise `StudyError` if it cannot be read or is not TOML."""
    text = read_text(path)
    try:
        values = tomllib.loads(text)
        lines = key_lines(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(path, text, str(error)) from None
    except RecursionError:
        raise StudyError([_problem(path, 0, TOO_DEEP)]) from None
    except ValueError:  # Python refuses to read integers of thousands of digits
        raise StudyError([_problem(path, 0, TOO_LARGE)]) from None
    source = Source(str(path), path.absolute().parent, values, lines)
    _refuse_extremes(path, source)
    return source


def read_text(path: Path) -> str:
    """Return the file's text without a byte order mark, which some editors write; raise `StudyError`."""
    try:
        data = read_file(path)
    except IsADirectoryError:
        raise StudyError([_problem(path, 0, "this is a folder; a TOML file is expected")]) from None
    except FileNotFoundError:
        raise StudyError([_problem(path, 0, "no such file")]) from None
    except ValueError:
        raise StudyError([_problem(path, 0, "no file can have this name")]) from None
    except OSError as error:
        raise StudyError([_problem(path, 0, f"cannot be read: {error.strerror or 'input or output failed'}")]) from None
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise StudyError([_problem(path, line, "not UTF-8 text: save the file with the encoding UTF-8")]) from None


def _syntax_error(path: Path, text: str, message: str) -> StudyError:
    """Say it in our words; the parser's message only tells which mistake it is, and where."""
    place = re.search(r"\(at line (\d+), column (\d+)\)$", message)
    line, column = (int(place[1]), int(place[2])) if place else (text.rstrip("\n").count("\n") + 1, 0)
    known = [ours for start, ours in SYNTAX.items() if message.startswith(start)]
    if re.search(r"=\s*-?\d+,\d+\s*($|[,}#])", next(iter(text.split("\n")[line - 1 : line]), "")):
        known = ["a decimal number has a point, no comma"]
    end = f" (column {column})" if column else " (end of the file)"
    wrong = f"not valid TOML: {(known or ['this is not understood'])[0]}{end}"
    return StudyError([_problem(path, line, wrong)])


def _refuse_extremes(path: Path, source: Source) -> None:
    """No study needs them, and every later part may count on their absence."""
    found: list[Problem] = []
    rest: list[tuple[KeyPath, Any]] = [((), source.values)]
    while rest:
        where, value = rest.pop()
        if len(where) > DEEPEST:
            found.append(_problem(path, source.line(where), TOO_DEEP))
        elif isinstance(value, dict):
            rest.extend(((*where, key), inner) for key, inner in value.items())
        elif isinstance(value, list):
            rest.extend(((*where, i), inner) for i, inner in enumerate(value))
        elif isinstance(value, int) and abs(value) > LARGEST:
            found.append(_problem(path, source.line(where), TOO_LARGE))
    if found:
        raise StudyError(list(dict.fromkeys(found)))


def _problem(path: Path, line: int, wrong: str) -> Problem:
    return Problem(str(path), line, "", "", "", wrong)
