"""The rooms of ANSI/ASHRAE 140 (BESTEST), cases 600 and 900, in the words of room `surfaces`.

Constructions, gains, infiltration and solar absorptances are the standard's. Where it leaves a coefficient to the
program or gives it in a form that this room does not know, the choice is marked and explained in docs/bestest.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from waxstudy_paper.room import RoomDescription

WIDTH_M, DEPTH_M, HEIGHT_M, WINDOW_M2 = 8.0, 6.0, 2.7, 12.0
FLOOR_M2 = WIDTH_M * DEPTH_M
VOLUME_M3 = FLOOR_M2 * HEIGHT_M
GAINS_W = 200.0
AIR_DENSITY_RATIO = 0.822  # at 1650 m over sea level
AIR_CHANGES_H = 0.5

Layer = Mapping[str, float]


def layer(thickness_m: float, conductivity_W_mK: float, density_kg_m3: float, heat_capacity_J_kgK: float) -> Layer:
    return {
        "thickness_m": thickness_m,
        "conductivity_W_mK": conductivity_W_mK,
        "density_kg_m3": density_kg_m3,
        "heat_capacity_J_kgK": heat_capacity_J_kgK,
    }


SIDING = layer(0.009, 0.14, 530.0, 900.0)
ROOF = [layer(0.010, 0.16, 950.0, 840.0), layer(0.1118, 0.04, 12.0, 840.0), layer(0.019, 0.14, 530.0, 900.0)]
LIGHT_WALL = [layer(0.012, 0.16, 950.0, 840.0), layer(0.066, 0.04, 12.0, 840.0), SIDING]
HEAVY_WALL = [layer(0.100, 0.51, 1400.0, 1000.0), layer(0.0615, 0.04, 10.0, 1400.0), SIDING]
LIGHT_FLOOR = [layer(0.025, 0.14, 650.0, 1200.0), layer(1.003, 0.04, 0.0, 1000.0)]
HEAVY_FLOOR = [layer(0.080, 1.13, 1400.0, 1000.0), layer(1.007, 0.04, 0.0, 1000.0)]

# clear double glazing of the standard's 2020 edition; the editions before had U = 3.0 and g = 0.789
WINDOW = {
    "name": "south window",
    "area_m2": WINDOW_M2,
    "U_W_m2K": 2.1,
    "g": 0.769,
    "secondary_share": 0.086,  # of g, what the panes absorb of 0.703 transmitted
    "panes": 2,
    "azimuth_deg": 180.0,
}
# EN ISO 6946 for heat that leaves through walls, upwards through the roof and downwards through the floor;
# outside 25 for 4 m/s of wind, of which 4.14 are radiation (ISO 52016-1)
FILMS = {"wall_W_m2K": 2.5, "ceiling_W_m2K": 5.0, "floor_W_m2K": 0.7, "exterior_W_m2K": 25.0, "sky_W_m2K": 4.14}
# the standard's fractions: 0.642 to the floor and 0.035 out again, of all that is transmitted
SUN = {"air_share": 0.0, "floor_share": 0.642 / 0.965, "reflected_share": 0.035}

WALLS = {"north": (WIDTH_M, 0.0, 0.0), "east": (DEPTH_M, 90.0, 0.0), "west": (DEPTH_M, 270.0, 0.0)}
WALLS["south"] = (WIDTH_M, 180.0, WINDOW_M2)


def room(wall: list[Layer], floor: list[Layer], **changes: Any) -> RoomDescription:
    """Return a case's room; `changes` set keys of a table, in every surface or window that has them."""
    surfaces = [
        {
            "name": f"{side} wall",
            "area_m2": width_m * HEIGHT_M - window_m2,
            "boundary": "outdoors",
            "layers": wall,
            "azimuth_deg": azimuth_deg,
            "solar_absorptance": 0.6,
        }
        for side, (width_m, azimuth_deg, window_m2) in WALLS.items()
    ]
    outside = {"boundary": "outdoors", "area_m2": FLOOR_M2}
    roof = {"facing": "ceiling", "layers": ROOF, "tilt_deg": 0.0, "azimuth_deg": 180.0, "solar_absorptance": 0.6}
    description: dict[str, Any] = {
        "surfaces": [
            *surfaces,
            {"name": "roof", **outside, **roof},
            {"name": "floor", **outside, "facing": "floor", "layers": floor, "tilt_deg": 180.0},
        ],
        "windows": [dict(WINDOW)],
        "air": {
            "volume_m3": VOLUME_M3,
            "capacity_multiplier": 1.0,
            "infiltration_L_s": AIR_CHANGES_H * VOLUME_M3 / 3.6 * AIR_DENSITY_RATIO,
        },
        # the standard's room has no heated floor: no water flows, and this only says where pipes would lie
        "heated_floor": {"surface": "floor", "pipes_after_layer": 1},
        "circuit": {"exchange": "pipe"},
        "films": dict(FILMS),
        "gains": {"mean_W_m2": GAINS_W / FLOOR_M2, "schedule": [1.0] * 24, "radiant_share": 0.6},
        "sun": dict(SUN),
    }
    for table, values in changes.items():
        target = description[table]
        for changed in target if isinstance(target, list) else [target]:
            changed.update({key: value for key, value in values.items() if key in changed})
    return RoomDescription.model_validate(description)


CASES = {"600": (LIGHT_WALL, LIGHT_FLOOR), "900": (HEAVY_WALL, HEAVY_FLOOR)}


def case(name: str, **changes: Any) -> RoomDescription:
    """Return the room of case 600, 900, 600FF or 900FF."""
    return room(*CASES[name.removesuffix("FF")], **changes)
