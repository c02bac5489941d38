"""The heating circuit: flow, water-to-floor heat exchange and supply temperature."""

from __future__ import annotations

from itertools import pairwise
from math import log, pi
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from waxstudy.plugin import FloatArray, Parameters, parameter

# water at 30 C
WATER_J_L_K = 4161.0  # density times specific heat
WATER_W_MK = 0.616
WATER_M2_S = 0.80e-6
WATER_PRANDTL = 5.4

CurvePoint = Annotated[tuple[float, float], Field(strict=False)]


class Circuit(Parameters):
    """The pipes in the floor, their design point and the supply temperature."""

    spacing_m: float = parameter(0.300, unit="m", description="pipe spacing", source="Table 3", gt=0, le=1)
    pipe_outer_m: float = parameter(0.020, unit="m", description="outer pipe diameter", source="Table 3", gt=0, le=0.1)
    pipe_wall_m: float = parameter(0.002, unit="m", description="pipe wall thickness", source="Table 3", gt=0, le=0.02)
    pipe_conductivity_W_mK: float = parameter(
        0.35, unit="W/(m K)", description="of the pipe wall", source="EN 1264-2: PEX", gt=0, le=500
    )
    nominal_output_W_m2: float = parameter(
        68.0, unit="W/m2", description="output at the design temperatures", source="Table 3", gt=0, le=500
    )
    design_supply_C: float = parameter(34.0, unit="C", description="at design", source="Table 3", ge=0, le=95)
    design_return_C: float = parameter(29.0, unit="C", description="at design", source="Table 3", ge=0, le=95)
    design_room_C: float = parameter(
        20.0, unit="C", description="room temperature at design", source="chosen: EN 1264-2", ge=0, le=40
    )
    full_flow_L_h: float | None = parameter(
        None,
        unit="L/h",
        description="flow with the valve open",
        source="chosen: what the nominal output needs at the design temperatures",
        gt=0,
        le=10_000,
    )
    exchange: Literal["nominal", "pipe", "stated"] = parameter(
        "nominal",
        unit="",
        description="water-to-layer exchange: from the nominal output, from the pipe's resistances, or from "
        "water_to_surface_m2K_W",
        source="section 3.3: logarithmic temperature differences to one layer; 'pipe' is ISO 11855-2",
    )
    water_to_surface_m2K_W: float | None = parameter(
        None,
        unit="m2 K/W",
        description="resistance between water and floor surface per floor area, in steady state, for exchange 'stated'",
        source="given by the user, as measured or from a floor's data sheet",
        gt=0,
        le=5,
    )
    design_cover_m2K_W: float | None = parameter(
        None,
        unit="m2 K/W",
        description="layers above the pipes that the nominal output is stated for; none given: those of the floor",
        source="chosen: a cover laid later takes from the output and leaves the pipes as they are",
        ge=0,
        le=5,
    )
    exchange_factor: float = parameter(
        1.0,
        unit="1",
        description="factor on the water-to-layer exchange",
        source="chosen: 1; other programs have a far stronger exchange, and more resistance above the pipes",
        ge=0.01,
        le=100,
    )
    heating_curve_C: tuple[CurvePoint, ...] = parameter(
        ((-22.0, 34.0), (20.0, 22.0)),
        unit="C",
        description="[outdoor, supply] points, straight between them, held outside",
        source="chosen: figure B1 is not in the text; design supply at the design outdoor temperature of Tallinn",
        min_length=1,
        strict=False,
    )

    @model_validator(mode="after")
    def _possible(self) -> Self:
        outdoor = [point[0] for point in self.heating_curve_C]
        if any(right <= left for left, right in pairwise(outdoor)):
            raise ValueError("heating_curve_C: outdoor temperatures must rise from point to point")
        if not self.design_room_C < self.design_return_C < self.design_supply_C:
            raise ValueError("design temperatures must rise from room over return to supply")
        if 2 * self.pipe_wall_m >= self.pipe_outer_m:
            raise ValueError("pipe_wall_m leaves no bore in the pipe")
        if self.exchange == "pipe" and self.spacing_m <= pi * self.pipe_outer_m:
            raise ValueError("spacing_m must exceed pi pipe diameters for the resistance method")
        if (self.exchange == "stated") != (self.water_to_surface_m2K_W is not None):
            raise ValueError('water_to_surface_m2K_W and exchange = "stated" go together')
        return self


def supply_C(circuit: Circuit, outdoor_C: FloatArray) -> FloatArray:
    """Return the supply temperature [C] of the heating curve, straight between its points and held outside."""
    outdoor, supply = np.array(circuit.heating_curve_C).T
    return np.asarray(np.interp(outdoor_C, outdoor, supply))


def full_flow_L_h(circuit: Circuit, area_m2: float) -> float:
    """Return the flow with the valve open [L/h]: as given, or q_N A / (rho c (T_supply - T_return))."""
    if circuit.full_flow_L_h is not None:
        return circuit.full_flow_L_h
    drop_K = circuit.design_supply_C - circuit.design_return_C
    return circuit.nominal_output_W_m2 * area_m2 / (WATER_J_L_K * drop_K) * 3600.0


def nominal_film_m2K_W(circuit: Circuit) -> float:
    """Return the film of a heated floor at the nominal output: q = 8.92 dT^1.1 (EN 1264-2)."""
    output = circuit.nominal_output_W_m2
    return float((output / 8.92) ** (1.0 / 1.1) / output)


