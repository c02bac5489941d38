"""Print the tables of docs/season.md: `python -m benchmarks.season [FOLDER]`.

What the folder has already is not computed again.
It needs Helsinki's weather year in the folder that `WAXSTUDY_DATA` names.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd

from benchmarks.commands import WAXSTUDY
from waxstudy.api.running import Results
from waxstudy.report.comparison import CORRECTED, HEAT, differences_percent, member_values
from waxstudy.report.season import COLD_SHARE, Months, interval_percent
from waxstudy.results.kpis import months_of
from waxstudy.sweeps.result import read_swept

ROOT = Path(__file__).parents[1]
RUNS = {
    "table5": ["studies/table5.toml"],
    "season": ["studies/season.toml"],
    "shading": ["studies/season.toml", "--sweep", "studies/sweeps/shading.toml"],
}
REFERENCES = {"O": "O_WM", "P": "P_WM"}
BETWEEN = (("O_0", "P_0"), ("O_CP", "P_CP"), ("O_WM", "P_WM"))  # On/Off over PI
PASSES = "room.shading.passes"


def compute(folder: Path) -> None:
    """Run the studies and the sweep, as far as they are not there."""
    for name, words in RUNS.items():
        subprocess.run(
            [WAXSTUDY, "run", *words, "--out", folder / name], cwd=ROOT, check=True, stdout=subprocess.DEVNULL
        )


def differences(weeks: pd.DataFrame, season: pd.DataFrame, bare: pd.DataFrame) -> Iterator[str]:
    """Yield the table of differences: a week, the same corrected for stored heat, a season, one without shading."""
    yield "| % | January | corrected | February | corrected | season | without shading |"
    yield "|---|---|---|---|---|---|---|"
    pairs = [(case, REFERENCES[case[0]]) for case in dict.fromkeys(season["case"]) if case not in REFERENCES.values()]
    for case, other in (*pairs, *BETWEEN):
        of_weeks = [
            differences_percent(weeks, case, other, week, column)
            for week in ("january", "february")
            for column in (HEAT, CORRECTED)
        ]
        told = [f"{values.mean():+.2f} ± {values.std(ddof=1):.2f}" for values in of_weeks]
        told += [_over_months(frame, case, other) for frame in (season, bare)]
        yield f"| {case}{' over ' + other if (case, other) in BETWEEN else ''} | {' | '.join(told)} |"


def _over_months(kpis: pd.DataFrame, case: str, other: str) -> str:
    """The season's difference, and half its 95 % interval over months that have a hundredth of the heat at least."""
    own, its = (_months(kpis, name) for name in (case, other))
    told = its > COLD_SHARE * its.sum()
    return f"{100.0 * (own.sum() / its.sum() - 1.0):+.2f} ± {interval_percent(own[told], its[told]):.2f}"


def _months(kpis: pd.DataFrame, case: str) -> np.ndarray:
    return kpis[kpis["case"] == case][list(months_of(kpis))].mean().to_numpy()


def comfort(season: pd.DataFrame, bare: pd.DataFrame) -> Iterator[str]:
    """Yield the table of comfort, with and without shading."""
    figures = ("setpoint_shift_K", "mae_K", "over_setpoint_1K_share", "in_category_II_share", "operative_max_C")
    yield "| case | shift, K | MAE, K | over 1 K warm, % | in category II, % | highest, °C | heat, kWh/m² |"
    yield "|---|---|---|---|---|---|---|"
    for case in dict.fromkeys(season["case"]):
        cells = []
        pairs = [[float(np.mean(member_values(f, case, "season", name))) for f in (season, bare)] for name in figures]
        for (with_it, without), (scale, form) in zip(
            pairs, ((1, "+.2f"), (1, ".2f"), (100, ".0f"), (100, ".1f"), (1, ".1f")), strict=True
        ):
            cells.append(f"{scale * with_it:{form}} / {scale * without:{form}}")
        cells.append(" / ".join(f"{_months(f, case).sum():.1f}" for f in (season, bare)))
        yield f"| {case} | {' | '.join(cells)} |"


def by_month(rows: list[Months]) -> Iterator[str]:
    """Yield heat of the references and differences by month."""
    names = list(rows[0].heat_kWh_m2)
    yield f"| | {' | '.join(name[5:] for name in names)} |"
    yield "|---" * (len(names) + 1) + "|"
    for row in rows:
        if row.case in REFERENCES.values():
            yield f"| heat of {row.case}, kWh/m² | {' | '.join(f'{row.heat_kWh_m2[n]:.2f}' for n in names)} |"
    for row in rows:
        if row.difference_percent:
            told = [row.difference_percent[name] for name in names]
            yield f"| {row.case}, % | {' | '.join('' if np.isnan(v) else f'{v:+.1f}' for v in told)} |"


def tables(folder: Path) -> Iterator[str]:
    """Yield the lines of all tables of the page."""
    weeks, season = (Results(folder / name) for name in ("table5", "season"))
    swept = read_swept(folder / "shading").frame
    bare = swept[swept[PASSES] == 1.0]
    yield from (*differences(weeks.kpis, season.kpis, bare), "")
    yield from (*by_month(list(season.content.months)), "")
    yield from comfort(season.kpis, bare)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/season-page")
    compute(folder.absolute())
    print("\n".join(tables(folder)))


if __name__ == "__main__":
    main()
