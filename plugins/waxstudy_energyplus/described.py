"""The loop of a room that we describe: EnergyPlus is told weather, sun, gains and water minute by minute."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from waxstudy_energyplus import objects
from waxstudy_energyplus.library import BEFORE_WEATHER, Engine
from waxstudy_energyplus.loop import Job, Loop

OUTDOOR, EXCHANGE_C = "outdoor", "air exchange temperature"
FLOW = ("Hydronic Low Temp Radiant", "Water Mass Flow Rate", objects.RADIANT_FLOOR)
DAY_S = 86400.0
PRESSURE_PA, AIR_CONSTANT_J_KGK, AIR_J_KGK = 101325.0, 287.0, 1004.84  # as EnergyPlus has dry air
# what holds air and floor at their temperatures before the warm-up: an exchange of air, and heat to the floor's surface
HOLD_AIR_W_K = 2000.0
HOLD_FLOOR_W_M2K = 20.0  # it acts on the surface of a minute ago: 100 swing up without limit


@dataclass(frozen=True, kw_only=True)
class DescribedJob(Job):
    """A run of a room that we describe; `inputs` has a value for each weather interval."""

    inputs: Mapping[str, Sequence[float]]
    interval_s: float
    full_flow_kg_s: float
    floor: str
    floor_surface: int  # place of its temperature among the variables
    start_air_C: float
    start_floor_C: float
    floor_film_m2K_W: float

    def loop(self, engine: Engine) -> DescribedLoop:
        return DescribedLoop(self, engine)


class DescribedLoop(Loop):
    """Writes what holds in each minute, before the engine takes its weather."""

    job: DescribedJob

    def __init__(self, job: DescribedJob, engine: Engine) -> None:
        super().__init__(job, engine)
        self.interval = -1
        self.writers: dict[str, Callable[[float], None]] = {}
        engine.at(BEFORE_WEATHER, self.set_inputs)

    @property
    def plain_flow(self) -> tuple[int, float]:
        return self.engine.actuator_handle(*FLOW), self.job.full_flow_kg_s

    def find(self) -> None:
        super().find()
        find = self.engine.actuator
        own = {
            OUTDOOR: ("Weather Data", "Outdoor Dry Bulb", "Environment"),
            EXCHANGE_C: ("Zone", "Outdoor Air Drybulb Temperature", objects.ZONE),
            objects.EXCHANGE: ("Zone Infiltration", "Air Exchange Flow Rate", objects.EXCHANGE),
            "flow": FLOW,
        }
        names = self.job.inputs
        schedules = {name: ("Schedule:Constant", "Schedule Value", name) for name in names if name not in own}
        self.writers = {name: find(*each) for name, each in (own | schedules).items()}

    def set_inputs(self) -> None:
        """Before the weather: write what holds in this minute."""
        if self.values is None:
            self.find()
        if self.is_warming():
            self._hold_start()
            return
        job, time_s = self.job, self.step * self.job.engine_step_s
        time_s = time_s % DAY_S if time_s < 0 else time_s
        interval = min(int(time_s // job.interval_s), len(job.inputs[OUTDOOR]) - 1)
        if interval != self.interval:
            self.interval = interval
            self._write({name: series[interval] for name, series in job.inputs.items()})

    def _hold_start(self) -> None:
        """Bring air, walls and floor to the start of the warm-up, which EnergyPlus cannot be told."""
        job = self.job
        assert self.values is not None
        heat_W_m2 = (job.start_floor_C - job.start_air_C) / job.floor_film_m2K_W
        heat_W_m2 += HOLD_FLOOR_W_M2K * (job.start_floor_C - self.values()[job.floor_surface])
        values = {
            OUTDOOR: job.start_air_C,
            EXCHANGE_C: job.start_air_C,
            objects.SUPPLY: job.start_floor_C,
            objects.sun_on(job.floor): heat_W_m2,
            objects.EXCHANGE: HOLD_AIR_W_K,
        }
        self._write(dict.fromkeys(job.inputs, 0.0) | values)

    def _write(self, values: Mapping[str, float]) -> None:
        density_kg_m3 = PRESSURE_PA / (AIR_CONSTANT_J_KGK * (values[EXCHANGE_C] + 273.15))
        flow_m3_s = values[objects.EXCHANGE] / (density_kg_m3 * AIR_J_KGK)
        for name, value in {**values, objects.EXCHANGE: flow_m3_s}.items():
            self.writers[name](value)

    def hold(self) -> None:
        self.set_share(0.0)

    def set_share(self, share: float) -> None:
        self.writers["flow"](share * self.job.full_flow_kg_s)