def nominal_exchange_W_m2K(circuit: Circuit, cover_m2K_W: float) -> float:
    """Return the exchange between water and layer that meets the nominal output at the design temperatures.

    k = q_N / LMTD(T_supply - T_layer, T_return - T_layer),  T_layer = T_room + q_N R_cover,
    with R_cover the layers above the pipes and the floor's film at that output [m2 K/W]. Heat lost downwards
    is not counted. Raises `ValueError` if the layer would have to be warmer than the return.
    """
    layer_C = circuit.design_room_C + circuit.nominal_output_W_m2 * cover_m2K_W
    cold_K, warm_K = circuit.design_return_C - layer_C, circuit.design_supply_C - layer_C
    if cold_K <= 0:
        raise ValueError(
            f"nominal_output_W_m2 = {circuit.nominal_output_W_m2:g} needs {layer_C:.1f} C "
            f"in the plane of the pipes, above the return of {circuit.design_return_C:g} C"
        )
    return circuit.nominal_output_W_m2 * log(warm_K / cold_K) / (warm_K - cold_K)


def film_W_m2K(flow_L_s: FloatArray, bore_m: float) -> FloatArray:
    """Return the water film in a long smooth pipe [W/(m2 K)].

    Nu = 3.66 below Re = 2300, Gnielinski above 10 000, straight between (VDI Heat Atlas, G1).
    """
    reynolds = 4.0 * flow_L_s * 1e-3 / (pi * bore_m * WATER_M2_S)
    turbulent = np.maximum(reynolds, 1e4)
    friction = (1.8 * np.log10(turbulent) - 1.5) ** -2 / 8.0
    gnielinski = friction * turbulent * WATER_PRANDTL
    gnielinski /= 1.0 + 12.7 * np.sqrt(friction) * (WATER_PRANDTL ** (2 / 3) - 1.0)
    share = np.clip((reynolds - 2300.0) / 7700.0, 0.0, 1.0)
    return ((1.0 - share) * 3.66 + share * gnielinski) * WATER_W_MK / bore_m


def pipe_exchange_W_m2K(circuit: Circuit, screed_W_mK: float, flow_L_s: FloatArray) -> FloatArray:
    """Return the exchange between water and layer by the resistance method, per floor area.

    1/k = s / (pi d_i h(flow)) + s ln(d/d_i) / (2 pi lambda_pipe) + s ln(s/(pi d)) / (2 pi lambda_screed)
    Source: ISO 11855-2, resistance method. Its water film is for turbulent flow only; ours is also for laminar.
    """
    spacing, outer = circuit.spacing_m, circuit.pipe_outer_m
    bore = outer - 2 * circuit.pipe_wall_m
    wall = spacing * log(outer / bore) / (2 * pi * circuit.pipe_conductivity_W_mK)
    spread = spacing * log(spacing / (pi * outer)) / (2 * pi * screed_W_mK)
    return 1.0 / (spacing / (pi * bore * film_W_m2K(flow_L_s, bore)) + wall + spread)


def stated_exchange_W_m2K(circuit: Circuit, cover_m2K_W: float) -> float:
    """Return the exchange between water and layer that leaves the stated resistance between water and floor surface.

    1/k = R_stated - R_layers above; heat lost downwards is not counted. Raises `ValueError` if the layers alone have
    more. `cover_m2K_W` has the floor's film in it, as for the nominal output.
    """
    above_m2K_W = cover_m2K_W - nominal_film_m2K_W(circuit)
    stated_m2K_W = circuit.water_to_surface_m2K_W or 0.0
    if stated_m2K_W <= above_m2K_W:
        raise ValueError(
            f"water_to_surface_m2K_W = {stated_m2K_W:g} is not above the {above_m2K_W:.3g} of the layers over the pipes"
        )
    return 1.0 / (stated_m2K_W - above_m2K_W)


def exchange_W_m2K(circuit: Circuit, cover_m2K_W: float, screed_W_mK: float, flow_L_s: FloatArray) -> FloatArray:
    """Return the exchange between water and layer per floor area: the circuit's way times its `exchange_factor`."""
    if circuit.exchange == "pipe":
        return pipe_exchange_W_m2K(circuit, screed_W_mK, flow_L_s) * circuit.exchange_factor
    way = nominal_exchange_W_m2K if circuit.exchange == "nominal" else stated_exchange_W_m2K
    return np.full_like(flow_L_s, way(circuit, cover_m2K_W)) * circuit.exchange_factor


def floor_conductance_W_K(
    circuit: Circuit, area_m2: float, cover_m2K_W: float, screed_W_mK: float, flow_fraction: FloatArray
) -> FloatArray:
    """Return the heat to the floor per kelvin of supply minus layer temperature [W/K], 0 without flow.

    K = m c (1 - exp(-k A / (m c))): the water cools towards a layer of one temperature on its way.
    """
    flow_L_s = np.asarray(flow_fraction, dtype=float) * full_flow_L_h(circuit, area_m2) / 3600.0
    exchange = exchange_W_m2K(circuit, cover_m2K_W, screed_W_mK, flow_L_s)
    stream_W_K = flow_L_s * WATER_J_L_K
    units = np.divide(exchange * area_m2, stream_W_K, out=np.full_like(stream_W_K, np.inf), where=stream_W_K > 0)
    return -stream_W_K * np.expm1(-units)
