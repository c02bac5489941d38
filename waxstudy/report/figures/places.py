"""Which cases, weeks and times the figures show: chosen by their place in the study, never by name."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from waxstudy.plugin import FloatArray
from waxstudy.report.content import Content
from waxstudy.report.figures.plot import Lacking
from waxstudy.study.model import Ladder

DAY_S, HOUR_S = 86400.0, 3600.0


def adapted(ladder: Ladder) -> str:
    """The second case: the first detail, in the paper the adapted parameters."""
    return ladder.cases[min(1, len(ladder.cases) - 1)]


def one_simpler(ladder: Ladder) -> str | None:
    """The case before the reference, if there is one."""
    place = list(ladder.cases).index(ladder.reference)
    return ladder.cases[place - 1] if place else None


def second_week(content: Content) -> str:
    """The last week, in the paper the one with sun; raise `Lacking` if the study has one only."""
    if len(content.run.weeks) < 2:
        raise Lacking("it compares in a second week, and the study has a single one")
    return content.run.weeks[-1]


def trace(content: Content, case: str, week: str) -> pd.DataFrame:
    """The trace of the first member that the study keeps; raise `Lacking` if it keeps none."""
    frame = content.run.traces(case, week)
    if frame.empty:
        raise Lacking("the study keeps no traces ([output] trace_members is 0)")
    kept: pd.DataFrame = frame[frame["member"] == frame["member"].min()]
    return kept.reset_index(drop=True)


def between(frame: pd.DataFrame, start_s: float, end_s: float) -> pd.DataFrame:
    return frame[(frame["time_s"] > start_s) & (frame["time_s"] <= end_s)]


def every(frame: pd.DataFrame, interval_s: float) -> pd.DataFrame:
    """Every n-th row: enough for a line that is narrow on the page."""
    times = frame["time_s"].to_numpy()
    own_s = times[1] - times[0] if len(times) > 1 else interval_s
    return frame.iloc[:: max(1, round(interval_s / own_s))]


def steps(frame: pd.DataFrame, channel: str) -> pd.DataFrame:
    """The rows at which a channel changes, which draw the same steps as all rows."""
    changed = frame[channel].diff().ne(0.0)
    return frame[changed | changed.shift(-1, fill_value=True)]


def cumulative(content: Content, case: str, week: str) -> pd.DataFrame:
    """Duration curves of a case, mean over the members, by percent of the time."""
    return content.run.durations(case, week).groupby("percent").mean()


def hours(frame: pd.DataFrame, start_s: float = 0.0) -> FloatArray:
    return np.asarray((frame["time_s"].to_numpy(dtype=float) - start_s) / HOUR_S)


def days(frame: pd.DataFrame) -> FloatArray:
    """Time from the start of the week, such that 1 is the first midnight."""
    return np.asarray(frame["time_s"].to_numpy(dtype=float) / DAY_S)


def rises(signal: FloatArray) -> NDArray[np.intp]:
    """Indices at which a signal rises over the half."""
    on = signal > 0.5
    return np.flatnonzero(on[1:] & ~on[:-1]) + 1
