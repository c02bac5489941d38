"""Parameters of the physical wax actuator, with where each comes from."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import model_validator

from waxstudy.plugin import Parameters, parameter
from waxstudy_enthalpy.products import PRODUCTS

_FITTED = "fitted to the times of Table 2; fit.py prints what they determine"
_DATA_SHEET = "data sheets of 24 V actuators: 250 mA inrush for less than 2 min, 75 mA (1.8 W) holding"
_PARAFFIN = "usual for paraffin: latent heat 150 to 220 J/g, 2.1 to 2.9 J/(g K)"
_STROKE_TEST = "a maker's stroke test: a wax element moves between 69 and 79 C under 80 N; see docs"


class EnthalpyParameters(Parameters):
    """Heater, wax, body, piston; what is not given is that of the product."""

    product: Literal["A", "B"] = parameter(
        "B", unit="", description="Product whose fitted values apply where none is given.", source="Table 2"
    )
    input: Literal["binary", "proportional"] = parameter(
        "binary",
        unit="",
        description="Binary: heated while the signal exceeds 0.5. Proportional: the signal is the voltage over 10 V.",
        source="section 2: most motors are binary, some 0-10 V",
    )
    ambient_C: float = parameter(
        21.0,
        unit="C",
        ge=-20.0,
        le=60.0,
        description="Air around the actuator.",
        source="chosen: the rooms' setpoint; the laboratory's temperature is not in the paper",
    )
    inrush_W: float = parameter(
        6.0, unit="W", gt=0.0, le=30.0, description="Power of the cold heater.", source=_DATA_SHEET
    )
    holding_W: float = parameter(
        1.8, unit="W", gt=0.0, le=10.0, description="Power of the heater at `holding_C`.", source=_DATA_SHEET
    )
    knee_C: float = parameter(
        unit="C", ge=-20.0, le=150.0, description="Heater temperature from which its power falls.", source=_FITTED
    )
    holding_C: float = parameter(
        unit="C",
        ge=30.0,
        le=250.0,
        description="Heater temperature that lasts while the valve is held open.",
        source=_FITTED,
    )
    cup_J_K: float = parameter(
        unit="J/K", ge=0.1, le=100.0, description="Heat capacity of heater and cup (the core less wax).", source=_FITTED
    )
    body_J_K: float = parameter(
        unit="J/K", ge=1.0, le=200.0, description="Heat capacity of the body around the core.", source=_FITTED
    )
    wax_g: float = parameter(unit="g", ge=0.05, le=20.0, description="Mass of wax.", source=_FITTED)
    core_body_W_K: float = parameter(
        unit="W/K", ge=0.005, le=1.0, description="Heat conductance from core to body.", source=_FITTED
    )
    body_ambient_W_K: float = parameter(
        unit="W/K",
        ge=0.005,
        le=1.0,
        description="Heat conductance from body to ambient.",
        source="follows from the others: in the fit the heater settles at `holding_C` and `holding_W`",
    )
    latent_J_g: float = parameter(
        200.0, unit="J/g", ge=50.0, le=300.0, description="Latent heat of the wax.", source=_PARAFFIN
    )
    solid_J_gK: float = parameter(
        2.1, unit="J/(g K)", ge=1.0, le=4.0, description="Heat capacity of solid wax.", source=_PARAFFIN
    )
    liquid_J_gK: float = parameter(
        2.5, unit="J/(g K)", ge=1.0, le=4.0, description="Heat capacity of liquid wax.", source=_PARAFFIN
    )
    melting_C: float = parameter(
        69.0, unit="C", ge=30.0, le=100.0, description="Where melting begins.", source=_STROKE_TEST
    )
    melting_range_K: float = parameter(
        10.0, unit="K", ge=0.5, le=40.0, description="From first to last melting.", source=_STROKE_TEST
    )
    expansion_mm: float = parameter(
        unit="mm",
        ge=0.1,
        le=30.0,
        description="Free travel of the piston if all wax melts and nothing holds it.",
        source=_FITTED,
    )
    stroke_mm: float = parameter(
        2.5,
        unit="mm",
        ge=0.5,
        le=10.0,
        description="Travel between the stops.",
        source="section 3.1: product A, 2.5 mm",
    )
    preload_N: float = parameter(
        105.0,
        unit="N",
        ge=10.0,
        le=500.0,
        description="Force of the spring on the closed piston.",
        source="section 3.1: product A, 105 N",
    )
    stiffness_N_mm: float = parameter(
        10.0, unit="N/mm", ge=0.0, le=200.0, description="Stiffness of the spring.", source="chosen: not in data sheets"
    )
    friction_N: float = parameter(
        20.0,
        unit="N",
        ge=0.0,
        le=200.0,
        description="Friction of piston, seal and spring; stands for all hysteresis of the piston.",
        source="chosen: the times hardly determine it; 20 to 30 % of the force is usual",
    )
    compliance_mm_N: float = parameter(
        0.004,
        unit="mm/N",
        ge=0.0,
        le=0.1,
        description="Travel that wax and seal give way per force.",
        source="chosen: 0.4 mm at the closing force",
    )
    positioning_band: float = parameter(
        0.2,
        unit="1",
        ge=0.05,
        le=1.0,
        description="Opening over which a proportional motor throttles its heater from full to none.",
        source="chosen: positioners are not described in data sheets",
    )

    @model_validator(mode="before")
    @classmethod
    def _fill_from_product(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        product = data.get("product", "B")
        return {**PRODUCTS.get(product if isinstance(product, str) else "B", PRODUCTS["B"]), **data}

    @model_validator(mode="after")
    def _sound(self) -> EnthalpyParameters:
        if self.holding_W >= self.inrush_W or self.knee_C >= self.holding_C:
            raise ValueError("holding_W must be below inrush_W, and knee_C below holding_C")
        if self.friction_N >= self.preload_N:
            raise ValueError("friction_N must be below preload_N, or the spring never closes the valve")
        force_N = self.preload_N + self.friction_N + self.stiffness_N_mm * self.stroke_mm
        if self.expansion_mm <= self.stroke_mm + self.compliance_mm_N * force_N:
            raise ValueError("expansion_mm must exceed stroke_mm plus compliance_mm_N times the force when open")
        return self
