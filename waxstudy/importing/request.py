"""What an import is asked for, and what comes of it."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from waxstudy.importing.limits import HOLD_S
from waxstudy.importing.matching import Match
from waxstudy.importing.reading import Place


@dataclass(frozen=True)
class Request:
    """What the user states; what is not stated is found, or asked."""

    sources: Sequence[Path]
    room: str | None = None
    entities: Mapping[str, str] = field(default_factory=dict)  # by channel; "" for a channel that was not measured
    units: Mapping[str, str] = field(default_factory=dict)  # by entity
    timezone: str | None = None  # "" for clocks on the wall that show standard time all year
    time_format: str | None = None
    begin: pd.Timestamp | None = None  # of times that tell no date
    hold_s: float = HOLD_S
    interval_s: float | None = None

    def command(self, folder: Path) -> str:
        """Return what to type for the same again, without a question."""
        words = ["waxstudy", "import", *map(str, self.sources), "--out", str(folder)]
        words += ["--room", self.room] if self.room else []
        words += ["--timezone", self.timezone] if self.timezone else []
        words += ["--time-format", self.time_format] if self.time_format else []
        words += ["--begin", self.begin.isoformat()] if self.begin is not None else []
        words += ["--hold", f"{self.hold_s:g} s"] if self.hold_s != HOLD_S else []
        words += ["--interval", f"{self.interval_s:g} s"] if self.interval_s else []
        for option, stated in (("--map", self.entities), ("--unit", self.units)):
            words += [word for key, value in stated.items() for word in (option, f"{key}={value}")]
        return shlex.join(words)


@dataclass(frozen=True)
class Imported:
    """Channels on a grid, and how they came about."""

    request: Request  # with everything that was decided
    matches: Mapping[str, Match]
    conversions: Mapping[str, tuple[float, float]]  # scale and offset by channel
    values: pd.DataFrame  # a column per channel, its index the ends of intervals in local standard time
    noise: Mapping[str, float]
    interval_s: float
    unused: Sequence[str]  # entities that are no channel
    warnings: Sequence[str]
    assumptions: Sequence[str]
    place: Place | None = None  # of the weather that was taken
