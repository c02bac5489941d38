"""A study case as the reality behind a dataset: one continuous record of everything that could be measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from waxstudy.plugin import ROOM_OUTPUTS, FloatArray, LinearRoom, Role, WeatherRecord
from waxstudy.plugin.registry import told
from waxstudy.results.kpis import MemberWeek, key_figures
from waxstudy.simulation import ensemble
from waxstudy.simulation.engine import DAY_S, Loop, Part, Week
from waxstudy.simulation.interpreted import checked
from waxstudy.simulation.modes import drive
from waxstudy.simulation.outside import OutsideLoop
from waxstudy.simulation.recorded import shared_by, sun_W
from waxstudy.simulation.run import loop_of, member_week, prepare
from waxstudy.study.model import Case, Study

# channels of what drives a room, by the role of its inputs
ROLE_CHANNELS = {
    Role.GAINS: "internal_gain_W",
    Role.SUPPLY_AIR: "ventilation_supply_C",
    Role.NEIGHBOUR: "neighbour_C",
}
EXACT = 1e-9


class RealityError(ValueError):
    """What was asked for cannot be had from this study; the message says why."""


@dataclass(frozen=True)
class Reality:
    """What happened, free of noise: `Channel.source` -> values at the end of every step."""

    week: MemberWeek
    first_day: str  # ISO date; the first step starts at its 00:00
    engine: str = ""  # an outside room's, with its version

    def figures(self) -> dict[str, float | None]:
        """Return the key figures of the record; None where one cannot be told."""
        return {name: value if math.isfinite(value) else None for name, value in key_figures(self.week).items()}


def reality_loop(study: Study, case: Case, weeks: Sequence[str], days: int | None) -> Loop | OutsideLoop:
    """Return a case's loop under some weeks one after another, the first day twice.

    The day put before fills the sensor's memory; `simulate` leaves it out. Raises as `simulation.run.prepare` does,
    and `RealityError`.
    """
    plan = prepare(replace(study, weeks={name: study.weeks[name] for name in weeks}))
    driven = plan.driven[weeks[0]]
    record = _first_days(_joined([plan.driven[name].weather for name in weeks]), days)
    weather = _joined([_first_days(record, 1), record])
    with told("[room]"):
        together = replace(drive(driven.room, weather, study.step_s), engine=driven.engine)
    return loop_of(study, case, together)


def simulate(
    loop: Loop | OutsideLoop, study: Study, setpoint_C: float, believed: Loop | OutsideLoop | None = None
) -> Reality:
    """Run the first member of the study's ensemble through the loop; raise `SimulationError`.

    What drives the room is recorded as the loop `believed` has it, by default as it is.
    """
    (simulated,) = loop.weeks(setpoint_C, ensemble.starts(study.ensemble)[:1], trace=True)
    return happened(loop, simulated, study, setpoint_C, believed or loop)


def happened(
    loop: Loop | OutsideLoop, simulated: Week, study: Study, setpoint_C: float, believed: Loop | OutsideLoop
) -> Reality:
    """Return what a simulated week shows, without its first day."""
    week = member_week(loop, Part(simulated.trace, math.nan), setpoint_C, study)
    channels = week.channels | surroundings(believed) | _readings(loop, week.channels)
    channels["setpoint_C"] = np.full(len(simulated.trace), setpoint_C)
    day = round(DAY_S / loop.driven.step_s)
    kept = {name: values[day:] for name, values in channels.items()}
    return Reality(replace(week, channels=kept), loop.driven.weather.first_day, loop.driven.engine)


def _joined(records: Sequence[WeatherRecord]) -> WeatherRecord:
    """Return one record after the other as if they were one; the dates are those of the first."""
    first = records[0]
    if any(record.interval_s != first.interval_s for record in records):
        raise RealityError("these weeks have weather of different intervals, which cannot follow each other")
    if any(record.duration_s % DAY_S for record in records[:-1]):
        raise RealityError("a week that another follows must last whole days")
    irradiance = {name: np.concatenate([r.irradiance_W_m2[name] for r in records]) for name in first.irradiance_W_m2}
    skies = [record.sky_C for record in records if record.sky_C is not None]
    sky_C = np.concatenate(skies) if len(skies) == len(records) else None
    outdoor_C = np.concatenate([record.outdoor_C for record in records])
    return replace(first, outdoor_C=outdoor_C, irradiance_W_m2=irradiance, sky_C=sky_C)


def _first_days(record: WeatherRecord, days: int | None) -> WeatherRecord:
    if days is None:
        return record
    count = round(days * DAY_S / record.interval_s)
    if count > len(record.outdoor_C):
        raise RealityError(f"the weather lasts {record.duration_s / DAY_S:g} days, less than {days}")
    return with_series(record, lambda values: values[:count])


def with_series(record: WeatherRecord, change: Callable[[FloatArray], FloatArray]) -> WeatherRecord:
    """Return a record with another series in the place of each."""
    irradiance = {name: change(values) for name, values in record.irradiance_W_m2.items()}
    sky_C = None if record.sky_C is None else change(record.sky_C)
    return replace(record, outdoor_C=change(record.outdoor_C), irradiance_W_m2=irradiance, sky_C=sky_C)


def surroundings(loop: Loop | OutsideLoop) -> dict[str, FloatArray]:
    """Return what drives the room: supply, outdoor air, the sun's heat, and its inputs that a record can know.

    Of several inputs of a role gains are summed up, and temperatures are their mean by the heat that a kelvin of each
    brings.
    """
    driven, room = loop.driven, loop.driven.room
    with told("[room]"):
        inputs, solar_W = room.drive(driven.weather)[0], sun_W(room, driven.weather)
    found = {"supply_C": driven.supply_C, "outdoor_C": driven.weather.outdoor_C, "solar_gain_W": solar_W}
    for role, channel in ROLE_CHANNELS.items():
        if places := room.places(role):
            by_heat = shared_by(room.input_matrix[:, places].sum(axis=0))
            found[channel] = inputs[:, places] @ (np.ones(len(places)) if role is Role.GAINS else by_heat)
    return {name: np.repeat(values, driven.steps_per_interval) for name, values in found.items()}


def _readings(loop: Loop | OutsideLoop, channels: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Return what the controller reads at the end of each step: the sensor once more, over the trace."""
    seen = _sensed_C(loop.driven.room, channels)
    block, dt = loop.chain.blocks[0], loop.driven.step_s
    if seen is None or block is None:
        return {} if seen is None else {"reading_C": seen}
    step, plain, state = checked(block), loop.chain.plain[0], loop.chain.start()[0]
    values = [step(plain, state, u, (n + 1) * dt, dt) for n, u in enumerate(seen.tolist())]
    return {"reading_C": np.array(values)}


def _sensed_C(room: LinearRoom, channels: dict[str, FloatArray]) -> FloatArray | None:
    """Return what the sensor is exposed to, which the trace has only as a mixture of its temperatures; or None."""
    names = ("air_C", "operative_C", "floor_surface_C", "layer_C")
    rows = np.hstack((room.output_matrix, room.feedthrough))
    parts, sensed = np.array([rows[ROOM_OUTPUTS.index(name)] for name in names]), rows[ROOM_OUTPUTS.index("sensed_C")]
    shares = np.linalg.lstsq(parts.T, sensed, rcond=None)[0]
    if np.max(np.abs(shares @ parts - sensed)) > EXACT:
        return None
    mixed: FloatArray = shares @ np.array([channels[name] for name in names])
    return mixed
