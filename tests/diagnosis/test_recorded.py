"""Claims about a room under recorded inputs: it is the closed loop's room, and its sun is one heat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.diagnosis.realities import PERFECT, belief, reality, record, study
from waxstudy.diagnosis.model.room_response import built, coarsened, room_response
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.residuals.judge import Judge
from waxstudy.plugin import FloatArray, Inputs, LinearRoom, Role, Room
from waxstudy.simulation.recorded import SUN, Moving, driven_by, recorded_room, respond, respond_to_heat

HOURS = 48


def room() -> LinearRoom:
    choice = study().room
    assert issubclass(choice.component, Room)
    return choice.component.build(choice.parameters)


def inputs(**channels: FloatArray | float) -> Inputs:
    still = {"outdoor_C": 0.0, "supply_C": 30.0, "solar_W": 0.0, "gains_W": 0.0, "ventilation_C": 18.0, "air_C": 21.0}
    count = HOURS * 12
    return Inputs(
        300.0, 0.0, **{name: np.broadcast_to(each, count) * np.ones(count) for name, each in (still | channels).items()}
    )


def air_C(given: Inputs, flow_L_h: float = 60.0) -> FloatArray:
    return respond(driven_by(room(), given), given, np.full(HOURS * 12, flow_L_h))["air_C"]


@pytest.mark.parametrize("case", ["IDEAL", "REAL"])
def test_under_recorded_inputs_and_flow_the_room_has_the_closed_loop_s_temperatures(case: str) -> None:
    """Without noise, and but for how warm the room was before the record, which nobody knows: a linear answer."""
    seen = record(case, **PERFECT)
    believed = belief(case, seen)
    assert believed.inputs
    warmer = replace(believed, inputs=replace(believed.inputs, start_K=1.0))
    plain, with_start = (room_response(seen, each, seen.filled("flow_L_h")) for each in (believed, warmer))
    channels = reality(case).week.channels
    own = {"air_temperature_C": "air_C", "floor_surface_temperature_C": "floor_surface_C"}
    for channel, name in own.items():
        quarters = channels[name].reshape(-1, 180).mean(axis=1)
        off_K, answer = (plain[channel] - quarters)[24:], (with_start[channel] - plain[channel])[24:]
        left_K = off_K - answer * (answer @ off_K) / (answer @ answer)
        assert np.ptp(quarters) > 0.5
        assert np.sqrt(np.mean(left_K**2)) < 0.02
    assert float(np.mean(plain["return_temperature_C"] > 15.0)) > 0.05


@pytest.mark.parametrize("case", ["IDEAL", "REAL", "PWM"])
def test_means_of_hours_in_which_a_valve_moved_are_no_misses_of_the_room(case: str) -> None:
    """The return counts where water flowed on, and what flows for a part of an hour warms less than half a flow."""
    seen = record(case, **PERFECT)
    hour = round(3600.0 / seen.interval_s)
    means = {name: values.reshape(-1, hour).mean(axis=1) for name, values in seen.values.items()}
    hourly = replace(seen, interval_s=3600.0, values=means)
    believed = belief(case, hourly)
    (link,) = [segment for segment in segments(hourly, believed) if segment.with_room]
    of_means = next(convention for convention in link.conventions if convention.is_mean)
    predicted = link.predict(hourly, believed, of_means)
    found = {each.channel: each for each in Judge(link, hourly, believed).residuals(predicted)}
    air, back = found["air_temperature_C"], found["return_temperature_C"]
    part = means["flow_L_h"] / means["flow_L_h"].max()
    assert back.judged.sum() >= 10
    assert ((part > 0.2) & (part < 0.85) & back.judged).sum() == 0 < ((part > 0.2) & (part < 0.85)).sum()
    later = back.judged & (np.arange(len(part)) >= 24)  # nobody knows how warm the floor was before
    assert np.abs(back.error[later]).max() < 0.12
    assert air.gap() < 0.1


def test_each_stage_driven_by_a_perfect_record_misses_next_to_nothing() -> None:
    seen = record("REAL", interval_s=5.0, days=2, **PERFECT)
    believed = belief("REAL", seen)
    for segment in segments(seen, believed)[2:4]:
        (channel,) = segment.judged
        error = (segment.predict(seen, believed)[channel] - seen.values[channel])[seen.settled]
        # but for the steps in which a valve opens at once, or an actuator is switched
        assert np.mean(np.abs(error) > 0.005 * np.nanmax(seen.values[channel])) < 0.01, segment.name


def test_the_sun_is_one_heat_shared_out_as_the_room_shares_it() -> None:
    original = room()
    given = inputs(solar_W=100.0)
    recorded = recorded_room(original, given)
    column = recorded.input_matrix[:, recorded.inputs.index(SUN)]
    by_facade = original.input_matrix[:, original.places(Role.SUN)]
    assert column.sum() == pytest.approx(1.0)
    assert column * by_facade.sum() == pytest.approx(by_facade.sum(axis=1))
    assert recorded.places(Role.SUN) == [recorded.inputs.index(SUN)]


@given(st.floats(0.0, 500.0))
@settings(max_examples=10)
def test_in_the_end_the_sun_s_heat_warms_as_much_as_its_watts(watts: float) -> None:
    """A linear room: twice the sun is twice the rise."""
    rise_K = air_C(inputs(solar_W=watts))[-1] - air_C(inputs())[-1]
    of_100_W = air_C(inputs(solar_W=100.0))[-1] - air_C(inputs())[-1]
    assert rise_K == pytest.approx(of_100_W * watts / 100.0, abs=1e-6)
    assert of_100_W > 1.0


@pytest.mark.parametrize("name", ["outdoor_C", "supply_C", "solar_W", "gains_W", "ventilation_C"])
def test_each_recorded_input_that_is_raised_warms_the_room(name: str) -> None:
    plain = inputs()
    warmer = replace(plain, **{name: getattr(plain, name) + 10.0})
    assert air_C(warmer)[-1] > air_C(plain)[-1] + 0.01


def test_extra_heat_goes_to_the_air_and_is_not_needed() -> None:
    plain = inputs()
    heated = replace(plain, extra_W=np.full(HOURS * 12, 50.0))
    without = replace(plain, extra_W=np.zeros(HOURS * 12))
    assert np.array_equal(air_C(without), air_C(plain))
    assert air_C(heated)[-1] > air_C(plain)[-1] + 0.5


@pytest.mark.parametrize("moving", [None, Moving(120.0), Moving(120.0, is_switched=True)])
def test_what_a_room_makes_of_heat_alone_is_what_that_heat_adds(moving: Moving | None) -> None:
    """After the first day, which `respond` repeats."""
    count = HOURS * 12
    flow = np.where(np.arange(count) // 24 % 3 == 0, 60.0, 0.0) * np.where(np.arange(count) % 24 < 5, 0.5, 1.0)
    heat_W = np.where(np.arange(count) // 36 == 9, 80.0, 0.0)
    still, warm = (inputs() if each is None else inputs(extra_W=each) for each in (None, heat_W))
    before, after = (respond(driven_by(room(), each), each, flow, moving) for each in (still, warm))
    (change,) = respond_to_heat(room(), still, flow, [{"extra_W": heat_W}], moving)
    for name in ("air_C", "operative_C", "floor_surface_C", "return_C"):
        assert change[name] == pytest.approx(after[name] - before[name], abs=0.002, nan_ok=True)
    assert change["air_C"].max() > 0.3


def test_without_flow_there_is_no_heat_of_the_water_and_no_return() -> None:
    found = respond(driven_by(room(), inputs()), inputs(), np.zeros(HOURS * 12))
    assert np.isnan(found["return_C"]).all()
    assert (found["water_heat_W"] == 0.0).all()


def test_the_water_gives_the_heat_by_which_it_cools() -> None:
    built_room, flow = room(), np.full(HOURS * 12, 80.0)
    found = respond(driven_by(built_room, inputs()), inputs(), flow)
    cooled_W = flow / 3600.0 * built_room.water_J_L_K * (30.0 - found["return_C"])
    assert cooled_W == pytest.approx(found["water_heat_W"])
    assert found["water_heat_W"].min() > 10.0


def test_the_step_of_the_water_changes_less_than_a_thermometer_shows() -> None:
    coarse, fine = (
        respond(driven_by(room(), inputs(), step_s), inputs(), np.where(np.arange(HOURS * 12) % 60 < 20, 122.0, 0.0))
        for step_s in (None, 10.0)
    )
    assert coarse["air_C"] == pytest.approx(fine["air_C"], abs=0.02)


def test_a_room_s_link_is_driven_by_the_flow_that_was_recorded() -> None:
    seen = record("REAL")
    segment = segments(seen, belief("REAL", seen))[-2]
    assert isinstance(segment, Segment)
    assert (segment.stages, segment.driven_by) == (("emitter", "room"), "flow_L_h")
    assert built(study().room) is built(study().room)


def test_an_input_that_was_changed_is_not_taken_for_one_that_was_there_before() -> None:
    """Means of inputs are kept by the arrays themselves, and of arrays that are gone another may take the place."""
    seen = record("REAL", interval_s=60.0, days=2, **PERFECT)
    believed = belief("REAL", seen)
    assert believed.inputs
    for number in range(200):
        heat_W = np.full(len(seen), float(number))
        coarse, _ = coarsened(seen, replace(believed, inputs=replace(believed.inputs, gains_W=heat_W)), heat_W, 5)
        assert coarse.gains_W == pytest.approx(np.full(len(seen) // 5, float(number)))
        del heat_W, coarse
