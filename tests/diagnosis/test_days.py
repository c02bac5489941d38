"""Claims about effects of a room that act between hours, on some days only."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.diagnosis.realities import EFFECTS, Effects, dataset, effects, planted, rows
from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import diagnose, record_of
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.result import Diagnosis
from waxstudy.diagnosis.select.appraise import _price
from waxstudy.diagnosis.select.days import Days, courses, days_of, on_days
from waxstudy.diagnosis.select.superposed import Superposed
from waxstudy.diagnosis.select.timed import timed
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import HOURS, Belief, Effect, Inputs

DAYS, INTERVAL_S = 7, 300.0
EVERY_OTHER = Days("every other day from day 2 on", tuple(day % 2 == 1 for day in range(DAYS)))
STOVE = effects(stove={"heat_W": 900.0, "from_h": 18.0, "to_h": 22.0})
WINDOW = effects(window={"flow_L_s": 15.0, "from_h": 11.5, "to_h": 12.25})


@cache
def seen() -> tuple[Record, Belief]:
    """A week of a room as it is believed."""
    made = dataset(rows("REAL", DAYS, interval_s=INTERVAL_S), "REAL")
    record = record_of(made)
    return record, made.believed(record.inputs)


def coldest(count: int) -> Days:
    record, believed = seen()
    assert believed.inputs
    mean = np.bincount(record.day, believed.inputs.outdoor_C) / np.bincount(record.day)
    return Days("when it is cold", tuple((np.argsort(np.argsort(mean)) < count).tolist()))


@pytest.fixture
def acting(monkeypatch: pytest.MonkeyPatch) -> None:
    """Put effects that act on some days into the library."""
    heat, window = timed(EFFECTS["extra-heat"]), EFFECTS["window-opening"]
    put_in: dict[str, type[Effect]] = {"stove": on_days(heat, coldest(3)), "window": on_days(window, EVERY_OTHER)}
    for name, effect in put_in.items():
        monkeypatch.setitem(EFFECTS, name, effect)


def told(true: Effects, seed: int, without: str = "") -> Diagnosis:
    """What is said of a room with effects, beside a week of it without; a channel was not recorded."""

    def of(true: Effects, seed: int, first: str) -> Dataset:
        record, believed = seen()
        segment = next(each for each in segments(record, believed) if each.with_room and not each.is_supply)
        for _ in range(3 if true else 1):  # what flows through a window depends on the air, which it cools
            record = planted(segment, record, believed, true, seed)
        time = pd.date_range(first, periods=len(record), freq=f"{INTERVAL_S:.0f}s") + pd.Timedelta(seconds=INTERVAL_S)
        keep = {*segment.judged, segment.driven_by, "supply_temperature_C", "outdoor_temperature_C"}
        keep |= {"solar_gain_W", "internal_gain_W"} - {without}
        values = {name: each for name, each in record.values.items() if name in keep}
        return dataset(pd.DataFrame({"time": time, **values}), "REAL", nominal={})  # the room alone is asked

    return diagnose(of(true, seed, "2021-01-15"), baseline=of((), seed + 1, "2021-01-01"), quick=True)


def hours(days: Days, from_h: float, to_h: float) -> list[Any]:
    return [pytest.approx((24.0 * day + from_h, 24.0 * day + to_h), abs=0.35) for day, it in enumerate(days.acts) if it]


@pytest.mark.slow
@pytest.mark.usefixtures("acting")
def test_a_stove_that_is_lit_on_cold_evenings_is_heat_between_hours_on_cold_days() -> None:
    found = told(STOVE, seed=3)
    (only,) = found.effects
    assert (only.name, found.verdict) == ("extra-heat", "effect")
    assert only.when.pattern.startswith("from 1")
    assert "on days colder than" in only.when.pattern
    assert list(only.when.spans_h) == hours(coldest(3), 18.0, 22.0)
    assert only.parameters["heat_W"].value == pytest.approx(900.0, rel=0.2)
    assert "every day" not in only.sentence
    assert "on days colder than" in only.sentence


@pytest.mark.slow
@pytest.mark.usefixtures("acting")
def test_a_window_that_is_open_every_other_day_is_told_so() -> None:
    (only,) = told(WINDOW, seed=5).effects
    assert only.name == "window-opening"
    assert only.when.pattern.endswith(f", {EVERY_OTHER.words}")
    assert list(only.when.spans_h) == hours(EVERY_OTHER, 11.5, 12.25)
    assert only.parameters["flow_L_s"].value == pytest.approx(15.0, rel=0.25)


@pytest.mark.slow
def test_what_acts_every_day_is_said_to(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(EFFECTS, "window", EFFECTS["window-opening"])
    (only,) = told(WINDOW, seed=7).effects
    assert only.when.pattern.startswith("every day from 11:")
    assert len(only.when.spans_h) == DAYS


@pytest.mark.slow
@pytest.mark.parametrize(("without", "named"), [("", ["extra-heat"]), ("solar_gain_W", [])])
def test_heat_by_day_may_be_a_sun_that_nobody_recorded(
    without: str, named: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where such a sun falls is unknown: heat by radiation around noon may be more of it than in the healthy week."""
    monkeypatch.setitem(EFFECTS, "noon", timed(EFFECTS["extra-heat"]))
    noon = effects(noon={"heat_W": 80.0, "radiant_share": 1.0, "from_h": 11.0, "to_h": 15.75})
    assert [each.name for each in told(noon, 7, without).effects] == named


