"""What of a diagnosis matters most: its stages, its days, its commonest hindrance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from waxstudy.diagnosis.result import Diagnosis, FoundEffect, Measurement, StageGap, Unexplained, Untestable

MOST_STAGES = 3
LEAST_OF_A_DAY = 0.5  # samples, against the fullest day


def main_stages(diagnosis: Diagnosis) -> list[StageGap]:
    """The channels of what was found or stays unexplained; else the one that stands out of its noise most.

    Of a gap that is no finding, such as the form of the room's model, one channel of each stage.
    """
    found = {effect.channel for effect in diagnosis.effects}
    ranked = sorted(diagnosis.stages, key=lambda stage: -stage.over_floor)
    shown = [stage for stage in ranked if stage.channel in found]
    for left in sorted(diagnosis.unexplained, key=lambda each: not each.is_finding):
        stage = stage_of(diagnosis, left)
        told = stage in shown or (not left.is_finding and left.stage in {each.stage for each in shown})
        shown += [stage] if stage and not told else []
    return (shown or ranked[:1])[:MOST_STAGES]


def other_stages(diagnosis: Diagnosis) -> list[StageGap]:
    """The rest, the one that stands out of its noise most first."""
    main = main_stages(diagnosis)
    return sorted((s for s in diagnosis.stages if s not in main), key=lambda stage: -stage.over_floor)


def stage_of(diagnosis: Diagnosis, left: FoundEffect | Unexplained) -> StageGap | None:
    """The judged channel at which a gap was found or stays unexplained."""
    for stage in diagnosis.stages:
        if left.channel == stage.channel or (not left.channel and left.stage == stage.stage):
            return stage
    return None


def left_at(diagnosis: Diagnosis, stage: StageGap) -> Unexplained | None:
    """What stays unexplained at a judged channel."""
    return next((left for left in diagnosis.unexplained if stage_of(diagnosis, left) is stage), None)


def unit_of(diagnosis: Diagnosis, gap: FoundEffect | Unexplained) -> str:
    stage = stage_of(diagnosis, gap)
    return stage.unit if stage else ""


def by_reason(untestable: Sequence[Untestable]) -> list[tuple[str, list[str]]]:
    """Effects by why they could not be tested, the commonest reason first."""
    found: dict[str, list[str]] = {}
    for each in untestable:
        found.setdefault(each.reason, []).append(each.name)
    return sorted(found.items(), key=lambda item: -len(item[1]))


def measurements(diagnosis: Diagnosis) -> list[Measurement]:
    """What to measure next, each once, with all that it would settle."""
    found: dict[str, list[str]] = {}
    for each in diagnosis.next_measurements:
        found.setdefault(each.what, []).extend(each.splits)
    return [Measurement(what, list(dict.fromkeys(splits))) for what, splits in found.items()]


@dataclass(frozen=True)
class Day:
    """A day of the record, and why it is shown."""

    what: str
    date: str
    traces: pd.DataFrame


def shown_days(diagnosis: Diagnosis, channel: str) -> list[Day]:
    """Return the days on which what is believed misses a channel most, and as much as on a typical day."""
    off = (diagnosis.traces[f"{channel}_before"] - diagnosis.traces[f"{channel}_measured"]) ** 2
    days = by_day(diagnosis.traces)
    size = off.groupby(days).mean() ** 0.5
    count = off.groupby(days).count()
    size = size[count >= LEAST_OF_A_DAY * count.max()].dropna().sort_values()
    if size.empty:
        return []
    dates = {"worst day": size.index[-1], "typical day": size.index[(len(size) - 1) // 2]}
    if len(size) == 1:
        dates = {"only day": size.index[0]}
    return [Day(what, date, diagnosis.traces[np.asarray(days == date)]) for what, date in dates.items()]


def by_day(traces: pd.DataFrame) -> pd.Series[str]:
    """The date of each row; stamps are ends of intervals, so that midnight ends a day."""
    times = pd.DatetimeIndex(traces.index)
    return pd.Series((times - pd.Timedelta(1, "s")).strftime("%Y-%m-%d"), index=traces.index)
