"""How a score is written: figures with their intervals, and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from waxstudy.report.words import Table

Score = Mapping[str, Any]
FIRST = "ours"
SHOWN = ("detection", "right_group", "stage", "false_alarm", "misdiagnosis", "unknown_found", "unknown_claimed", "both")
HEADINGS = {
    "detection": "detected",
    "right_group": "right\ngroup",
    "stage": "right\nstage",
    "false_alarm": "false\nalarm",
    "misdiagnosis": "mis-\ndiagnosis",
    "unknown_found": "unknown\nfound",
    "unknown_claimed": "unknown\nfalsely",
    "both": "both\nof two",
}


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


def _in_two_lines(figure: Mapping[str, Any]) -> str:
    if figure["value"] is None:
        return ""
    return f"{number(figure['value'])} of {figure['of']}\n{number(figure['low'])} to {number(figure['high'])}"


def wanted(goal: Mapping[str, Any]) -> str:
    if goal["name"].startswith("coverage") and goal["where"] == "fast room":
        return "interval holds 0.95"
    if goal["wanted"] is None:
        return "report"
    return f"{'at most' if goal['at_most'] else 'at least'} {goal['wanted']:.2f}"


def met(goal: Mapping[str, Any]) -> str:
    return {True: "met", False: "not met", None: ""}[goal["met"]]


def goal_table(score: Score, where: str) -> Table:
    """Return the goals of a room with everybody's figures."""
    names = ordered(score)
    first = [goal for goal in score["diagnosers"][names[0]]["goals"] if goal["where"] == where]
    others = {name: _by_name(score["diagnosers"][name]["goals"], where) for name in names}
    rows = []
    for goal in first:
        cells = [interval(others[names[0]][goal["name"]]), met(goal)]
        cells += [number(others[name][goal["name"]]["value"]) for name in names[1:]]
        rows.append([goal["name"], wanted(goal), *cells])
    return where, ["figure", "goal", names[0], "", *names[1:]], rows


def _by_name(goals: Sequence[Mapping[str, Any]], where: str) -> dict[str, Mapping[str, Any]]:
    return {goal["name"]: goal for goal in goals if goal["where"] == where}


def split_table(title: str, split: Mapping[str, Mapping[str, Any]]) -> Table:
    """Return the figures of parts of the records, in two lines each so that all columns fit a page."""
    rows = [
        [f"{name}\n{each['records']} records", *(_in_two_lines(each[figure]) for figure in SHOWN)]
        for name, each in split.items()
    ]
    return title, [title, *(HEADINGS[figure] for figure in SHOWN)], rows


def failure_table(title: str, failures: Sequence[Mapping[str, Any]]) -> Table:
    """Return what was not answered as it should be; a cell may have several lines."""
    headings = ["record", "truth", "gap over\nfloor", "beyond\nthe room", "channels", "said", "alike"]
    rows = [
        [
            f"{each['record']}\n{each['engine']}",
            _truth(each),
            number(each["over"], 1),
            number(each["beyond"], 1),
            _measured(each),
            "\n".join((each["said"], *(f"open: {stage}" for stage in each["open"]))),
            ", ".join(each["alike"]),
        ]
        for each in failures
    ]
    return title, headings, rows


def _truth(failure: Mapping[str, Any]) -> str:
    if not failure["values"]:
        return "nothing"
    return "; ".join(
        f"{name} ({', '.join(f'{key} {value:.4g}' for key, value in values.items())})"
        for name, values in failure["values"].items()
    )


def _measured(failure: Mapping[str, Any]) -> str:
    return (
        f"{failure['channels']}, {failure['interval_s']:g} s, {failure['days']} d, noise x {failure['noise_factor']:g}"
    )


def parameter_table(parameters: Mapping[str, Any]) -> Table:
    rows = [[name, interval(each["error"]), interval(each["coverage"])] for name, each in parameters.items()]
    return (
        "parameters of effects that were found",
        ["parameter", "relative error, median", "in its 95 % interval"],
        rows,
    )
