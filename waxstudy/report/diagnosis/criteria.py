"""Criteria and weights as people read them: what is asked, the number, why, and where it comes from."""

from __future__ import annotations

from waxstudy.diagnosis.criteria import Criterion, Limit, criteria, limits
from waxstudy.diagnosis.weights import Weight, weights
from waxstudy.report.formats import terminal
from waxstudy.report.table import Column, Table, text


def table_of_limits() -> Table[Limit]:
    columns: tuple[Column[Limit], ...] = (
        text("limit", lambda each: each.name),
        text("value", lambda each: f"{each.value:g} {each.unit}".rstrip()),
        text("what it is", lambda each: each.what, "prose"),
        text("because", lambda each: each.reason, "prose"),
        text("from", lambda each: f"{each.source} (set on judged records)" if each.is_tuned else each.source, "prose"),
    )
    return Table("limits", columns, list(limits().values()))


def table() -> Table[Criterion]:
    columns: tuple[Column[Criterion], ...] = (
        text("asked", lambda each: "; ".join(each.questions), "prose"),
        text("number", lambda each: f"{each.statistic} {each.operator} {each.limit.name}"),
        text("of", lambda each: each.where.words, "prose"),
        text("because", lambda each: each.reason, "prose"),
    )
    return Table("criteria", columns, criteria())


def table_of_weights() -> Table[Weight]:
    columns: tuple[Column[Weight], ...] = (
        text("weight", lambda each: each.name),
        text("value", lambda each: f"{each.value:g}"),
        text("what it is", lambda each: each.what, "prose"),
        text("because", lambda each: each.reason, "prose"),
        text("from", lambda each: each.source, "prose"),
    )
    return Table("weights", columns, weights())


def as_terminal(width: int) -> str:
    return terminal([table_of_limits(), table(), table_of_weights()], [], width, colour=False)
