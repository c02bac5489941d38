"""Run a room in EnergyPlus, in a process of its own."""

from __future__ import annotations

import io
import json
import pickle
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from waxstudy.plugin import Advance, BackendMissing, FloatArray, Refused, WeatherRecord
from waxstudy.results.atomic import scratch_folder
from waxstudy.simulation.engine import DAY_S, SLAB_ABOVE_K, START, WARM_UP_DAYS, Start
from waxstudy.simulation.own_process import ask
from waxstudy.simulation.standalone import ROW
from waxstudy.study.model import is_multiple
from waxstudy_energyplus import objects
from waxstudy_energyplus.described import DescribedJob
from waxstudy_energyplus.error_file import error_file
from waxstudy_energyplus.inputs import inputs
from waxstudy_energyplus.installation import EnergyPlusError, folder
from waxstudy_energyplus.library import LONGEST_SILENCE_S, MODEL, WEATHER, EngineFailed
from waxstudy_energyplus.loop import Job
from waxstudy_energyplus.model import MINUTE_S, Model, model
from waxstudy_energyplus.native_code import codes_for
from waxstudy_energyplus.plant import full_flow_kg_s
from waxstudy_energyplus.record import MINUTE, Simulated
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
    job = job_of(
        room, weather, advance, setpoint_C=setpoint_C, step_s=step_s, start=start, warm_up_days=warm_up_days, told=told
    )
    days = warm_up_days + int(np.ceil(weather.duration_s / DAY_S))
    rows, chain = asked(job, model(room, days), still_year(), stop)
    value = dict(zip(variables(room), rows.T, strict=True))
    radiant_C = sum(weight * value[f"face of {name}"] for name, weight in radiant_weights(room).items())
    share = room.sensing.operative_air_share
    value["operative_C"] = share * value["air_C"] + (1 - share) * radiant_C
    value["floor_heat_W_m2"] = -(value["convection"] + value["radiation"] + value["of gains"])
    return Simulated(np.column_stack([value[name] for name in MINUTE]), chain, step_s)


def job_of(
    room: RoomDescription,
    weather: WeatherRecord,
    advance: Advance,
    *,
    setpoint_C: float,
    step_s: float,
    start: Start,
    warm_up_days: int,
    told: Mapping[str, FloatArray] | None = None,
) -> DescribedJob:
    """Return what is asked of a run's process."""
    read, share = variables(room), room.sensing.sensor_radiant_share
    places = {name: place for place, name in enumerate(read)}
    faces = {places[f"face of {name}"]: share * weight for name, weight in radiant_weights(room).items()}
    given = {**inputs(room, weather), **(told or {})}
    return DescribedJob(
        engine=folder(),
        advance=advance,
        step_s=step_s,
        engine_step_s=MINUTE_S,
        warm_up_steps=round(warm_up_days * DAY_S / MINUTE_S),
        steps=round(weather.duration_s / MINUTE_S),
        variables=tuple(read.values()),
        sensed=tuple({places["air_C"]: 1 - share, **(faces if share else {})}.items()),
        longest_silence_s=LONGEST_SILENCE_S,
        codes=codes_for(advance),
        inputs={name: np.asarray(series, dtype=float).tolist() for name, series in given.items()},
        interval_s=weather.interval_s,
        full_flow_kg_s=full_flow_kg_s(room),
        floor=room.floor.name,
        floor_surface=places["floor_surface_C"],
        start_air_C=setpoint_C + start.air_K,
        start_floor_C=setpoint_C + SLAB_ABOVE_K + start.slab_K,
        floor_film_m2K_W=room.films.interior_m2K_W("floor"),
    )


def asked(
    job: Job, run: Model, weather: str, stop: Callable[[], bool], encoding: str = "utf-8"
) -> tuple[FloatArray, FloatArray]:
    """Run a model under the text of a weather file, in a process of its own.

    Returns a row of variables for each of the engine's steps, and the chain's rows; raises what `simulate` raises.
    """
    with scratch_folder("waxstudy-energyplus-") as scratch:
        (scratch / MODEL).write_text(json.dumps(run), encoding="utf-8")
        (scratch / WEATHER).write_text(weather, encoding=encoding)
        answer, code = ask("waxstudy_energyplus.worker", scratch, job, stop)
        numbers = _understood(answer, code, scratch)
    rows, chain = np.split(numbers, [job.steps * len(job.variables)])
    return rows.reshape(job.steps, -1), chain.reshape(-1, ROW)


class _Remote(Exception):
    """The traceback in the engine's process, as the cause of what is raised here."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.text = text

    def __str__(self) -> str:
        return f"\n{self.text}"


def _understood(answer: bytes, code: int, scratch: Path) -> FloatArray:
    if not answer:
        raise EnergyPlusError(f"EnergyPlus' process ended by itself (code {code}){error_file(scratch)}")
    stream = io.BytesIO(answer)
    error, text = pickle.load(stream)
    if isinstance(error, EngineFailed):
        raise BackendMissing(str(error)) if error.is_missing else EnergyPlusError(f"{error}{error_file(scratch)}")
    if error is not None:
        raise error from _Remote(text)
    return np.frombuffer(answer, dtype=float, offset=stream.tell())


def radiant_weights(room: RoomDescription) -> dict[str, float]:
    """Return the weights of surfaces and windows in the mean radiant temperature, as in the fast room."""
    weights = {p.name: p.area_m2 if p.operative_weight is None else p.operative_weight for p in room.parts}
    total = sum(weights.values())
    return {name: weight / total for name, weight in weights.items()}


def variables(room: RoomDescription) -> dict[str, tuple[str, str]]:
    """Return the output variables that a run reads."""
    floor, radiant = room.floor.name, objects.RADIANT_FLOOR
    return {
        "air_C": ("Zone Air Temperature", objects.ZONE),
        "floor_surface_C": ("Surface Inside Face Temperature", floor),
        "layer_C": ("Surface Internal Source Location Temperature", floor),
        "convection": ("Surface Inside Face Convection Heat Gain Rate per Area", floor),
        "radiation": ("Surface Inside Face Net Surface Thermal Radiation Heat Gain Rate per Area", floor),
        "of gains": ("Surface Inside Face Internal Gains Radiation Heat Gain Rate per Area", floor),
        "water_heat_W": ("Zone Radiant HVAC Heating Rate", radiant),
        "supply_C": ("Zone Radiant HVAC Inlet Temperature", radiant),
        "return_C": ("Zone Radiant HVAC Outlet Temperature", radiant),
        **{f"face of {part.name}": ("Surface Inside Face Temperature", part.name) for part in room.parts},
    }
