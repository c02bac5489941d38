"""The report as CSV, Markdown, JSON, or a table for the terminal."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from waxstudy.report.against import Against
from waxstudy.report.comparison import COLUMNS, Estimate, Row
from waxstudy.report.content import Content
from waxstudy.report.words import HEADINGS, Table, counted, decimals, with_spread

WIDEST = 1000  # columns that no comparison needs
FIGURES = 3  # of a finding, in the terminal
TEXT_HEADINGS = (
    *("finding", "verdict", "our figure", "week", "resolved"),
    *("coefficient", "95 % interval", "model", "meaning", "left out"),
)


def resolved_word(row: Row) -> str:
    """Empty for the reference itself."""
    return {None: "", True: "yes", False: "no"}[row.resolved]


def as_csv(content: Content) -> str:
    """Columns of Table 5, each with its spread, then cycles and whether the difference is resolved."""
    names = [name for column in COLUMNS for name in (column, f"{column}_sd")]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    against = content.against
    extra = [f"{column}_{what}" for column in COLUMNS for what in against.csv_suffixes] if against else []
    writer.writerow(["case", "week", *names, "cycles_per_week", "resolved", *extra])
    for row in content.rows:
        figures = [value for column in COLUMNS for value in _mean_and_sd(getattr(row, column))]
        other = _other_columns(against, row) if against else []
        writer.writerow([row.case, row.week, *figures, f"{row.cycles_per_week.mean:.4g}", resolved_word(row), *other])
    return out.getvalue()


def _mean_and_sd(value: Estimate) -> tuple[str, str]:
    return decimals(value.mean), decimals(value.sd)


def _other_columns(against: Against, row: Row) -> list[str]:
    found = against.of(row)
    return [text for c in COLUMNS for text in (against.csv_figures(found[c]) if c in found else ("", ""))]


def as_json(content: Content) -> str:
    """The whole report."""
    data = {
        "run": str(content.run.folder),
        "study": content.run.study,
        "members": content.members,
        "rows": [asdict(row) for row in content.rows],
        "starts": [{**asdict(s), "share": s.share} for s in content.starts],
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


def json_text(data: dict[str, Any]) -> str:
    """Return data as JSON, NaN as null."""
    return json.dumps(_finite(data), indent=1) + "\n"


def all_notes(content: Content) -> list[str]:
    """The notes of a report, then why the other side's figures are missing."""
    return [*content.notes, *(content.against.notes if content.against else ())]


