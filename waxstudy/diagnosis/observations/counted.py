"""A record whose flow was counted in pulses, with what flowed between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from waxstudy.dataset.pulses import Pulses, shows_opening
from waxstudy.diagnosis.observations.record import FLOW, Record


def with_pulses(record: Record) -> Record:
    """Return a record with the mean flow between pulses where it was counted so, another one as it is."""
    if not record.has(FLOW):
        return record
    flow, told_by = record.values[FLOW], shows_opening(record.values)
    opening = record.drive(told_by) if told_by else np.ones(len(record))
    pulses = Pulses.of(flow, opening)
    if pulses is None:
        return record
    found = replace(record, values={**record.values, FLOW: pulses.spread(flow, opening)}, pulses=pulses)
    noise = pulses.noise(found.usual_flow_L_h)[pulses.ends]
    return replace(found, stated_noise={**record.stated_noise, FLOW: float(np.sqrt(np.mean(noise**2)))})