@pytest.mark.slow
def test_a_room_in_which_nothing_happened_has_no_day_of_its_own() -> None:
    assert told((), seed=9).effects == []


@pytest.mark.parametrize(
    ("hours", "all_day", "needs"),
    [((17.6, 17.0), 39.0, False), ((0.0, 14.0), 39.0, False), ((17.6, 17.0), 1.0, True), ((7.0, 9.0), 39.0, True)],
)
def test_what_is_on_for_most_of_some_days_needs_its_hours(
    hours: tuple[float, float], all_day: float, needs: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What lasts all day on some days looks like a misjudged sun: an hour's pause does not make it another thing."""
    superposed = Superposed.__new__(Superposed)
    days: Any = SimpleNamespace(effects=((object, dict(zip(HOURS, hours, strict=True))),))
    promised = {hours: 40.0, (0.0, 24.0): all_day}
    looks: Any = SimpleNamespace(gain=lambda effect, values: promised[values["from_h"], values["to_h"]])
    superposed.looks = looks
    assert superposed._needs_hours(days) == needs


def test_hours_over_midnight_belong_to_the_day_on_which_they_begin() -> None:
    inputs = a_day_and_a_half()
    assert Days.only(0, 2).share(inputs, (22.4, 2.0))[22:26].tolist() == [1.0] * 4  # from within an interval on
    assert Days.only(1, 2).share(inputs, (22.4, 2.0))[22:26].tolist() == [0.0] * 4
    assert Days.only(0, 2).share(inputs, (22.4, 2.0))[:2].tolist() == [0.0] * 2  # began on the day before
    assert Days.only(0, 2).share(inputs, None).tolist() == [1.0] * 24 + [0.0] * 12


def a_day_and_a_half() -> Inputs:
    still = np.zeros(36)
    return Inputs(3600.0, 0.0, outdoor_C=still, supply_C=still, solar_W=still, gains_W=still, air_C=still)


def test_an_effect_does_nothing_on_other_days_and_all_of_it_on_its_own() -> None:
    record, believed = seen()
    heat = timed(EFFECTS["extra-heat"])
    p = heat.Parameters(heat_W=100.0, from_h=6.0, to_h=8.0)
    second, every = (each.apply(believed, p).inputs for each in (on_days(heat, Days.only(1, DAYS)), heat))
    assert second is not None
    assert every is not None
    assert second.extra_W is not None
    assert every.extra_W is not None
    assert (second.extra_W == np.where(record.day == 1, every.extra_W, 0.0)).all()
    assert second.extra_W.any()


def test_days_are_paid_for_in_whatever_company() -> None:
    heat, values = timed(EFFECTS["extra-heat"]), {"heat_W": 100.0, "radiant_share": 0.0, "from_h": 6.0, "to_h": 8.0}
    on = replace(EVERY_OTHER, tried=50)
    assert _price(on_days(heat, on), values) == pytest.approx(_price(heat, values) + WEIGHTS.price + np.log(50))


def test_an_attribute_of_somebody_else_s_effect_is_no_days() -> None:
    assert days_of(type("Theirs", (EFFECTS["window-opening"],), {"acts_on": "Mondays", "days": 3})) is None


def test_days_are_tried_once_and_weather_has_its_own() -> None:
    record, believed = seen()
    assert believed.inputs
    among = courses(record, believed.inputs)
    assert len({each.acts for each in among}) == len(among)
    assert all(len(each.acts) == DAYS and 1 < sum(each.acts) < DAYS for each in among)
    assert {each.tried for each in among} == {len(among)}
    assert coldest(3).acts in {each.acts for each in among}
    words = {each.words for each in among}
    assert {"from day 4 on", "every other day from day 2 on"} <= words
    assert "on day 3 only" not in words  # what happened once may be chance
    midnight = replace(record, start_s=-INTERVAL_S)  # its first stamp is a midnight
    assert {len(each.acts) for each in courses(midnight, believed.inputs)} == {DAYS}
    still = replace(believed.inputs, outdoor_C=np.zeros(len(record)), solar_W=np.zeros(len(record)))
    assert not any("colder" in each.words or "sun" in each.words for each in courses(record, still))
