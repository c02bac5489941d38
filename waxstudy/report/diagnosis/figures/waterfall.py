"""The waterfall: what each effect takes away of a channel's gap, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.diagnosis.result import Diagnosis, Step
from waxstudy.report.diagnosis.words import axis_unit, channel_words, number
from waxstudy.report.figures.plot import Lacking, drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS, DASHED, GREY, legend_below

MOST_CHANNELS = 4
HEIGHT = 0.62
HATCH = "////"
CLEARED: Any = {"facecolor": "white", "edgecolor": "none", "pad": 0.6}  # a figure that the noise floor would cross


@drawing(
    "waterfall",
    "How far the gap shrinks, effect by effect",
    "Root mean square gap of each channel over the whole record: as believed, what each effect takes away (hatched), "
    "and what is left. Dashed: noise floor, near what a perfect model would leave.",
)
def figure_waterfall(diagnosis: Diagnosis) -> Figure:
    """Gaps by channel, in the channel's unit; raise `Lacking` where no effect was found."""
    shown = [steps for steps in _by_channel(diagnosis) if len(steps) > 1][:MOST_CHANNELS]
    if not shown:
        raise Lacking("no effect was found that would shrink a gap")
    rows = [len(steps) + 1 for steps in shown]
    figure, axes = panels(len(shown), 1, 0.5 + sum(0.36 * n + 0.55 for n in rows), height_ratios=rows)
    floors = {stage.channel: stage.noise_floor for stage in diagnosis.stages}
    for panel, steps in zip(axes[:, 0], shown, strict=True):
        _channel(panel, steps, floors[steps[0].channel])
    legend_below(figure, axes[0, 0])
    return figure


def _by_channel(diagnosis: Diagnosis) -> list[list[Step]]:
    found: dict[str, list[Step]] = {}
    for step in diagnosis.waterfall:
        found.setdefault(step.channel, []).append(step)
    first = [effect.channel for effect in diagnosis.effects]
    return sorted(found.values(), key=lambda steps: steps[0].channel not in first)


def _channel(panel: Axes, steps: Sequence[Step], floor: float) -> None:
    gaps, last = [step.gap for step in steps], len(steps)
    _bar(panel, 0, 0.0, gaps[0], number(gaps[0]), facecolor=GREY)
    for place, (before, after) in enumerate(pairwise(gaps), start=1):
        ends = min(before, after), max(before, after)
        _bar(panel, place, *ends, f"to {number(after)}", facecolor="white", hatch=HATCH)
    _bar(panel, last, 0.0, gaps[-1], number(gaps[-1]), facecolor=COLOURS[1])
    for place, gap in enumerate(gaps):
        panel.plot([gap, gap], [place + HEIGHT / 2, place + 1 - HEIGHT / 2], color=BLACK, linewidth=0.8)
    panel.axvline(floor, color=COLOURS[5], linestyle=DASHED, linewidth=1.6, label="noise floor", zorder=2.5)
    panel.set_yticks(range(last + 1), ["as believed", *(step.effect for step in steps[1:]), "left"])
    panel.grid(axis="y", visible=False)
    panel.set_ylim(last + 0.55, -0.55)
    panel.set_xlim(0.0, 1.12 * max([*gaps, floor]) or 1.0)
    panel.set_xlabel(f"gap of {channel_words(steps[0].channel)}, {axis_unit(steps[0].unit)}")


def _bar(panel: Axes, place: int, low: float, high: float, text: str, **look: Any) -> None:
    panel.barh(place, high - low, HEIGHT, left=low, edgecolor=BLACK, linewidth=0.8, **look)
    panel.annotate(text, (high, place), (5, 0), textcoords="offset points", va="center", ha="left", bbox=CLEARED)
