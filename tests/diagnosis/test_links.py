"""Claims about what one link knows: of itself alone, where its drive is known, and what its own channels show."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, belief, dataset, record, rows
from tests.diagnosis.test_odd_records import of_room
from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.assembly import _believed
from waxstudy.diagnosis.calibration.calibrate import Calibration
from waxstudy.diagnosis.calibration.told import calibrated as told
from waxstudy.diagnosis.calibration.told import doubts
from waxstudy.diagnosis.consequence.closed_loop import recorded
from waxstudy.diagnosis.criteria import limits
from waxstudy.diagnosis.diagnose import _cut, _work, calibrated, diagnose, record_of
from waxstudy.diagnosis.model.as_built import AsBuilt, Left, knobs
from waxstudy.diagnosis.model.conventions import AFTER, BEFORE, LATE, PLAIN, RAW, left_by
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.plugin import Belief

DAYS = 4
OFFSET = EFFECTS["supply-offset"]


# --- the heating curve ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_supply_off_its_heating_curve_while_water_flows_is_told_as_that_and_standing_water_is_not_judged() -> None:
    seen = record("REAL", 7)
    is_flowing = seen.values["flow_L_h"] > 0.0
    supply_C = np.where(is_flowing, seen.values["supply_temperature_C"] + 3.0, 20.0)
    diagnosis = diagnose(of_room(7, (), supply_temperature_C=supply_C), quick=True)
    (found,) = [each for each in diagnosis.effects if each.channel == "supply_temperature_C"]
    assert found.parameters["offset_K"].value == pytest.approx(3.0, abs=0.3)
    assert diagnosis.summary == "The recorded supply is 3.0 K above the heating curve."


def test_the_free_loop_takes_the_recorded_supply_as_it_is() -> None:
    seen = record("REAL", 2)
    believed = belief("REAL", seen)
    (curve,) = (each for each in segments(seen, believed) if each.is_supply)
    model = SimpleNamespace(effects=[(OFFSET, {"offset_K": 3.0})])
    selection: Any = SimpleNamespace(segment=curve, before=model, after=model)
    work: Any = SimpleNamespace(belief=believed)
    assert believed.inputs
    there = _believed(work, [selection], is_after=True).inputs
    assert there
    assert there.supply_C.tolist() == believed.inputs.supply_C.tolist()


# --- drives --------------------------------------------------------------------------------------------


def test_a_room_is_not_judged_where_the_signal_that_drives_it_is_lost_for_long() -> None:
    whole = record("REAL", DAYS, without=("flow_L_h", "displacement", "return_temperature_C"), interval_s=300.0)
    signal = whole.values["heating_signal"].copy()
    since_s = np.arange(len(whole)) * whole.interval_s
    lost = (since_s >= 86_400.0) & (since_s < 172_800.0)
    signal[lost] = np.nan
    seen = replace(whole, values={**whole.values, "heating_signal": signal})
    believed = belief("REAL", seen)
    room = next(each for each in segments(seen, believed) if each.with_room and not each.is_supply)
    assert room.driven_by == "heating_signal"
    problem = SegmentProblem(room, seen, believed)
    fitted = problem.at((), np.zeros(len(problem.sd)), room.conventions[0])
    assert fitted
    (air,) = (each for each in fitted.residuals if each.channel == "air_temperature_C")
    assert not air.judged[lost[air.sample]].any()
    assert air.judged[air.sample * seen.interval_s > 2.5 * 86_400.0].all()


def test_heat_is_not_known_while_water_flows_and_its_temperatures_are_lost() -> None:
    whole = record("REAL", 2)
    back = whole.values["return_temperature_C"].copy()
    back[500:900] = np.nan
    seen = replace(whole, values={**whole.values, "return_temperature_C": back})
    heat_W = recorded(seen, belief("REAL", seen)).heat_W
    assert heat_W is not None
    flows = seen.values["flow_L_h"][500:900] > 0.0
    assert flows.any()
    assert np.isnan(heat_W[500:900][flows]).all()
    assert (heat_W[500:900][~flows] == 0.0).all()


# --- what a healthy record knows -----------------------------------------------------------------------


def room_of(lacks: str, choice: int) -> tuple[SegmentProblem, AsBuilt]:
    """A room of whose record something was not recorded, and what it tells if it is read in one of its ways."""
    whole = record("REAL", 2)
    seen = replace(whole, values={name: each for name, each in whole.values.items() if name != lacks})
    believed = belief("REAL", seen)
    (room,) = (each for each in segments(seen, believed) if each.with_room and not each.is_supply)
    read = {room.name: room.conventions[choice]}
    known = AsBuilt((), np.zeros(0), np.zeros((0, 0)), conventions=read, ways={room.name: room.conventions})
    return SegmentProblem(room, seen, believed), known


def ways_left(later: str, healthy: str, choice: int) -> tuple[list[float], list[float]]:
    """The sun's factors in which a record may be read after a healthy one, and by itself; each lacks a channel."""
    (room, _), (_, known) = room_of(later, 0), room_of(healthy, choice)
    left = SegmentProblem(room.segment, room.record, room.belief, as_built=known).conventions
    return [each.solar_factor for each in left], [each.solar_factor for each in room.conventions]


