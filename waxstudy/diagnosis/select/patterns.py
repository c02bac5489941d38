"""When an effect of the chain acts: its strength over time, where it is not always the same."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.result import GROWING
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray
from waxstudy.plugin.hours import DAY_H

TINY = 1e-9
LEAST_SHARE, MOST_SHARE = 0.02, 0.9  # of a record, in which something acts at times
LENGTHS_H = (2.0, 4.0, 6.0, 8.0, 12.0)
WEEK = ("Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday")


@dataclass(frozen=True)
class Pattern:
    """A course of an effect's strength over a record (n,), in words; the hours in which it acts."""

    words: str
    strength: FloatArray
    spans_h: tuple[tuple[float, float], ...]

    @property
    def is_at_times(self) -> bool:
        """Whether it acts at some times and not at others."""
        return not self.strength.all()


def patterns(record: Record) -> Iterator[Pattern]:
    """Yield the courses that are tried, each once: what is the same under two names would be paid for twice.

    They are: growing, from a day on, up to one, on one alone, between hours, on every other day, and, where it is known
    which days of the week a record has, at weekends or between them, and on a day of the week that comes again.
    """
    seen: set[bytes] = set()  # digests: a record may have a million samples
    for each in _named(record):
        digest = sha256(each.strength.tobytes()).digest()
        if digest not in seen:
            seen.add(digest)
            yield each


def _named(record: Record) -> Iterator[Pattern]:
    interval_h, count = record.interval_s / 3600.0, len(record)
    time_h = (np.arange(count) + 0.5) * interval_h
    length_h = count * interval_h
    yield Pattern(GROWING, np.asarray(2.0 * time_h / length_h), ((0.0, length_h),))
    for words, acts in of_days(record):
        yield _pattern(words, acts[day_of(record)], interval_h)
    for hour in range(24):
        for hours in LENGTHS_H:
            words = f"every day from {hour:02d}:00 to {int(hour + hours) % 24:02d}:00"
            yield _pattern(words, (record.clock_h - hour) % DAY_H < hours, interval_h)


def day_of(record: Record) -> np.ndarray:
    """Return the number of the day of each sample (n,): what ended at the first midnight belongs to the first one."""
    return np.asarray(np.maximum(record.day, 0))


def of_days(record: Record) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the courses that are tried of whole days: in words, and on which days each acts (days,)."""
    days = np.arange(int(day_of(record).max()) + 1)
    for day in days[1:].tolist():
        yield f"from day {day + 1} on", days >= day
        yield f"up to day {day}", days < day
        yield f"on day {day + 1} only", days == day
    for rest in (0, 1) if len(days) > 1 else ():
        yield f"every other day from day {rest + 1} on", days % 2 == rest
    if record.first_weekday is None:
        return
    weekday = (days + record.first_weekday) % len(WEEK)
    is_weekend = weekday >= WEEK.index("Saturday")
    if is_weekend.any() and not is_weekend.all():
        yield "on Saturdays and Sundays", is_weekend
        yield "from Mondays to Fridays", ~is_weekend
    for place, name in enumerate(WEEK):
        if (weekday == place).sum() > 1:
            yield f"on {name}s", weekday == place


def acting(
    before: Hypothesis,
    after: Hypothesis,
    pattern: Pattern,
    share: Mapping[str, float] | None = None,
    parts: Sequence[int] = ALL,
) -> tuple[Hypothesis, float]:
    """Return a hypothesis with one more effect, which has a course, and its strength, which suits some parts best.

    What the effect does to each sample is taken times its strength there: what it does later is left out. Of samples
    `share` count as one, by channel; None counts all alike.
    """
    pairs = list(zip(before.residuals, after.residuals, strict=True))
    courses = [pattern.strength[new.sample] for _, new in pairs]
    missed, change = [], []
    for (old, new), course in zip(pairs, courses, strict=True):
        counts = old.weights(share or {}) * np.isin(old.part, parts)
        missed.append(old.whitened * counts)
        change.append(course * (new.whitened - old.whitened) * counts)
    was, turned = np.concatenate(missed), np.concatenate(change)
    strength = float(np.clip(-(was @ turned) / max(float(turned @ turned), 1e-12), 0.0, WEIGHTS.strongest))
    residuals = [
        replace(
            new,
            error=old.error + strength * course * (new.error - old.error),
            whitened=old.whitened + strength * course * (new.whitened - old.whitened),
        )
        for (old, new), course in zip(pairs, courses, strict=True)
    ]
    return replace(after, residuals=residuals, is_at_times=True), strength


def concentrated(residual: Residual, together: float, record: Record) -> Pattern | None:
    """Return when a channel is missed by more than at other times; None where no course tells that.

    Two variances against one, by likelihood, with the number of courses tried paid for (Schwarz 1978); of samples
    `together` count as one.
    """
    squares, sample = residual.whitened[residual.judged] ** 2, residual.sample[residual.judged]
    if not squares.any():
        return None
    best: Pattern | None = None
    most, tried = -np.inf, 0
    for each in patterns(record):
        if each.is_at_times:
            tried += 1
            gain = _gain(squares, each.strength[sample] > 0.0) / together
            best, most = (each, gain) if gain > most else (best, most)
    price = float(np.log(tried) + 0.5 * np.log(max(2.0, len(squares) / together)))
    return best if most > price else None


def _gain(squares: FloatArray, acts: np.ndarray) -> float:
    """Return the log likelihood gained by another variance while something acts, where it is clearly larger then."""
    share = float(acts.mean())
    if not LEAST_SHARE <= share <= MOST_SHARE:
        return -np.inf
    within, beyond, whole = (float(each.mean()) + TINY for each in (squares[acts], squares[~acts], squares))
    if within < WEIGHTS.clearly**2 * beyond:
        return -np.inf
    spread = share * np.log(within) + (1.0 - share) * np.log(beyond)
    return 0.5 * len(squares) * float(np.log(whole) - spread)


def _pattern(words: str, acts: np.ndarray, interval_h: float) -> Pattern:
    edges = np.flatnonzero(np.diff(np.concatenate(([False], acts, [False]))))
    starts, ends = edges[::2] * interval_h, edges[1::2] * interval_h
    return Pattern(words, acts.astype(float), tuple(zip(starts.tolist(), ends.tolist(), strict=True)))
