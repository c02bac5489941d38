"""When an effect acts."""

from __future__ import annotations

from waxstudy.diagnosis.estimate.parameter_space import EffectType, Values
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.result import When
from waxstudy.plugin import clock

DAY_H = 24.0


def when(effect: EffectType, values: Values, record: Record) -> When:
    """Return when an effect acts, in hours since the record began."""
    length_h = len(record) * record.interval_s / 3600.0
    hours = effect.hours(effect.Parameters(**values))
    if hours is None:
        return When("always", [(0.0, length_h)])
    from_h, to_h = hours
    open_h = (to_h - from_h) % DAY_H
    first_h = from_h - record.start_s / 3600.0
    starts = (first_h + DAY_H * day for day in range(-1, int(length_h // DAY_H) + 2))
    spans = [(max(0.0, start), min(length_h, start + open_h)) for start in starts]
    words = f"every day from {clock(from_h)} to {clock(to_h)}"
    return When(words, [(start, end) for start, end in spans if start < end])
