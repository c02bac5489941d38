"""The chain closed over a user's model: what happens at each of its time steps, in the process that runs it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from waxstudy.plugin import Advance
from waxstudy.simulation.engine import DAY_S
from waxstudy_energyplus.chain import CHAIN_ROW, FLOW, through
from waxstudy_energyplus.library import AFTER_REPORTING, BEFORE_PREDICTOR, EnergyPlusError, Engine
from waxstudy_energyplus.record import MINUTE
from waxstudy_energyplus.users.zones import ACTUATORS, CONSTANT, VARIABLE

HOT_WATER_KG_M3 = 983.2  # with which EnergyPlus makes a mass flow of a design flow
# what the engine calls the full flow -> kg/s in one of its unit
FULL_FLOW = {
    VARIABLE: ("Hydronic Low Temp Radiant Design Water Volume Flow Rate for Heating", HOT_WATER_KG_M3),
    CONSTANT: ("Constant Flow Low Temp Radiant Design Water Mass Flow Rate", 1.0),
}
OF_ZONE = {
    "air_C": "Zone Air Temperature",
    "radiant_C": "Zone Mean Radiant Temperature",
    "operative_C": "Zone Operative Temperature",
}
OF_UNIT = {
    "water_heat_W": "Zone Radiant HVAC Heating Rate",
    "supply_C": "Zone Radiant HVAC Inlet Temperature",
    "return_C": "Zone Radiant HVAC Outlet Temperature",
}
OF_SURFACE = {
    "floor_surface_C": "Surface Inside Face Temperature",
    "layer_C": "Surface Internal Source Location Temperature",
    "convection": "Surface Inside Face Convection Heat Gain Rate per Area",
    "radiation": "Surface Inside Face Net Surface Thermal Radiation Heat Gain Rate per Area",
    "of gains": "Surface Inside Face Internal Gains Radiation Heat Gain Rate per Area",
}
LOST = ("convection", "radiation", "of gains")  # of the surface's face, where a gain is positive


@dataclass(frozen=True)
class Job:
    """One run: a unit of a model, driven by `advance` at a step that divides the engine's."""

    zone: str
    kind: str
    unit: str
    surfaces: Mapping[str, float]  # with the shares of their areas
    sensed: str  # of the zone's temperatures, what the sensor is exposed to
    advance: Advance
    step_s: float
    engine_step_s: float
    duration_s: float
    warm_up_days: int
    start_C: float  # of the zone, before the warm-up
    longest_silence_s: float

    @property
    def steps(self) -> int:
        return round(self.duration_s / self.engine_step_s)

    @property
    def chain_steps(self) -> int:
        return round(self.engine_step_s / self.step_s)

    def loop(self, engine: Engine) -> Loop:
        """Return the run in an engine of this process."""
        return Loop(self, engine)


@dataclass
class Loop:
    """The state of a run between steps of the engine, and its record."""

    job: Job
    engine: Engine
    time_s: float = 0.0
    sensed_C: list[float] = field(default_factory=list)  # at the end of the last two steps
    full_flow_kg_s: float = 0.0
    set_flow: Callable[[float], None] | None = None
    readers: dict[str, Callable[[], float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        job = self.job
        self.time_s = -job.warm_up_days * DAY_S
        self.minutes = np.zeros((job.steps, len(MINUTE)))
        self.chain = np.zeros((job.steps * job.chain_steps, len(CHAIN_ROW)))
        for variable, key in self._variables().values():
            self.engine.request(variable, key)
        self.engine.at(BEFORE_PREDICTOR, self.drive)
        self.engine.at(AFTER_REPORTING, self.read)

    def _variables(self) -> dict[str, tuple[str, str]]:
        job = self.job
        of_surfaces = {(name, key): (what, key) for name, what in OF_SURFACE.items() for key in job.surfaces}
        return {
            **{name: (what, job.zone) for name, what in OF_ZONE.items()},
            **{name: (what, job.unit) for name, what in OF_UNIT.items()},
            **{f"{name} of {key}": value for (name, key), value in of_surfaces.items()},
        }

    def drive(self) -> None:
        """Before the predictor: let the chain run through the step, and set its mean flow."""
        if not self.engine.in_weather:
            return
        if self.set_flow is None:
            self._find_handles()
        assert self.set_flow is not None
        if self.engine.warming_up or not self.sensed_C:
            is_cold = not self.sensed_C or self.sensed_C[-1] < self.job.start_C
            self.set_flow(self.full_flow_kg_s if is_cold else 0.0)
            return
        job = self.job
        rows = through(job.advance, self.sensed_C, self.time_s, job.step_s, job.engine_step_s)
        self.set_flow(float(rows[:, FLOW].mean()) * self.full_flow_kg_s)
        first = self._step * job.chain_steps
        if 0 <= first < len(self.chain):
            self.chain[first : first + len(rows)] = rows

    @property
    def _step(self) -> int:
        return round(self.time_s / self.job.engine_step_s)

    def read(self) -> None:
        """After reporting: keep what the step has brought."""
        if not self.readers or not self.engine.in_weather:
            return
        value = {name: read() for name, read in self.readers.items()}
        sensed_C = value[self.job.sensed]
        self.sensed_C = [*(self.sensed_C or [sensed_C]), sensed_C][-2:]
        if self.engine.warming_up:
            return
        if 0 <= self._step < len(self.minutes):
            for name in OF_SURFACE:
                value[name] = sum(share * value[f"{name} of {key}"] for key, share in self.job.surfaces.items())
            value["floor_heat_W_m2"] = -sum(value[name] for name in LOST)
            self.minutes[self._step] = [value[name] for name in MINUTE]
        self.time_s += self.job.engine_step_s

    def _find_handles(self) -> None:
        job = self.job
        name, factor = FULL_FLOW[job.kind]
        self.full_flow_kg_s = factor * self.engine.known(name, job.unit)
        if not self.full_flow_kg_s > 0.0:
            raise EnergyPlusError(f"EnergyPlus has a full flow of {self.full_flow_kg_s:g} kg/s for {job.unit}")
        self.set_flow = self.engine.actuator(ACTUATORS[job.kind], "Water Mass Flow Rate", job.unit)
        self.readers = {each: self.engine.variable(*names) for each, names in self._variables().items()}
