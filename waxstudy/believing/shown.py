"""What a record itself shows of a loop, so that nobody has to be asked."""

from __future__ import annotations

import numpy as np

from waxstudy.believing import typical
from waxstudy.dataset.pulses import pulses_of
from waxstudy.dataset.read import Dataset

FLOW, SUPPLY, OUTDOORS = "flow_L_h", "supply_temperature_C", "outdoor_temperature_C"
FEWEST = 20  # samples that show a flow or a curve
OPEN = 0.5  # of the largest flow: the valve is open
WIDE_K = 2.0  # standard deviation of outdoors from which on a record tells the slope
ENDS_C = (-20.0, 20.0)  # between which a curve is told


def full_flow_L_h(record: Dataset) -> float | None:
    """Return the usual flow with the valve open."""
    if FLOW not in record.values:
        return None
    if pulses := pulses_of(record.values):
        return round(pulses.usual_L_h, 1)
    flow_L_h = record.values[FLOW].dropna().to_numpy(dtype=float)
    is_open = flow_L_h > OPEN * np.quantile(flow_L_h, 0.99) if len(flow_L_h) else flow_L_h > 0.0
    return round(float(np.median(flow_L_h[is_open])), 1) if np.count_nonzero(is_open) >= FEWEST else None


def heating_curve_C(record: Dataset) -> tuple[tuple[float, float], ...] | None:
    """Return two points of the straight line of supply over outdoors while water flows."""
    if SUPPLY not in record.values or OUTDOORS not in record.values:
        return None
    rows = record.values
    if FLOW in rows:
        rows = rows[rows[FLOW] > OPEN * rows[FLOW].quantile(0.99)]
    rows = rows[[OUTDOORS, SUPPLY]].dropna()
    if len(rows) < FEWEST:
        return None
    outdoor_C, supply_C = rows.to_numpy(dtype=float).T
    (cold_C, warmest_C), (mild_C, coolest_C) = typical.CURVE_C
    slope = (coolest_C - warmest_C) / (mild_C - cold_C)
    if np.std(outdoor_C) >= WIDE_K:
        slope = min(0.0, float(np.polyfit(outdoor_C, supply_C, 1)[0]))
    level_C = float(np.mean(supply_C) - slope * np.mean(outdoor_C))
    return tuple((end_C, round(level_C + slope * end_C, 1)) for end_C in ENDS_C)
