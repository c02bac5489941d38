"""What a stage's gap does to heat and air temperature: its modelled output in place of the measured one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from waxstudy.diagnosis.model.room_response import built, coarsened, full_flow_L_h, merging, moving
from waxstudy.diagnosis.model.segments import SHOWN, Segment, replayed
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import CHAIN, Belief, FloatArray, SimulationError
from waxstudy.simulation.recorded import driven_by, respond

BEHIND = tuple(shown for kind, shown in SHOWN.items() if kind != "sensor")  # channels with stages behind them


def impact(record: Record, belief: Belief, segment: Segment, modelled: FloatArray) -> Mapping[str, float]:
    """Return what a modelled output of a chain's segment does to heat [%] and air [K, RMS], compared with the measured.

    Both run through the believed stages behind it and the fitted room; nothing where the room cannot be run. While
    nothing was recorded both are the modelled one.
    """
    channel = segment.judged[-1]
    if belief.room is None or belief.inputs is None or channel not in BEHIND:
        return {}
    try:
        measured = record.metered(channel, record.filled(channel))
        measured = np.where(np.isnan(record.values[channel]), modelled, measured)
        heat, air = zip(*(_response(record, belief, channel, signal) for signal in (measured, modelled)), strict=True)
    except (SimulationError, ValueError):
        return {}
    measured_W, modelled_W = (float(np.mean(each)) for each in heat)
    air_K = {"air_K": float(np.sqrt(np.mean((air[1] - air[0]) ** 2)))}
    return {"heat_percent": 100.0 * (modelled_W / measured_W - 1.0), **air_K} if measured_W else air_K


def _response(record: Record, belief: Belief, channel: str, signal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return heat of the water and air temperature that a channel's signal leads to."""
    assert belief.room
    parts, _ = merging(record.interval_s)
    flow = signal if channel == "flow_L_h" else _flow(record, belief, channel, signal)
    inputs, coarse = coarsened(record, belief, flow, parts)
    found = respond(driven_by(built(belief.room), inputs), inputs, coarse, moving(belief, inputs))
    return found["water_heat_W"], found["air_C"]


def _flow(record: Record, belief: Belief, channel: str, signal: FloatArray) -> FloatArray:
    behind = CHAIN[list(SHOWN.values()).index(channel) + 1 :]
    blocks = {kind: choice for kind, choice in belief.blocks.items() if kind in behind}
    jump = np.full(len(record), 0.5) if channel in record.binary else None
    setpoint_C = record.filled_or_zero("setpoint_C")
    _, means = replayed(blocks, behind[0], signal, setpoint_C, record.interval_s, record.start_s, jump)
    return means["valve"] * full_flow_L_h(record, belief)
