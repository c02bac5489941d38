"""The parameters of the paper's Table 3, and what is chosen where it leaves something open."""

from __future__ import annotations

from typing import Any, Literal

from waxstudy.plugin import Parameters, parameter
from waxstudy_paper.room.conditions import Films, Gains, Sensing, Shading, Sun
from waxstudy_paper.room.construction import Material
from waxstudy_paper.room.hydronics import Circuit

ISO_10456 = "chosen: EN ISO 10456, rounded"


def material(conductivity_W_mK: float, density_kg_m3: float, heat_capacity_J_kgK: float, description: str) -> Any:
    """Declare a parameter that holds a material."""
    default = Material(
        conductivity_W_mK=conductivity_W_mK, density_kg_m3=density_kg_m3, heat_capacity_J_kgK=heat_capacity_J_kgK
    )
    return parameter(default, unit="", description=description, source=ISO_10456)


Side = Literal["south", "west", "north", "east"]
SIDES: tuple[Side, ...] = ("south", "west", "north", "east")


class Widths(Parameters):
    """Widths of a rectangular room along its south and its west side."""

    south: float = parameter(4.0, unit="m", description="south side", source="chosen: gives 10.4 m2", gt=0, le=50)
    west: float = parameter(2.6, unit="m", description="west side", source="chosen: gives 10.4 m2", gt=0, le=50)

    def along(self, side: Side) -> float:
        return self.south if side in ("south", "north") else self.west


class WindowAreas(Parameters):
    """Window areas of the facades."""

    south: float = parameter(3.0, unit="m2", description="south windows", source="Table 3", ge=0, le=500)
    west: float = parameter(3.0, unit="m2", description="west windows", source="Table 3", ge=0, le=500)
    north: float = parameter(0.0, unit="m2", description="north windows", source="Table 3: none", ge=0, le=500)
    east: float = parameter(0.0, unit="m2", description="east windows", source="Table 3: none", ge=0, le=500)

    def on(self, side: Side) -> float:
        return {"south": self.south, "west": self.west, "north": self.north, "east": self.east}[side]


