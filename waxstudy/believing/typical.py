"""Typical values of houses by the year in which they were built or last insulated, and other usual values.

They are German figures, as those are published by year; other countries with cold winters are alike or better. No
uncertainty is published with them; what walls differ by was measured elsewhere (docs/what-is-believed.md).
Thermal bridges and air changes before 2002 are assumed.
"""

from __future__ import annotations

from typing import NamedTuple

SURVEY = "German federal rules for surveying dwellings (2015), table 2, rounded"
LIMITS = "EnEV 2002, annex 3, limits of components"
REFERENCE = "EnEV 2009, reference building"
LATER = "three quarters of EnEV 2009's reference building, as its step of 2016 asks of a house"


class Era(NamedTuple):
    """Houses up to a year: U-values [W/(m2 K)], and air changes at 50 Pa [1/h]."""

    until: int
    wall_U: float
    window_U: float
    floor_U: float  # towards the outdoors; what lies below counts by `BELOW`
    roof_U: float
    thermal_bridge: float  # per external area
    n50: float
    source: str


ERAS = (
    Era(1948, 1.7, 2.7, 1.2, 1.4, 0.10, 6.0, SURVEY),
    Era(1968, 1.4, 2.7, 1.2, 1.4, 0.10, 6.0, SURVEY),
    Era(1978, 1.0, 2.7, 1.0, 0.8, 0.10, 6.0, SURVEY),
    Era(1983, 0.8, 2.7, 0.8, 0.5, 0.10, 5.0, SURVEY),
    Era(1994, 0.6, 2.7, 0.6, 0.4, 0.10, 4.0, SURVEY),
    Era(2001, 0.5, 1.8, 0.6, 0.3, 0.10, 3.0, SURVEY),
    Era(2008, 0.35, 1.7, 0.4, 0.3, 0.05, 3.0, LIMITS),
    Era(2015, 0.28, 1.3, 0.35, 0.20, 0.05, 1.5, REFERENCE),
    Era(9999, 0.21, 0.98, 0.26, 0.15, 0.05, 1.5, LATER),
)
FIRST, LAST = 1700, 2100  # years that may be given

# g of a window by its U-value, from which on it is of such panes: single and double, double coated, triple (EN 410)
PANES = ((2.2, 0.75), (1.1, 0.60), (0.0, 0.50))
# part of the difference to outdoors that a floor sees (DIN V 4108-6, table 3); a room as warm takes hardly any
BELOW = {"outdoors": 1.0, "ground": 0.6, "cellar": 0.6, "warm room": 0.05}
# resistance of the covering [m2 K/W] (EN 1264-2)
COVERINGS = {"tiles": 0.01, "vinyl": 0.05, "wood": 0.10, "carpet": 0.15}
# what of a wall or partition stores heat in a day: 13 mm of board, or 100 mm of masonry (EN ISO 13786, simplified)
HEAVY = {
    "gypsum": {"conductivity_W_mK": 0.7, "density_kg_m3": 1600.0, "heat_capacity_J_kgK": 1000.0},
    "gypsum_m": 0.1,
    "partition_gypsum_m": 0.1,
}
WINDOW_HEIGHT_m, WINDOW_WIDTH = 1.5, 0.9  # of room nzeb; of a wall's length at most: chosen
WINDOW_SHARE = 1 / 8  # of the floor area (German model building code, section 47)
FRESH_AIR_L_s_m2 = 0.42  # EN 16798-1, dwellings, category II
SHELTER = 0.07  # air change by leaks, of that at 50 Pa (EN ISO 13789)
PIPE_M, PIPE_WALL_M, PIPE_W_mK = 0.016, 0.002, 0.35  # 16 x 2 mm of PE-X (EN 1264-2)
SCREED_W_mK = 1.2
FLOW_L_h_m2 = 10.0  # 60 W/m2 at 5 K between supply and return (EN 1264-3)
CURVE_C = ((-15.0, 35.0), (20.0, 22.0))  # of a floor: 35 degrees on the coldest day


def era_of(year: int) -> Era:
    return next(era for era in ERAS if year <= era.until)


def g_of(window_U: float) -> float:
    return next(g for from_U, g in PANES if window_U >= from_U)
