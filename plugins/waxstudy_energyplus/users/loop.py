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
from waxstudy_energyplus.users.takeover import ALWAYS_WARM_C, AVAILABLE
from waxstudy_energyplus.users.zones import ACTUATORS, CONSTANT, RADIANT, VARIABLE

HOT_WATER_KG_M3 = 983.2  # with which EnergyPlus makes a mass flow of a design flow
# what the engine calls the full flow, in m3/s: of constant flow too, whatever its name says
FULL_FLOW = {
    VARIABLE: "Hydronic Low Temp Radiant Design Water Volume Flow Rate for Heating",
    CONSTANT: "Constant Flow Low Temp Radiant Design Water Mass Flow Rate",
}
OF_ZONE = {
    "air_C": "Zone Air Temperature",
    "radiant_C": "Zone Mean Radiant Temperature",
    "operative_C": "Zone Operative Temperature",
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
    of_unit: Mapping[str, tuple[str, str]]  # heat and temperatures of its water: variable and key
    surfaces: Mapping[str, float]  # with the shares of their areas; none of a baseboard
    floor_area_m2: float
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
    set_share: Callable[[float], None] | None = None  # of the full flow
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
        names = {**{name: (what, job.zone) for name, what in OF_ZONE.items()}, **job.of_unit}
        return names | {f"{name} of {key}": value for (name, key), value in of_surfaces.items()}

    def drive(self) -> None:
        """Before the predictor: let the chain run through the step, and set its mean flow."""
        if not self.engine.in_weather:
            return
        if self.set_share is None:
            self._find_handles()
        assert self.set_share is not None
        if self.engine.warming_up or not self.sensed_C:
            is_cold = not self.sensed_C or self.sensed_C[-1] < self.job.start_C
            self.set_share(1.0 if is_cold else 0.0)
            return
        job = self.job
        rows = through(job.advance, self.sensed_C, self.time_s, job.step_s, job.engine_step_s)
        self.set_share(float(rows[:, FLOW].mean()))
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
            self._add_surfaces(value)
            self.minutes[self._step] = [value[name] for name in MINUTE]
        self.time_s += self.job.engine_step_s

    def _add_surfaces(self, value: dict[str, float]) -> None:
        """Add what the heated surfaces are; where there are none, what stands for it."""
        shares = self.job.surfaces
        for name in OF_SURFACE if shares else ():
            value[name] = sum(share * value[f"{name} of {key}"] for key, share in shares.items())
        if shares:
            value["floor_heat_W_m2"] = -sum(value[name] for name in LOST)
        else:
            value |= dict.fromkeys(("floor_surface_C", "layer_C"), value["operative_C"])
            value["floor_heat_W_m2"] = value["water_heat_W"] / self.job.floor_area_m2

    def _find_handles(self) -> None:
        find, job = self.engine, self.job
        if job.kind in RADIANT:
            full_kg_s = HOT_WATER_KG_M3 * find.known(FULL_FLOW[job.kind], job.unit)
            if not full_kg_s > 0.0:
                raise EnergyPlusError(f"EnergyPlus has a full flow of {full_kg_s:g} kg/s for {job.unit}")
            set_flow = find.actuator(ACTUATORS[job.kind], "Water Mass Flow Rate", job.unit)
            self.set_share = lambda share: set_flow(share * full_kg_s)
        else:
            wanted = find.actuator("Zone Temperature Control", "Heating Setpoint", job.zone)
            self.set_share = WholeSteps(find.actuator("Schedule:Constant", "Schedule Value", AVAILABLE), wanted)
        self.readers = {each: find.variable(*names) for each, names in self._variables().items()}


@dataclass
class WholeSteps:
    """Sets a unit that flows fully or not at all in a step: what a step has too much or too little is carried on."""

    set_available: Callable[[float], None]
    set_wanted_C: Callable[[float], None]
    owed: float = 0.0

    def __call__(self, share: float) -> None:
        self.owed += share
        is_on = self.owed >= 0.5
        self.owed -= is_on
        self.set_wanted_C(ALWAYS_WARM_C)
        self.set_available(float(is_on))
