"""The table of an activation: a row for each week, state and call, each figure with its band."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from waxstudy.fleet.response import Band, Fleets, calls, samples
from waxstudy.plugin import FloatArray
from waxstudy.study.activation import ActivationTable

MEGAWATT = 1e6
MEANS = ("opening_before", "warmer_K", "colder_K", "below_min", "below_without_min", "idle_share")


@dataclass(frozen=True)
class Row:
    """What one call finds and does, on the mean over the loops; heat is counted beyond what is taken without the call.

    `limit_W` is what a loop gives at the limit, `firm_W` the least from there to the end of the call; what a call to
    switch off takes away counts as given. Reserve that is not there needs infinitely many loops.
    """

    week: str
    state: str
    at_h: float
    loops: int
    opening_before: float
    flow_share: Band  # of loops with 90 % of flow within the limit (or a tenth, when switched off)
    opening_share: Band  # of loops fully open (or closed) within the limit
    slowest_s: float  # longest time to full opening (or to closing); NaN if a loop has not answered when the call ends
    limit_W: Band
    firm_W: Band
    mean_W: Band
    added_Wh: Band
    early_Wh: Band
    later_Wh: Band
    loops_per_MW_heat: Band
    loops_per_MW_electric: Band
    warmer_K: float  # operative temperature, most above that without the call
    colder_K: float  # most below it
    coldest_C: float
    warmest_C: float
    below_min: float
    below_without_min: float
    idle_share: float


def rows(loops: pd.DataFrame, call: ActivationTable, step_s: float) -> list[Row]:
    """Return the table's rows, in the order of the study."""
    fleets = Fleets(call.loops, call.seed)
    return list(_rows(loops, call, step_s, fleets))


def _rows(loops: pd.DataFrame, call: ActivationTable, step_s: float, fleets: Fleets) -> Iterator[Row]:
    sign = 1.0 if call.signal == "on" else -1.0
    for (week, state, at_h), of in calls(loops):
        given_W = sign * fleets.means(samples(of)["added_W"])
        since_limit_W = given_W[:, max(0, round(call.limit_s / step_s) - 1) :]  # a sample is at the end of its step
        firm_W = since_limit_W.min(axis=1)
        heat = np.divide(MEGAWATT, firm_W, out=np.full_like(firm_W, np.inf), where=firm_W > 0.0)
        mean = {name: float(of[name].mean()) for name in MEANS}
        yield Row(
            week=week,
            state=state,
            at_h=at_h,
            loops=len(of),
            flow_share=fleets.mean(of["flow_s"] <= call.limit_s),
            opening_share=fleets.mean(of["opening_s"] <= call.limit_s),
            slowest_s=float(of["opening_s"].max(skipna=False)),
            limit_W=_band(since_limit_W[:, 0]),
            firm_W=_band(firm_W),
            mean_W=_band(given_W.mean(axis=1)),
            added_Wh=fleets.mean(of["added_Wh"]),
            early_Wh=fleets.mean(of["early_Wh"]),
            later_Wh=fleets.mean(of["later_Wh"]),
            loops_per_MW_heat=_band(heat),
            loops_per_MW_electric=_band(heat * call.cop),
            coldest_C=float(of["coldest_C"].min()),
            warmest_C=float(of["warmest_C"].max()),
            **mean,
        )


def _band(of_fleets: FloatArray) -> Band:
    return Band.of(float(of_fleets[0]), of_fleets[1:])


def idle_warnings(table: list[Row], call: ActivationTable) -> Iterator[str]:
    """Yield which states let water flow while nobody asks for heat, such as a standby with pulses that are too long."""
    seen = {row.state: row.idle_share for row in table if row.idle_share > call.idle_limit}
    for state, share in seen.items():
        yield (
            f"state '{state}': water flows though nobody asks for heat, {100.0 * share:.1f} % of the full flow on the "
            f"mean (idle_limit {100.0 * call.idle_limit:g} %): pulses of its modulator open valves"
        )
