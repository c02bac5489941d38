"""The tables of a score, and what of it a terminal shows: the goals, on one screen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from waxstudy.report.formats import terminal
from waxstudy.report.table import Column, Table, text

Score = Mapping[str, Any]
FIRST = "ours"
WHERE = ("fast room", "other physics", "as built, with a baseline")
OF_PARTS = {  # figures of parts of the records, and their headings
    "detection": "detected",
    "right_group": "right\ngroup",
    "stage": "right\nstage",
    "false_alarm": "false\nalarm",
    "misdiagnosis": "mis-\ndiagnosis",
    "unknown_found": "unknown\nfound",
    "unknown_claimed": "unknown\nfalsely",
    "both": "both\nof two",
}


def as_terminal(score: Score, width: int, colour: bool) -> str:
    """Return the goals with everybody's figures, and what does not fit into a figure."""
    who = "".join(f"{_answers(name, score['diagnosers'][name])}\n" for name in ordered(score))
    shown = [*answered_goals(score), *posterior_tables(score)]
    return f"{_head(score)}\n\n{terminal(shown, [], width, colour)}{who}"


def answered_goals(score: Score) -> list[Table[Mapping[str, Any]]]:
    """Return the goals of which at least one diagnoser has a figure, by room."""
    goals = [goal_table(score, where) for where in WHERE]
    answered = [replace(table, rows=[row for row in table.rows if _is_answered(row)]) for table in goals]
    return [table for table in answered if table.rows]


def _is_answered(row: Mapping[str, Any]) -> bool:
    return any(goal["value"] is not None for goal in row.values())


def _head(score: Score) -> str:
    kinds = ", ".join(f"{count} {kind}" for kind, count in score["kinds"].items())
    seals = f"{len(score['broken_seals'])} seals are broken" if score["broken_seals"] else "all seals whole"
    return f"{score['records']} records ({kinds}); {seals}"


def _answers(name: str, each: Mapping[str, Any]) -> str:
    failed = f", {len(each['failed'])} by a failure of the diagnoser" if each["failed"] else ""
    wrong = f", {len(each['failures'])} not as they should be"
    return f"{name}: {each['answered']} of {each['records']} records answered{failed}{wrong}"


def ordered(score: Score) -> list[str]:
    """Return who answered, ours first."""
    return sorted(score["diagnosers"], key=lambda name: (name != FIRST, name))


def number(value: float | None, digits: int = 2) -> str:
    return "-" if value is None else f"{value:.{digits}f}"


def interval(figure: Mapping[str, Any]) -> str:
    """
    >>> interval({"value": 0.9, "low": 0.8, "high": 0.95, "of": 40})
    '0.90 (0.80 to 0.95; 40)'
    """
    if figure["value"] is None:
        return "-"
    return f"{number(figure['value'])} ({number(figure['low'])} to {number(figure['high'])}; {figure['of']})"


def goal_table(score: Score, where: str) -> Table[Mapping[str, Any]]:
    """Return the goals of a room; a row has everybody's figure by name."""
    goals = {
        name: {goal["name"]: goal for goal in score["diagnosers"][name]["goals"] if goal["where"] == where}
        for name in ordered(score)
    }
    first, *others = goals
    columns: list[Column[Mapping[str, Any]]] = [
        text("figure", lambda row: row[first]["name"], "prose"),
        text("goal", lambda row: _wanted(row[first])),
        Column(first, lambda row: interval(row[first])),
        text("", lambda row: {True: "met", False: "not met", None: ""}[row[first]["met"]]),
        *map(_value, others),
    ]
    return Table(where, columns, [{name: goals[name][goal] for name in goals} for goal in goals[first]])


def _wanted(goal: Mapping[str, Any]) -> str:
    if goal["name"].startswith("coverage") and goal["where"] == "fast room":
        return "interval holds 0.95"
    if goal["wanted"] is None:
        return "report"
    return f"{'at most' if goal['at_most'] else 'at least'} {goal['wanted']:.2f}"


def _value(name: str) -> Column[Mapping[str, Any]]:
    return Column(name, lambda row: number(row[name]["value"]))


def posterior_tables(score: Score) -> list[Table[Mapping[str, Any]]]:
    """Return what the probabilities that anybody stated are worth, a table for each who and where."""
    every = [(name, score["diagnosers"][name].get("posterior", {})) for name in ordered(score)]
    return [
        _posterior_table(f"{name}, {where}", said[where]) for name, said in every for where in WHERE if where in said
    ]


def _posterior_table(title: str, said: Mapping[str, Any]) -> Table[Mapping[str, Any]]:
    rows = [{**each, "first": first} for each, first in zip(said["every"], said["first"], strict=True)]
    columns: list[Column[Mapping[str, Any]]] = [
        text("probability stated", lambda row: f"{row['from']:.1f} to {row['to']:.1f}"),
        Column("mean", lambda row: number(row["stated"])),
        Column("share true", lambda row: interval(row["true"])),
        Column("the likeliest: share true", lambda row: interval(row["first"]["true"])),
    ]
    return Table(f"{title}: probabilities of {said['answers']} answers", columns, rows)


def split_table(title: str, split: Mapping[str, Mapping[str, Any]]) -> Table[tuple[str, Mapping[str, Any]]]:
    """Return the figures of parts of the records, in two lines each so that all columns fit a page."""
    part: Column[tuple[str, Mapping[str, Any]]] = text(title, lambda row: f"{row[0]}\n{row[1]['records']} records")
    return Table(title, [part, *map(_of_part, OF_PARTS)], list(split.items()))


def _of_part(figure: str) -> Column[tuple[str, Mapping[str, Any]]]:
    return Column(figure, lambda row: _in_two_lines(row[1][figure]), heading=OF_PARTS[figure])


def _in_two_lines(figure: Mapping[str, Any]) -> str:
    if figure["value"] is None:
        return ""
    return f"{number(figure['value'])} of {figure['of']}\n{number(figure['low'])} to {number(figure['high'])}"


def failure_table(title: str, failures: Sequence[Mapping[str, Any]]) -> Table[Mapping[str, Any]]:
    """Return what was not answered as it should be; a cell may have several lines."""
    columns: list[Column[Mapping[str, Any]]] = [
        text("record", lambda each: f"{each['record']}\n{each['engine']}"),
        text("truth", _truth),
        Column("gap over\nfloor", lambda each: number(each["over"], 1)),
        Column("beyond\nthe room", lambda each: number(each["beyond"], 1)),
        text("channels", _measured),
        text("said", lambda each: "\n".join((each["said"], *(f"open: {stage}" for stage in each["open"])))),
        text("alike", lambda each: ", ".join(each["alike"])),
    ]
    return Table(title, columns, failures)


def _truth(failure: Mapping[str, Any]) -> str:
    if not failure["values"]:
        return "nothing"
    return "; ".join(
        f"{name} ({', '.join(f'{key} {value:.4g}' for key, value in values.items())})"
        for name, values in failure["values"].items()
    )


def _measured(failure: Mapping[str, Any]) -> str:
    interval_s, noise = failure["interval_s"], failure["noise_factor"]
    return f"{failure['channels']}, {interval_s:g} s, {failure['days']} d, noise x {noise:g}"


def parameter_table(parameters: Mapping[str, Any]) -> Table[tuple[str, Mapping[str, Any]]]:
    return Table(
        "parameters of effects that were found",
        [
            text("parameter", lambda row: row[0]),
            Column("relative error, median", lambda row: interval(row[1]["error"])),
            Column("in its 95 % interval", lambda row: interval(row[1]["coverage"])),
        ],
        list(parameters.items()),
    )
