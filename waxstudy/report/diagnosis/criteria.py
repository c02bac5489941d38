"""The table of criteria as people read it: what is asked, the limit, why, and where it comes from."""

from __future__ import annotations

from textwrap import wrap

from waxstudy.diagnosis.criteria import Criterion, Question, criteria

TUNED = "set on judged records"
HEAD = "| asked | number | limit | of | because | from |\n|---|---|---|---|---|---|\n"


def as_terminal(width: int) -> str:
    """Return the criteria by question, each with its reason and source, in lines of a width."""
    lines = []
    for question in Question:
        lines.append(f"{question}?")
        for each in (one for one in criteria() if question in one.questions):
            of = f" ({each.where.words})" if each.where.words != "everything" else ""
            lines.append(f"  {_compared(each)}{of}")
            told = f"{each.reason}. From: {_source(each)}."
            lines += wrap(told, width, initial_indent="    ", subsequent_indent="    ")
    return "\n".join(lines) + "\n"


def as_markdown() -> str:
    return HEAD + "".join(map(_row, criteria()))


def _row(each: Criterion) -> str:
    asked = "; ".join(each.questions)
    number, limit = f"`{each.statistic}`", f"{each.operator} {each.limit:g}"
    return f"| {asked} | {number} | {limit} | {each.where.words} | {each.reason} | {_source(each)} |\n"


def _compared(each: Criterion) -> str:
    return f"{each.statistic} {each.operator} {each.limit:g}"


def _source(each: Criterion) -> str:
    return f"{each.source} ({TUNED})" if each.is_tuned else each.source
