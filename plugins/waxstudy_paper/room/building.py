"""Room `nzeb` told in words and numbers, as people have them, and its parameters from these."""

from __future__ import annotations

from collections.abc import Iterable
from math import sqrt
from typing import Any

from waxstudy.plugin import Parameters, parameter
from waxstudy_paper.room.hydronics import CurvePoint
from waxstudy_paper.room.table3 import SIDES, Side, Table3, Widths

BUILT = "as built"
AGREES = 0.02  # floor area and widths may differ by so much
LARGEST_DIFFERENCE = 0.4  # beyond, they contradict each other
# what a description should have; without it, Table 3 is a poor guess for another room
EXPECTED = (
    "height_m",
    "window_U_W_m2K",
    "window_g",
    "wall_U_W_m2K",
    "floor_U_W_m2K",
    "thermal_bridge_W_m2K",
    "infiltration_L_s",
    "ventilation_L_s",
    "nominal_flow_L_h",
    "heating_curve_C",
)


def external_m2(widths: Widths, outer: Iterable[Side], height_m: float, ceiling: str) -> float:
    """Return outer walls with their windows, the floor, and the roof if there is one."""
    floor_m2 = widths.south * widths.west
    walls_m2 = sum(widths.along(side) for side in outer) * height_m
    return walls_m2 + floor_m2 * (2 if ceiling == "outdoors" else 1)


class Facades(Widths):
    """Widths of the facades, which are the sides towards the outdoors; opposite ones are equal."""

    north: float | None = parameter(None, unit="m", description="north side", source=BUILT, gt=0, le=50)
    east: float | None = parameter(None, unit="m", description="east side", source=BUILT, gt=0, le=50)


class Pipe(Parameters):
    """The pipe in the floor."""

    outer_mm: float | None = parameter(None, unit="mm", description="outer diameter", source=BUILT, gt=0, le=100)
    wall_mm: float | None = parameter(None, unit="mm", description="wall thickness", source=BUILT, gt=0, le=20)
    spacing_mm: float | None = parameter(None, unit="mm", description="spacing", source=BUILT, gt=0, le=1000)
    conductivity_W_mK: float | None = parameter(
        None, unit="W/(m K)", description="of the pipe's wall", source=BUILT, gt=0, le=500
    )


class NzebBuilding(Table3):
    """`[building]`: numbers of a room as people have them; parameters of `nzeb` are understood as well."""

    facade_m: Facades = parameter(
        Facades(), unit="m", description="widths of the facades; what is not named is a partition", source=BUILT
    )
    floor_area_m2: float | None = parameter(None, unit="m2", description="floor area", source=BUILT, gt=0, le=2500)
    screed_W_mK: float | None = parameter(
        None, unit="W/(m K)", description="conductivity of the screed", source=BUILT, gt=0, le=500
    )
    screed_J_m3K: float | None = parameter(
        None, unit="J/(m3 K)", description="heat capacity of the screed", source=BUILT, ge=1e4, le=1e7
    )
    concrete_J_m3K: float | None = parameter(
        None, unit="J/(m3 K)", description="heat capacity of the concrete", source=BUILT, ge=1e4, le=1e7
    )
    pipe: Pipe | None = parameter(None, unit="", description="the pipe in the floor", source=BUILT)
    water_to_surface_resistance_m2K_W: float | None = parameter(
        None, unit="m2 K/W", description="between water and floor surface per floor area", source=BUILT, gt=0, le=5
    )
    infiltration_L_s: float | None = parameter(
        None, unit="L/s", description="outdoor air through leaks", source=BUILT, ge=0, le=10_000
    )
    ventilation_L_s: float | None = parameter(None, unit="L/s", description="supply air", source=BUILT, ge=0, le=10_000)
    gain_radiant_share: float | None = parameter(
        None, unit="1", description="share of the internal gains that is radiated", source=BUILT, ge=0, le=1
    )
    nominal_flow_L_h: float | None = parameter(
        None, unit="L/h", description="flow with the valve open", source=BUILT, gt=0, le=10_000
    )
    heating_curve_C: tuple[CurvePoint, ...] | None = parameter(
        None, unit="C", description="[outdoor, supply] points", source=BUILT, min_length=1, strict=False
    )


def parameters_of(b: NzebBuilding) -> tuple[dict[str, Any], list[str]]:
    """Return the parameters of `nzeb` in a study's words, and what was assumed; raise `ValueError`."""
    given = b.model_fields_set
    said: list[str] = []
    if lacking := [key for key in EXPECTED if key not in given and f"{key}_m2" not in given]:
        said.append(f"Not told in [building], so as in Table 3: {', '.join(lacking)}.")
    own = given & set(Table3.model_fields) - {"facade_m"}
    words = b.model_dump(mode="json", include=own, exclude_unset=True)
    words |= _plan(b, said)
    words |= _per_area(b, words)
    words |= _materials(b)
    words["circuit"] = {**words.get("circuit", {}), **_circuit(b, said)}
    if b.gain_radiant_share is not None:
        words["gains"] = {**words.get("gains", {}), "radiant_share": b.gain_radiant_share}
    return words, said


