"""The tables of a report, and the report as CSV, Markdown, JSON, or text for the terminal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from operator import attrgetter
from typing import Any

from waxstudy.report.activation import Activation
from waxstudy.report.against import Against
from waxstudy.report.cases import told_same
from waxstudy.report.comparison import CORRECTED_FIGURES, FIGURES, Row
from waxstudy.report.content import Content, Starts
from waxstudy.report.formats import csv_text, markdown, terminal
from waxstudy.report.season import Comfort, Months
from waxstudy.report.spread import Spread
from waxstudy.report.table import Column, Table, text
from waxstudy.report.words import MEAN_DECIDES, SINGLE_RUN, percent, with_spread, yes_or_no
from waxstudy.results.json_text import json_text
from waxstudy.results.kpis import CATEGORIES_C, HEAT_OF_MONTH

OF_SPREAD = ("start", "weather", "rest")
PICKED_MIN = (1.0, 5.0, 15.0, 30.0, 45.0, 120.0)  # of the times off


def tables(content: Content) -> list[Table[Any]]:
    """Every table of the report."""
    against = content.against.tables() if content.against else []
    return [*comparison_tables(content), *season_tables(content), *against, *activation_tables(content)]


def comparison_tables(content: Content) -> list[Table[Any]]:
    """Two tables for each week: the figures of Table 5, and heat without what the room stores.

    A third where the week has several weathers: what its single runs differ by.
    """
    made = (_table_5, _corrected_table, _spread_table)
    return [table for week in content.run.weeks for make in made if (table := make(content, week)).rows]


def _table_5(content: Content, week: str) -> Table[Row]:
    spread = "mean ± standard deviation of single runs" if content.members > 1 else "one run"
    title = f"{week}: {content.members_told(week)}, {spread}; heat and cycles per week"
    cycles: Column[Row] = Column("cycles", attrgetter("cycles_per_week.mean"), ".1f")
    return _comparison_table(content, week, title, FIGURES, [*VERDICTS, cycles])


def _corrected_table(content: Content, week: str) -> Table[Row]:
    title = f"{week}: heat per week, corrected by what the room holds more or less at its end"
    return _comparison_table(content, week, title, CORRECTED_FIGURES, CORRECTED_VERDICTS)


def _spread_table(content: Content, week: str) -> Table[Spread]:
    return Table(
        f"{week}: what single runs differ by, as shares of their variance; the rest is of start and weather together",
        [
            text("case"),
            text("figure"),
            Column("sd", lambda of: f"{of.split.sd:.3g} {of.unit}", heading="standard deviation"),
            *(Column(name, partial(_share, name)) for name in OF_SPREAD),
        ],
        [spread for spread in content.spreads if spread.week == week],
    )


def _share(name: str, of: Spread) -> str:
    return percent(of.split.share(name))


def _comparison_table(
    content: Content, week: str, title: str, figures: Sequence[Column[Row]], verdicts: Sequence[Column[Row]]
) -> Table[Row]:
    against = _beside(content, week)
    columns: list[Column[Row]] = [text("case")]
    for figure in figures:
        columns += [figure, against.beside(figure)] if against else [figure]
    return Table(title, [*columns, *verdicts], [row for row in content.rows if row.week == week])


def _verdicts(of: str) -> list[Column[Row]]:
    """Whether the mean decides a difference, and the share of single runs that could have shown it."""
    resolved, share = attrgetter(f"{of}resolved"), attrgetter(f"{of}single_run_share")
    return [
        text(f"{of}resolved", lambda row: yes_or_no(resolved(row)), "verdict", MEAN_DECIDES),
        Column(f"{of}single_run_share", lambda row: percent(share(row)), heading=SINGLE_RUN),
    ]


VERDICTS, CORRECTED_VERDICTS = _verdicts(""), _verdicts("corrected_")


def _beside(content: Content, week: str) -> Against | None:
    """The other side, if it has any figure of this week."""
    against = content.against
    return against if against and any(cell.week == week for cell in against.cells) else None


def season_tables(content: Content) -> list[Table[Any]]:
    """Of each record of several months, heat and differences by month; of one with a season, comfort in it."""
    made = (_months_table, _month_differences_table, _comfort_table)
    return [table for week in content.run.weeks for make in made if (table := make(content, week)).rows]


def _months_table(content: Content, week: str) -> Table[Months]:
    rows = [row for row in content.months if row.week == week]
    columns = [Column(name, partial(_heat, name), ".2f") for name in _names(rows)]
    whole: Column[Months] = Column("all", attrgetter("total_kWh_m2"), ".2f")
    return Table(f"{week}: heat by month, kWh/m², members' mean", [text("case"), *columns, whole], rows)


def _month_differences_table(content: Content, week: str) -> Table[Months]:
    rows = [row for row in content.months if row.week == week and row.difference_percent]
    columns = [Column(name, partial(_difference, name), "+.1f") for name in _names(rows)]
    whole: Column[Months] = Column(
        "all", lambda row: with_spread(row.whole_percent, row.interval_percent, ".1f"), kind="figure"
    )
    title = f"{week}: heat against the reference by month, %; of all ± half the 95 % interval over the months"
    return Table(title, [text("case"), *columns, whole], rows)


def _heat(month: str, row: Months) -> float:
    return row.heat_kWh_m2[month]


def _difference(month: str, row: Months) -> float:
    return row.difference_percent[month]


def _in_category(category: str, row: Comfort) -> str:
    return f"{100.0 * row.in_category[category]:.1f} %"


def _names(rows: Sequence[Months]) -> list[str]:
    return list(rows[0].heat_kWh_m2) if rows else []


def _comfort_table(content: Content, week: str) -> Table[Comfort]:
    rows = [row for row in content.comfort if row.week == week]
    days = f"{rows[0].days:.0f} heating days" if rows else ""
    return Table(
        f"{week}: comfort on {days}; shares of the time within the categories of EN 16798-1, homes",
        [
            text("case"),
            Column("hours_below_per_week", form=".1f", heading="below", unit="h a week"),
            Column("over_setpoint_1K_share", lambda row: percent(row.over_setpoint_1K_share), heading="over 1 K warm"),
            *(
                Column(
                    name,
                    partial(_in_category, name),
                    heading=f"{name} ({low:g} to {high:g} °C)",
                )
                for name, (low, high) in CATEGORIES_C.items()
            ),
        ],
        rows,
    )


def activation_tables(content: Content) -> list[Table[Any]]:
    """How fast valves answer on their own, and in the study."""
    return [_activation_table(content), _starts_table(content)]


def _activation_table(content: Content) -> Table[Activation]:
    def times(minutes: float, of: Activation) -> str:
        place = list(of.off_min).index(minutes)
        return f"{_seconds(of.opening_s[place])} / {_seconds(of.flow_s[place])}"

    return Table(
        "seconds to full opening / to 90 % of full flow, by time off before; * in this study",
        [
            text("actuator", lambda a: f"{a.actuator} *" if a.in_study else a.actuator),
            *(Column(f"{minutes:g} min", partial(times, minutes)) for minutes in PICKED_MIN),
        ],
        content.activations,
    )


def _seconds(value: float) -> str:
    return "never" if math.isnan(value) else f"{value:.0f}"


def _starts_table(content: Content) -> Table[Starts]:
    return Table(
        "starts from a closed valve that reach full opening, and those of them that take over 300 s",
        [
            text("case"),
            Column("starts"),
            Column("over_300_s", heading="over 300 s"),
            Column("share", lambda starts: f"{100.0 * starts.share:.0f} %"),
        ],
        content.starts,
    )


# --- the formats -------------------------------------------------------------------------------------


def as_csv(content: Content) -> str:
    """Columns of Table 5, each with its spread, then cycles, how sure the difference is, and the same corrected."""
    columns: list[Column[Row]] = [Column("case"), Column("week"), *_with_spreads(FIGURES)]
    columns += [Column("cycles_per_week", attrgetter("cycles_per_week.mean"), ".4g"), *_csv_verdicts("")]
    columns += [*_with_spreads(CORRECTED_FIGURES), *_csv_verdicts("corrected_")]
    columns += _month_columns(content)
    columns += content.against.csv_columns() if content.against else []
    return csv_text(Table("", columns, content.rows))


def _month_columns(content: Content) -> list[Column[Row]]:
    """The members' mean heat of each month, where a record has several."""
    heat = {(row.case, row.week): row.heat_kWh_m2 for row in content.months}
    names = sorted({name for months in heat.values() for name in months})

    def of(name: str) -> Column[Row]:
        return Column(HEAT_OF_MONTH.format(month=name), lambda row: heat.get((row.case, row.week), {}).get(name), ".5f")

    return [of(name) for name in names]


