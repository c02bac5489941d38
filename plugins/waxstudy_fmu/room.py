"""The room `fmu`: its parameters, what stands in for it, and its simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from waxstudy.plugin import (
    Advance,
    Facade,
    FloatArray,
    LinearRoom,
    OutsideRoom,
    Parameters,
    Refused,
    Role,
    WeatherRecord,
    parameter,
)
from waxstudy_fmu.job import Job
from waxstudy_fmu.package import opened
from waxstudy_fmu.roles import Variables, find
from waxstudy_fmu.run import simulate
from waxstudy_paper.room import NzebRoom
from waxstudy_paper.room.scaled import scaled

_GIVEN = "given by the user"


class FmuParameters(Parameters):
    path: str = parameter(unit="", description="The FMU, relative to the study file.", source=_GIVEN)
    inputs: dict[str, str] = parameter(unit="", description="Role to variable, of what it is given.", source=_GIVEN)
    outputs: dict[str, str] = parameter(unit="", description="Role to variable, of what it gives.", source=_GIVEN)
    sun: dict[str, str] = parameter(
        default_factory=dict,
        unit="",
        description="Azimuth of a vertical facade in degrees to the variable of its irradiance.",
        source=_GIVEN,
    )
    floor_area_m2: float = parameter(
        10.4, unit="m2", ge=1.0, le=100_000.0, description="Heated floor.", source="Table 3; the FMU's own is needed"
    )
    longest_silence_s: float = parameter(
        60.0,
        unit="s",
        gt=0.0,
        le=86_400.0,
        description="Time that the FMU may take for one call, before its process is ended.",
        source="chosen: steps take milliseconds",
    )


def facade_name(azimuth: str) -> str:
    return f"azimuth {azimuth} of the FMU"


class FmuRoom(OutsideRoom):
    """A room, or a house, that somebody has modelled elsewhere: an FMU for co-simulation of FMI 2.0 or 3.0.

    The paper's room, as large as `floor_area_m2`, stands in for it: its heating curve, full flow and gains drive it.
    """

    name = "fmu"
    api_version = "1.0"
    Parameters = FmuParameters
    examples = {}
    exemptions = {"examples": "it runs an FMU that the user has"}

    @classmethod
    def build(cls, p: FmuParameters) -> LinearRoom:
        room = scaled(NzebRoom.build(NzebRoom.Parameters()), p.floor_area_m2)
        return replace(room, facades={**room.facades, **{facade_name(a): Facade(_azimuth_deg(a)) for a in p.sun}})

    @classmethod
    def ready(cls, p: FmuParameters, weather: WeatherRecord, step_s: float) -> str:
        package = opened(Path(p.path))
        variables = find(package.description, p.inputs, p.outputs, p.sun)
        return "; ".join([f"{package.engine}, warmed up by time alone", *variables.told()])

    @classmethod
    def simulate(
        cls,
        p: FmuParameters,
        weather: WeatherRecord,
        advance: Advance,
        *,
        setpoint_C: float,
        step_s: float,
        air_K: float,
        slab_K: float,
        stop: Callable[[], bool],
    ) -> FloatArray:
        package, room = opened(Path(p.path)), cls.build(p)
        variables = find(package.description, p.inputs, p.outputs, p.sun)
        start = {"start_air_C": setpoint_C + air_K, "start_floor_C": setpoint_C + 2.0 + slab_K}
        given, supply_C = _given(room, weather, variables)
        job = Job(
            package.path,
            variables,
            weather.interval_s,
            given,
            supply_C,
            start,
            room.full_flow_L_h,
            room.water_J_L_K,
            room.floor_area_m2,
            _table(room),
            advance,
            step_s,
            p.longest_silence_s,
        )
        return simulate(job, stop)


def _azimuth_deg(text: str) -> float:
    try:
        azimuth_deg = float(text)
    except ValueError:
        azimuth_deg = -1.0
    if not 0.0 <= azimuth_deg <= 360.0:
        raise Refused("room.sun", text, "must be azimuths from 0 to 360 degrees, clockwise from north")
    return azimuth_deg


def _table(room: LinearRoom) -> FloatArray:
    """Heat per kelvin of supply minus layer over the flow fraction from 0 to 1, for an FMU that takes heat."""
    return room.floor_conductance_W_K(np.linspace(0.0, 1.0, 101))


def _given(room: LinearRoom, weather: WeatherRecord, variables: Variables) -> tuple[dict[int, FloatArray], FloatArray]:
    """Return what each input variable is given in each interval, in its own unit, and the supply temperature."""
    inputs, supply_C = room.drive(weather)
    ours = {
        "supply_C": supply_C,
        "outdoor_C": weather.outdoor_C,
        "gains_W": inputs[:, room.places(Role.GAINS)].sum(axis=1),
    }
    series = [(variables.inputs[role], values) for role, values in ours.items() if role in variables.inputs]
    series += [(each, weather.irradiance_W_m2[facade_name(azimuth)]) for azimuth, each in variables.sun.items()]
    return {each.reference: (values - each.offset) / each.factor for each, values in series}, supply_C
