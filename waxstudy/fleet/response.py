"""What fleets make of their loops: sums over them, with the band that other fleets of the same kind would fill."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

from waxstudy.fleet.figures import later_steps
from waxstudy.plugin import FloatArray
from waxstudy.study.activation import ActivationTable

FLEETS = 400  # drawn from the loops with replacement
BAND = (0.025, 0.975)
CALL = ["week", "state", "at_h"]
CHANNELS = {"added_W": "W", "flow_L_h": "L/h", "flow_share": "1", "later_W": "W"}
UNITS = {
    "week": "1",
    "state": "1",
    "at_h": "h",
    "time_s": "s",
    **{f"{name}{end}": unit for name, unit in CHANNELS.items() for end in ("", "_low", "_high")},
}


@dataclass(frozen=True)
class Band:
    """A figure of the fleet, and between which values other fleets have it."""

    value: float
    low: float
    high: float

    @classmethod
    def of(cls, value: float, others: FloatArray) -> Band:
        """Return a figure with the band of what other fleets have of it; infinity is a figure too."""
        low, high = np.quantile(others, BAND, method="inverted_cdf")
        return cls(float(value), float(low), float(high))


class Fleets:
    """A fleet, and others drawn from its loops: how often each has each loop (fleets, loops)."""

    def __init__(self, loops: int, seed: int) -> None:
        random = np.random.default_rng([seed, loops])
        others = random.multinomial(loops, np.full(loops, 1.0 / loops), size=FLEETS)
        self.counts = np.vstack((np.ones(loops), others))

    def means(self, values: FloatArray) -> FloatArray:
        """Return the mean over loops (fleets, ...) of values (loops, ...)."""
        return np.asarray(self.counts @ values / len(values))

    def mean(self, values: npt.ArrayLike) -> Band:
        """Return the mean over loops of a value (loops,)."""
        found = self.means(np.asarray(values, dtype=float))
        return Band.of(found[0], found[1:])


def calls(loops: pd.DataFrame) -> Iterator[tuple[tuple[str, str, float], pd.DataFrame]]:
    """Give each week, state and time of a call with its loops, in the order of the study."""
    for _, rows in loops.groupby(CALL, sort=False):
        week, state, at_h = tuple(rows[CALL].iloc[0])
        yield (str(week), str(state), float(at_h)), rows


def response(loops: pd.DataFrame, call: ActivationTable, step_s: float) -> pd.DataFrame:
    """Return the whole fleet's response: a row for each time after the call, NaN where a channel is not sampled.

    What is `added` is beyond what the loops take without the call; the call itself is sampled step by step, what
    comes `later` in means over `later_steps` that end at `time_s`, and begins with the call.
    """
    fleets, frames = Fleets(call.loops, call.seed), []
    for (week, state, at_h), rows in calls(loops):
        place = {"week": week, "state": state, "at_h": at_h}
        channels = samples(rows)
        now = {name: channels[name] for name in ("added_W", "flow_L_h", "flow_share")}
        frames.append(_frame(place, fleets, now, step_s).assign(**_nothing("later_W")))
        later = _frame(place, fleets, {"later_W": channels["later_W"]}, later_steps(step_s) * step_s)
        frames.append(later.assign(**{name: np.nan for key in now for name in _nothing(key)}))
    return pd.concat(frames, ignore_index=True)[list(UNITS)]


def samples(rows: pd.DataFrame) -> dict[str, FloatArray]:
    """Return each channel of the loops of one call (loops, samples)."""
    series = {name: np.stack(list(rows[name])) for name in ("heat_W", "without_W", "flow_L_h", "later_W")}
    most = rows["full_flow_L_h"].to_numpy(dtype=float)[:, None]
    return {
        "added_W": series["heat_W"] - series["without_W"],
        "flow_L_h": series["flow_L_h"],
        "flow_share": series["flow_L_h"] / most,
        "later_W": series["later_W"],
    }


def _nothing(name: str) -> dict[str, float]:
    return {f"{name}{end}": np.nan for end in ("", "_low", "_high")}


def _frame(place: dict[str, object], fleets: Fleets, channels: dict[str, FloatArray], every_s: float) -> pd.DataFrame:
    columns: dict[str, FloatArray] = {}
    for name, values in channels.items():
        times = 1.0 if name == "flow_share" else float(len(values))
        found = times * fleets.means(values)
        low, high = np.quantile(found[1:], BAND, axis=0)
        columns |= {name: found[0], f"{name}_low": low, f"{name}_high": high}
    count = len(next(iter(columns.values())))
    return pd.DataFrame({**place, "time_s": (np.arange(count) + 1.0) * every_s, **columns})
