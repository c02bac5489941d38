"""The chain closed over EnergyPlus: what happens at each minute of a run, in the process that runs the engine."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from waxstudy.plugin import Advance, FloatArray, WeatherRecord
from waxstudy.simulation.engine import DAY_S, SLAB_ABOVE_K, WARM_UP_DAYS, Start
from waxstudy_energyplus import objects
from waxstudy_energyplus.chain import CHAIN_ROW, FLOW, through
from waxstudy_energyplus.inputs import EXCHANGE_C, OUTDOOR, inputs
from waxstudy_energyplus.library import AFTER_REPORTING, BEFORE_PREDICTOR, BEFORE_WEATHER, LONGEST_SILENCE_S, Engine
from waxstudy_energyplus.model import STEPS_PER_HOUR
from waxstudy_energyplus.plant import full_flow_kg_s
from waxstudy_energyplus.record import MINUTE
from waxstudy_paper.room.description import RoomDescription

MINUTE_S = 3600.0 / STEPS_PER_HOUR
PRESSURE_PA, AIR_CONSTANT_J_KGK, AIR_J_KGK = 101325.0, 287.0, 1004.84  # as EnergyPlus has dry air
# what holds air and floor at their temperatures before the warm-up: an exchange of air, and heat to the floor's surface
HOLD_AIR_W_K = 2000.0
HOLD_FLOOR_W_M2K = 20.0  # it acts on the surface of a minute ago: 100 swing up without limit


@dataclass(frozen=True)
class Job:
    """One run: a room in one weather, driven by `advance` at a step that divides the minute.

    `told` stands for what `inputs` gives under the same names, one value per weather interval.
    """

    room: RoomDescription
    weather: WeatherRecord
    advance: Advance
    step_s: float
    setpoint_C: float  # near which the room starts
    start: Start
    warm_up_days: int = WARM_UP_DAYS
    told: Mapping[str, FloatArray] = field(default_factory=dict)
    longest_silence_s: float = LONGEST_SILENCE_S

    @property
    def days(self) -> int:
        return self.warm_up_days + int(np.ceil(self.weather.duration_s / DAY_S))

    @property
    def steps_per_minute(self) -> int:
        return round(MINUTE_S / self.step_s)

    @property
    def minutes(self) -> int:
        return round(self.weather.duration_s / MINUTE_S)

    def loop(self, engine: Engine) -> Loop:
        """Return the run in an engine of this process."""
        return Loop(self, engine)


@dataclass
class Loop:
    """The state of a run between minutes, and its record."""

    job: Job
    engine: Engine
    time_s: float = 0.0
    interval: int = -1
    sensed_C: list[float] = field(default_factory=list)  # at the end of the last two minutes
    writers: dict[str, Callable[[float], None]] = field(default_factory=dict)
    readers: dict[str, Callable[[], float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        job = self.job
        self.time_s = -job.warm_up_days * DAY_S
        self.inputs = {**inputs(job.room, job.weather), **job.told}
        self.minutes = np.zeros((job.minutes, len(MINUTE)))
        self.chain = np.zeros((job.minutes * job.steps_per_minute, len(CHAIN_ROW)))
        self.full_flow_kg_s = full_flow_kg_s(job.room)
        self.radiant = radiant_weights(job.room)
        for variable, key in variables(job.room).values():
            self.engine.request(variable, key)
        self.engine.at(BEFORE_WEATHER, self.set_inputs)
        self.engine.at(BEFORE_PREDICTOR, self.set_flow)
        self.engine.at(AFTER_REPORTING, self.read)

    def set_inputs(self) -> None:
        """Before the weather: write what holds in this minute."""
        if not self.writers:
            self._find_handles()
        if self.engine.warming_up:
            self._hold_start()
            return
        time_s = self.time_s % DAY_S if self.time_s < 0 else self.time_s
        interval = min(int(time_s // self.job.weather.interval_s), len(self.job.weather.outdoor_C) - 1)
        if interval != self.interval:
            self.interval = interval
            self._write({name: float(series[interval]) for name, series in self.inputs.items()})

    def _hold_start(self) -> None:
        """Bring air, walls and floor to the start of the warm-up, which EnergyPlus cannot be told."""
        job, floor = self.job, self.job.room.floor
        air_C = job.setpoint_C + job.start.air_K
        floor_C = job.setpoint_C + SLAB_ABOVE_K + job.start.slab_K
        heat_W_m2 = (floor_C - air_C) / job.room.films.interior_m2K_W("floor")
        heat_W_m2 += HOLD_FLOOR_W_M2K * (floor_C - self.readers["floor_surface_C"]())
        values = {OUTDOOR: air_C, EXCHANGE_C: air_C, objects.SUPPLY: floor_C, objects.sun_on(floor.name): heat_W_m2}
        self._write(dict.fromkeys(self.inputs, 0.0) | values | {objects.EXCHANGE: HOLD_AIR_W_K})

    def _write(self, values: dict[str, float]) -> None:
        density_kg_m3 = PRESSURE_PA / (AIR_CONSTANT_J_KGK * (values[EXCHANGE_C] + 273.15))
        flow_m3_s = values[objects.EXCHANGE] / (density_kg_m3 * AIR_J_KGK)
        for name, value in {**values, objects.EXCHANGE: flow_m3_s}.items():
            self.writers[name](value)

    def set_flow(self) -> None:
        """Before the predictor: let the chain run through the minute on a reading that goes on as it went."""
        if self.engine.warming_up:
            self.writers["flow"](0.0)
            return
        job = self.job
        rows = through(job.advance, self.sensed_C, self.time_s, job.step_s, MINUTE_S)
        self.writers["flow"](float(rows[:, FLOW].mean()) * self.full_flow_kg_s)
        first = self._minute * job.steps_per_minute
        if 0 <= first < len(self.chain):
            self.chain[first : first + job.steps_per_minute] = rows

    @property
    def _minute(self) -> int:
        return round(self.time_s / MINUTE_S)

    def read(self) -> None:
        """After reporting: keep what the minute has brought."""
        if not self.readers:
            return
        value = {name: read() for name, read in self.readers.items()}
        radiant_C = sum(weight * value[f"face of {name}"] for name, weight in self.radiant.items())
        air_C, sensing = value["air_C"], self.job.room.sensing
        sensed_C = (1 - sensing.sensor_radiant_share) * air_C + sensing.sensor_radiant_share * radiant_C
        self.sensed_C = [*(self.sensed_C or [sensed_C]), sensed_C][-2:]
        if self.engine.warming_up:
            return
        if 0 <= self._minute < len(self.minutes):
            value["operative_C"] = sensing.operative_air_share * air_C + (1 - sensing.operative_air_share) * radiant_C
            value["floor_heat_W_m2"] = -(value["convection"] + value["radiation"] + value["of gains"])
            self.minutes[self._minute] = [value[name] for name in MINUTE]
        self.time_s += MINUTE_S

    def _find_handles(self) -> None:
        find = self.engine.actuator
        own = {
            OUTDOOR: ("Weather Data", "Outdoor Dry Bulb", "Environment"),
            EXCHANGE_C: ("Zone", "Outdoor Air Drybulb Temperature", objects.ZONE),
            objects.EXCHANGE: ("Zone Infiltration", "Air Exchange Flow Rate", objects.EXCHANGE),
            "flow": ("Hydronic Low Temp Radiant", "Water Mass Flow Rate", objects.RADIANT_FLOOR),
        }
        schedules = {name: ("Schedule:Constant", "Schedule Value", name) for name in self.inputs if name not in own}
        self.writers = {name: find(*names) for name, names in (own | schedules).items()}
        self.readers = {name: self.engine.variable(*names) for name, names in variables(self.job.room).items()}


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
