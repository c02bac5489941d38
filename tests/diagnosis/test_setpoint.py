"""Claims about a controller that aims elsewhere: named with its hours, not on a healthy record, a group with a bias."""

from __future__ import annotations

import pytest

from tests.diagnosis.realities import Effects, dataset, effects, rows
from waxstudy.diagnosis.diagnose import diagnose
from waxstudy.diagnosis.result import Diagnosis

AROUND_CONTROLLER = ["time", "sensor_temperature_C", "air_temperature_C", "control_output"]
SETBACK = effects(setpoint_offset={"offset_K": -2.0, "from_h": 22.0, "to_h": 6.0})
CASES = ["LATE", pytest.param("PWM", marks=pytest.mark.slow)]  # an on-off controller and a PI controller


def told(case: str, put_in: Effects, without: str = "", days: int = 7) -> Diagnosis:
    data = rows(case, days, put_in)[AROUND_CONTROLLER].drop(columns=without or [])
    return diagnose(dataset(data, case), quick=True)


@pytest.mark.parametrize("case", CASES)
def test_a_setback_at_night_is_named_with_its_hours(case: str) -> None:
    (effect,) = told(case, SETBACK).effects
    assert effect.group == ["setpoint-offset"]
    values = {name: each.value for name, each in effect.parameters.items()}
    assert values["from_h"] == pytest.approx(22.0, abs=0.5)
    assert values["to_h"] == pytest.approx(6.0, abs=0.5)
    # below what a night cools to nothing says how much lower it aims, but that it does
    offset_K = effect.parameters["offset_K"]
    assert offset_K.low <= -2.0 <= offset_K.high < -1.0
    assert effect.when.spans_h[1] == pytest.approx((22.0, 30.0), abs=0.5)


def test_a_quick_look_finds_the_hours_of_warmer_nights_and_how_much_warmer_they_are() -> None:
    """A few switches tell them: hours that are looked at three apart lead to warmer nights that end at three."""
    (effect,) = told("LATE", effects(setpoint_offset={"offset_K": 1.4, "from_h": 22.06, "to_h": 7.28})).effects
    assert effect.parameters["offset_K"].value == pytest.approx(1.4, abs=0.05)
    assert effect.parameters["from_h"].value == pytest.approx(22.06, abs=0.1)


@pytest.mark.parametrize(
    ("offset_K", "from_h", "to_h"),
    [pytest.param(-1.3, 19.3, 6.43, id="colder"), pytest.param(0.57, 21.14, 4.0, id="warmer")],
)
def test_the_few_switches_of_four_days_tell_how_far_off_nights_are(offset_K: float, from_h: float, to_h: float) -> None:
    """No way leads downhill to them: nights at wrong hours suit another offset best."""
    (effect,) = told(
        "LATE", effects(setpoint_offset={"offset_K": offset_K, "from_h": from_h, "to_h": to_h}), days=4
    ).effects
    assert effect.group == ["setpoint-offset"]
    assert effect.parameters["offset_K"].value == pytest.approx(offset_K, abs=0.05)
    assert effect.parameters["from_h"].value == pytest.approx(from_h, abs=0.1)


@pytest.mark.parametrize("case", CASES)
def test_a_healthy_controller_aims_at_its_setpoint(case: str) -> None:
    assert not told(case, ()).effects


def test_beside_a_reading_it_is_told_from_a_bias_and_without_one_they_are_a_group() -> None:
    off = effects(setpoint_offset={"offset_K": 0.5})
    (effect,) = told("LATE", off).effects
    assert effect.group == ["setpoint-offset"]
    assert "at all times" in effect.sentence
    assert effect.when.pattern == "always"
    (either,) = told("LATE", off, without="sensor_temperature_C").effects
    assert {"setpoint-offset", "sensor-bias"} <= set(either.group)
