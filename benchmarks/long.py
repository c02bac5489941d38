"""Time and memory of long runs and long records: `python -m benchmarks.long`, also a part of `make bench`.

They need a year of weather in the folder that `WAXSTUDY_DATA` names.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

from benchmarks.commands import HEADINGS, WAXSTUDY, Cost, command_figure

# two cases: as many workers
STUDY = """
[study]
name = "long"
step_s = {step_s}
[room]
use = "nzeb"
[weather.long]
use = "epw"
path = "{weather}"
start = "01-01"
days = {days}
[ensemble]
members = {members}
[ladder.on-off]
reference = "O_WM"
start = {{ id = "O_0", controller = {{ use = "on-off" }} }}
steps = [{{ id = "O_WM", valve = {{ use = "quick-opening" }}, actuator = {{ use = "variable-times" }} }}]
"""
MEMBERS = 4
SEASON = Path(__file__).parents[1] / "studies" / "season.toml"


def long_figures(folder: Path) -> None:
    weather = next(Path(os.environ.get("WAXSTUDY_DATA", "none"), "weather").glob("*.epw"), None)
    print(f"\nlong runs and records\n{HEADINGS}")
    if weather is None:
        print("left out: WAXSTUDY_DATA names no folder with weather/*.epw")
        return
    week = _run(folder, weather, "a week", 7, "reference")
    year = _run(folder, weather, "a year", 365, "500 MB")
    print(f"{'':40} beside the week: {year.beside(week)}")
    if weather.name in SEASON.read_text(encoding="utf-8"):
        season = ["run", str(SEASON), "--quiet", "--out", str(folder / "season")]
        command_figure("a season of eleven cases, 4 members", season, "500 MB")
    fortnight = _diagnosis(folder, weather, 14, 60, "reference")
    for days, interval_s, limit in ((60, 60, "twice the reference's time"), (14, 1, "1.5 GB")):
        cost = _diagnosis(folder, weather, days, interval_s, limit)
        print(f"{'':40} beside 14 days at 1 min: {cost.beside(fortnight)}")


def _study(folder: Path, weather: Path, days: int, members: int, step_s: float = 5.0) -> str:
    path = folder / f"{days}-{members}-{step_s:g}.toml"
    path.write_text(STUDY.format(weather=weather.resolve(), days=days, members=members, step_s=step_s))
    return str(path)


def _run(folder: Path, weather: Path, span: str, days: int, limit: str) -> Cost:
    label = f"{span} at 5 s, two workers, {MEMBERS} members"
    study = _study(folder, weather, days, MEMBERS)
    return command_figure(label, ["run", study, "--quiet", "--out", str(folder / f"run-{days}")], limit)


def _diagnosis(folder: Path, weather: Path, days: int, interval_s: int, limit: str) -> Cost:
    record = str(folder / f"record-{days}-{interval_s}")
    study = _study(folder, weather, days, 1, min(5.0, interval_s))
    options = ["--case", "O_WM", "--believed", "O_0", "--interval-s", str(interval_s), "--out", record]
    subprocess.run([WAXSTUDY, "reality", study, *options], stdout=subprocess.DEVNULL, check=True)
    label = f"diagnosis of {days} days at {interval_s} s"
    return command_figure(label, ["diagnose", record, "--json", "--quiet"], limit)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        long_figures(Path(place))
