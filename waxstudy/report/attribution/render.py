"""The attribution as tables, and as text for the terminal, Markdown, CSV or JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from operator import attrgetter
from typing import Any, NamedTuple

from waxstudy.report.attribution.notes import notes
from waxstudy.report.attribution.shares import HEAT, MAE, PERCENT, SHIFT, Attribution, Difference, OrderFree, Share
from waxstudy.report.comparison import CORRECTED_DIFFERENCE, Estimate
from waxstudy.report.formats import csv_text, markdown, terminal
from waxstudy.report.table import Column, Table, text
from waxstudy.report.words import counted, with_spread, yes_or_no
from waxstudy.results.json_text import json_text

WORDS = {
    HEAT: ("heat", "kWh/m²", ".3f"),
    PERCENT: ("heat", "%", ".2f"),
    CORRECTED_DIFFERENCE: ("corrected heat", "%", ".2f"),
    SHIFT: ("shift", "K", ".3f"),
    MAE: ("MAE", "K", ".3f"),
}
Shares = Mapping[str, Share]  # of a step, by figure
STEP: Column[Shares] = text("step", lambda shares: shares[HEAT].step)


# --- tables for the terminal, Markdown and HTML ------------------------------------------------------


def tables(found: OrderFree) -> list[Table[Shares]]:
    """Two tables for each ladder and week: the shares, and how much of them is the step's place."""
    return [table for of in found.attributions for table in (_shares_table(of, found.members), _place_table(of))]


def _shares_table(of: Attribution, members: int) -> Table[Shares]:
    how = "order-free ± half its 95 % interval, in brackets where not resolved" if members > 1 else "order-free"
    cases = of.subsets.ladder.cases
    title = (
        f"ladder {of.name}: what each step adds, {cases[0]} to {cases[-1]}, by the ladder's order and beside it {how} "
        f"({counted(of.orders, 'order')}, {counted(members, 'member')})"
    )
    return Table(title, [STEP, *(column for figure in WORDS for column in _share_columns(figure))], _rows(of))


def _rows(of: Attribution) -> list[Shares]:
    """A row for each step, and the total."""
    lines = zip(*(difference.lines for difference in of.differences.values()), strict=True)
    return [dict(zip(of.differences, shares, strict=True)) for shares in lines]


def _share_columns(figure: str) -> list[Column[Shares]]:
    word, unit, form = WORDS[figure]
    return [
        Column(figure, lambda shares: shares[figure].in_ladder.mean, f"z{form}", word, unit),
        Column("order-free", lambda shares: _with_interval(shares[figure].order_free, form)),
    ]


def _place_table(of: Attribution) -> Table[Shares]:
    title = (
        f"ladder {of.name}: how much that depends on the order: least to most over all orders, and beside it what of "
        "the ladder's figure is the step's place there (ladder's order minus order-free)"
    )
    columns = [column for figure in WORDS if figure != HEAT for column in _place_columns(figure)]
    return Table(title, [STEP, *columns], _rows(of)[:-1])


def _place_columns(figure: str) -> list[Column[Shares]]:
    word, unit, form = WORDS[figure]
    return [
        Column(figure, lambda shares: _range(shares[figure], form), heading=word, unit=unit),
        Column("its place", lambda shares: _with_interval(shares[figure].of_its_place, form)),
    ]


def _range(share: Share, form: str) -> str:
    return "" if math.isnan(share.least) else f"{share.least:z{form}} to {share.most:z{form}}"


def _with_interval(value: Estimate, form: str) -> str:
    """In brackets where the ensemble cannot tell it from zero."""
    text = with_spread(value.mean, value.half_width, form)
    return f"({text})" if value.resolved is False else text


# --- the formats -------------------------------------------------------------------------------------


def as_terminal(found: OrderFree, width: int, colour: bool) -> str:
    return terminal(tables(found), notes(found), width, colour)


def as_markdown(found: OrderFree) -> str:
    return markdown(found.run.study, tables(found), notes(found))


class Line(NamedTuple):
    """A row of the CSV."""

    ladder: str
    week: str
    figure: str
    share: Share


def as_csv(found: OrderFree) -> str:
    """One row per ladder, week, figure and step; the row `total` of each is what the shares sum to."""
    columns: list[Column[Line]] = [Column("ladder"), Column("week"), Column("figure")]
    columns.append(Column("step", attrgetter("share.step")))
    for key in ("in_ladder", "order_free", "of_its_place"):
        for end, part in (("", "mean"), ("_low", "low"), ("_high", "high")):
            columns.append(Column(f"{key}{end}", attrgetter(f"share.{key}.{part}"), ".5f"))
    columns += [Column(key, attrgetter(f"share.{key}"), ".5f") for key in ("least", "most")]
    columns.append(Column("resolved", lambda line: yes_or_no(line.share.order_free.resolved)))
    lines = [
        Line(of.subsets.ladder.name, of.week, figure, share)
        for of in found.attributions
        for figure, difference in of.differences.items()
        for share in difference.lines
    ]
    return csv_text(Table("", columns, lines))


def as_json(found: OrderFree) -> str:
    """The shares, and the mean of each figure for each set of steps, from which they can be computed again."""
    return json_text(
        {
            "run": str(found.run.folder),
            "study": found.run.study,
            "members": found.members,
            "attribution": [_described(of) for of in found.attributions],
            "notes": notes(found),
        }
    )


def _described(of: Attribution) -> dict[str, Any]:
    subsets = of.subsets
    return {
        "ladder": subsets.ladder.name,
        "week": of.week,
        "simplest": subsets.ladder.cases[0],
        "most_detailed": subsets.ladder.cases[-1],
        "orders": of.orders,
        "steps": [{"step": step, "changes": edit} for step, edit in zip(subsets.steps, subsets.edits, strict=True)],
        "figures": {figure: _described_difference(d) for figure, d in of.differences.items()},
        "sets": [
            {
                "steps": [subsets.steps[step] for step in sorted(chosen)],
                "case": case,
                "hours_below_per_week": of.hours_below[chosen],
                **{figure: d.means[chosen] for figure, d in of.differences.items()},
            }
            for chosen, case in subsets.case.items()
        ],
    }


def _described_difference(of: Difference) -> dict[str, Any]:
    shares = [asdict(share) | {"resolved": share.order_free.resolved} for share in of.shares]
    return {"total": asdict(of.total), "sum_of_shares": of.total.mean + of.remainder, "shares": shares}