def _plan(b: NzebBuilding, said: list[str]) -> dict[str, Any]:
    """Return widths, outer walls and windows: sides that have no facade are partitions and have no window."""
    widths = _widths(b, said)
    if "facade_m" not in b.model_fields_set:
        said.append("No facade_m is told: the outer walls are south and west, as in Table 3.")
        return {"facade_m": widths.model_dump()}
    outer = [side for side in SIDES if side in b.facade_m.model_fields_set]
    windows: dict[str, float] = dict.fromkeys(SIDES, 0.0)
    if "window_area_m2" in b.model_fields_set:
        windows |= b.window_area_m2.model_dump(exclude_unset=True)
    else:
        said.append("No window_area_m2 is told: the room has no window.")
    plan = {"facade_m": widths.model_dump(), "window_area_m2": windows}
    return plan if "outer_walls" in b.model_fields_set else {**plan, "outer_walls": outer}


def _widths(b: NzebBuilding, said: list[str]) -> Widths:
    """Return the widths that the facades and the floor area give together; the plan is a rectangle."""
    along, across = _told(b, "south", "north"), _told(b, "west", "east")
    area, table3 = b.floor_area_m2, Widths()
    if area is None:
        if along is None or across is None:
            said.append("The plan is not told completely: what is missing is as in Table 3, 4.0 x 2.6 m.")
        return Widths(south=along or table3.south, west=across or table3.west)
    if along is None and across is None:
        along, across = table3.south, table3.west  # the shape alone, scaled below
    width = along if along is not None else area / (across or 1.0)
    depth = across if across is not None else area / width
    ratio = area / (width * depth)
    told_both = _told(b, "south", "north") is not None and _told(b, "west", "east") is not None
    if told_both and abs(ratio - 1.0) > LARGEST_DIFFERENCE:
        raise ValueError(f"floor_area_m2 = {area:g} contradicts facade_m, which gives {width * depth:.3g} m2")
    if abs(ratio - 1.0) <= AGREES:
        ratio = 1.0
    elif told_both:
        said.append(f"facade_m gives {width * depth:.3g} m2: its widths are scaled to the floor area of {area:g} m2.")
    return Widths(south=width * sqrt(ratio), west=depth * sqrt(ratio))


def _told(b: NzebBuilding, side: Side, opposite: Side) -> float | None:
    """Return the width that two opposite sides have; None if it is not told."""
    if "facade_m" not in b.model_fields_set:
        return None
    told = {s: getattr(b.facade_m, s) for s in (side, opposite) if s in b.facade_m.model_fields_set}
    widths = [width for width in told.values() if width is not None]
    if widths and max(widths) > (1.0 + AGREES) * min(widths):
        raise ValueError(f"facade_m: {side} and {opposite} of a rectangular room are equal")
    return widths[0] if widths else None


def _per_area(b: NzebBuilding, words: dict[str, Any]) -> dict[str, float]:
    """Return flows of air per area, as the parameters have them."""
    widths = Widths(**words["facade_m"])
    found: dict[str, float] = {}
    if b.infiltration_L_s is not None:
        outer = words.get("outer_walls", b.outer_walls)
        found["infiltration_L_s_m2"] = b.infiltration_L_s / external_m2(widths, outer, b.height_m, b.ceiling)
    if b.ventilation_L_s is not None:
        found["ventilation_L_s_m2"] = b.ventilation_L_s / (widths.south * widths.west)
    return found


def _materials(b: NzebBuilding) -> dict[str, dict[str, float]]:
    """Return materials with the heat capacity per volume that is told; the density stays."""
    found: dict[str, dict[str, float]] = {}
    if b.screed_W_mK is not None or b.screed_J_m3K is not None:
        found["screed"] = b.screed.model_dump()
    if b.screed_W_mK is not None:
        found["screed"]["conductivity_W_mK"] = b.screed_W_mK
    if b.screed_J_m3K is not None:
        found["screed"]["heat_capacity_J_kgK"] = b.screed_J_m3K / b.screed.density_kg_m3
    if b.concrete_J_m3K is not None:
        capacity = b.concrete_J_m3K / b.concrete.density_kg_m3
        found["concrete"] = {**b.concrete.model_dump(), "heat_capacity_J_kgK": capacity}
    return found


def _circuit(b: NzebBuilding, said: list[str]) -> dict[str, Any]:
    """Return the circuit: the exchange as stated, or by the pipe's resistances where a pipe is told."""
    found: dict[str, Any] = {}
    if b.pipe is not None:
        ours = {"outer_mm": "pipe_outer_m", "wall_mm": "pipe_wall_m", "spacing_mm": "spacing_m"}
        told = b.pipe.model_dump(exclude_unset=True, exclude_none=True)
        found = {ours[key]: value / 1000.0 for key, value in told.items() if key in ours}
        if "conductivity_W_mK" in told:
            found["pipe_conductivity_W_mK"] = told["conductivity_W_mK"]
        found["exchange"] = "pipe"
    if b.water_to_surface_resistance_m2K_W is not None:
        found |= {"exchange": "stated", "water_to_surface_m2K_W": b.water_to_surface_resistance_m2K_W}
        said.append(
            f"The resistance of {b.water_to_surface_resistance_m2K_W:g} m2 K/W is that between the water (logarithmic "
            "mean) and the floor surface in steady state, per floor area, at any flow; what the screed above the pipes "
            "does not account for lies between the water and the plane of the pipes."
        )
    elif b.pipe is not None:
        said.append("Water gives its heat to the floor by the pipe's resistances (ISO 11855-2).")
    if b.nominal_flow_L_h is not None:
        found["full_flow_L_h"] = b.nominal_flow_L_h
    if b.heating_curve_C is not None:
        found["heating_curve_C"] = [list(point) for point in b.heating_curve_C]
    return found