@pytest.mark.parametrize("choice", [0, 1])
def test_how_a_sun_is_meant_is_told_by_a_healthy_record_that_has_one_and_by_no_other(choice: int) -> None:
    left, by_itself = ways_left("", "", choice)
    assert left == [by_itself[choice]]
    assert len(by_itself) == 2
    assert ways_left("", "solar_gain_W", 0) == (by_itself, by_itself)
    assert ways_left("solar_gain_W", "", choice) == ([1.0], [1.0])


@pytest.mark.slow
def test_a_room_as_built_is_read_in_the_ways_of_its_documents_panes() -> None:
    days = rows("REAL", 7, interval_s=300.0)
    (before, after) = (dataset(each, "REAL", nominal={}) for each in (days[:1008], days[1008:]))
    work = _work(after, before, thorough=0.35)
    (room,) = (each for each in _cut(work)[0] if each.with_room)
    assert len({each.solar_factor for each in room.conventions}) == 2
    (way,) = SegmentProblem(room, work.record, work.documented, as_built=work.as_built).conventions
    assert work.as_built
    assert way == work.as_built.conventions[room.name]


def test_a_record_that_has_none_of_the_ways_that_are_left_may_be_read_in_all_of_its_own() -> None:
    assert left_by([RAW], [AFTER, BEFORE, RAW], [AFTER, BEFORE]) == [AFTER, BEFORE]
    assert left_by([BEFORE, AFTER], [AFTER, BEFORE, RAW], [AFTER, BEFORE, RAW, LATE]) == [BEFORE, AFTER]


def test_what_one_link_left_of_a_channel_says_nothing_of_another_link() -> None:
    left = {"flow_L_h": Left(2.0, 3.0)}
    known = AsBuilt((), np.zeros(0), np.zeros((0, 0)), conventions={"actuator+valve": PLAIN}, left=left)
    assert known.left_of("actuator+valve") == left
    assert known.left_of("valve") == {}
    seen = record("REAL", 2)
    believed = belief("REAL", seen)
    (valve,) = (each for each in segments(seen, believed) if each.name == "valve")
    as_of_another, as_believed = (
        SegmentProblem(valve, seen, believed, as_built=built) for built in (known, replace(known, left={}))
    )
    one, other = (each.at((), np.zeros(len(each.sd)), PLAIN) for each in (as_of_another, as_believed))
    assert one
    assert other
    assert one.whitened.tolist() == other.whitened.tolist()


@cache
def of_temperatures() -> tuple[Calibration, Belief]:
    """A healthy record without a signal or flow, in whose floor surface a thermometer died at once."""
    without = ("control_output", "heating_signal", "displacement", "flow_L_h", "return_temperature_C")
    made = dataset(rows("REAL", DAYS, interval_s=300.0, without=without), "REAL")
    values = made.values.copy()
    values.loc[values.index[20:], "floor_surface_temperature_C"] = np.nan
    made = replace(made, values=values)
    return calibrated(made, list(EFFECTS.values()), thorough=0.33), made.believed(record_of(made).inputs)


