"""When an effect acts."""

from __future__ import annotations

from waxstudy.diagnosis.model.edits import EffectType, Values
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.result import When
from waxstudy.diagnosis.select.days import Days, days_of
from waxstudy.plugin import clock
from waxstudy.plugin.hours import DAY_H, open_h


def when(effect: EffectType, values: Values, record: Record) -> When:
    """Return when an effect acts, in hours since the record began."""
    length_h = len(record) * record.interval_s / 3600.0
    hours, days = effect.hours(effect.Parameters(**values)), days_of(effect)
    if hours is None and days is None:
        return When("always", [(0.0, length_h)])
    from_h, to_h = hours or (0.0, DAY_H)
    lasting_h = open_h(from_h, to_h) if hours else DAY_H
    first_h = from_h - record.start_s / 3600.0
    starts = [first_h + DAY_H * day for day in range(-1, int(length_h // DAY_H) + 2)]
    if days is not None:
        starts = [start for start, acts in zip(starts[1:], days.acts, strict=False) if acts]
    spans = [(max(0.0, start), min(length_h, start + lasting_h)) for start in starts]
    return When(_words(hours, days), [(start, end) for start, end in spans if start < end])


def _words(hours: tuple[float, float] | None, days: Days | None) -> str:
    between = f"from {clock(hours[0])} to {clock(hours[1])}" if hours else ""
    return ", ".join(filter(None, (between, days.words))) if days else f"every day {between}"
