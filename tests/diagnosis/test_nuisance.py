"""Claims about what nobody knows of a room: what it may take, and when an effect makes it needless."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest

from tests.diagnosis.realities import belief, dataset, effects, estimator, planted, record, study
from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import diagnose
from waxstudy.diagnosis.model.nuisance import MOST_LOST, nuisances
from waxstudy.diagnosis.model.room_response import full_flow_L_h
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import Belief

DAYS = 7
LOST = "flow lost after"
FROM_FLOW = (
    "flow_L_h",
    "supply_temperature_C",
    "outdoor_temperature_C",
    "solar_gain_W",
    "internal_gain_W",
    "air_temperature_C",
    "operative_temperature_C",
    "floor_surface_temperature_C",
)


@cache
def ready() -> tuple[Record, Belief, Segment]:
    seen = record("REAL", days=DAYS)
    believed = belief("REAL", seen)
    return seen, believed, next(segment for segment in segments(seen, believed) if segment.with_room)


def without_flow(*hours: tuple[float, float]) -> tuple[Record, Belief]:
    """A record whose logger was out between some hours, of a room that is as believed."""
    seen, believed, segment = ready()
    made = planted(segment, seen, believed)
    values = {name: each.copy() for name, each in made.values.items()}
    for first, last in hours:
        lost = slice(round(first * 3600 / made.interval_s), round(last * 3600 / made.interval_s))
        for channel in (*segment.judged, "flow_L_h"):
            values[channel][lost] = np.nan
    gapped = replace(made, values=values)
    return gapped, belief("REAL", gapped)


def lost_flows(record: Record, believed: Belief) -> list[str]:
    return [each.name for each in nuisances(believed, record, "flow_L_h") if each.name.startswith(LOST)]


def test_what_flowed_in_a_gap_of_ten_minutes_or_more_is_not_known() -> None:
    assert lost_flows(*without_flow()) == []
    assert lost_flows(*without_flow((30.0, 30.1))) == []
    assert lost_flows(*without_flow((30.0, 30.5), (50.0, 52.0))) == [f"{LOST} 30.0 h", f"{LOST} 50.0 h"]


def test_of_many_gaps_the_longest_are_fitted() -> None:
    many = [(20.0 + 5.0 * place, 20.3 + 5.0 * place + 0.1 * place) for place in range(MOST_LOST + 3)]
    found = lost_flows(*without_flow(*many))
    assert found == [f"{LOST} {first:.1f} h" for first, _ in many[3:]]


def test_heat_that_came_while_nothing_was_recorded_is_no_error_of_the_room() -> None:
    seen, believed, segment = ready()
    flow = seen.filled("flow_L_h")
    is_on = np.convolve(flow > 0.5 * flow.max(), np.ones(90), mode="valid") == 90
    first_h = float(np.flatnonzero(is_on[2880:])[0] + 2880) * seen.interval_s / 3600.0
    lost = slice(round(first_h * 60), round(first_h * 60) + 90)
    gapped, believed = without_flow((first_h, first_h + 1.5))
    fitter = estimator(segment, gapped, believed, is_exact_room=True)
    (name,) = lost_flows(gapped, believed)
    found = dict(zip([each.name for each in fitter.problem.nuisances], fitter.base.departures, strict=True))
    fitted = np.clip(gapped.filled("flow_L_h") + found[name], 0.0, full_flow_L_h(gapped, believed))
    assert np.mean(fitted[lost]) == pytest.approx(np.mean(flow[lost]), rel=0.05)
    assert found[name] > 30.0
    blind = fitter.problem.at(
        (),
        np.where([each.name == name for each in fitter.problem.nuisances], 0.0, fitter.base.departures),
        segment.conventions[0],
    )
    assert blind
    for after, before in zip(fitter.base.residuals, blind.residuals, strict=True):
        assert after.gap() < 0.5 * before.gap() or after.channel == "return_temperature_C"


def of_the_room(**true: Mapping[str, float]) -> Dataset:
    """A dataset of a room alone, driven by its flow, in which some effects are put."""
    seen, believed, segment = ready()
    made = planted(segment, seen, believed, effects(**true))
    time = pd.date_range("2020-01-06T00:01", periods=len(made), freq="min")
    data = pd.DataFrame({"time": time, **{channel: made.values[channel] for channel in FROM_FLOW}})
    return replace(dataset(data, "REAL"), nominal={})


@pytest.mark.slow
def test_what_a_room_s_unknowns_could_take_is_named_where_it_makes_all_of_them_needless() -> None:
    found = diagnose(of_the_room(infiltration={"factor": 2.5}), quick=True)
    (effect,) = found.effects
    assert effect.name == "infiltration"
    assert set(effect.group) <= {"infiltration", "window-opening"}  # open all day it is the same air
    interval = effect.parameters["factor"]
    assert interval.value == pytest.approx(2.5, rel=0.15)
    assert interval.low <= 2.5 <= interval.high
    assert "heat-loss" not in found.departures
    assert any("exactly as believed" in sentence for sentence in found.assumptions)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "parameter", "true"),
    [
        ("thermal-mass", "factor", 0.7),
        ("floor-cover", "resistance_m2K_W", 0.01),
    ],
)
def test_so_is_what_is_a_few_times_the_noise(name: str, parameter: str, true: float) -> None:
    found = diagnose(of_the_room(**{name.replace("-", "_"): {parameter: true}}), quick=True)
    (effect,) = found.effects
    assert effect.name == name
    assert len(effect.group) <= 3
    interval = effect.parameters[parameter]
    assert interval.value == pytest.approx(true, rel=0.15)
    assert interval.low <= true <= interval.high


@pytest.mark.slow
def test_a_little_heat_that_half_of_the_library_explains_is_not_named() -> None:
    found = diagnose(of_the_room(neighbour_heat={"conductance_W_K": 0.6}), quick=True)
    assert (found.verdict, list(found.effects)) == ("none", [])


@pytest.mark.slow
@pytest.mark.parametrize("unknown", ["heat-loss", "sun-to-air"])
def test_one_unknown_of_a_room_that_is_off_is_not_taken_for_an_effect(unknown: str) -> None:
    seen, believed, _ = ready()
    departed = next(each for each in nuisances(believed, seen, "flow_L_h") if each.name == unknown)
    found = diagnose(replace(of_the_room(), room=departed.apply(believed, departed.sd).room), quick=True)
    assert (found.verdict, list(found.effects)) == ("none", [])
    assert abs(found.departures[unknown]) > 0.3


@pytest.mark.slow
def test_a_room_that_is_missed_by_more_than_noise_is_not_exactly_as_believed() -> None:
    leaky = of_the_room(infiltration={"factor": 0.5})
    wave_K = 0.02 * np.sin(2.0 * np.pi * np.arange(len(leaky.values)) / (17.0 * 60.0))
    of_room = ["air_temperature_C", "operative_temperature_C", "floor_surface_temperature_C"]
    values = leaky.values.assign(**{channel: leaky.values[channel] + wave_K for channel in of_room})
    found = diagnose(replace(leaky, values=values), quick=True)
    assert (found.verdict, list(found.effects)) == ("none", [])


@pytest.mark.slow
def test_a_channel_without_noise_ends_no_diagnosis() -> None:
    room = of_the_room()
    values = room.values.assign(operative_temperature_C=room.values["operative_temperature_C"].round())
    assert values["operative_temperature_C"].nunique() <= 3
    found = diagnose(replace(room, values=values), quick=True)
    assert not any("exactly as believed" in sentence for sentence in found.assumptions)


@pytest.mark.slow
def test_nor_is_one_that_a_noisy_opening_drives() -> None:
    seen, _, _ = ready()
    lacking = replace(seen, values={name: each for name, each in seen.values.items() if name != "flow_L_h"})
    believed = belief("REAL", lacking)
    segment = next(each for each in segments(lacking, believed) if each.with_room)
    made = planted(segment, lacking, believed, effects(infiltration={"factor": 2.5}))
    time = pd.date_range("2020-01-06T00:01", periods=len(made), freq="min")
    shown = {name: each for name, each in made.values.items() if name in (*FROM_FLOW, "displacement")}
    valve = {"valve": study().cases["REAL"].blocks["valve"]}
    found = diagnose(replace(dataset(pd.DataFrame({"time": time, **shown}), "REAL"), nominal=valve), quick=True)
    assert found.effects == []
    assert not any("exactly as believed" in sentence for sentence in found.assumptions)
