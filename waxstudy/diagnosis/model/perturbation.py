"""What noise does to the drive of a segment: the drive, perturbed by as much noise as it may hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class Perturbation:
    """How the drive of a segment is perturbed, to see what its noise does: random numbers, or none."""

    random: np.random.Generator | None = None
    is_twice: bool = True  # smoothed once more, which shows what smoothing does

    def temperature(self, record: Record, channel: str) -> FloatArray:
        """Return the smoothed channel, perturbed by as much noise as smoothing leaves."""
        values = record.drive(channel)
        if self.random is None:
            return values
        spread = float(np.hypot(record.noise[channel], record.between(channel)))
        noise = self.random.normal(0.0, spread, len(values))
        return record.smooth(values + noise) if self.is_twice else values + record.smooth(noise)

    def raw(self, record: Record, channel: str) -> FloatArray:
        """Return the channel as it was logged, perturbed by its noise once more."""
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
