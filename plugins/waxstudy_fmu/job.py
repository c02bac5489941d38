"""What is asked of a run's process."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from waxstudy.plugin import Advance, FloatArray
from waxstudy_fmu.roles import Variables


@dataclass(frozen=True)
class Job:
    """A run; `given` is for each value reference what it is given in each interval, in the FMU's unit."""

    path: Path
    variables: Variables
    interval_s: float
    given: Mapping[int, FloatArray]
    supply_C: FloatArray
    start: Mapping[str, float]
    full_flow_L_h: float
    water_J_L_K: float
    floor_area_m2: float
    conductance_W_K: FloatArray  # over the flow fraction from 0 to 1
    advance: Advance
    step_s: float
    longest_silence_s: float
