"""Sobol indices of a sweep: which share of a figure's variance each parameter makes, alone and with the others.

Estimated by SALib from Saltelli's design, with bootstrapped 95 % intervals (Saltelli et al., 2010, for both orders).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass

import numpy as np

from waxstudy.report.formats import csv_text, markdown, terminal
from waxstudy.report.table import Column, Table, text
from waxstudy.report.words import with_spread
from waxstudy.results.folder import RunError
from waxstudy.results.json_text import json_text
from waxstudy.sweeps.axes import problem, salib
from waxstudy.sweeps.result import Swept

WORDS = {
    "heat_corrected_kWh_m2_week": "corrected heat",
    "heat_kWh_m2_week": "heat",
    "setpoint_shift_K": "shift",
    "mae_K": "MAE",
    "cycles_per_week": "cycles",
}
SEED = 1  # of the bootstrap


@dataclass(frozen=True)
class Index:
    """What one parameter does to a figure of a case in a week: shares of its variance, with half their intervals."""

    case: str
    week: str
    figure: str
    parameter: str
    first: float
    first_half_width: float
    total: float
    total_half_width: float


def indices(swept: Swept) -> list[Index]:
    """Return the indices of every figure that varies.

    Raises `RunError` for a sweep that was not drawn for it or lacks points, and `BackendMissing` without SALib.
    """
    if swept.method != "sobol":
        raise RunError(f'{swept.folder}: drawn as {swept.method}; indices need method = "sobol" in its [sweep]')
    if swept.failed:
        raise RunError(f"{swept.folder}: {len(swept.failed)} points failed; indices need all {swept.points}")
    if swept.points < 2 * (len(swept.keys) + 2):
        raise RunError(f"{swept.folder}: samples = 1 tells no interval; indices need 2 at least, and more to be narrow")
    return list(_indices(swept))


def _indices(swept: Swept) -> Iterator[Index]:
    analyse = salib("SALib.analyze.sobol").analyze
    means = swept.frame.groupby(["case", "week", "point"], sort=False)[list(WORDS)].mean()
    for (case, week), group in means.groupby(level=["case", "week"], sort=False):
        for figure in WORDS:
            values = group[figure].to_numpy()
            if not np.all(np.isfinite(values)) or np.ptp(values) == 0.0:
                continue
            found = analyse(problem(swept.keys), values, calc_second_order=False, seed=SEED)
            rows = zip(swept.keys, found["S1"], found["S1_conf"], found["ST"], found["ST_conf"], strict=True)
            for key, *numbers in rows:
                yield Index(str(case), str(week), figure, key, *map(float, numbers))


def render(found: list[Index], swept: Swept, form: str, width: int = 100, colour: bool = False) -> str:
    """Return the indices in one of the formats `table`, `csv`, `md` or `json`."""
    if form == "json":
        return json_text(
            {"sweep": str(swept.folder), "points": swept.points, "indices": [asdict(each) for each in found]}
        )
    if form == "csv":
        return csv_text(Table("", [Column(name) for name in Index.__dataclass_fields__], found))
    told = [
        "alone ± half its 95 % interval: share of the figure's variance that the parameter makes by itself",
        "with others: its share with everything that it does together with others",
    ]
    tables = list(_tables(found))
    return (
        markdown(f"{swept.study}: sensitivity", tables, told) if form == "md" else terminal(tables, told, width, colour)
    )


def _tables(found: list[Index]) -> Iterator[Table[Index]]:
    columns: list[Column[Index]] = [
        text("case"),
        text("figure", lambda index: WORDS[index.figure]),
        text("parameter"),
        Column("first", lambda index: _share(index.first, index.first_half_width), heading="alone"),
        Column("total", lambda index: _share(index.total, index.total_half_width), heading="with others"),
    ]
    for week in dict.fromkeys(index.week for index in found):
        yield Table(
            f"{week}: what the variance of each figure comes from", columns, [i for i in found if i.week == week]
        )


def _share(value: float, half_width: float) -> str:
    return "" if math.isnan(value) else with_spread(value, half_width, ".2f")