class Table3(Parameters):
    """The room of Table 3; what the table leaves open is chosen and says so."""

    facade_m: Widths = parameter(Widths(), unit="m", description="widths of the room", source="chosen: 10.4 m2")
    outer_walls: tuple[Side, ...] = parameter(
        ("south", "west"),
        unit="",
        description="sides towards the outdoors; the others are partitions to rooms that are as warm",
        source="section 3.3: a corner room",
        strict=False,
    )
    height_m: float = parameter(
        2.6, unit="m", description="room height", source="chosen: the paper says nothing", gt=0, le=20
    )
    window_area_m2: WindowAreas = parameter(WindowAreas(), unit="m2", description="window areas", source="Table 3")
    window_height_m: float = parameter(
        1.5, unit="m", description="window height, for the view from the middle", source="chosen", gt=0, le=20
    )
    window_sill_m: float = parameter(
        0.8,
        unit="m",
        description="height of the sill; windows sit in the middle of the facade",
        source="chosen",
        ge=0,
        le=20,
    )
    window_U_W_m2K: float = parameter(0.75, unit="W/(m2 K)", description="U of windows", source="Table 3", gt=0, le=7)
    window_g: float = parameter(0.3, unit="1", description="solar transmittance", source="Table 3", ge=0, le=1)
    window_secondary_share: float = parameter(
        0.12,
        unit="1",
        description="share of g that the inner pane gives to the room",
        source="chosen: coated triple glazing by EN 410, order of magnitude",
        ge=0,
        le=1,
    )
    wall_U_W_m2K: float = parameter(0.12, unit="W/(m2 K)", description="U of outer walls", source="Table 3", gt=0, le=5)
    floor_U_W_m2K: float = parameter(
        0.08, unit="W/(m2 K)", description="U of the floor above outdoor air", source="Table 3", gt=0, le=5
    )
    ceiling: Literal["adiabatic", "outdoors"] = parameter(
        "adiabatic",
        unit="",
        description="what lies above the ceiling",
        source="chosen: Table 3 lists no roof, and the heat balance closes without one",
    )
    roof_U_W_m2K: float = parameter(
        0.08,
        unit="W/(m2 K)",
        description="U of the roof if the ceiling is 'outdoors'",
        source="chosen",
        gt=0,
        le=5,
    )
    thermal_bridge_W_m2K: float = parameter(
        0.031, unit="W/(m2 K)", description="per area of external surface", source="Table 3", ge=0, le=5
    )
    infiltration_L_s_m2: float = parameter(
        0.0048, unit="L/(s m2)", description="per area of external surface", source="Table 3", ge=0, le=10
    )
    ventilation_L_s_m2: float = parameter(
        0.5, unit="L/(s m2)", description="supply air per floor area", source="section 3.3", ge=0, le=50
    )
    ventilation_supply_C: float = parameter(
        18.0, unit="C", description="supply air temperature", source="section 3.3", ge=-40, le=60
    )
    air_capacity_multiplier: float = parameter(
        3.2,
        unit="1",
        description="air and furniture over air",
        source="chosen: ISO 52016-1, 10 kJ/(m2 K) of floor for air and furniture",
        ge=1,
        le=50,
    )
    screed_above_m: float = parameter(
        0.040, unit="m", description="screed above the pipes", source="Table 3", gt=0, le=1
    )
    screed_below_m: float = parameter(
        0.020, unit="m", description="screed below the pipes", source="chosen", gt=0, le=1
    )
    concrete_m: float = parameter(0.050, unit="m", description="concrete below the screed", source="chosen", gt=0, le=1)
    gypsum_m: float = parameter(0.013, unit="m", description="board inside outer walls", source="chosen", gt=0, le=1)
    partition_gypsum_m: float = parameter(
        0.013,
        unit="m",
        description="board of inner walls and ceiling",
        source="chosen: light partitions",
        gt=0,
        le=1,
    )
    partition_wool_m: float = parameter(
        0.050,
        unit="m",
        description="half the wool in inner walls and an adiabatic ceiling",
        source="chosen",
        gt=0,
        le=1,
    )
    cladding_m: float = parameter(0.020, unit="m", description="boards outside", source="chosen", gt=0, le=1)
    screed: Material = material(1.2, 2000.0, 1000.0, "screed")
    concrete: Material = material(2.0, 2300.0, 900.0, "concrete of the floor")
    gypsum: Material = material(0.25, 850.0, 1000.0, "gypsum board")
    wool: Material = material(0.035, 30.0, 1030.0, "wool in walls and roof; studs are in the U-value")
    eps: Material = material(0.035, 20.0, 1450.0, "expanded polystyrene of the floor")
    cladding: Material = material(0.13, 500.0, 1600.0, "timber boards")
    circuit: Circuit = parameter(Circuit(), unit="", description="heating circuit", source="Table 3")
    films: Films = parameter(Films(), unit="", description="films", source="EN ISO 6946, EN 1264-2")
    gains: Gains = parameter(Gains(), unit="", description="internal gains", source="section 3.3")
    sun: Sun = parameter(Sun(), unit="", description="sun in the room", source="chosen")
    shading: Shading = parameter(Shading(), unit="", description="external shading of the windows", source="chosen")
    sensing: Sensing = parameter(Sensing(), unit="", description="operative point and sensor", source="chosen")
    operative_height_m: float = parameter(
        0.6,
        unit="m",
        description="operative point above the middle of the floor",
        source="section 3.3",
        gt=0,
        le=20,
    )
    cell_time_s: float = parameter(
        300.0,
        unit="s",
        description="time in which heat crosses one cell of a layer",
        source="chosen: see docs/room-equations.md for the error",
        ge=10,
        le=86_400,
    )
