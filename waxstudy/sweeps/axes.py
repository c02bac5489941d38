"""A sweep file: which parameters take which values, and the points that this makes.

A TOML file states axes and how points are drawn from them; a CSV file has a row for each point.
"""

from __future__ import annotations

import csv
import io
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from waxstudy.plugin import BackendMissing, FloatArray, Parameters, parameter
from waxstudy.plugin.parameters import checked
from waxstudy.study.problems import Problem, StudyError, shown
from waxstudy.study.source import Source, read_source, read_text

MOST_POINTS = 100_000  # more rows than that are a mistake rather than a plan
NAME = "name"  # of a column that names the points of a table
Method = Literal["grid", "latin-hypercube", "sobol"]


@dataclass(frozen=True)
class Range:
    """Values between two bounds; whole numbers where both bounds are."""

    low: float
    high: float

    def at(self, share: float) -> float:
        """Return the value at a share of the way, 0 to 1."""
        if isinstance(self.low, int) and isinstance(self.high, int):
            return min(self.high, self.low + math.floor(share * (self.high - self.low + 1)))
        return self.low + share * (self.high - self.low)


@dataclass(frozen=True)
class Sweep:
    """Points in order, each a value for each key; `lines` tells where keys stand, and points that have lines."""

    file: str
    method: str
    keys: tuple[str, ...]
    points: tuple[tuple[Any, ...], ...]
    names: tuple[str, ...] = ()
    ranges: Mapping[str, Range] | None = None
    lines: Mapping[str | int | None, int] | None = None

    def problem(self, key: str, wrong: str, point: int | None = None, value: object = None) -> Problem:
        """Return what is wrong with a key, or with its value at a point; points that no file holds have no line."""
        lines = self.lines or {}
        line = next((lines[each] for each in (point, key) if each in lines), 0)
        return Problem(self.file, line, "", key, "" if value is None else shown(value), wrong)


class Drawing(Parameters):
    """`[sweep]`"""

    method: Method = parameter("grid", unit="", description="how points are drawn from the axes", source="chosen")
    samples: int = parameter(
        64,
        unit="1",
        description="points of a Latin hypercube; `sobol` takes as many times the count of axes and 2",
        source="chosen",
        ge=1,
        le=MOST_POINTS,
    )
    seed: int = parameter(1, unit="1", description="seed of what is drawn", source="chosen", ge=0)


def read_sweep(path: Path) -> Sweep:
    """Read a sweep from a TOML or CSV file.

    Raises `StudyError` with what is wrong, `BackendMissing` if `sobol` is asked for without SALib.
    """
    return _of_table(path) if path.suffix.lower() == ".csv" else _of_toml(read_source(path))


# --- TOML --------------------------------------------------------------------------------------------


def _of_toml(source: Source) -> Sweep:
    drawing = _drawing(source)
    vary = source.values.get("vary")
    for name in source.values.keys() - {"sweep", "vary"}:
        raise _wrong(source, (name,), "unknown table (allowed: sweep, vary)")
    if not isinstance(vary, dict) or not vary:
        raise _wrong(source, ("vary",), 'missing: [vary] with a line for each parameter, as "room.KEY" = [1.0, 2.0]')
    stated = list(_axes(source, vary, ("vary",)))
    axes = dict(stated)
    if len(axes) < len(stated):
        raise _wrong(source, ("vary",), "a key is given twice: as one key, and as tables in each other")
    if drawing.method != "grid" and not any(isinstance(axis, Range) for axis in axes.values()):
        raise _wrong(source, ("vary",), f"{drawing.method} needs a range: {{ low = 1.0, high = 2.0 }}")
    for key, axis in axes.items():
        if drawing.method == "grid" and isinstance(axis, Range):
            raise _wrong(source, _path(source, key), "a grid takes a list of values; a range needs another method")
        if drawing.method == "sobol" and not isinstance(axis, Range):
            raise _wrong(source, _path(source, key), "sobol takes ranges: { low = 1.0, high = 2.0 }")
    points = tuple(_drawn(drawing, axes, source))
    ranges = {key: axis for key, axis in axes.items() if isinstance(axis, Range)}
    lines: dict[str | int | None, int] = {key: source.line(_path(source, key)) for key in axes}
    return Sweep(source.file, drawing.method, tuple(axes), points, ranges=ranges, lines=lines)


def _drawing(source: Source) -> Drawing:
    table = source.values.get("sweep", {})
    if not isinstance(table, dict):
        raise _wrong(source, ("sweep",), "must be a table, written as [sweep]")
    try:
        return checked(Drawing, table)
    except ValueError as error:
        raise _wrong(source, ("sweep",), str(error)) from None


def _axes(source: Source, table: Mapping[str, Any], path: tuple[str, ...]) -> Iterator[tuple[str, Range | list[Any]]]:
    """Give each key with its values; `room.KEY` may be written as one key or as a table in a table."""
    for key, value in table.items():
        at = (*path, key)
        name = ".".join(at[1:])
        if isinstance(value, dict) and not value.keys() <= {"low", "high"}:
            yield from _axes(source, value, at)
        elif isinstance(value, dict):
            yield name, _range(source, at, value)
        elif isinstance(value, list) and value and not any(isinstance(each, list | dict) for each in value):
            yield name, value
        else:
            raise _wrong(source, at, "must be a list of values, or a range { low = 1.0, high = 2.0 }")


