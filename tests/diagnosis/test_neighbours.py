"""Rooms as each other's control: what departs where and when, and silence where nothing does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import comb, exp
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import waxstudy as wx
from tests.conftest import DATA
from tests.diagnosis.houses import Event, made, toml
from waxstudy.dataset.limits import MOST_DAYS
from waxstudy.dataset.read import read_dataset
from waxstudy.diagnosis.neighbours import judge
from waxstudy.diagnosis.neighbours.control import controlled
from waxstudy.diagnosis.neighbours.events import Happening, happenings
from waxstudy.diagnosis.neighbours.judge import house_of, judged
from waxstudy.diagnosis.neighbours.pattern import Pattern
from waxstudy.diagnosis.neighbours.reading import runs_own_heat, when
from waxstudy.diagnosis.neighbours.search import searched
from waxstudy.diagnosis.neighbours.series import House, RoomSeries
from waxstudy.diagnosis.neighbours.spans import Steady
from waxstudy.diagnosis.result import Interval, NeighbourEvent, RoomsBeside
from waxstudy.report.diagnosis.figures.neighbours import NUMBER, numbered
from waxstudy.study.problems import StudyError

NIGHTS = [(24.0 * day + 22.0, 24.0 * day + 30.0) for day in (3, 4, 7)]
OVERLAP = 0.5  # hours of both over hours of either, that is asked for


def written(folder: Path, record: pd.DataFrame, rooms: int) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    record.to_csv(folder / "data.csv", date_format="%Y-%m-%dT%H:%M:%S")
    (folder / "dataset.toml").write_text(toml(rooms))
    return folder


def beside(folder: Path, record: pd.DataFrame, rooms: int) -> RoomsBeside:
    dataset = read_dataset(written(folder, record, rooms))
    assert dataset.neighbours
    return judged(dataset.neighbours, lambda what, share: None)


def overlap(events: list[NeighbourEvent], spans_h: list[tuple[float, float]]) -> float:
    """Return the hours of both over the hours of either."""
    hours = np.arange(0.0, 24.0 * 60, 0.25)
    told = np.any([(hours >= a) & (hours < b) for each in events for a, b in each.spans_h], axis=0)
    true = np.any([(hours >= a) & (hours < b) for a, b in spans_h], axis=0)
    return float((told & true).sum() / (told | true).sum())


def of_room(found: RoomsBeside, room: int) -> list[NeighbourEvent]:
    return [each for each in found.events if each.room == f"room{room}"]


@pytest.mark.parametrize(
    ("event", "sign", "words"),
    [
        (Event(2, NIGHTS, outside_W_K=30.0), -1.0, "open window"),
        (Event(1, [(129.0, 135.0)], heat_W=400.0), 1.0, "not recorded"),
        (Event(0, [(100.0, 130.0)], sensor_K=1.5), 1.0, "thermometer"),
        (Event(2, [(24.0 * day, 24.0 * day + 6.0) for day in range(6, 12)], heat_W=-250.0), -1.0, "lost"),
    ],
    ids=["window", "heater", "sensor", "every-night-since"],
)
@pytest.mark.parametrize("seed", [0, 2])
def test_the_room_and_its_hours_are_named_and_no_other_room_is(
    tmp_path: Path, event: Event, sign: float, words: str, seed: int
) -> None:
    rooms = 5
    found = beside(tmp_path, made(seed, rooms=rooms, events=[event]), rooms)
    own = of_room(found, event.room)
    assert own
    assert overlap(own, list(event.spans_h)) >= OVERLAP
    assert len(own) == len(found.events)
    largest = max(own, key=lambda each: abs(each.size_K.value))
    assert largest.size_K.value * sign > 0.0
    assert words in largest.reading


@pytest.mark.parametrize(
    "event",
    [Event(1, [(129.0, 135.0)], heat_W=400.0), Event(2, NIGHTS, outside_W_K=8.0)],
    ids=["heater", "small-window"],
)
def test_intervals_hold_the_true_departure_in_most_seeds(tmp_path: Path, event: Event) -> None:
    """The truth is the same record with and without what happens, in the hours that are told."""
    held = []
    for seed in range(600, 606):
        record = made(seed, rooms=4, events=[event])
        own = of_room(beside(tmp_path / str(seed), record, 4), event.room)
        largest = max(own, key=lambda each: abs(each.size_K.value))
        departs_K = (record - made(seed, rooms=4))[f"room{event.room}"].to_numpy()
        hour = np.arange(len(record)) / 6.0
        true_K = departs_K[np.any([(hour >= a) & (hour < b) for a, b in largest.spans_h], axis=0)].mean()
        held.append(largest.size_K.low <= true_K <= largest.size_K.high)
    assert sum(held) >= 5


def test_heat_in_watts_is_right_where_own_heat_was_recorded(tmp_path: Path) -> None:
    found = of_room(beside(tmp_path, made(2, events=[Event(1, [(129.0, 133.0)], heat_W=400.0)]), 5), 1)
    assert found[0].heat_W
    assert found[0].heat_W.value == pytest.approx(400.0, rel=0.3)
    assert "recorded" in found[0].heat_from


def test_an_assumed_capacity_gives_watts_where_no_heat_was_recorded(tmp_path: Path) -> None:
    record = made(2, days=7, rooms=3, events=[Event(1, [(105.0, 109.0)], heat_W=400.0)])
    folder = written(tmp_path, record, 3)
    text = toml(3).replace('internal_gain_W = "gain1"', "capacity_Wh_K = 100.0")
    (folder / "dataset.toml").write_text(text)
    dataset = read_dataset(folder)
    assert dataset.neighbours
    found = judged(replace(dataset.neighbours, outdoor_C=None), lambda what, share: None)
    (heater,) = [each for each in of_room(found, 1) if overlap([each], [(105.0, 109.0)]) >= OVERLAP]
    assert heater.heat_W
    assert "assumed" in heater.heat_from
    assert 100.0 < heater.heat_W.value < 800.0


def test_nothing_is_named_where_nothing_happens(tmp_path: Path) -> None:
    """Recorded heat comes and goes in all rooms; that is no finding."""
    named = [bool(beside(tmp_path / str(seed), made(100 + seed, rooms=3), 3).events) for seed in range(20)]
    assert sum(named) <= 1


def test_gaps_are_not_filled_and_hours_that_come_back_are_one_event(tmp_path: Path) -> None:
    mornings = [(24.0 * day + 9.0, 24.0 * day + 12.0) for day in range(10, 20)]
    record = made(7, days=20, rooms=4, events=[Event(1, mornings, heat_W=250.0)])
    record.iloc[300:340] = np.nan
    record.loc[record.index[1000:1100], "room0"] = np.nan
    found = beside(tmp_path, record, 4)
    assert [each.room for each in found.events] == ["room1"]
    assert "every day from 21 Jan on" in found.events[0].when
    assert overlap(list(found.events), mornings) >= OVERLAP


def test_two_rooms_are_enough_and_say_that_either_may_depart(tmp_path: Path) -> None:
    found = beside(tmp_path, made(1, rooms=2, events=[Event(0, [(130.0, 138.0)], outside_W_K=30.0)]), 2)
    assert found.events
    assert "two rooms cannot tell" in found.events[0].reading


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('"room1"', '"roam1"', "there is no column 'roam1'"),
        ('"room1"', '"words"', "no numbers"),
        ('"room1"', '"room0"', "the column of another room"),
        ('"room1"', '"still"', "is always 21"),
        ('"room1"', '"short"', "days in common"),
        ('"room1"', '"empty"', "holds no value"),
        ('sun = ["sun"]', 'sun = ["moon"]', "there is no column 'moon'"),
        ('sun = ["sun"]', "sun = 3", "list of columns"),
        ('air_temperature_C = "room1"', 'air = "room1"', "air_temperature_C is missing"),
    ],
)
def test_what_cannot_be_used_is_refused(tmp_path: Path, old: str, new: str, told: str) -> None:
    record = made(0, days=5, rooms=3)
    record["words"], record["still"], record["empty"] = "warm", 21.0, np.nan
    record["short"] = record["room1"].where(np.arange(len(record)) < 200)
    folder = written(tmp_path, record, 3)
    (folder / "dataset.toml").write_text(toml(3).replace(old, new, 1))
    with pytest.raises(StudyError, match=told):
        read_dataset(folder)


def test_one_room_alone_has_no_control(tmp_path: Path) -> None:
    folder = written(tmp_path, made(0, days=5, rooms=1), 1)
    with pytest.raises(StudyError, match="no control"):
        read_dataset(folder)


def test_samples_of_sun_and_rooms_are_looked_at_as_those_of_channels_are(tmp_path: Path) -> None:
    record = made(3, days=6, rooms=3).resample("1h").last()
    record.iloc[40:52, record.columns.get_loc("sun")] = -9999.0
    record.iloc[20, record.columns.get_loc("room0")] -= 5.5  # by the hour air may fall so far
    read = read_dataset(written(tmp_path, record, 3))
    assert read.neighbours
    assert np.isnan(read.neighbours.sun["sun"]).sum() == 12
    assert np.isfinite(read.neighbours.rooms[0].air_C).all()
    # what judges rooms is not said to be left unread
    assert [each.split(":")[0] for each in read.warnings] == ["sun sun"]


def test_a_room_of_its_own_is_held_against_those_named(tmp_path: Path) -> None:
    folder = written(tmp_path, made(0, days=5, rooms=3), 3)
    text = toml(2) + '[columns]\nair_temperature_C = "room2"\noutdoor_temperature_C = "outdoor_temperature_C"\n'
    (folder / "dataset.toml").write_text(text)
    neighbours = read_dataset(folder).neighbours
    assert neighbours
    assert [each.name for each in neighbours.rooms] == ["made", "room0", "room1"]


def test_a_room_without_days_in_common_with_what_it_is_held_against_is_refused(tmp_path: Path) -> None:
    record = made(0, days=8, rooms=3)
    early = np.arange(len(record)) < len(record) // 2
    record["room2"], record["gain1"] = record["room2"].where(~early), record["gain1"].where(~early)
    record.loc[~early, ["room0", "room1"]] = np.nan
    folder = written(tmp_path, record, 3)
    text = toml(2) + '[columns]\nair_temperature_C = "room2"\noutdoor_temperature_C = "outdoor_temperature_C"\n'
    (folder / "dataset.toml").write_text(text)
    with pytest.raises(StudyError) as refused:
        read_dataset(folder)
    told = [each.wrong for each in refused.value.problems]
    assert [each.split(" days")[0] for each in told] == ["made has 0.0", "room1 has 0.0"]
    assert "its own heat" in told[1]


def test_own_heat_tells_by_the_hours_in_which_it_is_known(tmp_path: Path) -> None:
    record = made(2, days=7, rooms=3, events=[Event(1, [(105.0, 109.0)], heat_W=400.0)])
    dataset = read_dataset(written(tmp_path, record, 3))
    assert dataset.neighbours
    house = house_of(dataset.neighbours)
    (found,) = happenings(searched(house)["room1"])
    begin, end = found.spans[0]

    def with_heat(known: int) -> Happening:
        gain_W = np.zeros(len(house))
        gain_W[begin:end] = 50.0
        gain_W[begin + known : end] = np.nan
        control = replace(found.control, room=replace(found.control.room, gain_W=gain_W))
        return Happening(control, found.parts)

    assert runs_own_heat(with_heat(end - begin))
    assert runs_own_heat(with_heat(1))
    assert not runs_own_heat(with_heat(0))


@pytest.mark.slow
@pytest.mark.parametrize("baseline", [None, ("2021-01-12", "2021-01-16")], ids=["alone", "after days of its own"])
def test_rooms_of_a_long_record_are_judged_on_all_its_days(tmp_path: Path, baseline: tuple[str, str] | None) -> None:
    """A loop is looked at for four weeks; what happened in a room before or after them is found, but in a baseline."""
    days = MOST_DAYS + 10
    early, late = [(50.0, 58.0)], [(24.0 * (days - 2) + 20.0, 24.0 * (days - 1) + 4.0)]
    events = [Event(0, early, outside_W_K=40.0), Event(0, late, outside_W_K=40.0)]
    record = made(3, days=days, rooms=3, events=events)
    found = wx.diagnose(written(tmp_path, record, 3), baseline).diagnosis
    own = of_room(found.neighbours, 0)
    assert overlap(own, late if baseline else [*early, *late]) >= OVERLAP
    assert found.verdict == "room"
    assert any("Rooms beside each other are judged on all days" in each for each in found.warnings)


@pytest.mark.parametrize("steps", [8, 24])
@pytest.mark.parametrize("tau_h", [0.0, 4.0])
def test_a_span_in_a_long_gap_weighs_nothing(tmp_path: Path, steps: int, tau_h: float) -> None:
    record = made(1, days=20, rooms=3)
    per_day = len(record) // 20
    record.iloc[3 * per_day : 17 * per_day, record.columns.get_loc("room0")] = np.nan
    dataset = read_dataset(written(tmp_path, record, 3))
    assert dataset.neighbours
    house = house_of(dataset.neighbours)
    control = controlled(house, house.rooms[0], {room.name: room.air_C for room in house.rooms})
    _, weight = Steady.of(house, control.fit, tau_h).pulls(steps)
    a_day = round(24.0 / house.step_h)
    assert (weight[4 * a_day : 14 * a_day] == 0.0).all()
    assert (weight[a_day : 2 * a_day] > 0.0).all()


@pytest.mark.parametrize(
    ("days", "words"),
    [
        (range(3, 40, 2), "every other day from 14 Jan to 19 Feb"),
        (range(3, 9), "every day from 14 Jan to 19 Jan"),
        (range(5, 33, 7), "on Saturdays from 16 Jan to 6 Feb"),
        ([5, 6, 12, 13, 19, 20, 26, 27], "on Saturdays and Sundays from 16 Jan to 7 Feb"),
        ([day for day in range(35) if day % 7 < 5], "from Mondays to Fridays from 11 Jan to 12 Feb"),
        ([1, 10, 19, 28], "every 9 days from 12 Jan to 8 Feb"),
        ([1, 8, 22, 29], "on 12 Jan, 19 Jan, 2 Feb, 9 Feb"),
        ([1, 3, 5], "on 12 Jan, 14 Jan, 16 Jan"),
        (
            [day for day in range(35) if day % 7 in (0, 1, 3)],
            "on 11 Jan, 12 Jan, 14 Jan, 18 Jan, 19 Jan, 21 Jan, 25 Jan, 26 Jan and 7 more days",
        ),
        (
            [0, 1, 3, 4, 6, 7, 9, 10, 12],
            "on 11 Jan, 12 Jan, 14 Jan, 15 Jan, 17 Jan, 18 Jan, 20 Jan, 21 Jan and 1 more day",
        ),
    ],
)
def test_days_that_come_back_are_told_by_their_rule_and_others_one_by_one(days: Sequence[int], words: str) -> None:
    begin = pd.Timestamp("2021-01-11")  # a Monday
    air = np.zeros(60 * 48)
    house = House([RoomSeries("room", air)], None, {}, begin, 1800.0)
    assert when(house, [(48 * day + 20, 48 * day + 24) for day in days]) == f"10:00 to 12:00, {words}"


def test_spans_that_a_record_cuts_short_leave_their_rule_and_years_are_told() -> None:
    nights = [(48 * day + 44, min(48 * day + 60, 60 * 48)) for day in range(1, 60, 2)]
    usual, over_years = (
        when(House([RoomSeries("room", np.zeros(60 * 48))], None, {}, pd.Timestamp(begin), 1800.0), nights)
        for begin in ("2021-01-11", "2021-12-11")
    )
    assert usual == "22:00 to 06:00, every other day from 12 Jan to 11 Mar"
    assert over_years == "22:00 to 06:00, every other day from 12 Dec 2021 to 8 Feb 2022"
    uneven = [(48 * day + 20, 48 * day + 24 + day % 2) for day in range(1, 20)]
    house = House([RoomSeries("room", np.zeros(60 * 48))], None, {}, pd.Timestamp("2021-01-11"), 1800.0)
    assert when(house, uneven).endswith("19 Jan 10:00 to 19 Jan 12:00; and 11 more times")


def test_numbers_of_a_figure_never_touch_and_the_largest_have_theirs() -> None:
    def event(size_K: float, days: Sequence[float]) -> NeighbourEvent:
        spans_h = [(24.0 * day, 24.0 * day + 2.0) for day in days]
        return NeighbourEvent("room", "", spans_h, Interval(size_K, size_K, size_K), None, "", "", (), 1.0)

    places = numbered([event(0.6, np.arange(72.0).tolist()), event(-4.0, [10.3, 71.9])], 72.0)
    days = sorted(day for day, _ in places)
    assert min(np.diff(days)) >= NUMBER * 72.0
    assert 0.5 * NUMBER * 72.0 <= days[0] < days[-1] <= 72.0 - 0.5 * NUMBER * 72.0
    assert sorted(size_K for _, size_K in places)[:2] == [-4.0, -4.0]
    assert numbered([event(0.6, [1.0, 3.0])], 10.0) == [(pytest.approx(1.0 + 1.0 / 24.0), 0.6), (3.0 + 1.0 / 24.0, 0.6)]


HOUSE = DATA / "measured_house" / "o5_2019-02-01_to_10.csv"
TOML = Path(__file__).parents[2] / "studies" / "measured_house" / "rooms" / "dataset.toml"


@pytest.mark.skipif(not HOUSE.is_file(), reason=f"{HOUSE} is not there; WAXSTUDY_DATA names the folder of the data")
def test_in_the_measured_house_a_cold_evening_is_named(tmp_path: Path) -> None:
    """Seen in the file itself: the air of child1 falls from 18 to 14 °C on 10 February from 19 to 23:30."""
    (tmp_path / "dataset.toml").write_text(TOML.read_text().replace("../o5_2019-02-01_to_10.csv", str(HOUSE)))
    dataset = read_dataset(tmp_path)
    assert dataset.neighbours
    found = judged(dataset.neighbours, lambda what, share: None)
    own = [each for each in found.events if each.room == "child1"]
    last = max(own, key=lambda each: each.spans_h[0][0])
    assert overlap([last], [(224.5, 229.0)]) >= OVERLAP
    assert last.size_K.high < -2.0
    assert "open window" in last.reading


def test_own_heat_is_told_by_how_much_a_kilowatt_warms_on_average_in_three_hours(tmp_path: Path) -> None:
    """The truth is the same house with a kilowatt more for three hours; what is missed is no more than its noise."""
    found = {each.name: each for each in beside(tmp_path, made(2), 5).rooms}
    hours = np.arange(len(made(2))) / 6.0
    for room in range(2):
        more = made(2, events=[Event(room, [(129.0, 132.0)], heat_W=1000.0)]) - made(2)
        true_K = float(more[f"room{room}"][(hours >= 129.0) & (hours < 132.0)].mean())
        told = found[f"room{room}"]
        assert told.own_heat_K_kW
        assert told.own_heat_K_kW.value == pytest.approx(true_K, rel=0.3)


@pytest.mark.parametrize("count", [1, 4])
def test_who_may_choose_days_pays_for_them(monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    house: Any = SimpleNamespace(days=np.repeat(np.arange(20), 48))
    pattern = Pattern(tuple((48 * day, 48 * day + 6) for day in range(count)), (0.0,))
    control: Any = SimpleNamespace(house=house, fit=None, patterns=[pattern], without=lambda place: None)
    monkeypatch.setattr(judge, "gained", lambda *told: 30.0)
    monkeypatch.setattr(judge, "unrest_of", lambda *told: 1.0)
    monkeypatch.setattr(judge, "tried", lambda house: 100)
    happening: Any = SimpleNamespace(control=control, main=0)
    ways = comb(20, count) if count > 1 else 1  # where a single span lies is among what was tried
    odds = exp(15.0) / 100.0 / ways
    assert judge._probability(happening) == pytest.approx(odds / (1.0 + odds))
