"""Files that somebody spoilt: a key renamed, a value replaced, bytes in between, a column gone."""

from __future__ import annotations

import math
import tomllib
from random import Random
from typing import Any

import tomli_w

# keys that ask for work: what they may ask for is no fault, so that they get values of other kinds alone
WORK = ("members", "days", "step_s", "interval_s")
WORDS = ("use", "id", "start", "steps", "path", "from", "delay", "pi", "O_WM", "", "a.b", "x y", "é", "\x1b[2J", "..")
VALUES: tuple[Any, ...] = (
    *(True, False, 0, -1, 3, 2**62, -(2**63), 0.0, -0.0, 1e-300, 1e300, -1e300, math.nan, math.inf, -math.inf),
    *("", "x", "/dev/zero", "/proc/self/status", "../..", "a\0b", "x" * 5000, "居", "\x1b[31m", "NaN"),
    *([], {}, [[]], {"use": "linear"}, {"from": "s.toml"}, [1, "a"]),
)
PIECES = (b"", b"\0", b"[", b"{", b'"', b"'''", b"=", b"\n", b"[[", b"}", b"\\", b"\xff\xfe", b"#", b"1e999", b"\r")
CELLS = (
    "",
    "0",
    "-999",
    "9999",
    "1e300",
    "-1e300",
    "nan",
    "inf",
    "x",
    "on",
    "21,5",
    "1.234,5",
    "\x1b[2J",
    "1e-320",
    "-0",
)


def places(value: Any, place: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Return the path of every key and element of a table."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [(*place, key) for key, _ in inner] + [one for key, v in inner for one in places(v, (*place, key))]


def mutated(text: str, random: Random) -> bytes:
    """Return a TOML file with a few keys or values changed, or with some of its bytes replaced."""
    if random.random() < 0.3:
        return damaged(text.encode(), random)
    tables: Any = tomllib.loads(text)
    for _ in range(random.randint(1, 3)):
        if found := places(tables):
            _change(tables, random.choice(found), random)
    return tomli_w.dumps(tables).encode("utf-8", "surrogatepass")


def _change(table: Any, path: tuple[Any, ...], random: Random) -> None:
    for step in path[:-1]:
        table = table[step]
    key = path[-1]
    old = table[key]
    how = random.choice(("delete", "replace", "rename", "scale"))
    if how == "delete":
        del table[key]
    elif how == "rename" and isinstance(table, dict):
        table[random.choice(WORDS)] = table.pop(key)
    elif how == "scale" and isinstance(old, int | float) and not isinstance(old, bool) and key not in WORK:
        table[key] = old * random.choice((-1, 0, 0.01, 0.5, 2, 10, 1000, 1e12))
    else:
        allowed = [each for each in VALUES if key not in WORK or isinstance(each, str | list | dict | bool)]
        table[key] = random.choice(allowed)


def damaged(data: bytes, random: Random) -> bytes:
    """Return bytes with one to three pieces of at most 40 replaced, or cut off."""
    if random.random() < 0.1:
        return data[: random.randrange(len(data))]
    for _ in range(random.randint(1, 3)):
        begin = random.randrange(len(data) + 1)
        end = min(len(data), begin + random.choice((0, 0, 1, 1, 5, 40)))
        piece = random.choice((*PIECES, random.randbytes(4), data[begin : begin + 60]))
        data = data[:begin] + piece + data[end:]
    return data


def spoilt(text: str, random: Random) -> bytes:
    """Return a CSV file with cells, columns or rows changed, or with some of its bytes replaced."""
    if random.random() < 0.2:
        return damaged(text.encode(), random)
    rows = [line.split(",") for line in text.splitlines()]
    for _ in range(random.randint(1, 3)):
        _spoil(rows, random)
    return "\n".join(",".join(row) for row in rows).encode()


def _spoil(rows: list[list[str]], random: Random) -> None:
    random.choice((_spoil_column, _spoil_rows))(rows, random)


def _spoil_column(rows: list[list[str]], random: Random) -> None:
    column, other = random.randrange(len(rows[0])), random.randrange(len(rows[0]))
    match random.choice(("same", "scale", "drop", "swap", "rename")):
        case "same":
            value = random.choice(CELLS)
            rows[1:] = [[*each[:column], value, *each[column + 1 :]] for each in rows[1:]]
        case "scale":
            factor = random.choice((-1.0, 0.0, 0.01, 10.0, 1e6, 1e200))
            rows[1:] = [[*each[:column], _scaled(each, column, factor), *each[column + 1 :]] for each in rows[1:]]
        case "drop" if len(rows[0]) > 2:
            rows[:] = [each[:column] + each[column + 1 :] for each in rows]
        case "swap":
            rows[0][column], rows[0][other] = rows[0][other], rows[0][column]
        case _:
            rows[0][column] = random.choice(WORDS)


def _spoil_rows(rows: list[list[str]], random: Random) -> None:
    column, row = random.randrange(len(rows[0])), random.randrange(len(rows))
    match random.choice(("cell", "gap", "double", "cut", "short")):
        case "cell":
            rows[row][column : column + 1] = [random.choice(CELLS)]
        case "gap":
            del rows[row + 1 : row + random.choice((1, 50, 2000))]
        case "double":
            rows[row:row] = rows[row : row + random.choice((1, 30))]
        case "cut":
            del rows[random.choice((1, 2, 3, 12)) :]
        case "short":
            rows[row][column:] = []


def _scaled(row: list[str], column: int, factor: float) -> str:
    try:
        return repr(float(row[column]) * factor)
    except (ValueError, IndexError):
        return row[column] if column < len(row) else ""
