"""A record whose flow was counted in pulses, with what flowed between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from waxstudy.dataset.pulses import Pulses, opening_channel
from waxstudy.diagnosis.observations.record import FLOW, Record


def with_pulses(record: Record) -> Record:
    """Return a record with what flowed between pulses where its flow was counted so, another one as it is."""
    if not record.has(FLOW):
        return record
    flow, told_by = record.values[FLOW], opening_channel(record.values)
    opening = record.drive(told_by) if told_by else np.ones(len(record))
    pulses = Pulses.of(flow, opening)
    if pulses is None:
        return record
    return replace(record, values={**record.values, FLOW: pulses.spread(flow, opening)}, pulses=pulses)
