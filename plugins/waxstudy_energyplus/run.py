"""Run a room in EnergyPlus, in a process of its own."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable, Mapping
from pathlib import Path

from waxstudy.plugin import Advance, FloatArray, Refused, WeatherRecord
from waxstudy.results.atomic import scratch_folder
from waxstudy.simulation.engine import START, WARM_UP_DAYS, Start
from waxstudy.simulation.own_process import ask
from waxstudy.study.model import is_multiple
from waxstudy_energyplus.error_file import error_file
from waxstudy_energyplus.library import MODEL, WEATHER, EnergyPlusError, installed_version
from waxstudy_energyplus.loop import MINUTE_S, Job
from waxstudy_energyplus.model import Model, model
from waxstudy_energyplus.record import Simulated
from waxstudy_energyplus.weather_file import still_year
from waxstudy_paper.room.description import RoomDescription


def refuse_times(weather: WeatherRecord, step_s: float) -> None:
    """Raise `Refused` for a step or a weather interval that does not fit the engine's minute."""
    if not is_multiple(MINUTE_S, of=step_s):
        raise Refused("study.step_s", step_s, "must divide the minute in EnergyPlus, as 1, 2, 5, 10 or 60 s do")
    if not is_multiple(weather.interval_s, of=MINUTE_S):
        raise Refused("weather.interval_s", weather.interval_s, "must be whole minutes in EnergyPlus, as 60 or 3600 s")


def simulate(
    room: RoomDescription,
    weather: WeatherRecord,
    advance: Advance,
    *,
    setpoint_C: float,
    step_s: float = 5.0,
    start: Start = START,
    stop: Callable[[], bool] = lambda: False,
    warm_up_days: int = WARM_UP_DAYS,
    told: Mapping[str, FloatArray] | None = None,
) -> Simulated:
    """Warm a room up with the first day's weather and simulate the record, `advance` opening and closing the valve.

    `told` stands for what `inputs.inputs` gives under the same names, one value per weather interval.

    `advance` is pickled with its state, called in another process at every `step_s`, warm-up included, and given the
    sensed temperature, carried on straight from the last two minutes because EnergyPlus tells it once a minute.
    Raises what `advance` raises, `EnergyPlusError` with the engine's error file, `BackendMissing`, `Stopped`,
    or `OSError`.
    """
    refuse_times(weather, step_s)
    installed_version()
    job = Job(room, weather, advance, step_s, setpoint_C, start, warm_up_days, dict(told or {}))
    minutes, chain = asked(job, model(room, job.days), still_year(), stop)
    return Simulated(minutes, chain, step_s)


def asked(
    job: object, objects: Model, weather: str, stop: Callable[[], bool], encoding: str = "utf-8"
) -> tuple[FloatArray, FloatArray]:
    """Run a model under the text of a weather file, in a process of its own; `job.loop(engine)` is what happens there.

    Returns the rows of the engine's steps and of the chain's; raises what `simulate` raises.
    """
    with scratch_folder("waxstudy-energyplus-") as folder:
        (folder / MODEL).write_text(json.dumps(objects), encoding="utf-8")
        (folder / WEATHER).write_text(weather, encoding=encoding)
        answer, code = ask("waxstudy_energyplus.worker", folder, job, stop)
        return _understood(answer, code, folder)


class _Remote(Exception):
    """The traceback in the engine's process, as the cause of what is raised here."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.text = text

    def __str__(self) -> str:
        return f"\n{self.text}"


def _understood(answer: bytes, code: int, folder: Path) -> tuple[FloatArray, FloatArray]:
    if not answer:
        raise EnergyPlusError(f"EnergyPlus' process ended by itself (code {code}){error_file(folder)}")
    result: tuple[FloatArray, FloatArray]
    result, error, text = pickle.loads(answer)
    if isinstance(error, EnergyPlusError):
        raise EnergyPlusError(f"{error}{error_file(folder)}")
    if error is not None:
        raise error from _Remote(text)
    return result
