"""The believed room under a record's inputs, as it is judged: means over quarters of an hour."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from math import prod
from types import MappingProxyType
from typing import Any

import numpy as np

from waxstudy.dataset.levels import drives_by_switching
from waxstudy.diagnosis.model.conventions import PLAIN, Convention
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import ROOM_OUTPUTS, Belief, FloatArray, Inputs, LinearRoom, ModelError, Room
from waxstudy.plugin.model_error import model_errors
from waxstudy.simulation.recorded import Moving, driven_by, respond, respond_to_heat
from waxstudy.study.model import Choice

OF_ROOM = {
    "air_temperature_C": "air_C",
    "operative_temperature_C": "operative_C",
    "floor_surface_temperature_C": "floor_surface_C",
    "return_temperature_C": "return_C",
}
OF_AIR_AND_FLOOR = [channel for channel in OF_ROOM if channel != "return_temperature_C"]
ROOM_STEP_S = 300.0  # the room is judged on means of quarters of an hour; its water on steps no longer than this
JUDGED_S = 900.0
FINE_STEP_S = 5.0
VALVE_S = 120.0  # chosen: a stroke takes up to 180 s (Table 2), and most of the flow comes in its middle


class Predicted(dict[str, FloatArray]):
    """What is predicted of channels, each (n,), of a room's (quarters,).

    `shifted` (shifts, n) has those that a switch drives, for each part of an interval in which it may have been thrown.
    """

    def __init__(
        self, values: Mapping[str, FloatArray] = MappingProxyType({}), shifted: Mapping[str, FloatArray] | None = None
    ) -> None:
        super().__init__(values)
        self.shifted = shifted or {}


def full_flow_L_h(record: Record, belief: Belief) -> float:
    """Return the flow with the valve open: the room's, or the usual one of the largest that were recorded."""
    if belief.room is not None:
        return built(belief.room).full_flow_L_h
    return record.usual_flow_L_h


def error_of(belief: Belief, channel: str) -> ModelError:
    """Return how far a room's model is off at a channel by its form: as it states, widened by the dataset."""
    assert belief.room
    return model_errors(belief.room)[OF_ROOM[channel]].times(belief.room_error_factor)


@lru_cache(maxsize=256)
def built(room: Choice) -> LinearRoom:
    """Return the linear room of a choice."""
    assert issubclass(room.component, Room)
    return room.component.build(room.parameters)


def room_response(
    record: Record, belief: Belief, flow_L_h: FloatArray, convention: Convention = PLAIN, is_fine: bool = False
) -> Predicted:
    """Return what the room makes of a flow: its channels, means over quarters of an hour.

    Where it is to be fine its steps are short, and its flow is that of the record's intervals. Else its flow is a mean
    over five minutes, or over the record's interval where that is longer. How valves move within one says `moving`.
    """
    assert belief.room
    parts, merged = merging(record.interval_s)
    if is_fine:
        parts, merged = 1, parts * merged
    coarse, flow = coarsened(record, belief, flow_L_h, parts)
    coarse = replace(coarse, solar_W=convention.solar_factor * coarse.solar_W)
    driven = driven_by(built(belief.room), coarse, FINE_STEP_S if is_fine else None)
    return _shown(respond(driven, coarse, flow, moving(belief, coarse, is_fine)), flow, convention, parts, merged)


def response_to_heat(
    record: Record,
    belief: Belief,
    flow_L_h: FloatArray,
    convention: Convention,
    heats_W: Iterable[Mapping[str, FloatArray]],
    repeats_first_day: bool = False,
) -> Iterator[Predicted]:
    """Yield by how much courses of heat [W], by field of the inputs (n,), change what the room makes."""
    assert belief.room
    parts, merged = merging(record.interval_s)
    coarse, flow = coarsened(record, belief, flow_L_h, parts)

    def shapes_W(heat_W: Mapping[str, FloatArray]) -> Mapping[str, FloatArray]:
        found = {name: means(each, parts) for name, each in heat_W.items()}
        return {name: (convention.solar_factor if name == "solar_W" else 1.0) * each for name, each in found.items()}

    about = built(belief.room), coarse, flow, map(shapes_W, heats_W), moving(belief, coarse), repeats_first_day
    for found in respond_to_heat(*about):
        yield _shown(found, flow, convention, parts, merged)


