"""The tables of an activation: how the fleet answers, what a megawatt needs, what rooms have of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from waxstudy.fleet.response import Band
from waxstudy.fleet.result import Activated
from waxstudy.fleet.summary import Row
from waxstudy.report.formats import markdown, terminal
from waxstudy.report.table import Column, Table, text
from waxstudy.results.json_text import json_text


def _band(key: str, heading: str, times: float = 1.0) -> Column[Row]:
    return Column(key, lambda row: banded(getattr(row, key), times), heading=heading)


LOOPS_PER_MW = (
    _band("loops_per_MW_heat", "loops for 1 MW of heat"),
    _band("loops_per_MW_electric", "loops for 1 MW of electricity"),
)


def tables(found: Activated) -> list[Table[Row]]:
    """Five tables with the same rows."""
    place = _place(found)
    return [
        Table("answers within the limit", [*place, *_answers(found)], found.rows),
        Table("reserve of a loop", [*place, *_reserve_of_a_loop(found)], found.rows),
        Table("what 1 MW of reserve needs", [*place, *LOOPS_PER_MW], found.rows),
        Table("heat of a loop", [*place, *_heat(found)], found.rows),
        Table("rooms meanwhile", [*place, *_rooms(found)], found.rows),
    ]


def _place(found: Activated) -> list[Column[Row]]:
    weeks = len({row.week for row in found.rows}) > 1
    return [
        *([text("week")] if weeks else []),
        text("state"),
        Column("at_h", None, "g", "call at", "h"),
    ]


def _answers(found: Activated) -> list[Column[Row]]:
    on = found.said["signal"] == "on"
    limit = f"in {found.said['limit_s']:g} s, %"
    return [
        Column("opening_before", None, ".2f", "mean opening before"),
        _band("flow_share", f"{'90 % of flow' if on else '10 % of flow or less'} {limit}", 100.0),
        _band("opening_share", f"{'fully open' if on else 'closed'} {limit}", 100.0),
        Column("slowest_s", None, ".0f", "slowest", "s"),
        Column("idle_share", lambda row: 100.0 * row.idle_share, ".1f", "flow while nobody asks", "%"),
    ]


def _reserve_of_a_loop(found: Activated) -> list[Column[Row]]:
    return [
        _band("limit_W", f"at {found.said['limit_s']:g} s, W per loop"),
        _band("firm_W", "firm, W per loop"),
        _band("mean_W", "on the mean, W per loop"),
    ]


def _heat(found: Activated) -> list[Column[Row]]:
    early = [_band("early_Wh", "before the call, Wh")] if any(row.early_Wh.value for row in found.rows) else []
    return [
        *early,
        _band("added_Wh", "in the call, Wh"),
        _band("later_Wh", f"in {found.said['rebound_h']:g} h after, Wh"),
    ]


def _rooms(found: Activated) -> list[Column[Row]]:
    below = f"below {found.comfort_limit_C:g} °C"
    return [
        Column("warmer_K", None, ".2f", "warmer by", "K"),
        Column("colder_K", None, ".2f", "colder by", "K"),
        Column("warmest_C", None, ".1f", "warmest", "°C"),
        Column("coldest_C", None, ".1f", "coldest", "°C"),
        Column("below_min", None, ".1f", below, "min"),
        Column("below_without_min", None, ".1f", "without the call", "min"),
    ]


def banded(band: Band, times: float = 1.0) -> str:
    """
    >>> banded(Band(2084.2, 1999.7, 2187.6)), banded(Band(0.55, 0.55, 0.55), 100.0), banded(Band(math.nan, 1.0, 2.0))
    ('2,080 (2,000 to 2,190)', '55', '-')
    """
    if math.isnan(band.value):
        return "-"
    value, low, high = (_figure(times * each) for each in (band.value, band.low, band.high))
    return value if low == high == value else f"{value} ({low} to {high})"


def _figure(value: float) -> str:
    """No more than three digits that tell something."""
    return "any number" if math.isnan(value) else f"{float(f'{value:.3g}') if abs(value) >= 1000.0 else value:z,.0f}"


def notes(found: Activated) -> list[str]:
    """How the figures are meant, and what a reader must know."""
    return [*_meant(found), *found.warnings]


def _meant(found: Activated) -> Iterator[str]:
    said = found.said
    yield "in brackets: 95 % of other fleets of as many loops, drawn from the same distributions"
    yield (
        "heat is per loop, and beyond what it takes without the call; firm: the least from "
        f"{said['limit_s']:g} s to the end of the call at {said['lasts_s']:g} s"
    )
    if said["signal"] == "off":
        yield "reserve: heat that is switched off counts as given"
    yield f"a megawatt of electricity takes {said['cop']:g} of heat (cop), and as many loops more"
    yield "warmer, colder: the most by which a room departs from what it is without the call (operative, mean of loops)"
    if any(math.isnan(row.slowest_s) for row in found.rows):
        yield "no slowest time: a loop had not answered when the call ended"
    if any(math.isnan(row.loops_per_MW_heat.value) for row in found.rows):
        yield "-: the fleet gives nothing that lasts to the end of the call"


def verdict(found: Activated) -> str:
    """What was found, in one sentence for each state."""
    on = found.said["signal"] == "on"
    what = "fully open" if on else "closed"
    shares: dict[str, list[str]] = {}
    for row in found.rows:
        shares.setdefault(row.state, []).append(f"{100.0 * row.opening_share.value:.0f}")
    told = "; ".join(f"{state} {' and '.join(dict.fromkeys(values))} %" for state, values in shares.items())
    return f"{what.capitalize()} within {found.said['limit_s']:g} s of the call: {told}."


def as_json(found: Activated) -> dict[str, Any]:
    """Return all figures with their bands; what is not known is null."""
    return {
        "format": 1,
        "study": found.study,
        "activation": found.said,
        "rooms": found.rooms,
        "table": [asdict(row) for row in found.rows],
        "warnings": found.warnings,
        "provenance": found.provenance,
    }


def as_csv(found: Activated) -> str:
    """Return the table as CSV: a row for each week, state and call, bands as columns NAME_low and NAME_high."""
    return str(found.table.to_csv(index=False, lineterminator="\n"))


def render(found: Activated, form: str, width: int = 120, colour: bool = False) -> str:
    """Return the tables in one of the formats but HTML."""
    if form == "json":
        return json_text(as_json(found))
    if form == "csv":
        return as_csv(found)
    if form == "md":
        return markdown(f"Activation of the study {found.study}", tables(found), notes(found))
    return f"{verdict(found)}\n{terminal(tables(found), notes(found), width, colour)}"
