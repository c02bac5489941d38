"""Reading `[activation]`: its call, its states, what is drawn, and a table of rooms."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from waxstudy.plugin import CHAIN, Choice, Parameters
from waxstudy.plugin.registry import nearest
from waxstudy.study.activation import (
    FLOW,
    MOST_ROOMS,
    SETPOINT,
    TABLE,
    Activation,
    ActivationTable,
    FleetState,
    RoomRow,
    StateTable,
    bare,
    of_block,
)
from waxstudy.study.check import Check
from waxstudy.study.model import NAME_RULE, Case, Comfort, is_safe_name
from waxstudy.study.problems import Problem, StudyError, listed, shown
from waxstudy.study.rooms_table import LOOPS, NAME, read_rooms
from waxstudy.study.spots import RawTable, Spot, Written
from waxstudy.study.spread import Between, Normal, OneOf, Spread, spread_of

APART = ("draw", "state", "rooms")
NOTHING = "nothing of this study"
ALLOWED = "allowed: setpoint_C, flow_share, room.KEY, or BLOCK.KEY of the states' cases"
FLOWS = (0.05, 2.0)  # of the room's full flow; what is drawn has to lie between


def read_activation(check: Check, cases: Mapping[str, Case], room: Choice | None) -> Activation | None:
    """Return `[activation]`, None if the study has none; notes what is wrong with it."""
    spot = Spot.table(TABLE)
    if TABLE not in check.source.values or (values := check.table(spot)) is None:
        return None
    call = check.parameters(ActivationTable, _own(check, ActivationTable, values, spot, APART))
    states = dict(_states(check, cases))
    if "ensemble" in check.source.values and "weather" in (check.table(Spot.table("ensemble")) or {}):
        check.problem(Spot.table("ensemble", "weather"), "has no use beside [activation]: each week is taken as it is")
    if "season" in check.source.values:
        check.problem(Spot.table("season"), "has no use beside [activation]: cold minutes count in all of its hours")
    before = len(check.problems)
    file, rows = _table_of_rooms(check, values)
    draws = dict(_draws(check))
    if len(check.problems) == before:
        keys = _Keys(check, cases, states, room)
        keys.check(draws, rows, file)
    return Activation(call, states, draws, rows, file) if call else None


def _own(
    check: Check, model: type[Parameters], values: Mapping[str, Any], spot: Spot, apart: Sequence[str]
) -> RawTable:
    """Return a table without the keys that are read apart; unknown ones are noted beside all that there are."""
    check.unknown_keys(spot, values, [*model.model_fields, *apart])
    return RawTable.of({key: value for key, value in values.items() if key in model.model_fields}, spot)


# --- states ------------------------------------------------------------------------------------------


def _states(check: Check, cases: Mapping[str, Case]) -> Iterator[tuple[str, FleetState]]:
    parent = Spot.table(TABLE, "state")
    tables = check.table(parent)
    if tables == {}:
        check.problem(parent, "missing: at least one table [activation.state.NAME] with the case of a ladder")
    for name, values in (tables or {}).items():
        spot = Spot.table(TABLE, "state", name)
        if not isinstance(values, dict):
            check.problem(parent.at(name), "must be a table, written as [activation.state.NAME]", value=values)
        elif not is_safe_name(name):
            check.problem(spot, f"the name {NAME_RULE}")
        elif state := _state(check, name, values, spot, cases):
            yield name, state


def _state(
    check: Check, name: str, values: Mapping[str, Any], spot: Spot, cases: Mapping[str, Case]
) -> FleetState | None:
    stated = check.parameters(StateTable, _own(check, StateTable, values, spot, ("pause_s",)))
    pause = _spread(check, spot.at("pause_s"), values["pause_s"]) if "pause_s" in values else None
    if pause and not all(_is_pause(end) for end in pause.ends):
        check.problem(spot.at("pause_s"), "must be seconds from 0 to 86400")
        return None
    if stated and stated.case not in cases:
        near, allowed = nearest(stated.case, cases), f"cases: {listed(cases)}"
        check.problem(spot.at("case"), "is no case", value=stated.case, near=near, allowed=allowed)
    return FleetState(name, stated.case, stated.preheat_s, pause) if stated else None


def _is_pause(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and 0.0 <= value <= 86400.0


# --- what is drawn -----------------------------------------------------------------------------------


def _draws(check: Check) -> Iterator[tuple[str, Spread]]:
    seen: set[str] = set()
    for key, value, spot in _flat(check.table(Spot.table(TABLE, "draw")) or {}, Spot.table(TABLE, "draw"), ""):
        if key in seen:
            check.problem(spot, "is given twice: as one key, and as tables in each other")
        elif spread := _spread(check, spot, value):
            seen.add(key)
            yield key, spread


def _flat(table: Mapping[str, Any], spot: Spot, before: str) -> Iterator[tuple[str, Any, Spot]]:
    """Give each key with its value; `room.KEY` may be written as one key or as a table in a table."""
    for key, value in table.items():
        if isinstance(value, dict) and key in ("room", *CHAIN):
            yield from _flat(value, spot.at(key), f"{key}.")
        else:
            yield f"{before}{key}", value, spot.at(key)


def _spread(check: Check, spot: Spot, value: object) -> Spread | None:
    try:
        return spread_of(value)
    except ValueError as error:
        check.problem(spot, str(error))
        return None


def _place(check: Check, key: str) -> Spot:
    """Return where a key of `[activation.draw]` is written."""
    spot, table = Spot.table(TABLE, "draw"), check.table(Spot.table(TABLE, "draw")) or {}
    return spot.at(key) if key in table else spot.at(*key.split(".", 1))


class _Keys:
    """Whether what is drawn can be had: keys that there are, and values at the ends of every distribution."""

    def __init__(
        self, check: Check, cases: Mapping[str, Case], states: Mapping[str, FleetState], room: Choice | None
    ) -> None:
        self.check_, self.room = check, room
        used = [cases[state.case] for state in states.values() if state.case in cases]
        self.blocks: dict[str, list[Choice]] = {"room": [room] if room else []}
        for case in used:
            for kind, choice in case.blocks.items():
                if choice not in self.blocks.setdefault(kind, []):
                    self.blocks[kind].append(choice)
        self.known = [SETPOINT, FLOW]
        for kind, choices in self.blocks.items():
            names = dict.fromkeys(name for each in choices for name in type(each.parameters).model_fields)
            self.known += [f"{kind}.{name}" for name in names]

    def check(self, draws: Mapping[str, Spread], rows: Sequence[RoomRow], file: Path | None) -> None:
        for key, spread in draws.items():
            spot = _place(self.check_, key)
            if rows and key in rows[0].values:
                self.check_.problem(spot, f"is in the table of rooms too: {file}")
            elif key not in self.known:
                self.check_.problem(spot, NOTHING, near=nearest(key, self.known), allowed=ALLOWED)
            elif key.startswith("room.") and not isinstance(spread, OneOf):
                self.check_.problem(spot, "rooms are built for a list of values, which loops share: give a list")
            else:
                self._values(self.check_, spot, key, spread)
        count = math.prod(len(spread.ends) for key, spread in draws.items() if key.startswith("room."))
        if count * max(1, len(rows)) > MOST_ROOMS:
            wrong = f"gives {count * max(1, len(rows))} different rooms; {MOST_ROOMS} at most"
            self.check_.problem(Spot.table(TABLE, "draw"), wrong)
        if rows and file:
            self._rows(rows, file)

    def _values(self, check: Check, spot: Spot, key: str, spread: Spread) -> None:
        for number, value in enumerate(spread.ends):
            place = spot.at(number) if isinstance(spread, OneOf) and _is_list(check, spot) else spot
            self._value(check, place, key, value, "" if isinstance(spread, OneOf) else _of_end(spread, value))

    def _value(self, check: Check, spot: Spot, key: str, value: Any, end: str = "") -> None:
        """Note it if a value cannot be had by every block of its kind that has the parameter."""
        kind, name = of_block(key)
        low, high = FLOWS
        if key == SETPOINT:
            check.parameters(Comfort, RawTable({name: Written(value, spot)}, spot, spot))
        elif key == FLOW and not (isinstance(value, int | float) and low <= value <= high):
            check.problem(spot, f"must be from {low} to {high}{end}", value=value)
        for choice in self.blocks.get(kind, []):
            if name not in type(choice.parameters).model_fields:
                continue
            stated = {each: Written(said, spot) for each, said in bare(choice, [name]).items()}
            check.parameters(choice.component.Parameters, RawTable({**stated, name: Written(value, spot)}, spot, spot))

    def _rows(self, rows: Sequence[RoomRow], file: Path) -> None:
        head = list(rows[0].values)
        for key in head:
            if key not in self.known:
                near, allowed = nearest(key, self.known), f"{ALLOWED}, {NAME}, {LOOPS}"
                self.check_.problems.append(Problem(str(file), 1, "", key, "", NOTHING, near, allowed))
        if self.check_.problems:
            return
        for row in rows:
            for key, value in row.values.items():
                self._cell(file, row, key, value)

    def _cell(self, file: Path, row: RoomRow, key: str, value: Any) -> None:
        """Check a cell on its own, and say of it where it stands."""
        apart = replace(self.check_, problems=[], said=set())
        self._value(apart, Spot.table(TABLE).at("rooms"), key, value)
        for problem in apart.problems[:1]:
            moved = replace(
                problem, file=str(file), line=row.line, where=f"room {row.name}", key=key, value=shown(value)
            )
            self.check_.problems.append(moved)


def _is_list(check: Check, spot: Spot) -> bool:
    value: Any = check.source.values
    for key in spot.path:
        value = value[key]
    return isinstance(value, list)


def _of_end(spread: Spread, value: float) -> str:
    if isinstance(spread, Normal):
        return " (mean and three times sd)"
    return " (low)" if isinstance(spread, Between) and value == spread.low else " (high)"


# --- a table of rooms --------------------------------------------------------------------------------


def _table_of_rooms(check: Check, values: Mapping[str, Any]) -> tuple[Path | None, list[RoomRow]]:
    spot = Spot.table(TABLE).at("rooms")
    stated = values.get("rooms")
    if stated is None:
        return None, []
    if not isinstance(stated, str):
        check.problem(spot, "must be the name of a CSV file in quotes", value=stated)
        return None, []
    file = check.source.folder / stated
    try:
        return file, read_rooms(file)
    except StudyError as error:
        for problem in error.problems:
            if problem.line:
                check.problems.append(problem)
            else:
                check.problem(spot, problem.wrong, value=stated, allowed=f"looked for {file}")
        return None, []
