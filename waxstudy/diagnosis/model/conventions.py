"""Ways to read a record where its words leave a choice, and what noise does to what drives a segment."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class Convention:
    """A way to read a record where its words leave a choice."""

    words: str = ""  # a sentence for the report
    is_before: bool = False  # the sensor's temperature was logged before what the sensor does to it
    is_raw: bool = False  # the controller reads the noise that was logged
    is_late: bool = False  # the controller reads the temperature of a sample ago
    solar_factor: float = 1.0  # the sun's heat over what was recorded of it
    is_mean: bool = False  # temperatures were logged as means over the interval, not at its end
    handicap: float = 0.0  # loss by which it must be better than the others

    def differs(self, other: Convention) -> int:
        """Return in how many of its choices it differs: the sensor's log, the sun's heat, the room's temperatures."""
        pairs = zip(self._choices, other._choices, strict=True)
        return sum(one != another for one, another in pairs)

    @property
    def _choices(self) -> tuple[Any, ...]:
        return (self.is_before, self.is_raw, self.is_late), self.solar_factor, self.is_mean


AFTER = Convention("The sensor temperature was logged as the controller reads it.")
BEFORE = Convention("The sensor temperature was logged before the sensor's delay or lag.", is_before=True)
RAW = Convention(
    "The controller reads the sensor temperature with the noise that was logged.", is_raw=True, handicap=60.0
)
LATE = Convention("The controller decides once a sample, on the temperature of the last.", is_late=True, handicap=60.0)
PLAIN = Convention()
MEAN = "The room's temperatures were logged as means over the interval."
LONG_S = 300.0  # interval from which on that matters


@dataclass(frozen=True)
class Perturbation:
    """How the drive of a segment is shaken to see what its noise does: random numbers, or none."""

    random: np.random.Generator | None = None
    is_twice: bool = True  # smoothed once more, which shows what smoothing does

    def temperature(self, record: Record, channel: str) -> FloatArray:
        """Return the smoothed channel, shaken with as much noise as smoothing leaves."""
        values = record.drive(channel)
        if self.random is None:
            return values
        spread = float(np.hypot(record.noise[channel], record.between(channel)))
        noise = self.random.normal(0.0, spread, len(values))
        return record.smooth(values + noise) if self.is_twice else values + record.smooth(noise)

    def raw(self, record: Record, channel: str) -> FloatArray:
        """Return the channel as it was logged, shaken with its noise once more."""
        values = record.filled(channel)
        return values if self.random is None else values + self.random.normal(0.0, record.noise[channel], len(values))

    def opening(self, record: Record) -> FloatArray:
        values = record.drive("displacement")
        if self.random is None:
            return values
        noise = self.random.normal(0.0, record.noise["displacement"], len(values))
        return np.where((values > 0.0) & (values < 1.0), np.clip(values + noise, 0.0, 1.0), values)

    def output(self, record: Record) -> FloatArray:
        """Return the controller's output, a sample early or late: nobody knows when in an interval it was read."""
        values = record.drive("control_output")
        if self.random is None:
            return values
        at = np.arange(len(values)) + self.random.integers(-1, 2, len(values))
        return np.asarray(values[np.clip(at, 0, len(values) - 1)])

    def jump(self, record: Record) -> FloatArray:
        """Return after which part of each interval a switch jumps: halfway, or anywhere."""
        return np.full(len(record), 0.5) if self.random is None else self.random.random(len(record))


STILL = Perturbation()
