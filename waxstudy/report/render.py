"""The report as CSV, Markdown, JSON, or a table for the terminal."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from waxstudy.report.comparison import COLUMNS, Estimate, Row
from waxstudy.report.content import Content

HEADINGS = {
    "setpoint_shift_K": ("shift", "K", 2),
    "mae_K": ("MAE", "K", 3),
    "heat_kWh_m2_week": ("heat", "kWh/m²", 2),
    "heat_vs_most_detailed_percent": ("difference", "%", 2),
}


WIDEST = 1000  # columns that no comparison needs


def resolved_word(row: Row) -> str:
    """Empty for the reference itself."""
    return {None: "", True: "yes", False: "no"}[row.resolved]


def as_csv(content: Content) -> str:
    """Columns of Table 5, each with its spread, then cycles and whether the difference is resolved."""
    names = [name for column in COLUMNS for name in (column, f"{column}_sd")]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    extra = ["published", "published_difference"] if content.against else []
    header = ["case", "week", *names, "cycles_per_week", "resolved"]
    writer.writerow(header + [f"{column}_{what}" for column in (COLUMNS if extra else ()) for what in extra])
    for row in content.rows:
        figures = [value for column in COLUMNS for value in _mean_and_sd(getattr(row, column))]
        published = _published_columns(content, row) if extra else []
        writer.writerow(
            [row.case, row.week, *figures, f"{row.cycles_per_week.mean:.4g}", resolved_word(row), *published]
        )
    return out.getvalue()


def _mean_and_sd(value: Estimate) -> tuple[str, str]:
    return _decimals(value.mean), _decimals(value.sd)


def _decimals(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.5f}"


def _published_columns(content: Content, row: Row) -> list[str]:
    found = _published(content, row)
    pairs = [(found[c].published, found[c].difference) if c in found else (math.nan, math.nan) for c in COLUMNS]
    return ["" if math.isnan(value) else f"{value:.5g}" for pair in pairs for value in pair]


def _published(content: Content, row: Row) -> dict[str, Any]:
    cells = content.against.cells if content.against else ()
    return {cell.column: cell for cell in cells if (cell.case, cell.week) == (row.case, row.week)}


def as_json(content: Content) -> str:
    """The whole report; NaN as null."""
    against = content.against
    data = {
        "run": str(content.run.folder),
        "study": content.run.study,
        "members": content.members,
        "rows": [asdict(row) for row in content.rows],
        "starts": [{**asdict(s), "share": s.share} for s in content.starts],
        "activation": [
            {
                "actuator": a.actuator,
                "off_min": a.off_min.tolist(),
                "full_opening_s": a.opening_s.tolist(),
                "flow_90_percent_s": a.flow_s.tolist(),
            }
            for a in content.activations
        ],
        "notes": all_notes(content),
    }
    if against:
        data["against"] = {
            "name": against.name,
            "cells": [
                asdict(c) | {"difference": c.difference, "within_single_run_range": c.within_single_run_range}
                for c in against.cells
            ],
            "scores": [asdict(score) for score in against.scores],
            "findings": [asdict(finding) for finding in against.findings],
        }
    return json.dumps(_finite(data), indent=1) + "\n"


def all_notes(content: Content) -> list[str]:
    """The notes of a report, with the reason where findings are missing."""
    lacking = content.against.lacking if content.against else ""
    return [*content.notes, *([lacking] if lacking else [])]


def _finite(value: Any) -> Any:
    """JSON has no NaN."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


# --- tables: headings and rows of text, for the terminal, Markdown and HTML alike --------------------


Table = tuple[str, list[str], list[list[str]]]  # title, headings, rows


def tables(content: Content) -> list[Table]:
    """Every table of the report as text."""
    found = [_comparison_table(content, week) for week in content.run.weeks]
    if content.against:
        found += [_score_table(content), _findings_table(content)]
    return [*found, *_activation_tables(content)]


def _filled(content: Content) -> list[Table]:
    return [table for table in tables(content) if table[2]]


def _comparison_table(content: Content, week: str) -> Table:
    columns = [f"{name} {unit}" for name, unit, _ in HEADINGS.values()]
    if content.against:
        columns = [text for column in columns for text in (column, content.against.name)]
    headings = ["case", *columns, "resolved", "cycles"]
    rows = [_comparison_row(content, row) for row in content.rows if row.week == week]
    spread = "mean ± standard deviation of single runs" if content.members > 1 else "one run"
    return f"{week}: {content.members} members, {spread}", headings, rows


