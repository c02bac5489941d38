"""A year of O_0 and O_WM in the fast room and in EnergyPlus: `python -m benchmarks.energyplus WEATHER.epw`.

Setpoint, step and start are the same in both; hourly means are compared, without the first week.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.timing import processor_s
from waxstudy.plugin import TRACE, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.simulation.engine import START, Loop
from waxstudy.simulation.outside import OutsideLoop
from waxstudy.simulation.run import loop_of, prepare
from waxstudy.study.model import Choice, Study
from waxstudy.study.read import read_study

STUDY = Path(__file__).parents[1] / "studies" / "table5_energyplus.toml"
CASES = ("O_0", "O_WM")
WEEK_H = 168
REPEATS = 7


def year_study(weather: Path) -> Study:
    """The ladder under a year of a weather file instead of its two weeks."""
    epw = installed().get("weather", "epw")
    year = epw.Parameters.model_validate({"path": str(weather), "start": "01-01", "days": 365})
    return replace(read_study(STUDY, installed()), weeks={"year": Choice(epw, year)})


def simulated(loop: Loop | OutsideLoop, setpoint_C: float, trace: bool = True) -> tuple[float, FloatArray]:
    """Return the seconds of processor that a year takes, and its record."""
    begin = processor_s()
    (year,) = loop.weeks(setpoint_C, [START], trace=trace)
    return processor_s() - begin, year.trace


def hourly(record: FloatArray, column: str, step_s: float) -> FloatArray:
    values = record[:, TRACE.index(column)].reshape(-1, round(3600.0 / step_s)).mean(axis=1)
    return np.asarray(values[WEEK_H:])


def compare(study: Study, id: str) -> None:
    driven = prepare(study).driven["year"]
    outside = loop_of(study, study.cases[id], driven)
    assert isinstance(outside, OutsideLoop)
    fast, setpoint_C = outside.stand_in, study.comfort.setpoint_C
    _, ours = simulated(fast, setpoint_C)  # the first compiles
    quick_s = min(simulated(fast, setpoint_C, trace=False)[0] for _ in range(REPEATS))
    slow_s, theirs = simulated(outside, setpoint_C)
    print(f"\n{id}: fast room {quick_s:.2f} s, EnergyPlus {slow_s:.1f} s, ratio {slow_s / quick_s:.0f}")
    print(f"{'':28} {'fast room':>10} {'EnergyPlus':>10} {'hourly RMSE':>12} {'correlation':>12}")
    for label, column, unit in (
        ("air", "air_C", "C"),
        ("operative", "operative_C", "C"),
        ("floor surface", "floor_surface_C", "C"),
        ("floor heat", "floor_heat_W_m2", "W/m2"),
        ("water heat", "water_heat_W", "W"),
    ):
        a, b = hourly(ours, column, study.step_s), hourly(theirs, column, study.step_s)
        rmse, correlation = float(np.sqrt(np.mean((a - b) ** 2))), float(np.corrcoef(a, b)[0, 1])
        print(f"{f'mean {label} [{unit}]':28} {a.mean():10.3f} {b.mean():10.3f} {rmse:12.3f} {correlation:12.3f}")


def main() -> None:
    if len(sys.argv) != 2:
        raise SystemExit("usage: python -m benchmarks.energyplus WEATHER.epw")
    study = year_study(Path(sys.argv[1]))
    for id in CASES:
        compare(study, id)


main()