@pytest.mark.slow
def test_temperatures_alone_calibrate_a_room_and_a_dead_thermometer_spoils_nothing() -> None:
    calibration, _ = of_temperatures()
    known = calibration.as_built.discrepancies
    assert known.keys() == {"air_temperature_C", "operative_temperature_C"}
    assert all(np.isfinite(each.shared) and each.shared >= 1.0 for each in known.values())


@pytest.mark.slow
def test_what_of_the_chain_is_calibrated_with_the_room_is_told_as_of_the_chain() -> None:
    parts = {each.name: each.part for each in told(*of_temperatures())}
    assert parts["slow-actuator factor"] == "chain"
    assert parts["supply-offset offset_K"] == "drives"


@pytest.mark.slow
def test_a_healthy_record_that_departs_as_far_as_is_looked_for_is_doubted() -> None:
    calibration, documents = of_temperatures()
    place, knob = next((n, each) for n, each in enumerate(calibration.as_built.knobs) if each.name == "heat-loss")
    departures = np.zeros(len(calibration.as_built.knobs))

    def said(departure: float) -> list[str]:
        departures[place] = departure
        built = replace(calibration.as_built, departures=departures)
        return [each for each in doubts(replace(calibration, as_built=built), documents) if "heat-loss" in each]

    assert said(0.5 * limits()["odd"].value * knob.sd) == []
    (doubt,) = said(-limits()["odd"].value * knob.sd)
    assert doubt.startswith("the baseline itself: heat-loss lies 2.5 standard deviations")


def still(made: Dataset) -> Dataset:
    """The same loop on mild days: the valve stays shut, and what drives it never asks."""
    values = made.values.copy()
    for channel in ("control_output", "heating_signal", "displacement", "flow_L_h"):
        values[channel] = 0.0
    return replace(made, values=values)


@pytest.mark.slow
def test_a_link_in_which_nothing_moved_is_not_known_as_healthy() -> None:
    made = dataset(rows("REAL", DAYS, interval_s=300.0), "REAL")
    effects = list(EFFECTS.values())
    whole, none = (calibrated(each, effects, thorough=0.33) for each in (made, still(made)))
    assert {"actuator", "valve"} <= whole.healthy.keys()
    assert not {"actuator", "valve"} & (none.healthy.keys() | none.as_built.conventions.keys())
    assert "actuator" in {knob.effect.stage for knob, _ in whole.as_built.chain}
    assert not {knob.effect.stage for knob, _ in none.as_built.chain} & {"actuator", "valve"}
    assert not {effect.stage for effect, _ in none.as_built.always} & {"actuator", "valve"}


@pytest.mark.slow
def test_a_room_that_a_healthy_record_hardly_shows_is_as_documented() -> None:
    calibration, _ = of_temperatures()
    (room,) = calibration.healthy
    assert calibration.as_built.knobs
    found = calibration.without({room})
    assert (found.healthy, found.as_built.knobs, found.as_built.discrepancies) == ({}, (), {})
    assert found.as_built.covariance.shape == (0, 0)


def test_what_is_so_between_hours_from_the_start_is_told_beside_what_differs_at_all_hours() -> None:
    setpoint, documents = EFFECTS["setpoint-offset"], belief("REAL", record("REAL", 2))
    (knob,) = (each for each in knobs([setpoint], ["controller"], documents) if each.parameter == "offset_K")
    by_night = {"offset_K": -2.0, "from_h": 22.0, "to_h": 6.0}
    built = AsBuilt((), np.zeros(0), np.zeros((0, 0)), chain=((knob, 0.1),), always=[(setpoint, by_night)])
    offsets = [each.value.value for each in told(Calibration(built, {}), documents) if each.name == knob.name]
    assert offsets == [pytest.approx(0.1), -2.0]