def _with_spreads(figures: Sequence[Column[Row]]) -> list[Column[Row]]:
    parts = ("", "mean"), ("_sd", "sd")
    return [Column(f"{f.key}{end}", attrgetter(f"{f.key}.{part}"), ".5f") for f in figures for end, part in parts]


def _csv_verdicts(of: str) -> list[Column[Row]]:
    resolved = attrgetter(f"{of}resolved")
    return [Column(f"{of}resolved", lambda row: yes_or_no(resolved(row))), Column(f"{of}single_run_share", form=".4g")]


def _described(spread: Spread) -> dict[str, Any]:
    shares = {f"{name}_share": spread.split.share(name) for name in OF_SPREAD}
    return {key: value for key, value in asdict(spread).items() if key != "split"} | {"sd": spread.split.sd, **shares}


def as_json(content: Content) -> str:
    """The whole report."""
    data = {
        "run": str(content.run.folder),
        "study": content.run.study,
        "members": content.members,
        "rows": [asdict(row) for row in content.rows],
        "starts": [{**asdict(s), "share": s.share} for s in content.starts],
        "spread": [_described(spread) for spread in content.spreads],
        "months": [{**asdict(row), "total_kWh_m2": row.total_kWh_m2} for row in content.months],
        "comfort": [asdict(row) for row in content.comfort],
        "activation": [
            {
                "actuator": a.actuator,
                "in_study": a.in_study,
                "off_min": a.off_min.tolist(),
                "full_opening_s": a.opening_s.tolist(),
                "flow_90_percent_s": a.flow_s.tolist(),
            }
            for a in content.activations
        ],
        "notes": all_notes(content),
    }
    if content.against:
        data["against"] = content.against.described()
    return json_text(data)


def as_markdown(content: Content) -> str:
    return markdown(content.run.study, tables(content), all_notes(content))


def as_terminal(content: Content, width: int, colour: bool) -> str:
    return terminal(tables(content), all_notes(content), width, colour)


def all_notes(content: Content) -> list[str]:
    """Which cases are one run, then the other notes."""
    return [*told_same(content.run), *other_notes(content)]


def other_notes(content: Content) -> list[str]:
    """The notes of a report, then why the other side's figures are missing."""
    return [*content.notes, *(content.against.notes if content.against else ())]
