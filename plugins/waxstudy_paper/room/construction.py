"""What a room is made of: layers, surfaces and windows."""

from __future__ import annotations

from typing import Literal

from waxstudy.plugin import Facade, Parameters, parameter

STUDY = "the study"
HEAVIEST_KG_M3, THICKEST_M = 20_000.0, 5.0  # of a layer

Facing = Literal["wall", "floor", "ceiling"]
Boundary = Literal["outdoors", "ground", "adiabatic"]


class Material(Parameters):
    """Conductivity and heat capacity of a homogeneous material."""

    conductivity_W_mK: float = parameter(unit="W/(m K)", description="thermal conductivity", source=STUDY, gt=0, le=500)
    density_kg_m3: float = parameter(
        unit="kg/m3", description="density; 0 makes a layer without mass", source=STUDY, ge=0, le=HEAVIEST_KG_M3
    )
    heat_capacity_J_kgK: float = parameter(
        unit="J/(kg K)", description="specific heat capacity", source=STUDY, gt=0, le=10_000
    )


class Layer(Material):
    """A layer of one material."""

    thickness_m: float = parameter(unit="m", description="thickness", source=STUDY, gt=0, le=THICKEST_M)

    @property
    def resistance_m2K_W(self) -> float:
        return self.thickness_m / self.conductivity_W_mK

    @property
    def capacity_J_m2K(self) -> float:
        return self.thickness_m * self.density_kg_m3 * self.heat_capacity_J_kgK


class Part(Parameters):
    """A flat part of the room's shell."""

    name: str = parameter(unit="", description="name, unique in the room", source=STUDY, min_length=1)
    area_m2: float = parameter(
        unit="m2", description="area; of a surface without windows", source=STUDY, gt=0, le=10_000
    )
    operative_weight: float | None = parameter(
        None,
        unit="1",
        description="share of the sphere around the operative point that it fills, on any scale",
        source="chosen: without any weights, areas are the weights",
        ge=0,
        le=1e6,
    )
    tilt_deg: float = parameter(90.0, unit="deg", description="90 is vertical, 0 looks up", source=STUDY, ge=0, le=180)

    @property
    def facade(self) -> Facade | None:
        """The direction that the sun is asked for; None where the sun does not matter."""
        return None


class Surface(Part):
    """An opaque part of the shell."""

    facing: Facing = parameter(
        "wall", unit="", description="which convective coefficient its room side has", source=STUDY
    )
    boundary: Boundary = parameter(unit="", description="what lies behind the last layer", source=STUDY)
    layers: tuple[Layer, ...] = parameter(
        unit="", description="layers from the room outwards", source=STUDY, min_length=1, strict=False
    )
    solar_absorptance: float = parameter(
        0.0,
        unit="1",
        description="share of the sun on its outer side that is absorbed; above 0 it needs azimuth_deg",
        source="chosen: 0, the sun on a dark wall of U = 0.12 adds about 2 % to that through the windows",
        ge=0,
        le=1,
    )

    azimuth_deg: float | None = parameter(
        None, unit="deg", description="outward direction from north, clockwise", source=STUDY, ge=0, lt=360
    )

    @property
    def facade(self) -> Facade | None:
        if self.solar_absorptance == 0 or self.azimuth_deg is None:
            return None
        return Facade(self.azimuth_deg, self.tilt_deg)


class Window(Part):
    """A window: U includes both films; g counts what is let through and what the panes give to the room."""

    U_W_m2K: float = parameter(
        unit="W/(m2 K)", description="U-value of glass and frame, with both films", source=STUDY, gt=0, le=10
    )
    g: float = parameter(
        unit="1",
        description="total solar energy transmittance, at normal incidence if panes are given, else at any angle",
        source=STUDY,
        ge=0,
        le=1,
    )
    secondary_share: float = parameter(
        0.12,
        unit="1",
        description="share of g that is absorbed in the panes and reaches the room as heat from the inner pane",
        source="chosen: coated triple glazing by EN 410, order of magnitude; the paper gives g only",
        ge=0,
        le=1,
    )
    panes: int = parameter(
        0,
        unit="1",
        description="number of panes, by which g falls with the angle of incidence; 0 leaves it constant",
        source="chosen: 0, g as the paper gives it; see docs/room-equations.md for the equation",
        ge=0,
        le=5,
    )
    azimuth_deg: float = parameter(
        unit="deg", description="outward direction from north, clockwise", source=STUDY, ge=0, lt=360
    )

    @property
    def facade(self) -> Facade:
        return Facade(self.azimuth_deg, self.tilt_deg, self.panes)
