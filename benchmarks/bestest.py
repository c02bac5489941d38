"""Hold the room against ANSI/ASHRAE 140 (BESTEST), cases 600, 900, 600FF and 900FF.

`python -m benchmarks.bestest [--data FOLDER] [--effects]` prints our figures beside the acceptance limits and the
reference programs; `--effects` also prints what each part of the description does. The folder holds the reference
results and the weather, which are not part of this repository; docs/bestest.md and docs/bestest-parts.md
have the tables.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from benchmarks.bestest_cases import case
from benchmarks.ideal_air import hold_air
from waxstudy_paper.room import SurfacesRoom
from waxstudy_paper.weather import Epw

WEATHER = "USA_CO_Denver.Intl.AP.725650_TMY3.epw"
RESULTS = "bestest_reference_results_long.csv"
HEATED, FREE = ("600", "900"), ("600FF", "900FF")
LOADS = ("Annual heating load (MWh)", "Annual cooling load (MWh)", "Peak heating load (kW)", "Peak cooling load (kW)")
EXTREMES = ("Maximum temperature (°C)", "Minimum temperature (°C)")
LIMITS = ["Lower limit", "Upper limit"]
LOWEST_C, HIGHEST_C = 20.0, 27.0

EFFECTS: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "as described": {},
    "g constant over the angle": {"windows": {"panes": 0}},
    "no colder sky": {"films": {"sky_W_m2K": 0.0}},
    "no sun on walls and roof": {"surfaces": {"solar_absorptance": 0.0}},
    "no sun reflected out": {"sun": {"reflected_share": 0.0}},
    "a tenth of the sun to the air": {"sun": {"air_share": 0.1}},
    "window U 2.4": {"windows": {"U_W_m2K": 2.4}},
    "window U 2.8 (EN 673, from its panes)": {"windows": {"U_W_m2K": 2.8}},
    "window U 3.0, g 0.789 (before 2020)": {"windows": {"U_W_m2K": 3.0, "g": 0.789}},
    "g 5 % lower": {"windows": {"g": 0.769 * 0.95}},
    "films of a heated floor (defaults)": {"films": {"ceiling_W_m2K": 0.7, "floor_W_m2K": 5.0}},
    "3.16 W/(m2 K) inside everywhere": {"films": dict.fromkeys(("wall_W_m2K", "ceiling_W_m2K", "floor_W_m2K"), 3.16)},
    "17 W/(m2 K) outside": {"films": {"exterior_W_m2K": 17.0}},
}


def default_folder() -> Path:
    """The folder `bestest` of `WAXSTUDY_DATA`, by default `shared/data` beside the repository."""
    shared = Path(__file__).parents[2] / "shared" / "data"
    return Path(os.environ.get("WAXSTUDY_DATA", shared)) / "bestest"


def figures(folder: Path, name: str, **changes: Any) -> dict[str, float]:
    """Return the figures of a case that the standard asks for; peaks and extremes are means of an hour."""
    room = SurfacesRoom.build(case(name, **changes))
    weather = Epw.load(Epw.Parameters(path=str(folder / WEATHER), start="01-01", days=365), room.facades)
    if name in FREE:
        air_C = hold_air(room, weather).air_C
        return dict(zip(EXTREMES, (float(air_C.max()), float(air_C.min())), strict=True))
    heat_W = hold_air(room, weather, LOWEST_C, HIGHEST_C).heat_W
    heating, cooling = heat_W.clip(min=0.0), -heat_W.clip(max=0.0)
    sums_MWh, peaks_kW = [part.sum() / 1e6 for part in (heating, cooling)], [heating.max() / 1e3, cooling.max() / 1e3]
    return dict(zip(LOADS, map(float, [*sums_MWh, *peaks_kW]), strict=True))


def reference(folder: Path) -> pd.DataFrame:
    """Return the reference results: (quantity, case) by program, and the acceptance limits where there are any."""
    rows = pd.read_csv(folder / RESULTS)
    rows = rows[rows["dup"] == 0].astype({"value": float})  # dup 1 are the hours of peaks and extremes
    return rows.pivot(index=["quantity", "case"], columns="source", values="value")


@dataclass(frozen=True)
class Line:
    """One figure beside its reference."""

    quantity: str
    case: str
    ours: float
    lower: float  # acceptance limit; NaN where the data has none
    upper: float
    programs: pd.Series

    @property
    def outside_programs(self) -> float:
        """How far our figure lies above (or, negative, below) what the programs span; 0 between them."""
        return _outside(self.ours, float(self.programs.min()), float(self.programs.max()))

    @property
    def outside_limits(self) -> float:
        """The same for the acceptance limits; 0 where there are none."""
        return _outside(self.ours, self.lower, self.upper)

    @property
    def verdict(self) -> str:
        limits = "" if pd.isna(self.lower) else f"{_place(self.outside_limits)} limits, "
        return f"{limits}{_place(self.outside_programs)} programs"


def _outside(value: float, lower: float, upper: float) -> float:
    return max(value - upper, 0.0) - max(lower - value, 0.0) if lower <= upper else 0.0


def _place(outside: float) -> str:
    return "within" if outside == 0.0 else f"{abs(outside):.2f} {'above' if outside > 0.0 else 'below'}"


def lines(folder: Path) -> Iterator[Line]:
    """Compute all cases and put each figure beside its reference."""
    known = reference(folder)
    for name in (*HEATED, *FREE):
        for quantity, ours in figures(folder, name).items():
            row = known.loc[(quantity, name)]
            yield Line(quantity, name, ours, *row[LIMITS], row.drop(LIMITS))


def print_table(table: list[Line]) -> None:
    programs = list(table[0].programs.index)
    heads = ["quantity", "case", "ours", "lower", "upper", *programs, "verdict"]
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}")
    for line in table:
        numbers = [line.ours, line.lower, line.upper, *line.programs]
        shown = ["" if pd.isna(number) else f"{number:.2f}" for number in numbers]
        print(f"| {' | '.join([line.quantity, line.case, *shown, line.verdict])} |")


def print_effects(folder: Path) -> None:
    """Print annual loads [MWh], peak heating [kW] and extremes [C] with one part of the description changed."""
    parts = ("heating", "cooling", "peak", "maximum", "minimum")
    heads = ["", *(f"{name} {part}" for name in HEATED for part in parts)]
    print(f"\n| {' | '.join(heads)} |\n|{'---|' * len(heads)}")
    for label, changes in EFFECTS.items():
        shown = []
        for name in HEATED:
            loads, extremes = figures(folder, name, **changes), figures(folder, f"{name}FF", **changes)
            shown += [f"{loads[quantity]:.2f}" for quantity in LOADS[:3]]
            shown += [f"{extremes[quantity]:.1f}" for quantity in EXTREMES]
        print(f"| {' | '.join([label, *shown])} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bestest", description=__doc__)
    parser.add_argument("--data", type=Path, default=default_folder(), help="folder of results and weather")
    parser.add_argument("--effects", action="store_true", help="also what each part of the description does")
    arguments = parser.parse_args()
    if missing := [name for name in (RESULTS, WEATHER) if not (arguments.data / name).is_file()]:
        sys.exit(f"{arguments.data}: no {' and no '.join(missing)}: say where with --data or WAXSTUDY_DATA")
    print_table(list(lines(arguments.data)))
    if arguments.effects:
        print_effects(arguments.data)


if __name__ == "__main__":
    main()
