"""Valve curves: opening to flow fraction."""

from __future__ import annotations

import math
from typing import Any

from pydantic import model_validator

from waxstudy.plugin import Parameters, Valve, parameter


class LinearValve(Valve):
    """The flow is proportional to the opening, the default of building simulation programs."""

    name = "linear"
    api_version = "1.0"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return u


class QuickOpeningParameters(Parameters):
    h_min: float = parameter(
        0.17, unit="1", ge=0.0, lt=1.0, description="Opening at which the flow starts.", source="Section 4.2"
    )
    h_mid: float = parameter(
        0.41, unit="1", gt=0.0, lt=1.0, description="Opening at which the curve bends.", source="Section 4.2, h_p"
    )
    v_mid: float = parameter(
        0.50,
        unit="1",
        ge=0.0,
        le=1.0,
        description="Theoretical flow at the bend.",
        source="Section 4.2, V_p; the corrected curve's MAE is 1.02 %",
    )
    h_max: float = parameter(
        1.0, unit="1", gt=0.0, le=1.0, description="Opening from which the flow is full.", source="Section 3.2.2"
    )
    authority: float = parameter(
        2.9 / 30.0,
        unit="1",
        gt=0.0,
        le=1.0,
        description="Authority N: pressure drop of the open valve over that of the pump.",
        source="Section 3.2.2: 2.9 kPa of 30 kPa",
    )

    @model_validator(mode="after")
    def _ordered(self) -> QuickOpeningParameters:
        if not self.h_min < self.h_mid < self.h_max:
            raise ValueError(f"h_min < h_mid < h_max is needed, got {self.h_min}, {self.h_mid}, {self.h_max}")
        return self


class QuickOpeningValve(Valve):
    """Three-point quick-opening curve V(h), corrected by the authority N (section 3.2.2).

    V_auth = sqrt((1/N) / (1/N - 1 + 1/V^2)), written here as V / sqrt(V^2 (1 - N) + N), which also holds at V = 0.
    """

    name = "quick-opening"
    api_version = "1.0"
    Parameters = QuickOpeningParameters

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        if u <= p.h_min:
            return 0.0
        if u >= p.h_max:
            return 1.0
        if u < p.h_mid:
            flow = p.v_mid * (u - p.h_min) / (p.h_mid - p.h_min)
        else:
            flow = p.v_mid + (1.0 - p.v_mid) * (u - p.h_mid) / (p.h_max - p.h_mid)
        return min(1.0, flow / math.sqrt(flow * flow * (1.0 - p.authority) + p.authority))
