"""What surrounds the structure: films, air, internal gains, sun, and what is felt of them."""

from __future__ import annotations

from math import cos, radians
from typing import Self

import numpy as np
from pydantic import model_validator

from waxstudy.plugin import FloatArray, Parameters, WeatherRecord, parameter
from waxstudy_paper.room.construction import STUDY, Facing


class Films(Parameters):
    """Heat transfer coefficients at the surfaces; constant, so that the room is linear."""

    wall_W_m2K: float = parameter(
        2.5,
        unit="W/(m2 K)",
        description="convective, walls and windows",
        source="EN ISO 6946, ISO 52016-1",
        gt=0,
        le=50,
    )
    ceiling_W_m2K: float = parameter(
        0.7,
        unit="W/(m2 K)",
        description="convective, ceiling",
        source="EN ISO 6946, heat flow downwards: above a heated floor the ceiling is warmer than the air",
        gt=0,
        le=50,
    )
    floor_W_m2K: float = parameter(
        5.0,
        unit="W/(m2 K)",
        description="convective, floor",
        source="EN ISO 6946, ISO 52016-1, heat flow upwards; with the radiative part 10.1, as EN 1264-2 at 34 W/m2",
        gt=0,
        le=50,
    )
    radiative_W_m2K: float = parameter(
        5.13,
        unit="W/(m2 K)",
        description="linearised long-wave exchange inside",
        source="EN ISO 6946, ISO 52016-1: emissivity 0.9 times 5.7 W/(m2 K), a black body at 20 C",
        gt=0,
        le=10,
    )
    exterior_W_m2K: float = parameter(
        25.0,
        unit="W/(m2 K)",
        description="convective and radiative, to the outdoor air",
        source="EN ISO 6946: R_se = 0.04 m2 K/W",
        gt=0,
        le=100,
    )

    sky_W_m2K: float = parameter(
        0.0,
        unit="W/(m2 K)",
        description="part of the exterior coefficient with which a surface that looks up radiates to the sky "
        "instead of to the air; by tilt for others; above 0 it needs a weather that knows the sky, such as epw",
        source="chosen: 0, the sky is as warm as the air; ISO 52016-1 has 4.14 for all radiation outside",
        ge=0,
        le=10,
    )

    @model_validator(mode="after")
    def _sky_is_a_part(self) -> Self:
        if self.sky_W_m2K > self.exterior_W_m2K:
            raise ValueError("sky_W_m2K is a part of exterior_W_m2K and cannot exceed it")
        return self

    def sky_share(self, tilt_deg: float) -> float:
        """Part of the exterior coefficient that goes to the sky: cos(tilt / 2)^3 of that of a surface looking up.

        The view of the sky, cos(tilt / 2)^2, times what of it is colder than the air (Walton 1983, as in EnergyPlus).
        """
        return self.sky_W_m2K / self.exterior_W_m2K * cos(radians(tilt_deg) / 2) ** 3

    def convective_W_m2K(self, facing: Facing) -> float:
        return {"wall": self.wall_W_m2K, "ceiling": self.ceiling_W_m2K, "floor": self.floor_W_m2K}[facing]

    def interior_m2K_W(self, facing: Facing) -> float:
        """Resistance of both exchanges in parallel."""
        return 1.0 / (self.convective_W_m2K(facing) + self.radiative_W_m2K)


class Air(Parameters):
    """The room's air and what exchanges it."""

    volume_m3: float = parameter(unit="m3", description="air volume", source=STUDY, gt=0, le=100_000)
    capacity_multiplier: float = parameter(
        3.0,
        unit="1",
        description="capacity of air and furniture over that of the air",
        source="chosen: a furnished room; the paper says nothing",
        ge=1,
        le=50,
    )
    ventilation_L_s: float = parameter(0.0, unit="L/s", description="supply air", source=STUDY, ge=0, le=100_000)
    ventilation_supply_C: float = parameter(
        18.0, unit="C", description="supply air temperature", source="section 3.3", ge=-40, le=60
    )
    infiltration_L_s: float = parameter(0.0, unit="L/s", description="outdoor air", source=STUDY, ge=0, le=100_000)
    thermal_bridges_W_K: float = parameter(
        0.0, unit="W/K", description="from the air to outdoors", source=STUDY, ge=0, le=100_000
    )


# EN 16798-1, detached house, a working day: shares of each hour for people, appliances and light
PEOPLE = (1.0,) * 6 + (0.5,) * 3 + (0.1,) * 4 + (0.2,) * 3 + (0.5,) * 3 + (0.8,) * 3 + (1.0,) * 2
APPLIANCES = (0.5,) * 7 + (0.7,) * 2 + (0.5,) * 2 + (0.6,) * 4 + (0.5,) * 2 + (0.7,) * 2 + (0.8,) * 3 + (0.6,) * 2
LIGHT = (0.0,) * 6 + (0.15,) * 4 + (0.05,) * 6 + (0.2,) * 6 + (0.15,) * 2
# installed 3, 2.4 and 8 W/m2: together 4.03 W/m2 on average, the paper's 4
DWELLING = tuple(
    round(3.0 * people + 2.4 * appliances + 8.0 * light, 2)
    for people, appliances, light in zip(PEOPLE, APPLIANCES, LIGHT, strict=True)
)


