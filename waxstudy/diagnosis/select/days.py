"""An effect of a room that acts on some days of a record only."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from waxstudy.diagnosis.estimate.parameter_space import EffectType
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

    @classmethod
    def only(cls, day: int, count: int) -> Days:
        return cls("", tuple(each == day for each in range(count)))

    def share(self, inputs: Inputs, hours: tuple[float, float] | None) -> FloatArray:
        """Return 1 for each interval of these days, 0 for the others (n,); hours over midnight belong to the first."""
        begin_h = hours[0] if hours and hours[0] > hours[1] else 0.0
        middle_h = (inputs.start_s + (np.arange(len(inputs.outdoor_C)) + 0.5) * inputs.interval_s) / 3600.0
        day = np.clip((middle_h - begin_h) // DAY_H, 0, len(self.acts) - 1).astype(int)
        return np.asarray(np.array(self.acts, dtype=float)[day])


def courses(record: Record, inputs: Inputs) -> list[Days]:
    """Return the days that are tried, each once: of the calendar and the week, the coldest, warmest, sunniest, dullest.

    Weather is that of whole days. What depends on it in steps, as a stove that is lit when it is cold, acts on these.
    """
    named = [*of_days(record), *_of_weather(record, inputs)]
    found = {tuple(acts.tolist()): words for words, acts in reversed(named)}
    return [Days(words, acts) for acts, words in found.items() if any(acts) and not all(acts)]


def _of_weather(record: Record, inputs: Inputs) -> Iterator[tuple[str, np.ndarray]]:
    """Yield in words and by day (days,) where it is colder or warmer than between two days, sunnier or duller."""
    day = day_of(record)
    counts = np.bincount(day)
    if not counts.all():
        return
    outdoor = inputs.outdoor_C, "colder", "warmer", ".1f", "C"
    sun = inputs.solar_W, "with less", "with more", ".0f", "W of sun"
    for values, less, more, digits, unit in (outdoor, sun):
        mean = np.bincount(day, values) / counts
        for below, above in pairwise(np.unique(mean).tolist()):
            edge = 0.5 * (below + above)
            yield f"on days {less} than {edge:{digits}} {unit}", mean < edge
            yield f"on days {more} than {edge:{digits}} {unit}", mean > edge


def on_days(effect: EffectType, on: Days) -> EffectType:
    """Return the effect where it acts on some days only, with the same parameters."""

    class OnDays(effect):  # type: ignore[misc, valid-type]
        days = on

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
    found: Days | None = getattr(effect, "days", None)
    return found
