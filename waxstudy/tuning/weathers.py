"""Weather to tune on, and weather that takes no part and is tested on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from waxstudy.plugin import Choice
from waxstudy.study.model import Drawn, Study


@dataclass(frozen=True)
class Split:
    """A study on the weather that is tuned on, and on all other that it has (None: there is none), with their words."""

    tuned: Study
    tested: Study | None
    tuned_words: str
    tested_words: str


def split(study: Study, weeks: Sequence[str]) -> Split:
    """Divide a study's weather: of a week that is tuned on and has several, every second one is kept for the test."""
    tuned: dict[str, Sequence[Choice]] = {}
    tested: dict[str, Sequence[Choice]] = {}
    for week in study.weeks:
        choices = study.weathers(week)
        tuned[week], tested[week] = (choices[::2], choices[1::2]) if week in weeks else ((), choices)
    of = [_of(study, part) for part in (tuned, tested)]
    words = [_words(study, part) for part in (tuned, tested)]
    assert of[0], "a week is tuned on"
    return Split(of[0], of[1], *words)


def _of(study: Study, weathers: dict[str, Sequence[Choice]]) -> Study | None:
    kept = {week: choices for week, choices in weathers.items() if choices}
    drawn = {week: Drawn(study.drawn[week].keys, each) for week, each in kept.items() if len(each) > 1}
    weeks = {week: choices[0] for week, choices in kept.items()}
    return replace(study, weeks=weeks, drawn=drawn) if kept else None


def _words(study: Study, weathers: dict[str, Sequence[Choice]]) -> str:
    told = []
    for week, choices in weathers.items():
        of = study.weathers(week)
        places = [str(place + 1) for place, choice in enumerate(of) if any(choice is each for each in choices)]
        if places:
            told.append(f"{week} (weathers {', '.join(places)} of {len(of)})" if len(places) < len(of) else week)
    return ", ".join(told)
