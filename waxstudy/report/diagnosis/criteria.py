"""The criteria as people read them: what each limit decides, why, and where it comes from."""

from __future__ import annotations

from waxstudy.diagnosis.criteria import CRITERIA, Criterion
from waxstudy.report.formats import terminal
from waxstudy.report.table import Column, Table, text


def table() -> Table[Criterion]:
    columns: tuple[Column[Criterion], ...] = (
        text("name", lambda each: each.name),
        text("limit", lambda each: f"{each.limit:g}"),
        text("decides", lambda each: each.decides, "prose"),
        text("because", lambda each: each.reason, "prose"),
        text("from", lambda each: each.source, "prose"),
        text("without it", lambda each: each.ablation, "prose"),
    )
    return Table("criteria", columns, CRITERIA)


def as_terminal(width: int) -> str:
    return terminal([table()], [], width, colour=False)
