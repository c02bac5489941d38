"""The corner room of the paper's Table 3 in the words of room `surfaces`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Self

from pydantic import ValidationError, model_validator

from waxstudy.plugin import Choice
from waxstudy.plugin.wording import reasons
from waxstudy_paper.room.building import external_m2
from waxstudy_paper.room.conditions import Air
from waxstudy_paper.room.construction import THICKEST_M, Boundary, Facing, Layer, Material, Surface, Window
from waxstudy_paper.room.description import HeatedFloor, RoomDescription
from waxstudy_paper.room.table3 import SIDES, Side, Table3
from waxstudy_paper.room.view import Rectangle

Layers = tuple[Layer, ...]
AZIMUTH_DEG: dict[Side, float] = {"south": 180.0, "west": 270.0, "north": 0.0, "east": 90.0}


class NzebParameters(Table3):
    """The parameters of Table 3, checked to give a room that is possible."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        problems = list(_misfits(self))
        if problems:
            raise ValueError("; ".join(problems))
        try:
            describe(self)
        except ValidationError as error:
            raise ValueError(reasons(error)) from None
        return self

    @property
    def floor_area_m2(self) -> float:
        return self.facade_m.south * self.facade_m.west

    @property
    def external_m2(self) -> float:
        return external_m2(self.facade_m, self.outer_walls, self.height_m, self.ceiling)

    @property
    def glazed(self) -> tuple[Side, ...]:
        """The sides with windows."""
        return tuple(side for side in SIDES if self.window_area_m2.on(side) > 0.0)


def _misfits(p: NzebParameters) -> Iterator[str]:
    if p.operative_height_m >= p.height_m:
        yield "operative_height_m is not below the ceiling"
    if p.window_sill_m + p.window_height_m > p.height_m:
        yield "window_sill_m and window_height_m are together more than height_m"
    if len(set(p.outer_walls)) < len(p.outer_walls):
        yield "outer_walls names a side twice"
    for side in p.glazed:
        width, area = p.facade_m.along(side), p.window_area_m2.on(side)
        if side not in p.outer_walls:
            yield f"window_area_m2.{side} = {area:g}, but {side} is not among outer_walls"
        elif area >= width * p.height_m or area / p.window_height_m > width:
            yield f"window_area_m2.{side} = {area:g} does not fit into a facade of {width:g} m at window_height_m"


def described(room: Choice) -> RoomDescription:
    """Return a room `nzeb` or `surfaces` in the words of `surfaces`."""
    parameters: Any = room.parameters
    return parameters if isinstance(parameters, RoomDescription) else describe(parameters)


def describe(p: NzebParameters) -> RoomDescription:
    """Return the room of Table 3 in the words of room `surfaces`."""
    return RoomDescription(
        surfaces=tuple(_surfaces(p)),
        windows=tuple(_windows(p)),
        air=Air(
            volume_m3=p.floor_area_m2 * p.height_m,
            capacity_multiplier=p.air_capacity_multiplier,
            ventilation_L_s=p.ventilation_L_s_m2 * p.floor_area_m2,
            ventilation_supply_C=p.ventilation_supply_C,
            infiltration_L_s=p.infiltration_L_s_m2 * p.external_m2,
            thermal_bridges_W_K=p.thermal_bridge_W_m2K * p.external_m2,
        ),
        heated_floor=HeatedFloor(surface="floor", pipes_after_layer=1),
        circuit=p.circuit,
        films=p.films,
        gains=p.gains,
        sun=p.sun,
        shading=p.shading,
        sensing=p.sensing,
        cell_time_s=p.cell_time_s,
    )


