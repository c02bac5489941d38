"""The clock of a modulator, which counts its periods from when it was switched on: no record tells when."""

from __future__ import annotations

import numpy as np

from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import Modulator
from waxstudy.study.model import Choice

FEWEST_RISES = 8
TINY = 1e-6  # of a sample: rounding
LEAST_RHYTHM = 0.5  # length of the mean of all pulses' directions on the clock's face


def late_s(record: Record, modulator: Choice | None) -> float:
    """Return how late a modulator's periods begin by the record's clock, from where its pulses begin.

    0 where they are seen as those of a clock that is right are: from half a sample early, by a logger that writes
    down what begins, to a sample late. Also where the pulses have no such period, or where nothing shows them.
    """
    if modulator is None or "heating_signal" not in record.binary:
        return 0.0
    assert issubclass(modulator.component, Modulator)
    rises_s = record.rises_s
    if not modulator.component.period or len(rises_s) < FEWEST_RISES:
        return 0.0
    period_s: float = getattr(modulator.parameters, modulator.component.period)
    face = complex(np.mean(np.exp(2j * np.pi * rises_s / period_s)))
    mean_s = float(np.angle(face)) / (2.0 * np.pi) * period_s
    # most pulses begin with their period: the median leaves out the few that do not
    late = mean_s + float(np.median((rises_s - mean_s + 0.5 * period_s) % period_s - 0.5 * period_s))
    is_right = -(0.5 + TINY) <= late / record.interval_s <= 1.0
    return late if abs(face) > LEAST_RHYTHM and not is_right else 0.0
