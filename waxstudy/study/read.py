"""Reading a study file: values, then tables, then cases; all problems at once."""

from __future__ import annotations

import math
from collections.abc import Collection
from pathlib import Path
from typing import TypeVar

from waxstudy.plugin import Parameters
from waxstudy.plugin.registry import Registry
from waxstudy.study.check import Check
from waxstudy.study.drawn import read_drawn
from waxstudy.study.fragment import table_of
from waxstudy.study.ladder import RawLadder, read_ladder
from waxstudy.study.lines import KeyPath
from waxstudy.study.model import (
    NAME_RULE,
    Case,
    Choice,
    Comfort,
    Ensemble,
    Ladder,
    Output,
    Season,
    Study,
    StudyTable,
    is_multiple,
    is_safe_name,
)
from waxstudy.study.problems import Problem, StudyError, shown
from waxstudy.study.read_activation import read_activation
from waxstudy.study.source import Source, read_source
from waxstudy.study.spots import RawTable, Spot

__all__ = ["Problem", "StudyError", "problem_at", "read_study"]

TABLES = ("study", "room", "weather", "comfort", "season", "ensemble", "output", "ladder", "activation")

P = TypeVar("P", bound=Parameters)


def read_study(path: Path, registry: Registry, *, needs_files: bool = True) -> Study:
    """Return the checked study; raise `StudyError` with every problem of the file.

    Without `needs_files` a weather file may have gone, as it may when a finished run is reported.
    """
    return study_of(read_source(path), registry, path, needs_files=needs_files)


def study_of(source: Source, registry: Registry, file: Path | None = None, *, needs_files: bool = True) -> Study:
    """Return the checked study of a source, which may be of no file; raise as `read_study`."""
    check = Check(source, registry, needs_files)
    check.unknown_keys(Spot.table(), check.source.values, TABLES)
    study, comfort = _part(check, "study", StudyTable), _part(check, "comfort", Comfort)
    if study and study.against is not None:
        check.reference(Spot.table("study").at("against"), study.against)
    season = _part(check, "season", Season) if "season" in check.source.values else None
    ensemble = _part(check, "ensemble", Ensemble, apart=("weather",))
    output = _output(check, study, ensemble)
    room = _room(check)
    weeks = _weeks(check)
    drawn = read_drawn(check, weeks)
    ladders = [read_ladder(check, name) for name in _names(check, "ladder")]
    cases = _cases(check, ladders)
    activation = read_activation(check, cases, room)
    if check.problems or not (study and comfort and ensemble and output and room):
        raise StudyError(check.problems)
    named = {ladder.name: Ladder(ladder.name, ladder.reference, [c.id for c in ladder.cases]) for ladder in ladders}
    tables = (study.name, study.step_s, study.against, room, weeks, comfort, ensemble, output)
    return Study(*tables, named, cases, check.fragments, file, drawn, activation, season)


def problem_at(path: Path, table: KeyPath, wrong: str, key: str = "", value: object = None) -> Problem:
    """Return a problem that only showed in use, of a table such as `("weather", "february")` or of a key in it."""
    spot = Spot.table(*map(str, table)).at(*filter(None, key.split(".")))
    try:
        line = read_source(path).line(spot.path)
    except StudyError:  # the file has changed or gone since it was read
        line = 0
    return Problem(str(path), line, spot.where, spot.key, "" if value is None else shown(value), wrong)


def _part(check: Check, name: str, model: type[P], apart: Collection[str] = ()) -> P | None:
    """Return a table's parameters but for the tables in it that are read apart."""
    spot = Spot.table(name)
    values = check.table(spot)
    if values is None:
        return None
    own = {key: value for key, value in values.items() if key not in apart}
    return check.parameters(model, RawTable.of(own, spot))


def _room(check: Check) -> Choice | None:
    """Return `[room]`, which may be of a file that a calibration has written."""
    spot = Spot.table("room")
    values = check.table(spot)
    table = None if values is None else table_of(check, "room", values, spot)
    return check.choice("room", table) if table else None


def _choice(check: Check, kind: str, spot: Spot) -> Choice | None:
    values = check.table(spot)
    return None if values is None else check.choice(kind, RawTable.of(values, spot))


def _output(check: Check, study: StudyTable | None, ensemble: Ensemble | None) -> Output | None:
    """Return `[output]`, which depends on the step and the members."""
    output = _part(check, "output", Output)
    if output is None or study is None or ensemble is None:
        return output
    spot, interval_s = Spot.table("output"), output.trace_interval_s
    if "trace_interval_s" not in output.model_fields_set:
        steps = math.ceil(interval_s / study.step_s - 1e-9)
        output = output.model_copy(update={"trace_interval_s": steps * study.step_s})
    elif not is_multiple(interval_s, of=study.step_s):
        wrong = f"must be a multiple of step_s = {study.step_s:g}"
        check.problem(spot.at("trace_interval_s"), wrong, value=interval_s)
    if output.trace_members > ensemble.members:
        wrong = f"must be at most [ensemble] members = {ensemble.members}"
        check.problem(spot.at("trace_members"), wrong, value=output.trace_members)
    return output


def _names(check: Check, parent: str) -> list[str]:
    """Return the names NAME of all tables `[parent.NAME]`."""
    spot = Spot.table(parent)
    tables = check.table(spot)
    if tables == {}:
        check.problem(spot, f"missing: at least one table [{parent}.NAME]")
    for name, value in (tables or {}).items():
        if not isinstance(value, dict):
            check.problem(spot.at(name), f"must be a table, written as [{parent}.NAME]", value=value)
        elif not is_safe_name(name):
            check.problem(Spot.table(parent, name), f"the name {NAME_RULE}")
    return [name for name, value in (tables or {}).items() if isinstance(value, dict)]


def _weeks(check: Check) -> dict[str, Choice]:
    names = _names(check, "weather")
    _refuse_doubles(check, "week", [(name, Spot.table("weather", name)) for name in names])
    weeks = {name: _choice(check, "weather", Spot.table("weather", name)) for name in names}
    return {name: choice for name, choice in weeks.items() if choice}


def _cases(check: Check, ladders: list[RawLadder]) -> dict[str, Case]:
    """Return all cases by id; a block with a problem is left out, and the problem noted."""
    _refuse_doubles(check, "case", [(case.id, case.spot.at("id")) for ladder in ladders for case in ladder.cases])
    cases: dict[str, Case] = {}
    for ladder in ladders:
        for raw in ladder.cases:
            blocks = {kind: check.choice(kind, block) for kind, block in raw.blocks.items()}
            cases[raw.id] = Case(raw.id, ladder.name, {kind: choice for kind, choice in blocks.items() if choice})
    return cases


def _refuse_doubles(check: Check, what: str, named: list[tuple[str, Spot]]) -> None:
    """Names become file names, and some systems do not tell capitals apart there."""
    seen: dict[str, Spot] = {}
    for name, spot in named:
        first = seen.setdefault(name.casefold(), spot)
        if first is not spot and is_safe_name(name):
            line = check.source.line(first.path)
            check.problem(spot, f"there is a {what} of this name in line {line}", allowed="capitals do not count")
