"""A study at one point of a sweep: the file's values with those of the point in their places."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from waxstudy.plugin import Choice, Parameters
from waxstudy.plugin.registry import installed, nearest
from waxstudy.study.model import Comfort, Ensemble, Season, Study
from waxstudy.study.problems import Problem, StudyError
from waxstudy.study.read import study_of
from waxstudy.study.source import Source
from waxstudy.sweeps.axes import Sweep

ALLOWED = (
    "allowed: room.KEY, weather.KEY, weather.WEEK.KEY, comfort.KEY, season.KEY, ensemble.KEY, BLOCK.KEY or "
    "CASE.BLOCK.KEY"
)
TABLES: dict[str, type[Parameters]] = {"comfort": Comfort, "season": Season, "ensemble": Ensemble}


@dataclass(frozen=True)
class Place:
    """Where a key of a sweep stands in a study: in a table of its own name, in weeks, or in a block of cases."""

    table: str
    path: tuple[str, ...]  # within the table, or within the block
    unit: str
    of: tuple[str, ...] = ()  # weeks or cases


def studies(source: Source, study: Study, sweep: Sweep) -> list[Study]:
    """Return the study at every point; raise `StudyError` with what is wrong with keys or values of the sweep."""
    known = places(study)
    wrong = [
        replace(sweep.problem(key, "no parameter of this study"), near=nearest(key, known), allowed=ALLOWED)
        for key in sweep.keys
        if key not in known
    ]
    if wrong:
        raise StudyError(wrong)
    made: list[Study] = []
    for number, values in enumerate(sweep.points):
        try:
            made.append(study_at(source, known, dict(zip(sweep.keys, values, strict=True))))
        except StudyError as error:
            wrong += [_in_sweep(sweep, number, problem) for problem in error.problems]
    if wrong:
        raise StudyError(list(dict.fromkeys(wrong)))
    return made


def study_at(source: Source, known: Mapping[str, Place], values: Mapping[str, Any]) -> Study:
    """Return a study with some values changed; traces are not kept. Raises `StudyError`."""
    changed: dict[str, Any] = copy.deepcopy(source.values)
    for key, value in values.items():
        *way, last = known[key].path
        for table in _tables(changed, known[key]):
            for name in way:
                table = table.setdefault(name, {})
            table[last] = value
    changed["output"] = {**changed.get("output", {}), "trace_members": 0}
    return study_of(replace(source, values=changed), installed())


def places(study: Study) -> dict[str, Place]:
    """Return every key that a sweep of this study may vary, and where it stands."""
    found: dict[str, Place] = {}

    def add(before: str, table: str, path: tuple[str, ...], unit: str, of: str) -> None:
        key = ".".join((before, *path))
        found[key] = Place(table, path, unit, (*(found[key].of if key in found else ()), of))

    for name, table in TABLES.items():
        found |= {f"{name}.{key}": Place(name, (key,), _unit(table, key)) for key in table.model_fields}
    found |= {".".join(("room", *path)): Place("room", path, unit) for path, unit in _paths(study.room)}
    for week, choice in study.weeks.items():
        for path, unit in _paths(choice):
            add("weather", "weather", path, unit, week)
            add(f"weather.{week}", "weather", path, unit, week)
    for case in study.cases.values():
        for kind, choice in case.blocks.items():
            for path, unit in _paths(choice):
                add(kind, kind, path, unit, case.id)
                add(f"{case.id}.{kind}", kind, path, unit, case.id)
    return found


def _paths(choice: Choice) -> Iterator[tuple[tuple[str, ...], str]]:
    """Give each parameter of a component, and each that a table among them holds, with its unit."""
    stated, model = choice.described(), type(choice.parameters)
    for key in model.model_fields:
        unit, inner = _unit(model, key), stated.get(key)
        yield (key,), unit
        yield from (((key, name), unit) for name in (inner if isinstance(inner, dict) else ()))


def _unit(model: type[Parameters], key: str) -> str:
    """Return the unit that a parameter declares; 1 for words and for numbers without one."""
    declared = model.model_fields[key].json_schema_extra
    return str(declared.get("unit") or "1") if isinstance(declared, dict) else "1"


def _tables(values: dict[str, Any], place: Place) -> Iterator[dict[str, Any]]:
    """Give each table of the file in which a key is to be set; the cases of a ladder inherit from those before."""
    if not place.of:
        yield values.setdefault(place.table, {})
    elif place.table == "weather":
        yield from (values["weather"][week] for week in place.of)
    else:
        for ladder in values["ladder"].values():
            for step in (ladder["start"], *ladder.get("steps", [])):
                if step["id"] in place.of and (place.table in step or len(place.of) == 1):
                    yield step.setdefault(place.table, {})


def _in_sweep(sweep: Sweep, number: int, problem: Problem) -> Problem:
    """Say of a value that the study cannot take which key of the sweep it is; else at which point it is not taken."""
    words = set(problem.where.strip("[]").removeprefix("case ").split(".")) | set(problem.key.split("."))
    own = next((key for key in sweep.keys if key.rsplit(".", 1)[-1] in words), "")
    if own:
        value = sweep.points[number][sweep.keys.index(own)]
        return replace(sweep.problem(own, problem.wrong, number, value), allowed=problem.allowed)
    return sweep.problem("", f"point {number}: {problem}", number)