def _comparison_row(content: Content, row: Row) -> list[str]:
    published = _published(content, row)
    texts = [row.case]
    for column, (_, _, digits) in HEADINGS.items():
        is_own = column == "heat_vs_most_detailed_percent" and row.resolved is None
        texts.append("0" if is_own else _figure(getattr(row, column), digits))
        if content.against:
            texts.append(f"{published[column].published:.{digits}f}" if column in published else "")
    return [*texts, resolved_word(row), f"{row.cycles_per_week.mean:.1f}"]


def _figure(value: Estimate, digits: int) -> str:
    if math.isnan(value.mean):
        return ""
    text = f"{value.mean:z.{digits}f}"  # z: no minus before a zero
    return text if math.isnan(value.sd) else f"{text} ± {value.sd:.{digits}f}"


def _score_table(content: Content) -> Table:
    assert content.against
    headings = ["column", "week", "RMSE", "RMSE of median", "mean error", "correlation", "in range", "range width"]
    rows = [
        [
            f"{HEADINGS[s.column][0]} {HEADINGS[s.column][1]}",
            s.week,
            f"{s.rmse:.3f}",
            f"{s.null_rmse:.3f}",
            f"{s.mean_error:+.3f}",
            f"{s.correlation:.2f}",
            f"{s.within_range} of {s.n}",
            f"{s.mean_range_width:.3f}",
        ]
        for s in content.against.scores
    ]
    title = (
        f"against {content.against.name}: agreement by column; `RMSE of median` is a model that predicts each "
        "column's median, `in range` the published cells within the 95 % range of our single runs"
    )
    return title, headings, rows


def _findings_table(content: Content) -> Table:
    assert content.against
    found = content.against.findings
    counts = ", ".join(
        f"{sum(f.verdict == verdict for f in found)} {verdict}" for verdict in ("held", "not held", "not resolved")
    )
    rows = [[f.id, f.statement, f.verdict, f.figure] for f in found]
    return f"findings: {counts}", ["id", "finding", "verdict", "our figure"], rows


def _activation_tables(content: Content) -> list[Table]:
    picked = (1.0, 5.0, 15.0, 30.0, 45.0, 120.0)
    headings = ["actuator", *(f"{minutes:g} min" for minutes in picked)]
    rows = []
    for a in content.activations:
        index = [int(i) for minutes in picked for i in range(len(a.off_min)) if a.off_min[i] == minutes]
        rows.append([a.actuator, *(f"{_seconds(a.opening_s[i])} / {_seconds(a.flow_s[i])}" for i in index)])
    title = "seconds to full opening / to 90 % of full flow, by time off before"
    shares = [[s.case, str(s.starts), str(s.over_300_s), f"{100 * s.share:.0f} %"] for s in content.starts]
    second = "starts from a closed valve that reach full opening, and those of them that take over 300 s"
    return [(title, headings, rows), (second, ["case", "starts", "over 300 s", "share"], shares)]


def _seconds(value: float) -> str:
    return "never" if math.isnan(value) else f"{value:.0f}"


def as_markdown(content: Content) -> str:
    """Pipe tables, then the notes."""
    parts = [f"# {content.run.study}\n"]
    for title, headings, rows in _filled(content):
        lines = [_pipes(headings), _pipes(["---"] * len(headings)), *map(_pipes, rows)]
        parts.append(f"## {title[0].upper()}{title[1:]}\n\n" + "\n".join(lines) + "\n")
    if notes := all_notes(content):
        parts.append("## Notes\n\n" + "\n".join(f"- {note}" for note in notes) + "\n")
    return "\n".join(parts)


def _pipes(texts: Sequence[str]) -> str:
    return "| " + " | ".join(text.replace("|", "\\|") for text in texts) + " |"


def as_terminal(content: Content, width: int, colour: bool) -> str:
    """Tables and notes for a terminal of a given width; one too narrow for the figures wraps lines, but hides none."""
    from rich import box
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table as RichTable

    out = io.StringIO()
    console = Console(file=out, width=WIDEST, force_terminal=colour, highlight=False)
    for title, headings, rows in _filled(content):
        console.print(title, style="bold", width=width)
        grid = RichTable(box=box.SIMPLE_HEAD, pad_edge=False)
        for i, heading in enumerate(headings):
            is_text = i == 0 or heading in ("finding", "verdict", "our figure", "week", "resolved")
            published = content.against is not None and heading == content.against.name
            grid.add_column(
                heading,
                justify="left" if is_text else "right",
                style="dim" if published else None,
                no_wrap=heading not in ("finding", "our figure"),
            )
        for row in rows:
            grid.add_row(*row)
        natural = Measurement.get(console, console.options, grid).maximum
        can_wrap = any(not column.no_wrap for column in grid.columns)
        console.print(grid, width=width if can_wrap else max(width, natural), crop=False)
    for note in all_notes(content):
        console.print(f"note: {note}", width=width)
    return out.getvalue()
