"""The attribution as tables of text, CSV or JSON."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from waxstudy.report.attribution.notes import notes
from waxstudy.report.attribution.shares import HEAT, MAE, PERCENT, SHIFT, Attribution, Difference, OrderFree, Share
from waxstudy.report.comparison import Estimate
from waxstudy.report.render import json_text, markdown, terminal
from waxstudy.report.words import Table, counted, decimals, with_spread

WORDS = {HEAT: ("heat", "kWh/m²", 3), PERCENT: ("heat", "%", 2), SHIFT: ("shift", "K", 3), MAE: ("MAE", "K", 3)}
TOTAL = "total"


# --- tables for the terminal, Markdown and HTML ------------------------------------------------------


def tables(found: OrderFree) -> list[Table]:
    """Two tables for each ladder and week: the shares, and how much of them is the step's place."""
    return [table for of in found.attributions for table in (_shares_table(of, found.members), _place_table(of))]


def name(of: Attribution) -> str:
    """The words for a ladder in a week."""
    return f"ladder {of.subsets.ladder.name}, {of.week}"


def _shares_table(of: Attribution, members: int) -> Table:
    columns = [text for word, unit, _ in WORDS.values() for text in (f"{word} {unit}", "order-free")]
    how = "order-free ± half its 95 % interval, in brackets where not resolved" if members > 1 else "order-free"
    cases, steps = of.subsets.ladder.cases, of.subsets.steps
    title = (
        f"{name(of)}: what each step adds, {cases[0]} to {cases[-1]}, by the ladder's order and beside it {how} "
        f"({counted(of.orders, 'order')}, {counted(members, 'member')})"
    )
    rows = [[step, *_shares(of, i)] for i, step in enumerate(steps)]
    total = [text for figure, d in of.differences.items() for text in _total(d, WORDS[figure][2])]
    return title, ["step", *columns], [*rows, [TOTAL, *total]]


def _shares(of: Attribution, step: int) -> list[str]:
    texts = []
    for figure, (_, _, digits) in WORDS.items():
        share = of.differences[figure].shares[step]
        texts += [_plain(share.in_ladder.mean, digits), _with_interval(share.order_free, digits)]
    return texts


def _total(of: Difference, digits: int) -> tuple[str, str]:
    return _plain(sum(share.in_ladder.mean for share in of.shares), digits), _with_interval(of.total, digits)


def _place_table(of: Attribution) -> Table:
    shown = [figure for figure in WORDS if figure != HEAT]
    columns = [text for f in shown for text in (f"{WORDS[f][0]} {WORDS[f][1]}", "its place")]
    title = (
        f"{name(of)}: how much that depends on the order: least to most over all orders, and beside it what of the "
        "ladder's figure is the step's place there (ladder's order minus order-free)"
    )
    return title, ["step", *columns], [[step, *_places(of, shown, i)] for i, step in enumerate(of.subsets.steps)]


def _places(of: Attribution, figures: Sequence[str], step: int) -> list[str]:
    texts = []
    for figure in figures:
        share, digits = of.differences[figure].shares[step], WORDS[figure][2]
        texts += [_range(share, digits), _with_interval(share.of_its_place, digits)]
    return texts


def _range(share: Share, digits: int) -> str:
    least, most = (_plain(value, digits) for value in (share.least, share.most))
    return f"{least} to {most}" if least else ""


def _with_interval(value: Estimate, digits: int) -> str:
    """In brackets where the ensemble cannot tell it from zero."""
    text = with_spread(value.mean, (value.high - value.low) / 2.0, digits)
    return f"({text})" if is_resolved(value) is False else text


def _plain(value: float, digits: int) -> str:
    return with_spread(value, math.nan, digits)


def is_resolved(value: Estimate) -> bool | None:
    """Whether the 95 % interval excludes zero; None without a spread."""
    return None if math.isnan(value.low) else value.excludes_zero


# --- the formats -------------------------------------------------------------------------------------


def as_terminal(found: OrderFree, width: int, colour: bool) -> str:
    return terminal(tables(found), notes(found), width, colour)


def as_markdown(found: OrderFree) -> str:
    return markdown(found.run.study, tables(found), notes(found))


ESTIMATES = ("in_ladder", "order_free", "of_its_place")


def as_csv(found: OrderFree) -> str:
    """One row per ladder, week, figure and step; the row `total` of each is what the shares sum to."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    columns = [f"{name}{end}" for name in ESTIMATES for end in ("", "_low", "_high")]
    writer.writerow(["ladder", "week", "figure", "step", *columns, "least", "most", "resolved"])
    for of in found.attributions:
        for figure, d in of.differences.items():
            start = [of.subsets.ladder.name, of.week, figure]
            writer.writerows([*start, share.step, *_csv_share(share)] for share in d.shares)
            total = _csv_estimate(d.total)
            writer.writerow([*start, TOTAL, *total, *total, *[""] * 5, _word(d.total)])
    return out.getvalue()


def _csv_share(share: Share) -> list[str]:
    estimates = [text for name in ESTIMATES for text in _csv_estimate(getattr(share, name))]
    return [*estimates, decimals(share.least), decimals(share.most), _word(share.order_free)]


def _csv_estimate(value: Estimate) -> list[str]:
    return [decimals(figure) for figure in (value.mean, value.low, value.high)]


def _word(value: Estimate) -> str:
    """Empty where there is no spread to tell it from."""
    return {None: "", True: "yes", False: "no"}[is_resolved(value)]


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
    shares = [asdict(share) | {"resolved": is_resolved(share.order_free)} for share in of.shares]
    return {"total": asdict(of.total), "sum_of_shares": of.total.mean + of.remainder, "shares": shares}
