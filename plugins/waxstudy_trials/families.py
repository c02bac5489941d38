"""The families outside the library, stage by stage; those that are kept are drawn in judged runs only."""

from __future__ import annotations

from collections.abc import Mapping

from waxstudy_trials.family import Family, logged
from waxstudy_trials.family_chain import (
    Lockout,
    PolledBus,
    PumpPauses,
    StickingValve,
    SunlitSensor,
    WanderingSensor,
    WeakAtNight,
)
from waxstudy_trials.family_logger import CoarseMeter, DriftingClock, SlowLogger
from waxstudy_trials.family_room import ColdVentilation, HuntingSupply, OpenDoor, Stove

__all__ = ["FAMILIES", "Family", "logged"]

FAMILIES: Mapping[str, type[Family]] = {
    family.name: family
    for family in (
        SunlitSensor,
        WanderingSensor,
        Lockout,
        PolledBus,
        WeakAtNight,
        StickingValve,
        PumpPauses,
        HuntingSupply,
        Stove,
        OpenDoor,
        ColdVentilation,
        DriftingClock,
        SlowLogger,
        CoarseMeter,
    )
}
