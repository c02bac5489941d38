"""Answers as the tables of dataset.toml."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import log, pi, sqrt
from typing import Any

from waxstudy.believing import typical

ROOM = "nzeb"  # whose words [building] is written in
# Table 4 of the paper, adapted to a floor
PI = {"use": "pi", "gain": 18.0, "integration_time_s": 2300.0, "tracking_time_s": 30.0}
WATER_W_mK, LAMINAR = 0.62, 3.66  # at 35 degrees; Nusselt number

Values = Mapping[str, Any]
Curve = tuple[tuple[float, float], ...]


def building(values: Values, curve_C: Curve | None) -> dict[str, Any]:
    """Return [building] from answers, and the heating curve that the record shows, if it does."""
    era, area_m2, height_m = typical.era_of(values["year"]), values["floor_area_m2"], values["height_m"]
    side_m = sqrt(area_m2)
    is_open = values["above"] == "outdoors"
    air_L_s = typical.FRESH_AIR_L_s_m2 * area_m2
    leaks_L_s = typical.SHELTER * era.n50 * area_m2 * height_m / 3.6
    has_fans = values["ventilation"] == "balanced"
    made = {
        "use": ROOM,
        "floor_area_m2": area_m2,
        "height_m": height_m,
        "facade_m": {side: length or round(side_m, 2) for side, length in values["outer_walls"].items()},
        "window_area_m2": values["windows"],
        "window_U_W_m2K": values["window_U"],
        "window_g": typical.g_of(values["window_U"]),
        "wall_U_W_m2K": values["wall_U"],
        "floor_U_W_m2K": round(values["floor_U"] * typical.BELOW[values["below"]], 3),
        "ceiling": "outdoors" if is_open else "adiabatic",
        "thermal_bridge_W_m2K": era.thermal_bridge,
        "ventilation_L_s": round(air_L_s, 2) if has_fans else 0.0,
        "infiltration_L_s": round(leaks_L_s if has_fans else max(leaks_L_s, air_L_s), 2),
        "screed_above_m": values["screed_mm"] / 1000.0,
        "water_to_surface_resistance_m2K_W": round(water_to_surface_m2K_W(values), 3),
        "nominal_flow_L_h": values["full_flow_L_h"],
        "heating_curve_C": [list(point) for point in curve_C or typical.CURVE_C],
    }
    made |= {"roof_U_W_m2K": era.roof_U} if is_open else {}
    return made | (typical.HEAVY if values["walls"] == "heavy" else {})


def water_to_surface_m2K_W(values: Values) -> float:
    """Return the resistance between water and floor surface (ISO 11855-2, resistances; laminar water)."""
    spacing_m: float = values["pipe_spacing_mm"] / 1000.0
    screed_m: float = values["screed_mm"] / 1000.0
    outer_m, inner_m = typical.PIPE_M, typical.PIPE_M - 2.0 * typical.PIPE_WALL_M
    film = spacing_m / (pi * LAMINAR * WATER_W_mK)
    wall = spacing_m * log(outer_m / inner_m) / (2.0 * pi * typical.PIPE_W_mK)
    between = spacing_m * log(spacing_m / (pi * outer_m)) / (2.0 * pi * typical.SCREED_W_mK)
    covering: float = typical.COVERINGS[values["covering"]]
    return film + wall + between + screed_m / typical.SCREED_W_mK + covering


def nominal(values: Values, motor_from: str) -> Iterator[tuple[str, Any]]:
    """Yield the entries of [nominal] that were asked for; `motor_from`: the motor's file, seen from the dataset."""
    if values.get("thermostat") == "on-off":
        yield "controller", {"use": "on-off", "dead_band_K": values.get("dead_band_K", 0.5)}
    elif "thermostat" in values:
        yield "controller", PI
        yield "modulator", {"use": "pwm"}
    if "motor" in values:
        yield "actuator", {"from": motor_from} if motor_from else {"use": "variable-times", "product": values["motor"]}
    if "valve" in values:
        yield "valve", {"use": values["valve"]}
    if "setpoint_C" in values:
        yield "setpoint_C", values["setpoint_C"]


def site(values: Values, timezone: str) -> dict[str, Any]:
    """Return [site], empty where nobody said where the house is."""
    if not values.get("place"):
        return {}
    latitude, longitude = values["place"]
    made = {"latitude": latitude, "longitude": longitude, **({"timezone": timezone} if timezone else {})}
    if values.get("panels"):
        names = ("panels_peak_W", "panels_tilt_deg", "panels_azimuth_deg")
        made |= dict(zip(names, values["panels"], strict=True))
    return made