def moving(belief: Belief, inputs: Inputs, is_fine: bool = False) -> Moving | None:
    """Return how a valve moves within the intervals of a flow; None where it is taken to stand still.

    In longer ones than five minutes it moves where what drives it only switches, or where nothing is known of that.
    """
    if inputs.interval_s <= ROOM_STEP_S:
        return Moving(VALVE_S) if is_fine else None
    switches = drives_by_switching(belief.blocks)
    return None if switches is False else Moving(VALVE_S, is_switched=bool(switches))


def _shown(
    found: Mapping[str, FloatArray], flow_L_h: FloatArray, convention: Convention, parts: int, merged: int
) -> Predicted:
    """Return what a logger shows of a room's temperatures at the ends of its steps."""
    # what is logged is at the end of each interval, or its mean; the room is known at the end of several
    early = 0.5 if convention.is_mean else 0.5 * (1.0 - 1.0 / parts)
    shown = Predicted()
    for channel, output in OF_ROOM.items():
        values = found[output]
        if output in ROOM_OUTPUTS:
            values = (1.0 - early) * values + early * np.concatenate((values[:1], values[:-1]))
            shown[channel] = means(values, merged)
        else:
            shown[channel] = weighted(values, flow_L_h, merged)
    return shown


def merging(interval_s: float) -> tuple[int, int]:
    """Return how many intervals make a step of a room, and how many steps a quarter of an hour."""
    parts = max(1, round(ROOM_STEP_S / interval_s))
    return parts, max(1, round(JUDGED_S / (parts * interval_s)))


def samples_of_mean(interval_s: float) -> int:
    """Return how many intervals make a mean that a room is judged on: about a quarter of an hour, or one."""
    return prod(merging(interval_s))


def coarsened(record: Record, belief: Belief, flow_L_h: FloatArray, parts: int) -> tuple[Inputs, FloatArray]:
    """Return what drives a room, and its flow, as means over some intervals; the supply as what flowed had it."""
    inputs, room = belief.inputs, belief.room
    assert inputs
    assert room
    if inputs.added_flow_L_h is not None:
        most = np.maximum(flow_L_h, built(room).full_flow_L_h)
        flow_L_h = np.where(inputs.added_flow_L_h, np.clip(flow_L_h + inputs.added_flow_L_h, 0.0, most), flow_L_h)
    arrays = {name: value for name, value in vars(inputs).items() if isinstance(value, np.ndarray)}
    changes: dict[str, Any] = {name: _kept_means(record, value, parts) for name, value in arrays.items()}
    flow, supply_C = means(flow_L_h, parts), weighted(inputs.supply_C, flow_L_h, parts)
    changes["supply_C"] = np.where(flow > 0.0, supply_C, changes["supply_C"])
    return replace(inputs, interval_s=inputs.interval_s * parts, **changes), flow


def _kept_means(record: Record, values: FloatArray, parts: int) -> FloatArray:
    """Return the means of an input, kept with it, read-only: most inputs are the same array in every hypothesis."""

    def made() -> tuple[FloatArray, FloatArray]:
        found = means(values, parts)
        found.flags.writeable = False
        return values, found

    return record.remembered("means", (id(values), parts), made, arrays=2)[1]


def means(values: FloatArray, parts: int) -> FloatArray:
    """Return the means over each `parts` values; a rest at the end is left out."""
    count = len(values) // parts
    return np.asarray(values[: count * parts].reshape(count, parts) @ np.full(parts, 1.0 / parts))


def weighted(values: FloatArray, weight: FloatArray, parts: int) -> FloatArray:
    """Return the means over each `parts` values by weight, NaN where there is none."""
    known = np.isfinite(values)
    whole = np.where(known, weight, 0.0)
    sums, weighed = means(whole, parts), means(whole * np.where(known, values, 0.0), parts)
    return np.asarray(np.divide(weighed, sums, out=np.full(len(sums), np.nan), where=sums > 0.0))