def _finite(value: Any) -> Any:
    """JSON has no NaN."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


# --- tables: headings and rows of text, for the terminal, Markdown and HTML alike --------------------


def tables(content: Content) -> list[Table]:
    """Every table of the report as text."""
    found = [_comparison_table(content, week) for week in content.run.weeks]
    if content.against:
        found += content.against.tables()
    return [*found, *_activation_tables(content)]


def _filled(content: Content) -> list[Table]:
    return [table for table in tables(content) if table[2]]


def _comparison_table(content: Content, week: str) -> Table:
    columns = [f"{name} {unit}" for name, unit, _ in HEADINGS.values()]
    against = _beside(content, week)
    if against:
        columns = [text for column in columns for text in (column, against.name)]
    headings = ["case", *columns, "resolved", "cycles"]
    rows = [_comparison_row(row, against) for row in content.rows if row.week == week]
    spread = "mean ± standard deviation of single runs" if content.members > 1 else "one run"
    title = f"{week}: {counted(content.members, 'member')}, {spread}; heat and cycles per week"
    return title, headings, rows


def _beside(content: Content, week: str) -> Against | None:
    """The other side, if it has any figure of this week."""
    against = content.against
    return against if against and any(cell.week == week for cell in against.cells) else None


def _comparison_row(row: Row, against: Against | None) -> list[str]:
    other = against.of(row) if against else {}
    texts = [row.case]
    for column, (_, _, digits) in HEADINGS.items():
        is_own = column == "heat_vs_most_detailed_percent" and row.resolved is None
        texts.append("0" if is_own else _figure(getattr(row, column), digits))
        if against:
            texts.append(_figure(other[column].theirs, digits) if column in other else "")
    return [*texts, resolved_word(row), f"{row.cycles_per_week.mean:.1f}"]


def _figure(value: Estimate, digits: int) -> str:
    return with_spread(value.mean, value.sd, digits)


def _activation_tables(content: Content) -> list[Table]:
    picked = (1.0, 5.0, 15.0, 30.0, 45.0, 120.0)
    headings = ["actuator", *(f"{minutes:g} min" for minutes in picked)]
    rows = []
    for a in content.activations:
        index = [int(i) for minutes in picked for i in range(len(a.off_min)) if a.off_min[i] == minutes]
        name = f"{a.actuator} *" if a.in_study else a.actuator
        rows.append([name, *(f"{_seconds(a.opening_s[i])} / {_seconds(a.flow_s[i])}" for i in index)])
    title = "seconds to full opening / to 90 % of full flow, by time off before; * in this study"
    shares = [[s.case, str(s.starts), str(s.over_300_s), f"{100 * s.share:.0f} %"] for s in content.starts]
    second = "starts from a closed valve that reach full opening, and those of them that take over 300 s"
    return [(title, headings, rows), (second, ["case", "starts", "over 300 s", "share"], shares)]


def _seconds(value: float) -> str:
    return "never" if math.isnan(value) else f"{value:.0f}"


def as_markdown(content: Content) -> str:
    return markdown(content.run.study, _filled(content), all_notes(content))


def markdown(title: str, tables: Sequence[Table], notes: Sequence[str]) -> str:
    """Pipe tables, then the notes."""
    parts = [f"# {title}\n"]
    for heading, headings, rows in tables:
        lines = [_pipes(headings), _pipes(["---"] * len(headings)), *map(_pipes, rows)]
        parts.append(f"## {heading[0].upper()}{heading[1:]}\n\n" + "\n".join(lines) + "\n")
    if notes:
        parts.append("## Notes\n\n" + "\n".join(f"- {note}" for note in notes) + "\n")
    return "\n".join(parts)


def _pipes(texts: Sequence[str]) -> str:
    return "| " + " | ".join(text.replace("|", "\\|") for text in texts) + " |"


def as_terminal(content: Content, width: int, colour: bool) -> str:
    published = content.against.name if content.against else None
    return terminal([_shortened(table) for table in _filled(content)], all_notes(content), width, colour, published)


def _shortened(table: Table) -> Table:
    """A finding may rest on dozens of figures: the terminal shows the first of them, every other format all."""
    title, headings, rows = table
    return (
        title,
        headings,
        [[_first(t) if h == "our figure" else t for h, t in zip(headings, row, strict=True)] for row in rows],
    )


def _first(text: str) -> str:
    """
    >>> _first("1 K; 2 K; 3 K"), _first("1 K; 2 K; 3 K; 4 K; 5 K")
    ('1 K; 2 K; 3 K', '1 K; 2 K; 3 K; 2 more in --format html')
    """
    figures = text.split("; ")
    more = len(figures) - FIGURES
    return text if more <= 0 else "; ".join([*figures[:FIGURES], f"{more} more in --format html"])


def terminal(
    tables: Sequence[Table], notes: Sequence[str], width: int, colour: bool, published: str | None = None
) -> str:
    """Tables and notes for a terminal of a given width; one too narrow for the figures wraps lines, but hides none.

    Columns whose heading is `published` are dim.
    """
    from rich import box
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table as RichTable

    out = io.StringIO()
    console = Console(file=out, width=WIDEST, force_terminal=colour, highlight=False, markup=False, emoji=False)
    for title, headings, rows in tables:
        console.print(title, style="bold", width=width)
        grid = RichTable(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
        for i, heading in enumerate(headings):
            grid.add_column(
                heading,
                justify="left" if i == 0 or heading in TEXT_HEADINGS else "right",
                style="dim" if heading == published else None,
                no_wrap=heading not in ("finding", "our figure", "left out"),
            )
        for row in rows:
            grid.add_row(*row)
        natural = Measurement.get(console, console.options, grid).maximum
        can_wrap = any(not column.no_wrap for column in grid.columns)
        console.print(grid, width=width if can_wrap else max(width, natural), crop=False)
    for note in notes:
        console.print(f"note: {note}", width=width)
    return out.getvalue()
