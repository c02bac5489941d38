"""The score on a terminal: the table of the goals, on one screen."""

from __future__ import annotations

from waxstudy.report.blind_test.words import Score, goal_table, ordered

WIDEST = 44  # letters of a goal's name


def as_terminal(score: Score) -> str:
    """Return the goals with everybody's figures, and what does not fit into a figure."""
    lines = [_head(score)]
    for where in ("fast room", "other physics"):
        title, headings, rows = goal_table(score, where)
        kept = [row for row in rows if row[2] != "-" or any(cell != "-" for cell in row[4:])]
        if kept:
            lines += ["", *_laid_out([[title, *headings[1:]], *kept])]
    for name in ordered(score):
        each = score["diagnosers"][name]
        said = f"{name}: {each['answered']} of {each['records']} records answered"
        failed = f", {len(each['failed'])} by a failure of the diagnoser" if each["failed"] else ""
        wrong = f", {len(each['failures'])} not as they should be"
        lines.append(f"{said}{failed}{wrong}" if name != ordered(score)[0] else f"\n{said}{failed}{wrong}")
    return "\n".join(lines) + "\n"


def _head(score: Score) -> str:
    kinds = ", ".join(f"{count} {kind}" for kind, count in score["kinds"].items())
    seals = f"{len(score['broken_seals'])} seals are broken" if score["broken_seals"] else "all seals whole"
    return f"{score['records']} records ({kinds}); {seals}"


def _laid_out(rows: list[list[str]]) -> list[str]:
    rows = [[row[0][:WIDEST], *row[1:]] for row in rows]
    widths = [max(len(row[place]) for row in rows) for place in range(len(rows[0]))]
    return ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
