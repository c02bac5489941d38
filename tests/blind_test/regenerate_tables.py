"""Write the tables of judged runs again from their scores: `python -m tests.blind_test.regenerate_tables`."""

from __future__ import annotations

import gzip
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tests.conftest import ROOT

RUNS = ROOT / "results" / "blind_test"
BUILT = "as built, with a baseline"
WHERE = ("fast room", "other physics", BUILT)
BASELINES = ("refit", "rules", "forward", "random", "ours-without-baselines")
FEW = 10
# name in the summary; name of the goal of the fast room; of other physics and houses as built
SUMMARY = (
    ("right group", "right group", "right group"),
    ("… of those beyond what is unknown of the room", "right group, beyond what is unknown of the room", ""),
    ("… room and emitter", "", "right group, room and emitter"),
    ("… sensor to valve", "", "right group, sensor to valve"),
    ("effect named alone, where it could be", *["top-1 effect, where it could be named"] * 2),
    ("right stage", "right stage", "right stage"),
    ("false alarms on nulls", "false alarms on nulls", "false alarms on nulls"),
    ("misdiagnosis", "misdiagnosis", "misdiagnosis"),
    ("unknown found", "unknown found", "unknown found"),
    ("unknown falsely claimed", "unknown falsely claimed", "unknown falsely claimed"),
    ("leave-one-out answered honestly", "leave-one-out answered honestly", ""),
    ("both of two effects", "both of two effects found", "both of two effects found"),
    ("median true shrinkage", *["median true shrinkage, held-out days"] * 2),
    ("coverage of 95 % intervals", "coverage of 95 % intervals", "coverage of 95 % intervals"),
    ("measured house: right or untestable", "", "semi-real: right group or untestable"),
)

SUMMARY_PAGE = ROOT / "docs" / "blind_test_table.md"
SUMMARY_INTRO = """\
# The newest judged runs

This page has the marks of the newest [judged runs](../results/blind_test/README.md) of the [blind
test](blind_test.md), beside a list of rules and a diagnoser that guesses. It is written by `make golden`. Shares have
their 95 % intervals, or are counts of few; \\* falls short of its goal.
"""
PICTURE = ROOT / "docs" / "images" / "blind-test.svg"
SHOWN = ("right group", "right stage", "unknown found", "misdiagnosis", "false alarms on nulls")

Score = Mapping[str, Any]
Goal = Mapping[str, Any]


def scores() -> dict[str, Score]:
    """Every judged run by its number."""
    packed = {path.parent.name: path.read_bytes() for path in RUNS.glob("*/score.json.gz")}
    return {name: json.loads(gzip.decompress(packed[name])) for name in sorted(packed, key=int)}


def judged(score: Score) -> list[str]:
    """Where a run has records: the first ones had no baselines."""
    return [where for where in WHERE if any(goal["of"] for goal in _goals(score, "ours", where).values())]


def pages() -> dict[Path, str]:
    """Every page that shows figures of judged runs, as it should be."""
    every = scores()
    wanted = {
        RUNS / name / "README.md": [_run(score, where) for where in judged(score)] for name, score in every.items()
    }
    wanted[RUNS / "README.md"] = [_over_runs(every, where) for where in WHERE]
    every_page = {page: _with(page.read_text(encoding="utf-8"), tables) for page, tables in wanted.items()}
    return every_page | {SUMMARY_PAGE: f"{SUMMARY_INTRO}\n{_summaries(every)}"}


def newest(every: Mapping[str, Score], where: str) -> str:
    """Return the newest run that asked for effects of a place: not all runs draw from all."""
    return [run for run, score in every.items() if _goals(score, "ours", where).get("right group", {}).get("of")][-1]


def _answered(every: Mapping[str, Score], run: str) -> str:
    score = every[run]
    told = [f"{name} answered {of['answered']}" for name, of in score["diagnosers"].items()]
    return f"Run {run}: of {score['records']} records {', '.join(told)}.\n\n"


def _with(text: str, tables: Iterable[str]) -> str:
    """Return a page with each table in the place of the one whose heading begins alike."""
    for table in tables:
        start = re.escape(table[: table.index("| goal |")])
        text, found = re.subn(rf"^{start}\| goal \|.*\n(\|.*\n)*", lambda _, new=table: new, text, flags=re.M)
        assert found == 1, f"a page should have one table that begins with {start}"
    return text


def _run(score: Score, where: str) -> str:
    """One run: ours with intervals, whether the goal is met, the baselines that were asked."""
    asked = [name for name in BASELINES if name in score["diagnosers"]]
    rows = [["", "goal", "ours, 95 % interval, records", "met", *asked]]
    for name, goal in _goals(score, "ours", where).items():
        if goal["of"]:
            beside = [_value(_goals(score, other, where)[name]) for other in asked]
            rows.append([name, _wanted(goal), _with_interval(goal), _met(goal), *beside])
    rows[0][0] = where
    return _table(rows)


