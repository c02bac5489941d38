"""What the bench does to a movement before it is on file: mechanics, sensor, logger. Its values are chosen."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit, types

from waxstudy.plugin import FloatArray, Parameters, parameter
from waxstudy.simulation.cache import cached

CHOSEN = "chosen: "


class Bench(Parameters):
    """The bench and how its motors scatter."""

    interval_s: float = parameter(
        1.0, unit="s", description="Sampling interval of displacement.", source="section 3.1.2", ge=0.1, le=60.0
    )
    flow_interval_s: float = parameter(
        5.0, unit="s", description="Sampling interval of flow.", source=CHOSEN + "not in the paper", ge=0.1, le=60.0
    )
    stroke_mm: float = parameter(
        2.5, unit="mm", description="Stroke.", source="section 3.1, product A", gt=0.0, le=20.0
    )
    valve_stroke: float = parameter(
        0.9,
        unit="1",
        description="Stroke with a valve attached, over that without.",
        source=CHOSEN + "section 3.1 says smaller",
        gt=0.0,
        le=1.0,
    )
    closed_mm: float = parameter(
        8.0,
        unit="mm",
        description="Reading when closed; it falls on opening.",
        source="section 3.1.3",
        ge=-50.0,
        le=50.0,
    )
    exemplar_scatter: float = parameter(
        0.02,
        unit="1",
        description="Standard deviation of the pace of exemplars: all times of one are longer by a factor.",
        source=CHOSEN + "section 4.1.1 says small",
        ge=0.0,
        le=0.2,
    )
    record_scatter: float = parameter(
        0.005,
        unit="1",
        description="The same from record to record (supply, ambient temperature).",
        source=CHOSEN + "not in the paper",
        ge=0.0,
        le=0.2,
    )
    cycle_scatter: float = parameter(
        0.005,
        unit="1",
        description="The same from one switching to the next.",
        source=CHOSEN + "section 4.1.1: the periods of a record performed very similarly",
        ge=0.0,
        le=0.2,
    )
    slack_mm: float = parameter(
        0.003, unit="mm", description="Play between piston and sensor.", source=CHOSEN + "0.1 %", ge=0.0, le=1.0
    )
    friction_mm: float = parameter(
        0.003,
        unit="mm",
        description="Length of the jerks of a stem that sticks.",
        source=CHOSEN + "0.1 %",
        ge=0.0,
        le=1.0,
    )
    noise_mm: float = parameter(
        0.002,
        unit="mm",
        description="Standard deviation of the sensor.",
        source=CHOSEN + "10-mm transducer",
        ge=0.0,
        le=1.0,
    )
    resolution_mm: float = parameter(
        0.001, unit="mm", description="Step of the reading.", source=CHOSEN + "10-mm transducer", ge=0.0, le=1.0
    )
    drift_mm_day: float = parameter(
        0.01,
        unit="mm/day",
        description="Standard deviation of the zero's drift in a day.",
        source=CHOSEN + "0.4 % of the stroke",
        ge=0.0,
        le=5.0,
    )
    spikes_per_day: float = parameter(
        3.0,
        unit="1/day",
        description="Single samples that are wrong.",
        source=CHOSEN + "rare",
        ge=0.0,
        le=10_000.0,
    )
    gaps_per_day: float = parameter(
        0.0, unit="1/day", description="Gaps of about 5 min.", source=CHOSEN + "none unless asked for", ge=0.0, le=100.0
    )
    signal_V: float = parameter(24.0, unit="V", description="Supply when on.", source="section 3.1.2", gt=0.0, le=250.0)
    signal_noise_V: float = parameter(
        0.02, unit="V", description="Standard deviation of its reading.", source=CHOSEN + "0.1 %", ge=0.0, le=10.0
    )
    full_flow_L_h: float = parameter(
        120.0, unit="L/h", description="Flow when open.", source=CHOSEN + "not in the paper", gt=0.0, le=10_000.0
    )
    flow_noise: float = parameter(
        0.007,
        unit="1",
        description="Standard deviation of the flow's reading, over full flow.",
        source=CHOSEN + "with the scatter of cycles the curve's MAE comes near the paper's 1.02 %",
        ge=0.0,
        le=0.5,
    )


def displacement_mm(opening: FloatArray, stroke_mm: float, bench: Bench, draw: np.random.Generator) -> FloatArray:
    """Return what the sensor shows of an opening 0..1 sampled every `interval_s`."""
    moved = _moved()(stroke_mm * opening, bench.slack_mm, bench.friction_mm)
    days = bench.interval_s * np.arange(len(moved)) / 86_400.0
    drift = bench.drift_mm_day * draw.normal() * days
    read = bench.closed_mm - moved + drift + bench.noise_mm * draw.normal(size=len(moved))
    spikes = draw.random(len(moved)) < bench.spikes_per_day * bench.interval_s / 86_400.0
    read = np.where(spikes, read + draw.uniform(-5.0, 5.0, len(moved)), read)
    return _rounded(read, bench.resolution_mm)


def flow_L_h(share: FloatArray, bench: Bench, draw: np.random.Generator) -> FloatArray:
    """Return what the flow meter shows of a flow 0..1."""
    read = np.maximum(0.0, share + bench.flow_noise * draw.normal(size=len(share)) * (share > 0.0))
    return np.round(bench.full_flow_L_h * read, 2)


def voltage_V(on: FloatArray, bench: Bench, draw: np.random.Generator) -> FloatArray:
    return np.round(bench.signal_V * on + bench.signal_noise_V * draw.normal(size=len(on)), 3)


def _rounded(values: FloatArray, step: float) -> FloatArray:
    return np.round(values / step) * step if step > 0.0 else values


def move(driven: Any, slack: float, friction: float, shown: Any) -> None:
    """Write what follows a piston with play, which opens late by `slack`, and sticks until it is `friction` behind."""
    held = after = driven[0]
    for n in range(len(driven)):
        held = min(max(held, driven[n] - slack), driven[n])
        if abs(held - after) >= friction:
            after = held
        shown[n] = after


_NUMBERS = types.float64[::1]


@cache
def _compiled() -> Callable[..., None]:
    def build(folder: Path | None) -> Any:
        signature = types.void(_NUMBERS, types.float64, types.float64, _NUMBERS)
        return njit(signature, nogil=True, cache=folder is not None)(move)

    function: Callable[..., None] = cached(build)
    return function


def _moved() -> Callable[[FloatArray, float, float], FloatArray]:
    move_compiled = _compiled()

    def moved(driven: FloatArray, slack: float, friction: float) -> FloatArray:
        shown = np.empty_like(driven)
        move_compiled(np.ascontiguousarray(driven), slack, friction, shown)
        return shown

    return moved
