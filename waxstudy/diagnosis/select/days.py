"""An effect of a room that acts on some days of a record only."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.select.patterns import day_of, of_days
from waxstudy.diagnosis.select.timed import blended
from waxstudy.plugin import Belief, FloatArray, Inputs
from waxstudy.plugin.hours import DAY_H


@dataclass(frozen=True)
class Days:
    """Days of a record, by number from 0, in words."""

    words: str
    acts: tuple[bool, ...]
    tried: int = 1  # courses that it was chosen from

    @classmethod
    def only(cls, day: int, count: int) -> Days:
        return cls("", tuple(each == day for each in range(count)))

    def share(self, inputs: Inputs, hours: tuple[float, float] | None) -> FloatArray:
        """Return 1 for each interval of these days, 0 for the others (n,); hours over midnight belong to the first.

        What began before the first day is of no day.
        """
        # a day of hours over midnight begins in the middle of those in which nothing acts
        begin_h = 0.5 * sum(hours) if hours and hours[0] > hours[1] else 0.0
        middle_h = (inputs.start_s + (np.arange(len(inputs.outdoor_C)) + 0.5) * inputs.interval_s) / 3600.0
        day = ((middle_h - begin_h) // DAY_H).astype(int)
        is_known = (day >= 0) & (day < len(self.acts))
        return np.where(is_known, np.array(self.acts, dtype=float)[np.where(is_known, day, 0)], 0.0)


def courses(record: Record, inputs: Inputs) -> list[Days]:
    """Return the days that are tried, each once: of the calendar and the week, the coldest, warmest, sunniest, dullest.

    Each holds two days at least: what happened once may be chance. Weather tells the days of what depends on it in
    steps, as of a stove that is lit when it is cold.
    """
    named = [*of_days(record), *_of_weather(record, inputs)]
    found = {tuple(acts.tolist()): words for words, acts in reversed(named)}
    chosen = {acts: words for acts, words in found.items() if sum(acts) > 1 and not all(acts)}
    return [Days(words, acts, len(chosen)) for acts, words in chosen.items()]


def _of_weather(record: Record, inputs: Inputs) -> Iterator[tuple[str, np.ndarray]]:
    """Yield in words and by day (days,) where it is colder or warmer than between two days, sunnier or duller.

    The weather of a day is the mean of what the record has of it.
    """
    day = day_of(record)
    counts = np.bincount(day)
    if not counts.all():
        return
    outdoor = inputs.outdoor_C, "colder", "warmer", 1, "C"
    sun = inputs.solar_W, "with less", "with more", 0, "W of sun"
    for values, less, more, digits, unit in (outdoor, sun):
        mean = np.bincount(day, values) / counts
        for below, above in pairwise(np.unique(mean).tolist()):
            edge = round(0.5 * (below + above), digits) + 0.0  # as it is told; no -0
            yield f"on days {less} than {edge:.{digits}f} {unit}", mean < edge
            yield f"on days {more} than {edge:.{digits}f} {unit}", mean > edge


def on_days(effect: EffectType, on: Days) -> EffectType:
    """Return the effect where it acts on some days only, with the same parameters."""

    class OnDays(effect):  # type: ignore[misc, valid-type]
        acts_on = on

        @classmethod
        def apply(cls, belief: Belief, p: Any) -> Belief:
            other = effect.apply(belief, p)
            assert belief.inputs
            assert other.inputs
            share = on.share(belief.inputs, effect.hours(p))
            return replace(other, inputs=blended(belief.inputs, other.inputs, share))

        @classmethod
        def sentence(cls, p: Any) -> str:
            said = effect.sentence(p).replace("Every day from", "From").replace("every day from", "from")
            return f"{said.removesuffix('.')}, {on.words}."

    OnDays.__name__ = f"{effect.__name__}OnDays"
    return OnDays


def days_of(effect: EffectType) -> Days | None:
    """Return the days on which an effect acts; None where it acts on all of them."""
    found = getattr(effect, "acts_on", None)
    return found if isinstance(found, Days) else None
