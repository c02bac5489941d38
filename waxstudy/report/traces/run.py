"""Traces of a run: cases of one week beside each other, through the loop from the air to the heat."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from waxstudy.plugin.registry import hint
from waxstudy.report.comparison import shifted_setpoint_C
from waxstudy.report.traces.lines import Line, Panel, Traces
from waxstudy.results.folder import RunError, again
from waxstudy.results.run import Run
from waxstudy.study.model import Study

AIR = "air_C"
PANELS = {  # channel: words, unit
    AIR: ("air temperature and set-point (dotted)", "°C"),
    "operative_C": ("operative temperature", "°C"),
    "floor_surface_C": ("floor surface temperature", "°C"),
    "signal": ("signal to the actuator", "0 to 1"),
    "opening": ("valve opening", "0 to 1"),
    "water_heat_W_m2": ("heat that the water gives off", "W/m²"),
    "floor_heat_W_m2": ("heat from the floor to the room", "W/m²"),
}


class Unknown(Exception):
    """A case or week that the run does not hold; the message names the nearest and all."""


def of_run(run: Run, study: Study, cases: Sequence[str], week: str | None) -> Traces:
    """Return traces of cases (none: the simplest of the first ladder and its reference) in a week (None: the first).

    Raises `Unknown`, and `RunError` where the run keeps no traces.
    """
    ladder = run.ladders[0]
    shown = list(dict.fromkeys(cases)) or list(dict.fromkeys((ladder.cases[0], ladder.reference)))
    for case in shown:
        _must_be("case", case, [each.case for each in run.cases])
    week = run.weeks[0] if week is None else week
    _must_be("week", week, run.weeks)
    frames = {case: _frame(run, case, week) for case in shown}
    panels = [
        Panel(
            title, unit, [*_lines(frames, channel), *(_setpoints(run, study, frames, week) if channel == AIR else [])]
        )
        for channel, (title, unit) in PANELS.items()
    ]
    summary = f"{', '.join(shown)} in {week}, one member. Levels and heat are means of the interval that ends."
    return Traces(f"Traces of the study “{run.study}”", summary, panels)


def _must_be(what: str, name: str, known: Sequence[str]) -> None:
    if name not in known:
        raise Unknown(f"no {what} '{name}' in this run{hint(name, known)}; it has {', '.join(dict.fromkeys(known))}")


def _frame(run: Run, case: str, week: str) -> pd.DataFrame:
    frame = run.traces(case, week)
    if frame.empty:
        raise RunError(f"{run.folder}: the study keeps no traces ([output] trace_members is 0)")
    if "time" not in frame:
        raise RunError(f"{run.folder}: traces of an earlier version, without calendar time; {again(run.folder)}")
    first: pd.DataFrame = frame[frame["member"] == frame["member"].min()]
    return first.set_index("time")


def _lines(frames: dict[str, pd.DataFrame], channel: str) -> list[Line]:
    return [Line(case, place, frame[channel].dropna()) for place, (case, frame) in enumerate(frames.items())]


def _setpoints(run: Run, study: Study, frames: dict[str, pd.DataFrame], week: str) -> list[Line]:
    found = []
    for place, (case, frame) in enumerate(frames.items()):
        ends = frame.index[[0, -1]]
        at_C = shifted_setpoint_C(run, study, case, week)
        found.append(Line(f"set-point of {case}", place, pd.Series(at_C, index=ends), is_dotted=True))
    return found
