"""What follows the valve: water is warm while it is open, a room a good while later, the air outdoors never."""

from __future__ import annotations

import numpy as np

from waxstudy.importing.limits import FEWEST_TO_FOLLOW, LATER_NS
from waxstudy.importing.reading import Logged


def following(logged: Logged, valve: Logged) -> float:
    """Return the correlation of readings with what the valve was a quarter of an hour before; 0 where none is seen."""
    place = np.searchsorted(valve.ns, logged.ns - LATER_NS, side="right") - 1
    opened = np.where(place >= 0, valve.values[place], np.nan)
    is_known = np.isfinite(opened) & np.isfinite(logged.values)
    values, opened = logged.values[is_known], opened[is_known]
    if len(values) < FEWEST_TO_FOLLOW or values.std() == 0.0 or opened.std() == 0.0:
        return 0.0
    return float(np.corrcoef(values, opened)[0, 1])
