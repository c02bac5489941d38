"""A study: what a study file says once it is read, checked, and all defaults are filled in."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import Any, Self

from pydantic import field_validator, model_validator

from waxstudy.plugin import Choice as Choice
from waxstudy.plugin import Parameters, parameter
from waxstudy.study.activation import Activation

NAME_RULE = "must be at most 64 letters a to z, digits, '_', '-' or '.', with a letter or digit at both ends"
NAME_PATTERN = r"[A-Za-z0-9]([A-Za-z0-9_.-]{0,62}[A-Za-z0-9])?"
HOUR_S = 3600.0


def is_safe_name(name: object) -> bool:
    """Whether a name can be part of a file name on any system."""
    return isinstance(name, str) and bool(re.fullmatch(NAME_PATTERN, name))


def is_multiple(value: float, of: float) -> bool:
    """Whether a time is a whole number of others, but for rounding: 3600 is one of 0.1."""
    count = round(value / of)
    return count >= 1 and abs(count * of - value) <= 1e-9 * value


@dataclass(frozen=True)
class Case:
    """One chain; `blocks` holds the kinds that are present, in the order of the chain."""

    id: str
    ladder: str
    blocks: Mapping[str, Choice]

    def described(self) -> dict[str, object]:
        return {"id": self.id, **{kind: choice.described() for kind, choice in self.blocks.items()}}


@dataclass(frozen=True)
class Drawn:
    """The weathers of a week that the ensemble is drawn over, and the parameters in which they differ."""

    keys: Sequence[str]
    choices: Sequence[Choice]

    def described(self) -> dict[str, object]:
        stated = [choice.described() for choice in self.choices]
        return {key: [each.get(key) for each in stated] for key in self.keys}


@dataclass(frozen=True)
class Ladder:
    """Case ids in the order of the file, and the case that the others are compared with."""

    name: str
    reference: str
    cases: Sequence[str]


class StudyTable(Parameters):
    """`[study]`"""

    name: str = parameter(unit="", description="name of the study and of its run folder", source="given by the user")
    step_s: float = parameter(
        5.0,
        unit="s",
        description="time step, which must divide the hour",
        source="the paper's actuator model needs 5 s; the bounds are chosen",
        ge=0.01,
        le=60.0,
    )

    against: str | None = parameter(
        None,
        unit="",
        description="published figures that `waxstudy run` puts beside its own",
        source="given by the user; `paper` is built in",
    )

    @field_validator("name")
    @classmethod
    def _is_safe(cls, name: str) -> str:
        if not is_safe_name(name):
            raise ValueError(NAME_RULE)
        return name

    @field_validator("step_s")
    @classmethod
    def _divides_the_hour(cls, step_s: float) -> float:
        if not is_multiple(HOUR_S, of=step_s):
            raise ValueError("must divide the hour, as 1, 2, 5, 10 or 60 s do")
        return step_s


class Comfort(Parameters):
    """`[comfort]`: every case is shifted to equal comfort."""

    setpoint_C: float = parameter(
        21.0,
        unit="C",
        description="setpoint before the shift",
        source="section 4.3, Table 5; bounds chosen",
        ge=5.0,
        le=40.0,
    )
    operative_limit_C: float = parameter(
        21.0,
        unit="C",
        description="operative temperature that counts as comfortable",
        source="section 3.3; bounds chosen",
        ge=5.0,
        le=40.0,
    )
    hours_below_per_week: float = parameter(
        33.0,
        unit="h/week",
        description="time below that limit after the shift",
        source="section 3.3: 20 % of the week (EN 16798-2)",
        gt=0.0,
        lt=168.0,
    )


class Season(Parameters):
    """`[season]`: comfort is counted on heating days only, found from the outdoor temperature or given."""

    limit_C: float = parameter(
        10.0,
        unit="C",
        description="running mean outdoor temperature of the days before, below which a day is a heating day",
        source="EN 16798-1: its limits for warm seasons begin at 10 C; bounds chosen",
        ge=-30.0,
        le=30.0,
    )
    first_day: str | None = parameter(
        None, unit="", description="first heating day as MM-DD, in place of that rule", source="given by the user"
    )
    last_day: str | None = parameter(None, unit="", description="last heating day as MM-DD", source="given by the user")

    @field_validator("first_day", "last_day")
    @classmethod
    def _is_a_day(cls, day: str | None) -> str | None:
        if day is None:
            return None
        try:
            if not re.fullmatch(r"\d\d-\d\d", day):
                raise ValueError
            return f"{date.fromisoformat(f'2000-{day}'):%m-%d}"
        except ValueError:
            raise ValueError(f"'{day}' is not a day of the year as MM-DD") from None

    @model_validator(mode="after")
    def _both_or_none(self) -> Self:
        if (self.first_day is None) != (self.last_day is None):
            raise ValueError("first_day and last_day belong together: give both, or none")
        if self.first_day is not None and "limit_C" in self.model_fields_set:
            raise ValueError("limit_C is a rule for days that are not given: leave it out, or first_day and last_day")
        return self


class Ensemble(Parameters):
    """`[ensemble]`: initial states shared by all cases; `[ensemble.weather.WEEK]` is in `Study.drawn`."""

    members: int = parameter(
        16, unit="1", description="initial states; 1 gives a single run", source="chosen", ge=1, le=1000
    )
    seed: int = parameter(1, unit="1", description="seed of the initial states", source="chosen", ge=0)


class Output(Parameters):
    """`[output]`: traces that are kept."""

    trace_interval_s: float = parameter(
        60.0,
        unit="s",
        description="interval of the traces, a multiple of the step",
        source="chosen",
        gt=0.0,
        le=HOUR_S,
    )
    trace_members: int = parameter(1, unit="1", description="members with traces", source="chosen", ge=0, le=1000)


def _stated(season: Season) -> dict[str, Any]:
    """Return a season in the study file's words: its days, or else the rule."""
    return season.model_dump(exclude_none=True, exclude={"limit_C"} if season.first_day else set())


