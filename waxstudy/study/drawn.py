"""`[ensemble.weather.WEEK]`: lists of values that a week's weather takes, number by number, over the ensemble."""

from __future__ import annotations

from collections.abc import Mapping

from waxstudy.plugin.registry import nearest
from waxstudy.study.check import Check
from waxstudy.study.model import Choice, Drawn
from waxstudy.study.problems import listed
from waxstudy.study.spots import RawTable, Spot

TABLE = ("ensemble", "weather")
MOST_WEATHERS = 100  # weathers of a week: each is simulated from every start


def read_drawn(check: Check, weeks: Mapping[str, Choice]) -> dict[str, Drawn]:
    """Return the weathers of each week that has such a table; notes what is wrong with it."""
    tables = check.table(Spot.table(*TABLE)) or {}
    found = {}
    for week, values in tables.items():
        spot = Spot.table(*TABLE, week)
        if week not in weeks:
            wrong, names = "no [weather.NAME] of this name", list(weeks)
            check.problem(spot, wrong, near=nearest(week, names), allowed=f"there are: {listed(names)}")
        elif not isinstance(values, dict):
            check.problem(spot, f"must be a table, written as [{'.'.join((*TABLE, week))}]", value=values)
        elif drawn := _drawn(check, week, weeks[week], RawTable.of(values, spot)):
            found[week] = drawn
    return found


def _drawn(check: Check, week: str, stated: Choice, table: RawTable) -> Drawn | None:
    known, lists = type(stated.parameters).model_fields, table.written
    check.unknown_keys(table.first, {key: written.value for key, written in lists.items()}, known)
    for key, written in lists.items():
        if key in known and not (isinstance(written.value, list) and 2 <= len(written.value) <= MOST_WEATHERS):
            check.problem(written.spot, f"must be a list of 2 to {MOST_WEATHERS} values", value=written.value)
            return None
    counts = {key: len(written.value) for key, written in lists.items()}
    if not counts or not set(counts) <= set(known):
        return None
    if len(set(counts.values())) > 1:
        said = ", ".join(f"{key} {count}" for key, count in counts.items())
        check.problem(table.first, f"its lists are of different lengths: {said}")
        return None
    choices = [_choice(check, week, table, number) for number in range(next(iter(counts.values())))]
    kept = [choice for choice in choices if choice]
    return Drawn(tuple(counts), kept) if len(kept) == len(choices) else None


def _choice(check: Check, week: str, table: RawTable, number: int) -> Choice | None:
    """Return a week's weather with the values of this number in place of its own."""
    spot = Spot.table("weather", week)
    own = RawTable.of(check.table(spot) or {}, spot)
    changed = {
        key: written._replace(value=written.value[number], spot=written.spot.at(number))
        for key, written in table.written.items()
    }
    return check.choice("weather", RawTable({**own.written, **changed}, own.first, own.last))
