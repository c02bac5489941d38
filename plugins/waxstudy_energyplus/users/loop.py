"""The loop of a user's model: one unit is driven, all else is theirs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from waxstudy_energyplus.library import Engine, EngineFailed
from waxstudy_energyplus.loop import Job, Loop

HOT_WATER_KG_M3 = 983.2  # with which EnergyPlus makes a mass flow of a design flow
# outside all that a room comes to, so that the unit asks for heat always and never cools
ALWAYS_WARM_C, STILL_WARMER_C, NEVER_C = 98.0, 99.0, 199.0


@dataclass(frozen=True, kw_only=True)
class UnitJob(Job):
    """A run of a unit of a model: its flow is an actuator, or it is there or not and asks by its zone's thermostat."""

    flow: tuple[str, str, str]  # the actuator of its flow, or of its availability
    full_flow: tuple[str, str] | None  # what the engine calls the full flow; none of one that is there or not
    wanted: tuple[str, str, str]  # the actuator of the thermostat
    start_C: float  # of the zone, before the warm-up

    def loop(self, engine: Engine) -> UnitLoop:
        return UnitLoop(self, engine)


class UnitLoop(Loop):
    """Sets the flow of the unit."""

    job: UnitJob
    set_part: Callable[[float], None]
    plain_flow: tuple[int, float] | None = None

    def find(self) -> None:
        super().find()
        find, job = self.engine, self.job
        if job.full_flow is None:
            self.set_part = WholeSteps(find.actuator(*job.flow), find.actuator(*job.wanted))
            return
        full_kg_s = HOT_WATER_KG_M3 * find.known(*job.full_flow)
        if not full_kg_s > 0.0:
            raise EngineFailed(f"EnergyPlus has a full flow of {full_kg_s:g} kg/s for {job.flow[-1]}")
        self.plain_flow = find.actuator_handle(*job.flow), full_kg_s
        set_flow = find.actuator(*job.flow)
        self.set_part = lambda share: set_flow(share * full_kg_s)

    def hold(self) -> None:
        """Be a plain thermostat: the start of the floor cannot be told."""
        is_cold = not self.sensed_C or self.sensed_C[-1] < self.job.start_C
        self.set_share(1.0 if is_cold else 0.0)

    def set_share(self, share: float) -> None:
        self.set_part(share)


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
