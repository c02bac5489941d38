"""What is missed of a record, in the currency of its channel.

Of what switches the seconds around each switch at which it is the other way, of a room means over quarters of an hour,
of all else each sample in the channel's unit.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from waxstudy.blind_test.sizes.record import Record
from waxstudy.blind_test.sizes.room import OUTPUTS, in_quarters
from waxstudy.blind_test.sizes.stretch import Shown, Stretch
from waxstudy.plugin import FloatArray

SETTLING_S, SETTLING_SHARE = 6 * 3600.0, 0.1  # at the start, where nobody knows the state of the blocks
JUMP = 0.4  # of a displacement within an interval: nobody knows what flowed meanwhile
DAY_S = 86_400.0
LEAST = 1e-9  # a floor of nothing at all would make any gap a large one

Missed = Mapping[str, FloatArray]  # channel -> errors, NaN where nothing is judged
Gaps = dict[str, float]


def gaps(missed: Missed) -> Gaps:
    """Return the root mean square of each channel's errors."""
    judged = {channel: errors[np.isfinite(errors)] for channel, errors in missed.items()}
    return {c: max(LEAST, float(np.sqrt(np.mean(e**2)))) if len(e) else LEAST for c, e in judged.items()}


def measured(stretch: Stretch, record: Record) -> Shown:
    """Return the judged channels of a record as `Stretch.shown` gives them."""
    return {channel: _measured(stretch, record, channel) for channel in stretch.judged}


def _measured(stretch: Stretch, record: Record, channel: str) -> FloatArray:
    if channel in OUTPUTS and stretch.has_room:
        return in_quarters(record, channel)
    is_smooth = channel in ("sensor_temperature_C", "control_output") and channel not in record.switches
    return record.smooth(record.values[channel]) if is_smooth else record.values[channel]


def missed(stretch: Stretch, record: Record, shown: Shown) -> Missed:
    """Return the errors of what is said to be shown of each judged channel."""
    return {channel: _errors(stretch, record, channel, shown[channel]) for channel in stretch.judged}


def _errors(stretch: Stretch, record: Record, channel: str, shown: FloatArray) -> FloatArray:
    if channel in record.switches:
        return _seconds(record, channel, shown)
    own = _measured(stretch, record, channel)
    known = _settled(record, len(own))
    if stretch.driven_by == "displacement" and not stretch.has_room:
        known &= np.abs(np.diff(record.values["displacement"], prepend=0.0)) < JUMP
    errors = np.where(known, shown - own, np.nan)
    return _best_shift(errors, record.values[stretch.driven_by]) if errors.ndim == 2 else errors


def _settled(record: Record, count: int) -> np.ndarray:
    share = min(SETTLING_S / (len(record) * record.interval_s), SETTLING_SHARE)
    return np.arange(count) >= round(share * count)


def _best_shift(errors: FloatArray, drive: FloatArray) -> FloatArray:
    """Return the errors (n,) of (shifts, n) after each switch of the drive is put where it fits best."""
    segment = np.concatenate(([0], np.cumsum(np.diff(drive) != 0.0)))
    losses = [np.bincount(segment, weights=np.nan_to_num(each) ** 2) for each in errors]
    return np.asarray(errors[np.argmin(losses, axis=0)[segment], np.arange(len(segment))])


def _seconds(record: Record, channel: str, shown: FloatArray) -> FloatArray:
    """Return for how long what is shown differs from the record around each of its switches, or each day."""
    own, known = record.values[channel], _settled(record, len(record))
    edges = np.flatnonzero(np.diff(own) != 0.0) + 1
    days = (np.arange(len(own)) * record.interval_s // DAY_S).astype(int)
    window = (
        np.searchsorted((edges[1:] + edges[:-1]) // 2, np.arange(len(own)), side="right") if len(edges) > 1 else days
    )
    seconds = record.interval_s * np.bincount(window, weights=np.abs(shown - own) * known)
    return np.where(np.bincount(window, weights=known) > 0.5 * np.bincount(window), seconds, np.nan)
