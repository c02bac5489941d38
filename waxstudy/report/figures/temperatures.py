"""Air and operative temperatures: one day, the whole week, and their cumulative curves."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.report.comparison import shifted_setpoint_C
from waxstudy.report.content import Content
from waxstudy.report.figures import places
from waxstudy.report.figures.plot import drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS, DASHED, GREY, ladder_dash, legend_below, look

BAND_K = 0.25
MOST_TICKS = 14


@drawing(
    "17",
    "Figure 17. Air and operative temperature of one day",
    "Air temperature (solid), operative temperature (dashed) and shifted setpoint (dotted) of the second case "
    "of each ladder in the middle of the first week; one member. The grey line is the limit of the operative "
    "temperature.",
)
def figure_17(content: Content) -> Figure:
    """Air, operative temperature and setpoint [°C] during one day; raise `Lacking` without traces."""
    week, ladders = content.run.weeks[0], content.run.ladders
    figure, axes = panels(1, len(ladders), 3.9, sharey=True)
    for panel, ladder in zip(axes[0], ladders, strict=True):
        _day(panel, content, places.adapted(ladder), week)
        panel.set_xlabel("time of the day, h")
    axes[0, 0].set_ylabel("temperature, °C")
    legend_below(figure, axes[0, 0])
    return figure


def _day(panel: Axes, content: Content, case: str, week: str) -> None:
    whole = places.trace(content, case, week)
    start_s = places.DAY_S * (int(whole["time_s"].iloc[-1] / places.DAY_S) // 2)
    frame = places.between(whole, start_s, start_s + places.DAY_S)
    limit_C = content.study.comfort.operative_limit_C
    panel.axhline(limit_C, color=GREY, linewidth=2.0, zorder=1.0, label=f"limit {limit_C:g} °C")
    time_h, colour = places.hours(frame, start_s), COLOURS[1]
    panel.plot(time_h, frame["air_C"], color=colour, label="air")
    panel.plot(time_h, frame["operative_C"], color=BLACK, linestyle=DASHED, label="operative")
    setpoint_C = shifted_setpoint_C(content.run, content.study, case, week)
    panel.axhline(setpoint_C, color=COLOURS[5], linestyle=":", linewidth=1.8, label="setpoint")
    panel.set(title=f"{case}, {week}, day {int(start_s / places.DAY_S) + 1}", xticks=range(0, 25, 3), xlim=(0, 24))


@drawing(
    "18",
    "Figure 18. Cumulative operative temperatures",
    "Operative temperature that is not exceeded for a share of the week, mean over the members; the first "
    "ladder solid, the second dashed, the reference cases black and thick, with the range of the members "
    "as a band. The grey lines meet where equal comfort asks every case to pass.",
)
def figure_18(content: Content) -> Figure:
    """Duration curves of the operative temperature [°C], one panel per week."""
    weeks = content.run.weeks
    figure, axes = panels(1, len(weeks), 5.2, sharey=True)
    for panel, week in zip(axes[0], weeks, strict=True):
        _comfort_lines(panel, content)
        for ladder in content.run.ladders:
            for case in ladder.cases:
                _duration(panel, content, case, week)
            _members(panel, content, ladder.reference, week)
        panel.set(title=week, xlabel="share of the week that is cooler, %", xlim=(0, 100))
    axes[0, 0].set_ylabel("operative temperature, °C")
    legend_below(figure, axes[0, 0])
    return figure


def _comfort_lines(panel: Axes, content: Content) -> None:
    comfort = content.study.comfort
    panel.axhline(comfort.operative_limit_C, color=GREY, linewidth=1.0, zorder=1.0)
    panel.axvline(100.0 * comfort.hours_below_per_week / 168.0, color=GREY, linewidth=1.0, zorder=1.0)


def _duration(panel: Axes, content: Content, case: str, week: str) -> None:
    curve = places.cumulative(content, case, week)["operative_C"]
    style, place = look(content, case), len(panel.get_lines())
    markers = (5 + 3 * place % 20, 20)  # staggered, so that markers of close curves do not cover each other
    panel.plot(curve.index, curve, label=case, linestyle=ladder_dash(content, case), markevery=markers, **style)


def _members(panel: Axes, content: Content, case: str, week: str) -> None:
    groups = content.run.durations(case, week).groupby("percent")["operative_C"]
    low, high = groups.min(), groups.max()
    panel.fill_between(low.index.to_numpy(), low.to_numpy(), high.to_numpy(), color=BLACK, alpha=0.15, linewidth=0)


@drawing(
    "20",
    "Figure 20. Air temperature over the first week",
    "The simplest (thin), the second (dashed) and the reference case (black) of each ladder; one member. "
    "The grey lines are a quarter of a kelvin above and below the unshifted setpoint.",
)
def figure_20(content: Content) -> Figure:
    """Air temperature [°C] over the first week, a panel per ladder; raise `Lacking` without traces."""
    week, ladders = content.run.weeks[0], content.run.ladders
    figure, axes = panels(len(ladders), 1, 1.0 + 2.6 * len(ladders), sharex=True, sharey=True)
    for panel, ladder in zip(axes[:, 0], ladders, strict=True):
        shown = dict.fromkeys((ladder.cases[0], places.adapted(ladder), ladder.reference))
        _week(panel, content, list(shown), week)
        panel.set(title=f"{ladder.name}, {week}", ylabel="air temperature, °C")
        panel.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), handlelength=3.0)
    axes[-1, 0].set_xlabel("time from the start of the week, days")
    return figure


def _week(panel: Axes, content: Content, cases: list[str], week: str) -> None:
    for off_K in (-BAND_K, BAND_K):
        panel.axhline(content.study.comfort.setpoint_C + off_K, color=GREY, linewidth=1.2, zorder=1.0)
    for place, case in enumerate(cases):
        frame = places.every(places.trace(content, case, week), 300.0)
        style = look(content, case) | {"marker": "", "linestyle": "--" if place == 1 and len(cases) > 2 else "-"}
        style["linewidth"] = min(1.6, style.get("linewidth", 1.2))
        panel.plot(places.days(frame), frame["air_C"], label=case, **style)
    last = int(np.ceil(places.days(frame)[-1]))
    panel.set(xticks=range(0, last + 1, -(-last // MOST_TICKS)), xlim=(0, last))