@dataclass(frozen=True)
class Study:
    """Everything a run needs. Weeks and cases keep the order of the file.

    `fragments` are the files that blocks were taken from, with their hashes; the blocks hold what they said.
    `file` is the study's own, None of a study that was made otherwise. `drawn` has the weeks of which the ensemble
    has several weathers; `activation` the fleet that is switched instead of the cases being compared. Without a
    `season` comfort counts all the time.
    """

    name: str
    step_s: float
    against: str | None
    room: Choice
    weeks: Mapping[str, Choice]
    comfort: Comfort
    ensemble: Ensemble
    output: Output
    ladders: Mapping[str, Ladder]
    cases: Mapping[str, Case]
    fragments: Mapping[str, str] = field(default_factory=dict)
    file: Path | None = field(default=None, compare=False)
    drawn: Mapping[str, Drawn] = field(default_factory=dict)
    activation: Activation | None = None
    season: Season | None = None

    def weathers(self, week: str) -> Sequence[Choice]:
        """Return what a week is drawn from: the weather that its table states, where nothing else is said."""
        return self.drawn[week].choices if week in self.drawn else (self.weeks[week],)

    def described(self) -> dict[str, Any]:
        """The resolved study in the study file's words; reading it again gives the same study."""
        against = {} if self.against is None else {"against": self.against}
        return {
            "study": {"name": self.name, "step_s": self.step_s, **against},
            "room": self.room.described(),
            "weather": {week: choice.described() for week, choice in self.weeks.items()},
            "comfort": self.comfort.model_dump(),
            **({"season": _stated(self.season)} if self.season else {}),
            "ensemble": {**self.ensemble.model_dump(), **self._drawn()},
            "output": self.output.model_dump(),
            "ladder": {name: self._ladder(ladder) for name, ladder in self.ladders.items()},
            **({"activation": self.activation.described()} if self.activation else {}),
        }

    def _drawn(self) -> dict[str, object]:
        return {"weather": {week: drawn.described() for week, drawn in self.drawn.items()}} if self.drawn else {}

    def _ladder(self, ladder: Ladder) -> dict[str, object]:
        start, *steps = [self.cases[id].described() for id in ladder.cases]
        return {"reference": ladder.reference, "start": start, "steps": steps}
