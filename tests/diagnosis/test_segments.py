"""Claims about how a record is cut: whatever is recorded, each stage lies in one segment, each with a drive."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.diagnosis.realities import belief, record
from waxstudy.diagnosis.model.conventions import AFTER, BEFORE, LATE, PLAIN, RAW
from waxstudy.diagnosis.model.perturbation import Perturbation
from waxstudy.diagnosis.model.room_response import OF_ROOM
from waxstudy.diagnosis.model.segments import SHOWN, Segment, segments
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import CHAIN, STAGES, Belief, Choice
from waxstudy_paper.room.surfaces import SurfacesRoom

OUTPUTS = [SHOWN[kind] for kind in CHAIN[1:]]
INPUTS = ("outdoor_temperature_C", "supply_temperature_C")
SUBSETS = st.sets(st.sampled_from([*OUTPUTS, *OF_ROOM, *INPUTS, "sensor_temperature_C"])).filter(
    lambda chosen: chosen & {"sensor_temperature_C", "air_temperature_C", "operative_temperature_C"}
)


@cache
def whole(case: str = "REAL") -> Record:
    return record(case, days=2)


def cut(chosen: set[str], case: str = "REAL") -> tuple[Record, Belief, Sequence[Segment]]:
    """The segments of some channels, but for the heating curve beside the recorded supply."""
    kept = {*chosen, "setpoint_C", "solar_gain_W", "internal_gain_W"}
    values = {name: each for name, each in whole(case).values.items() if name in kept}
    seen = Record(whole(case).interval_s, 0.0, values)
    believed = belief(case, seen)
    return seen, believed, [segment for segment in segments(seen, believed) if not segment.is_supply]


def expected(chosen: set[str]) -> list[tuple[str, ...]]:
    """The stages cut after each output that is recorded, the rest with the room if that can be driven and judged."""
    stages: list[tuple[str, ...]] = []
    rest: list[str] = []
    for kind in CHAIN:
        rest.append(kind)
        if kind != "sensor" and SHOWN[kind] in chosen:
            stages.append(tuple(rest))
            rest = []
    judged = chosen & set(OF_ROOM) - (set() if "flow_L_h" in chosen else {"return_temperature_C"})
    has_room = chosen.issuperset(INPUTS) and bool(judged)
    return [*stages, (*rest, "emitter", "room")] if has_room else stages


@given(SUBSETS)
def test_a_missing_channel_merges_the_stages_on_either_side_of_it(chosen: set[str]) -> None:
    _, _, found = cut(chosen)
    assert [segment.stages for segment in found] == expected(chosen)


@given(SUBSETS)
def test_every_stage_is_in_one_link_at_most_and_none_is_left_out_between(chosen: set[str]) -> None:
    _, _, found = cut(chosen)
    stages = tuple(stage for segment in found for stage in segment.stages)
    assert stages == STAGES[: len(stages)]


@given(SUBSETS)
def test_no_channel_is_judged_twice_and_none_that_is_not_there(chosen: set[str]) -> None:
    seen, _, found = cut(chosen)
    judged = [channel for segment in found for channel in segment.judged]
    assert len(judged) == len(set(judged))
    assert all(seen.has(channel) for channel in judged)
    assert all(segment.judged for segment in found)


@given(SUBSETS)
def test_no_link_is_without_a_drive(chosen: set[str]) -> None:
    seen, _, found = cut(chosen)
    assert all(seen.has(segment.driven_by) for segment in found)
    for before, segment in pairwise(found):
        assert segment.driven_by == before.judged[-1]


@given(SUBSETS)
@settings(max_examples=25)
def test_each_link_predicts_what_it_is_judged_by_for_the_whole_record(chosen: set[str]) -> None:
    seen, believed, found = cut(chosen)
    for segment in found:
        for convention in segment.conventions:
            predicted = segment.predict(seen, believed, convention)
            assert list(predicted) == list(segment.judged)
            for channel, values in predicted.items():
                of_room = segment.with_room and channel in OF_ROOM
                assert len(values) == (len(seen) // 15 if of_room else len(seen))


def test_with_all_channels_each_stage_of_the_chain_is_judged_alone() -> None:
    _, _, found = cut(set(whole().values))
    names = [segment.name for segment in found]
    assert names == ["sensor+controller", "modulator", "actuator", "valve", "emitter+room"]


def test_only_a_sensor_s_own_log_leaves_open_what_it_is() -> None:
    _, _, found = cut(set(whole().values))
    assert found[0].conventions == (AFTER, BEFORE, RAW, LATE)
    _, _, found = cut(set(whole().values) - {"sensor_temperature_C"})
    assert found[0].conventions == (PLAIN, LATE)
    assert [len(segment.conventions) for segment in found[1:-1]] == [1] * 3


def test_a_recorded_supply_is_put_beside_the_believed_heating_curve() -> None:
    seen = whole()
    believed = belief("REAL", seen)
    (curve,) = [segment for segment in segments(seen, believed) if segment.is_supply]
    assert (curve.stages, curve.driven_by) == (("emitter",), "outdoor_temperature_C")
    off_K = curve.predict(seen, believed)["supply_temperature_C"] - seen.values["supply_temperature_C"]
    # its own noise, and that of the outdoor temperature by the slope of the curve
    assert np.std(off_K) < 0.1


def test_a_supply_that_is_assumed_is_not_judged() -> None:
    seen = replace(whole(), assumed=("supply_temperature_C",))
    assert not any(segment.is_supply for segment in segments(seen, belief("REAL", seen)))


CURVE = {"heating_curve_C": [[-20.0, 40.0], [20.0, 25.0]]}


@pytest.mark.parametrize(
    ("told", "is_judged"),
    [({}, True), ({"circuit": CURVE}, True), ({"circuit": {}}, False)],
    ids=["the circuit of Table 3", "a curve of its own", "another circuit without one"],
)
def test_a_supply_is_held_against_no_heating_curve_of_another_room(told: dict[str, Any], is_judged: bool) -> None:
    seen = whole()
    room = belief("REAL", seen).room
    assert room
    believed = replace(belief("REAL", seen), room=Choice.of(room.component, told))
    assert any(segment.is_supply for segment in segments(seen, believed)) == is_judged
    surfaces = SurfacesRoom.examples["the room of Table 3"] | {"circuit": told.get("circuit", {})}
    described = replace(believed, room=Choice.of(SurfacesRoom, surfaces if told else {**surfaces, "circuit": CURVE}))
    assert any(segment.is_supply for segment in segments(seen, described)) == is_judged


def test_without_a_room_there_are_links_of_the_chain_alone() -> None:
    seen, believed, _ = cut(set(whole().values))
    found = segments(seen, Belief(believed.blocks))
    assert [segment.stages[-1] for segment in found] == list(CHAIN[1:])


def test_a_blocks_absence_passes_on_what_it_is_given() -> None:
    """An ideal actuator is none: its displacement is the signal, thrown halfway through the interval."""
    seen, believed, found = cut(set(whole("IDEAL").values), "IDEAL")
    actuator = next(segment for segment in found if segment.stages == ("actuator",))
    predicted = actuator.predict(seen, believed)["displacement"]
    assert np.array_equal(predicted, seen.values["heating_signal"])


def test_a_link_of_which_no_block_is_believed_passes_on_what_it_is_given() -> None:
    """As a valve of which nobody said anything: it passes the share of the full flow by which it is open."""
    seen, believed, _ = cut(set(whole().values))
    bare = replace(believed, blocks={kind: each for kind, each in believed.blocks.items() if kind != "valve"})
    valve = next(segment for segment in segments(seen, bare) if segment.stages == ("valve",))
    flow_L_h = valve.predict(seen, bare)["flow_L_h"]
    assert np.corrcoef(flow_L_h, seen.filled("displacement"))[0, 1] > 0.99


@pytest.mark.parametrize("seed", [1, 2])
def test_shaking_a_drive_moves_a_prediction_and_the_same_numbers_move_it_alike(seed: int) -> None:
    seen, believed, found = cut(set(whole().values))
    for segment in [each for each in found if not each.with_room and each.stages != ("modulator",)]:
        channel = segment.judged[-1]
        still = segment.predict(seen, believed)[channel]
        one, other = (
            segment.predict(seen, believed, perturbation=Perturbation(np.random.default_rng(seed)))[channel]
            for _ in range(2)
        )
        assert np.array_equal(one, other)
        assert not np.array_equal(one, still)