def _range(source: Source, at: tuple[str, ...], value: Mapping[str, Any]) -> Range:
    bounds: list[Any] = [each for each in (value.get("low"), value.get("high")) if _is_finite(each)]
    if len(bounds) < 2:
        raise _wrong(source, at, "a range needs two numbers, low and high")
    low, high = bounds
    if not low < high:
        raise _wrong(source, at, f"low must be less than high, not {low} and {high}")
    return Range(low, high)


def _is_finite(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _drawn(drawing: Drawing, axes: Mapping[str, Range | list[Any]], source: Source) -> Iterator[tuple[Any, ...]]:
    lists = [axis for axis in axes.values() if isinstance(axis, list)]
    base = drawing.samples * (len(axes) + 2 if drawing.method == "sobol" else 1)
    count = math.prod(map(len, lists)) if drawing.method == "grid" else base
    if count > MOST_POINTS:
        raise _wrong(source, ("vary",), f"{count} points; {MOST_POINTS} at most")
    if drawing.method == "grid":
        yield from itertools.product(*lists)
        return
    draw: Callable[[Drawing, Sequence[str]], FloatArray] = _saltelli if drawing.method == "sobol" else _hypercube
    for row in draw(drawing, list(axes)):
        yield tuple(_value(axis, float(share)) for axis, share in zip(axes.values(), row, strict=True))


def _value(axis: Range | list[Any], share: float) -> Any:
    return axis.at(share) if isinstance(axis, Range) else axis[min(len(axis) - 1, int(share * len(axis)))]


def _hypercube(drawing: Drawing, names: Sequence[str]) -> FloatArray:
    from scipy.stats import qmc

    return np.asarray(qmc.LatinHypercube(len(names), rng=drawing.seed).random(drawing.samples))


def _saltelli(drawing: Drawing, names: Sequence[str]) -> FloatArray:
    """Return Saltelli's design, from which Sobol indices of first and total order are estimated."""
    sampled = salib("SALib.sample.sobol").sample(
        problem(names), drawing.samples, calc_second_order=False, seed=drawing.seed
    )
    return np.asarray(sampled)


def problem(names: Sequence[str]) -> dict[str, Any]:
    """Return axes as SALib wants them, each as a share of its range."""
    return {"num_vars": len(names), "names": list(names), "bounds": [[0.0, 1.0]] * len(names)}


def salib(module: str) -> Any:
    """Import a part of SALib; raise `BackendMissing` if it is not installed."""
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError as error:
        raise BackendMissing("SALib is not installed: pip install 'waxstudy[sensitivity]'") from error


def _path(source: Source, key: str) -> tuple[str, ...]:
    """Return where a key stands in the file, however it is written."""
    return ("vary", key) if key in source.values["vary"] else ("vary", *key.split("."))


def _wrong(source: Source, path: tuple[str, ...], wrong: str) -> StudyError:
    table, *keys = path
    return StudyError([Problem(source.file, source.line(path), f"[{table}]", ".".join(keys), "", wrong)])


# --- CSV ---------------------------------------------------------------------------------------------


def _of_table(path: Path) -> Sweep:
    """Read a table of points; its first row has the keys, and may have `name`."""
    reader = csv.reader(io.StringIO(read_text(path)))
    rows = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]

    def wrong(line: int, text: str) -> StudyError:
        return StudyError([Problem(str(path), line, "", "", "", text)])

    if len(rows) < 2:
        raise wrong(0, "a row of keys and at least one row of values are expected")
    (first, keys), *rest = rows
    head = [cell.strip() for cell in keys]
    if len(set(head)) < len(head) or "" in head:
        raise wrong(first, "every column needs a key of its own")
    for number, row in rest:
        if len(row) != len(head):
            raise wrong(number, f"{len(row)} values where there are {len(head)} keys")
        if "" in map(str.strip, row):
            raise wrong(number, "a value is missing: every point needs one for every key")
    if len(rest) > MOST_POINTS:
        raise wrong(0, f"{len(rest)} points; {MOST_POINTS} at most")
    at = [place for place, key in enumerate(head) if key != NAME]
    points = tuple(tuple(_number(row[place].strip()) for place in at) for _, row in rest)
    names = tuple(row[head.index(NAME)].strip() for _, row in rest) if NAME in head else ()
    lines: dict[str | int | None, int] = dict.fromkeys(head, first)
    lines |= {point: number for point, (number, _) in enumerate(rest)}
    return Sweep(str(path), "table", tuple(head[place] for place in at), points, names, lines=lines)


def _number(cell: str) -> Any:
    """Return a number where a cell is one, true or false, else its text."""
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            pass
    return {"true": True, "false": False}.get(cell.lower(), cell)