def _over_runs(every: Mapping[str, Score], where: str) -> str:
    goals = {run: _goals(score, "ours", where) for run, score in every.items() if where in judged(score)}
    rows = [[where, "goal", *(f"run {run}" for run in goals)]]
    for name, goal in list(goals.values())[-1].items():
        if any(run[name]["of"] for run in goals.values()):
            rows.append([name, _wanted(goal), *(_value(run[name]) + _star(run[name]) for run in goals.values())])
    return _table(rows)


def _summaries(every: Mapping[str, Score]) -> str:
    """The newest run of each place: ours with intervals beside the baselines that were asked."""
    told = []
    for where in WHERE:
        run = newest(every, where)
        told.append(_answered(every, run) + _summary(every[run], where))
    return "\n".join(told)


def _summary(score: Score, where: str) -> str:
    beside = [name for name in BASELINES if name in score["diagnosers"]]
    rows = [["", "goal", where, *beside]]
    for label, of_fast_room, of_others in SUMMARY:
        name = of_fast_room if where == WHERE[0] else of_others
        if _goals(score, "ours", where).get(name, {}).get("of"):
            rows.append([label, *_summary_cells(score, where, name, beside)])
    return _table(rows)


def _summary_cells(score: Score, where: str, name: str, beside: Sequence[str]) -> list[str]:
    goal = _goals(score, "ours", where)[name]
    wanted = "" if goal["wanted"] is None else f"{'≤ ' if goal['at_most'] else ''}{goal['wanted']:.2f}"
    others = [_value(_goals(score, other, where)[name]) for other in beside]
    return [wanted, _briefly(goal) + _star(goal), *others]


def _goals(score: Score, diagnoser: str, where: str) -> dict[str, Goal]:
    return {goal["name"]: goal for goal in score["diagnosers"][diagnoser]["goals"] if goal["where"] == where}


def _wanted(goal: Goal) -> str:
    if goal["wanted"] is None:
        return "report"
    if goal["where"] == "fast room" and goal["name"].startswith("coverage"):
        return f"holds {goal['wanted']:.2f}"
    return f"{'at most' if goal['at_most'] else 'at least'} {goal['wanted']:.2f}"


def _met(goal: Goal) -> str:
    return {True: "yes", False: "**no**", None: ""}[goal["met"]]


def _star(goal: Goal) -> str:
    return r" \*" if goal["met"] is False else ""


def _value(goal: Goal) -> str:
    return f"{goal['value']:.2f}" if goal["of"] else "-"


def _with_interval(goal: Goal) -> str:
    return f"{goal['value']:.2f} ({goal['low']:.2f} to {goal['high']:.2f}; {goal['of']})"


def _briefly(goal: Goal) -> str:
    if goal["count"] is not None and goal["of"] < FEW:
        return f"{goal['count']} of {goal['of']}"
    return f"{goal['value']:.2f} ({goal['low']:.2f} to {goal['high']:.2f})" if goal["of"] else "-"


def _table(rows: Sequence[Sequence[str]]) -> str:
    lines = [f"| {' | '.join(row)} |".replace("|  |", "| |") for row in rows]
    return "".join(f"{line}\n" for line in [lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])


def draw(every: Mapping[str, Score]) -> None:
    """Draw the README's figure: shares with their intervals, goals as ticks."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from waxstudy.report.figures.style import BLACK, GREY, name_rows, series

    mpl.rcParams["svg.hashsalt"] = "waxstudy"
    with mpl.rc_context({"svg.fonttype": "none", "font.size": 9, "font.family": "sans-serif"}):
        figure = Figure(figsize=(7.2, 2.6), layout="constrained")
        panels = figure.subplots(1, len(WHERE), sharey=True)
        for place, (panel, where) in enumerate(zip(panels, WHERE, strict=True)):
            score = every[newest(every, where)]
            goals, guess = (_goals(score, diagnoser, where) for diagnoser in ("ours", "random"))
            for row, name in enumerate(SHOWN):
                goal = goals[name]
                panel.plot([goal["low"], goal["high"]], [row, row], color=GREY, linewidth=5, alpha=0.5)
                panel.plot(goal["value"], row, linestyle="", **series(place))
                if goal["wanted"] is not None:
                    panel.plot(goal["wanted"], row, marker="|", color=BLACK, markersize=14, markeredgewidth=1.6)
                if guess[name]["value"] is not None:  # of few records a guess may have had none to answer
                    panel.plot(guess[name]["value"], row, marker="x", color=BLACK, linestyle="")
            panel.set_xlim(-0.03, 1.03)
            panel.set_title(where, fontsize=9)
            name_rows(panel, SHOWN)
            for side in ("top", "right"):
                panel.spines[side].set_visible(False)
        figure.supxlabel("share of records; | goal, x a guess, bar 95 % interval", fontsize=9)
        figure.savefig(PICTURE, metadata={"Date": None})


if __name__ == "__main__":
    for page, text in pages().items():
        page.write_text(text, encoding="utf-8", newline="\n")
    draw(scores())
