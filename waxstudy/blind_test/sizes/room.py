"""What a believed room makes of its flow, and what nobody knows of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any

import numpy as np

from waxstudy.blind_test.sizes.record import Record
from waxstudy.plugin import ROOM_OUTPUTS, Belief, Choice, FloatArray, LinearRoom, Room
from waxstudy.simulation.recorded import Moving, driven_by, respond
from waxstudy.synthetic.departures import departed

OUTPUTS = {
    "air_temperature_C": "air_C",
    "operative_temperature_C": "operative_C",
    "floor_surface_temperature_C": "floor_surface_C",
    "return_temperature_C": "return_C",
}
QUARTER_S = 900.0
PIECE_S, STEP_S, VALVE_S = 60.0, 15.0, 120.0  # of inputs, of steps, of a stroke: 2 mK from steps of 5 s
ROUGH_S = 300.0
FLOWING = 0.2  # of the largest flow, from which on a return is judged
START_K = 2.0  # nobody knows the weather before the record
# chosen: how well gains and sun are known, as logarithms of a factor: measured, assumed
GAINS = {"internal_gain_W": (0.05, 0.15), "solar_gain_W": (0.07, 0.12)}
UNSEEN = 1.1  # chosen: the same of what nobody recorded, a factor of three


@dataclass(frozen=True)
class Unknown:
    """Something that nobody knows: a usual departure from what is believed, and the belief with one."""

    name: str
    usual: float
    apply: Callable[[Belief, float], Belief]


@lru_cache(maxsize=256)
def built(room: Choice) -> LinearRoom:
    """Return the linear room of a choice; raise `ValueError`."""
    assert issubclass(room.component, Room)
    return room.component.build(room.parameters)


def response(belief: Belief, flow_L_h: FloatArray, is_rough: bool) -> dict[str, FloatArray]:
    """Return what the room makes of a flow (n,): its channels as means over quarters of an hour.

    A rough one takes long steps, and is off by some hundredths of a kelvin.
    """
    assert belief.room
    assert belief.inputs
    interval_s = belief.inputs.interval_s
    parts, merged = _parts(interval_s, is_rough)
    flow = means(flow_L_h, parts)
    changes: dict[str, Any] = {n: means(v, parts) for n, v in vars(belief.inputs).items() if isinstance(v, np.ndarray)}
    carried_C = weighted(belief.inputs.supply_C, flow_L_h, parts)  # what flowed had that temperature
    changes |= {"interval_s": parts * interval_s, "supply_C": np.where(flow > 0.0, carried_C, changes["supply_C"])}
    inputs = replace(belief.inputs, **changes)
    driven = driven_by(built(belief.room), inputs, None if is_rough else STEP_S)
    found = respond(driven, inputs, flow, None if is_rough else Moving(VALVE_S))
    early = 0.5 * (1.0 - 1.0 / parts)  # samples lie within a piece, what is computed at its end
    shown = {}
    for channel, output in OUTPUTS.items():
        now = found[output]
        before = np.concatenate((now[:1], now[:-1]))
        is_node = output in ROOM_OUTPUTS
        shown[channel] = means(now + early * (before - now), merged) if is_node else weighted(now, flow, merged)
    return shown


def _parts(interval_s: float, is_rough: bool) -> tuple[int, int]:
    """Return how many intervals make a piece, and how many pieces a quarter of an hour: the same, rough or not."""
    rough = max(1, round(ROUGH_S / interval_s))
    parts = rough if is_rough else max(1, round(PIECE_S / interval_s))
    return parts, rough * max(1, round(QUARTER_S / (rough * interval_s))) // parts


def in_quarters(record: Record, channel: str) -> FloatArray:
    """Return a channel as means over quarters of an hour, a return only while water flows, else NaN."""
    weight = np.ones(len(record))
    if channel == "return_temperature_C":
        flow = record.values["flow_L_h"]
        weight = np.where(flow > FLOWING * flow.max(), flow, 0.0)
    parts, merged = _parts(record.interval_s, is_rough=True)
    return weighted(record.values[channel], weight, parts * merged)


def means(values: FloatArray, parts: int) -> FloatArray:
    """Return the means over each `parts` values; a rest at the end is left out."""
    count = len(values) // parts
    return np.asarray(values[: count * parts].reshape(count, parts).mean(axis=1))


def weighted(values: FloatArray, weight: FloatArray, parts: int) -> FloatArray:
    """Return the means over each `parts` values by weight, NaN where there is none."""
    weight = np.where(np.isfinite(values), weight, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return means(weight * np.nan_to_num(values), parts) / means(weight, parts)


def unknowns(belief: Belief, record: Record, tolerance: float) -> Iterator[Unknown]:
    """Yield what nobody knows of a room, of its gains and of how warm it was at first.

    `tolerance` multiplies the spreads of the first two; at 0 the room is exactly as believed.
    """
    room = belief.room
    assert room
    assert issubclass(room.component, Room)
    if tolerance > 0.0:
        for each in room.component.uncertainties(room.parameters):
            yield Unknown(each.name, tolerance * each.sd, partial(_departed, each.name))
        for channel, (measured, assumed) in GAINS.items():
            if channel in record.values:
                seen = tolerance * (assumed if channel in record.assumed else measured)
                usual = UNSEEN if channel in record.unseen else seen
                yield Unknown(channel, usual, partial(_departed, channel))
    for name in ("start_K", "start_floor_K"):
        yield Unknown(name, START_K, partial(_set, name))


def _departed(name: str, belief: Belief, departure: float) -> Belief:
    return departed(belief, {name: departure})


def _set(name: str, belief: Belief, value: Any) -> Belief:
    assert belief.inputs
    return replace(belief, inputs=replace(belief.inputs, **{name: value}))