def _surfaces(p: NzebParameters) -> Iterator[Surface]:
    views = solid_angles_sr(p)
    wall = p.films.interior_m2K_W("wall")
    board, cladding = _layer(p.gypsum, p.gypsum_m), _layer(p.cladding, p.cladding_m)
    outer = _insulated(p, "wall_U_W_m2K", (board,), p.wool, (cladding,), wall)
    partition = (_layer(p.gypsum, p.partition_gypsum_m), _layer(p.wool, p.partition_wool_m))
    for side in SIDES:
        area = p.facade_m.along(side) * p.height_m
        if side in p.outer_walls:
            opaque = area - p.window_area_m2.on(side)
            yield _surface(f"{side} wall", opaque, "wall", "outdoors", outer, views)
        else:
            yield _surface(f"{side} partition", area, "wall", "adiabatic", partition, views)
    yield _surface("floor", p.floor_area_m2, "floor", "outdoors", _floor_layers(p), views)
    if p.ceiling == "outdoors":
        board = _layer(p.gypsum, p.partition_gypsum_m)
        layers = _insulated(p, "roof_U_W_m2K", (board,), p.wool, (cladding,), p.films.interior_m2K_W("ceiling"))
    else:
        layers = partition
    yield _surface("ceiling", p.floor_area_m2, "ceiling", p.ceiling, layers, views)


def _surface(
    name: str, area_m2: float, facing: Facing, boundary: Boundary, layers: Layers, views: dict[str, float]
) -> Surface:
    return Surface(
        name=name, area_m2=area_m2, facing=facing, boundary=boundary, layers=layers, operative_weight=views[name]
    )


def _floor_layers(p: NzebParameters) -> Layers:
    above = _layer(p.screed, p.screed_above_m)
    below = _layer(p.screed, p.screed_below_m)
    inner = (above, below, _layer(p.concrete, p.concrete_m))
    return _insulated(p, "floor_U_W_m2K", inner, p.eps, (), p.films.interior_m2K_W("floor"))


def _layer(material: Material, thickness_m: float) -> Layer:
    return Layer(thickness_m=thickness_m, **material.model_dump())


def _insulated(
    p: NzebParameters, u_value: str, inner: Layers, insulation: Material, outer: Layers, film_m2K_W: float
) -> Layers:
    """Return the layers with as much insulation as the U-value asks for, films included."""
    others = film_m2K_W + sum(layer.resistance_m2K_W for layer in (*inner, *outer)) + 1 / p.films.exterior_W_m2K
    needed_m2K_W = 1 / getattr(p, u_value) - others
    if needed_m2K_W <= 0:
        raise ValueError(f"{u_value}: without any insulation it is {1 / others:.3g} already")
    thickness_m = needed_m2K_W * insulation.conductivity_W_mK
    if thickness_m > THICKEST_M:
        raise ValueError(f"{u_value}: it would need {thickness_m:.3g} m of insulation, at most {THICKEST_M:g} m")
    return (*inner, _layer(insulation, thickness_m), *outer)


def _windows(p: NzebParameters) -> Iterator[Window]:
    views = solid_angles_sr(p)
    for side in p.glazed:
        name = f"{side} window"
        yield Window(
            name=name,
            area_m2=p.window_area_m2.on(side),
            U_W_m2K=p.window_U_W_m2K,
            g=p.window_g,
            secondary_share=p.window_secondary_share,
            azimuth_deg=AZIMUTH_DEG[side],
            operative_weight=views[name],
        )


def solid_angles_sr(p: NzebParameters) -> dict[str, float]:
    """Return the solid angles with which the operative point sees surfaces and windows; together 4 pi."""
    width, depth, up, down = (
        p.facade_m.south,
        p.facade_m.west,
        p.height_m - p.operative_height_m,
        p.operative_height_m,
    )
    angles = {
        "floor": _centred(down, width, -depth / 2, depth / 2),
        "ceiling": _centred(up, width, -depth / 2, depth / 2),
    }
    for side in SIDES:
        distance = (depth if side in ("south", "north") else width) / 2
        whole = _centred(distance, p.facade_m.along(side), -down, up)
        window = _window_sr(p, side, distance) if side in p.glazed else 0.0
        if side in p.outer_walls:
            angles |= {f"{side} window": window, f"{side} wall": whole - window}
        else:
            angles[f"{side} partition"] = whole
    return angles


def _window_sr(p: NzebParameters, side: Side, distance_m: float) -> float:
    sill = p.window_sill_m - p.operative_height_m
    return _centred(distance_m, p.window_area_m2.on(side) / p.window_height_m, sill, sill + p.window_height_m)


def _centred(distance_m: float, width_m: float, bottom_m: float, top_m: float) -> float:
    return Rectangle(distance_m, -width_m / 2, width_m / 2, bottom_m, top_m).solid_angle_sr