LARGEST_FACTOR = 1e6  # of a schedule; more would overflow when they are scaled


class Gains(Parameters):
    """People, light and appliances."""

    mean_W_m2: float = parameter(
        4.0, unit="W/m2", description="daily mean per area of the heated floor", source="section 3.3", ge=0, le=200
    )
    schedule: tuple[float, ...] = parameter(
        DWELLING,
        unit="1",
        description="factors of the 24 hours of the day; scaled so that their mean is 1",
        source="chosen: EN 16798-1, a dwelling with 3, 2.4 and 8 W/m2 of people, appliances and light, whose mean "
        "is the paper's 4 W/m2; the paper cites the Estonian regulation of 2015 without its hours",
        min_length=24,
        max_length=24,
        strict=False,
    )
    radiant_share: float = parameter(
        0.6,
        unit="1",
        description="share that is radiated",
        source="chosen: ISO 52016-1, 0.4 convective",
        ge=0,
        le=1,
    )

    @model_validator(mode="after")
    def _positive(self) -> Self:
        if min(self.schedule) < 0 or max(self.schedule) > LARGEST_FACTOR or sum(self.schedule) <= 0:
            raise ValueError(f"schedule: factors are 0 to {LARGEST_FACTOR:g}, and not all of them 0")
        return self


class Sun(Parameters):
    """Where the sun that windows let through is absorbed."""

    reflected_share: float = parameter(
        0.0,
        unit="1",
        description="share that leaves through the windows again; the other shares are of the rest",
        source="chosen: 0; ANSI/ASHRAE 140 has 0.035 for its case 600, whose surfaces absorb 0.6",
        ge=0,
        lt=1,
    )
    air_share: float = parameter(
        0.1,
        unit="1",
        description="share that furniture gives to the air at once",
        source="chosen: ISO 52016-1",
        ge=0,
        le=1,
    )
    floor_share: float = parameter(
        0.64,
        unit="1",
        description="share of the rest that falls on floors; other surfaces take theirs by area",
        source="chosen: ANSI/ASHRAE 140, interior solar distribution of its cases; the paper says nothing",
        ge=0,
        le=1,
    )


class Shading(Parameters):
    """External shading of all windows, each drawn by the sun on its own facade, the clock and the month."""

    passes: float = parameter(
        1.0,
        unit="1",
        description="share of the sun that passes while it is drawn; 1 is none",
        source="chosen: none, the paper names none; external blinds and screens let through 0.1 to 0.3",
        ge=0,
        le=1,
    )
    above_W_m2: float = parameter(
        300.0,
        unit="W/m2",
        description="irradiance on the window from which it is drawn; 0 leaves it to the schedule",
        source="chosen: EN ISO 13790 draws movable shading above 300 W/m2",
        ge=0,
        le=2000,
    )
    from_hour: float = parameter(
        0.0, unit="h", description="time of day from which it may be drawn", source="chosen", ge=0, le=24
    )
    to_hour: float = parameter(
        24.0, unit="h", description="time of day until which it may be drawn", source="chosen", ge=0, le=24
    )
    months: tuple[int, ...] = parameter(
        tuple(range(1, 13)),
        unit="1",
        description="months in which it may be drawn, 1 to 12",
        source="chosen: all",
        strict=False,
    )

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.from_hour >= self.to_hour:
            raise ValueError(f"from_hour = {self.from_hour:g} must lie before to_hour = {self.to_hour:g}")
        if not self.months or not set(self.months) <= set(range(1, 13)):
            raise ValueError("months: at least one of 1 to 12, and no other")
        return self

    def passed(self, weather: WeatherRecord, facade: str) -> FloatArray:
        """Return the irradiance behind it (intervals,); an interval counts by its middle.

        Behind counted panes the limit is of the irradiance that they count.
        """
        middle_s = (np.arange(len(weather.outdoor_C)) + 0.5) * weather.interval_s
        hour = middle_s % 86_400 / 3600
        day = np.datetime64(weather.first_day) + (middle_s // 86_400).astype("timedelta64[D]")
        month = day.astype("datetime64[M]").astype(int) % 12 + 1
        sun = weather.irradiance_W_m2[facade]
        is_time = (hour >= self.from_hour) & (hour < self.to_hour) & np.isin(month, self.months)
        return np.where(is_time & (sun > self.above_W_m2), self.passes * sun, sun)


class Sensing(Parameters):
    """What a person and the sensor feel of air and radiation."""

    operative_air_share: float = parameter(
        0.5,
        unit="1",
        description="share of air in the operative temperature",
        source="EN ISO 7726, still air",
        ge=0,
        le=1,
    )
    sensor_radiant_share: float = parameter(
        0.0,
        unit="1",
        description="share of radiation in what the sensor is exposed to, seen from the operative point",
        source="section 3.3: the air temperature is controlled",
        ge=0,
        le=1,
    )
