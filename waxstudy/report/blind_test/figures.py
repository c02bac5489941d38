"""The drawings of a score: goals with their intervals, the confusion matrix, what size of gap is found."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from waxstudy.report.blind_test.tables import Score, ordered
from waxstudy.report.figures.plot import Lacking, drawing, one_panel, panels
from waxstudy.report.figures.style import BLACK, legend_of, name_rows, series

NOT_CAUSES = ("nothing", "none", "counted apart", "unknown", "untestable", "failed")
NO_SHARES = ("mean size of right groups", "Brier score of the probabilities", "logarithmic score of the probabilities")
SIZES = ("0 to 1", "1 to 2", "2 to 4", "4 to 10", "above 10")


@drawing(
    "goals",
    "Figures and goals",
    "With their 95 % intervals; where no mark stands, nobody answered such a record.",
)
def figure_goals(score: Score) -> Figure:
    """Each goal's figure of everybody, with its 95 % interval, beside what is wanted."""
    names = ordered(score)
    goals = [goal for goal in score["diagnosers"][names[0]]["goals"] if goal["name"] not in NO_SHARES]
    shown = [goal for goal in goals if goal["value"] is not None]
    if not shown:
        raise Lacking("no goal has a record")
    figure, panel = one_panel(1.2 + 0.34 * len(shown))
    for place, goal in enumerate(shown):
        if goal["wanted"] is not None:
            panel.plot([goal["wanted"]] * 2, [place - 0.4, place + 0.4], color=BLACK, linewidth=2.0)
        for number, name in enumerate(names):
            every = score["diagnosers"][name]["goals"]
            own = next(each for each in every if all(each[key] == goal[key] for key in ("name", "where")))
            _point(panel, place, own, number, len(names))
    name_rows(panel, [f"{goal['name']}  ({goal['where']})" for goal in shown])
    panel.grid(axis="y", visible=False)
    words = "share, or median shrinkage, with its 95 % interval; black bar: what is wanted"
    panel.set(xlim=(-0.02, 1.02), xlabel=words)
    _legend(figure, names)
    return figure


def _point(panel: Axes, place: int, goal: Mapping[str, Any], number: int, count: int) -> None:
    if goal["value"] is None:
        return
    at = place + 0.6 * ((number + 0.5) / count - 0.5)
    value, low, high = (min(1.0, max(0.0, goal[key])) for key in ("value", "low", "high"))
    look = series(number)
    panel.plot([low, high], [at, at], color=look["color"], linewidth=1.2)
    panel.plot([value], [at], markersize=5.0, linestyle="none", **look)


def _legend(figure: Figure, names: list[str]) -> None:
    legend_of(figure, [Line2D([], [], label=name, linestyle="none", **series(i)) for i, name in enumerate(names)])


@drawing(
    "confusion",
    "True cause and what was said",
    "Records with one cause or none, all channel sets and noises; the darker, the larger the share of a row.",
)
def figure_confusion(score: Score) -> Figure:
    """True cause against what the first diagnoser named; raise `Lacking` without answers."""
    rows = score["diagnosers"][ordered(score)[0]]["confusion"]
    if not rows:
        raise Lacking("nothing was answered")
    truths = sorted(rows, key=lambda name: (name in NOT_CAUSES, name))
    said = sorted({name for row in rows.values() for name in row}, key=lambda name: (name in NOT_CAUSES, name))
    counts = np.array([[rows[true].get(name, 0) for name in said] for true in truths], dtype=float)
    shares = counts / counts.sum(axis=1, keepdims=True)
    figure, panel = one_panel(2.4 + 0.24 * len(truths))
    panel.imshow(shares, cmap="Greys", vmin=0.0, vmax=1.4, aspect="auto")
    for i, j in zip(*np.nonzero(counts), strict=True):
        colour = "white" if shares[i, j] > 0.85 else BLACK
        panel.annotate(f"{counts[i, j]:.0f}", (j, i), ha="center", va="center", fontsize=8.0, color=colour)
    panel.set_xticks(range(len(said)), said, rotation=90)
    panel.set_yticks(range(len(truths)), truths)
    panel.grid(visible=False)
    panel.set(xlabel="said", ylabel="true")
    return figure


@drawing(
    "sizes",
    "What size of gap is found",
    "Shares with 95 % intervals; all channel sets and noises.",
)
def figure_sizes(score: Score) -> Figure:
    """How often the right group is found, and a wrong effect named, by the size of the true gap."""
    names = ordered(score)
    split = score["diagnosers"][names[0]]["by"]["gap over floor"]
    shown = [size for size in SIZES if size in split and split[size]["right_group"]["value"] is not None]
    if not shown:
        raise Lacking("no record with one effect was answered")
    figure, axes = panels(1, 2, 3.6)
    titles = {"right_group": ("right group", "one effect"), "misdiagnosis": ("misdiagnosis", "one effect or two")}
    for panel, (key, (title, of)) in zip(axes[0], titles.items(), strict=True):
        for number, name in enumerate(names):
            _course(panel, score["diagnosers"][name]["by"]["gap over floor"], shown, key, number)
        panel.set_xticks(range(len(shown)), shown)
        panel.set(ylim=(-0.03, 1.03), title=title, xlabel="true gap over its noise floor")
        panel.set_ylabel(f"share of records with {of}")
    _legend(figure, names)
    return figure


def _course(panel: Axes, split: Mapping[str, Any], shown: list[str], key: str, number: int) -> None:
    points = [(place, split[size][key]) for place, size in enumerate(shown) if size in split]
    seen = [(place, figure) for place, figure in points if figure["value"] is not None]
    look = series(number)
    for place, each in seen:
        panel.plot([place] * 2, [each["low"], each["high"]], color=look["color"], linewidth=1.0)
    panel.plot([place for place, _ in seen], [each["value"] for _, each in seen], markersize=5.0, **look)
