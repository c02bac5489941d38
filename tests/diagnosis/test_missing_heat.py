"""Claims about missing heat: what was put into a room is found again, when it was and how much, and nothing else."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
import pytest

from tests.diagnosis.realities import belief, dataset, effects, estimator, planted, record, rows, with_effects
from waxstudy.dataset.stand_ins import GAINS
from waxstudy.diagnosis.consequence.heat_estimate import HeatData, HeatEstimate, Pieces, Unknowns, estimated
from waxstudy.diagnosis.consequence.heat_words import sentence
from waxstudy.diagnosis.consequence.missing_heat import Drivers, _unknowns, missing_heat
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.model.as_built import AsBuilt
from waxstudy.diagnosis.model.nuisance import habits
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.record import Record, settling_s
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import HeatPer, HeatPiece, Interval, MissingHeat
from waxstudy.diagnosis.select.search import Selection
from waxstudy.plugin import Belief, FloatArray

DAYS = 7
HEAT_W = 60.0
STOVE = {"heat_W": HEAT_W}
WINDOW = {"flow_L_s": 8.0, "from_h": 9.0, "to_h": 12.0}


KNOWN = ("heat", "window", "none")
ROOMS: dict[str, dict[str, dict[str, float]]] = {
    "heat": {"extra_heat": STOVE},
    "window": {"window_opening": WINDOW},
    "none": {},
    "colder water": {"supply_offset": {"offset_K": -3.0}},
}


@cache
def ready() -> tuple[Record, Belief, Segment]:
    seen = record("REAL", days=DAYS)
    believed = belief("REAL", seen)
    return seen, believed, next(each for each in segments(seen, believed) if each.with_room)


@cache
def told(room: str) -> tuple[MissingHeat, FloatArray]:
    """Return missing heat of a room with effects, and the true one in each piece (P,)."""
    seen, believed, segment = ready()
    true = effects(**ROOMS[room])
    made = planted(segment, seen, believed, true)
    asked = estimator(segment, made, belief("REAL", made))
    selection = Selection(asked, [asked.base], [], (), (), NoiseFloor.of(asked.problem, asked.base))
    time = pd.date_range("2026-01-05", periods=len(made) + 1, freq=f"{made.interval_s}s")[1:]
    found = missing_heat(selection, None, time)
    inputs = with_effects(believed, true).inputs
    assert inputs
    heat_W = np.zeros(len(seen)) if inputs.extra_W is None else inputs.extra_W
    at_h = (np.arange(len(seen)) + 0.5) * seen.interval_s / 3600.0
    return found, np.array([heat_W[(at_h > each.from_h) & (at_h < each.to_h)].mean() for each in found.before])


def covered(pieces: list[HeatPiece], true_W: FloatArray) -> float:
    pairs = zip(pieces, true_W.tolist(), strict=True)
    return float(np.mean([each.low_W <= true <= each.high_W for each, true in pairs]))


@pytest.mark.parametrize("room", KNOWN)
def test_known_heat_is_within_its_interval_in_nine_of_ten_pieces(room: str) -> None:
    found, true_W = told(room)
    assert covered(list(found.before), true_W) >= 0.9
    assert found.after == found.before


def test_heat_that_stands_in_for_how_warm_the_mass_was_at_first_is_not_told() -> None:
    found, _ = told("colder water")
    middle_h = 0.5 * (found.before[0].from_h + found.before[0].to_h)
    assert middle_h * 3600.0 >= settling_s(DAYS * 86_400.0)
    assert found.mean_before
    assert max(abs(each.heat_W) for each in found.before) < 5.0 * abs(found.mean_before.value)


@pytest.mark.parametrize("room", ["heat", "window"])
def test_all_heat_together_is_what_was_put_in(room: str) -> None:
    found, true_W = told(room)
    hours = np.array([each.to_h - each.from_h for each in found.before])
    sum_Wh = hours @ np.array([each.heat_W for each in found.before])
    assert sum_Wh == pytest.approx(hours @ true_W, rel=0.15)
    assert found.mean_before
    assert found.mean_before.value == pytest.approx(sum_Wh / hours.sum())


def test_a_window_shows_at_its_hours() -> None:
    found, true_W = told("window")
    by_hour = {each.name: each for each in found.by if each.driver == "hour"}
    most = max(by_hour.values(), key=lambda each: -each.before.value)
    assert most.name == "09 to 12 h"
    assert most.before.low <= true_W.min() * 0.95
    assert most.beside.high < 0.0
    assert found.is_resolved
    assert "from 09 to 12 h" in found.sentence


def test_of_a_healthy_room_nothing_is_said_to_be_missing() -> None:
    found, _ = told("none")
    assert not found.is_resolved
    assert found.sentence.startswith("No heat is missing as far as this record can tell")


# --- the estimate ------------------------------------------------------------------------------------


@pytest.mark.parametrize("is_calibrated", [False, True])
def test_hours_of_gains_are_lost_of_a_record_unless_a_healthy_one_tells_them(is_calibrated: bool) -> None:
    """What is lost is fitted along with heat; what is known of habits blurs it."""
    seen = record_of(dataset(rows("REAL", 4, without=(GAINS,)), "REAL"))
    believed = belief("REAL", seen)
    room = next(each for each in segments(seen, believed) if each.with_room and not each.is_supply)
    of_gains = list(habits(seen))
    known = AsBuilt(tuple(of_gains), np.zeros(len(of_gains)), np.eye(len(of_gains)))
    problem = SegmentProblem(room, seen, believed, as_built=known if is_calibrated else None)
    slopes = np.arange(float(len(problem.nuisances)))[None, :]
    lost, doubted = _unknowns(problem, slopes)
    places = [place for place, each in enumerate(problem.nuisances) if each.is_habit]
    assert len(places) == len(of_gains) > 0
    assert set(places) <= set((doubted if is_calibrated else lost).slopes[0])
    assert lost.slopes.shape[1] + doubted.slopes.shape[1] == len(problem.nuisances)


def test_pieces_are_whole_hours_by_the_clock() -> None:
    pieces = Pieces.of(count=48, interval_s=600.0, start_s=2.0 * 3600.0, length_h=3.0)
    assert pieces.count == 4
    assert pieces.hours(600.0).tolist() == [1.0, 3.0, 3.0, 1.0]
    assert pieces.middle_h.tolist() == [1.5, 4.5, 7.5, 10.5]
    longer = Pieces.of(count=48, interval_s=600.0, start_s=2.0 * 3600.0, length_h=6.0)
    assert pieces.within(longer).sum(axis=0).tolist() == [2.0, 2.0]


def drivers(flows: list[float], colder_K: list[float]) -> Drivers:
    """What eight pieces had, of which the first two are not judged."""
    hours, still = np.array([0.0, 0.0, *[3.0] * 6]), np.zeros(8)
    return Drivers(hours, [""] * 8, still > 0.0, np.array(colder_K), still, np.array(flows))


@pytest.mark.parametrize(("share", "is_told"), [(0.0, False), (1.0, True)])
def test_heat_is_told_by_what_differs_among_the_pieces_that_are_judged(share: float, is_told: bool) -> None:
    """Water that flows, or cold, in the hours at the start alone tells nothing of the rest."""
    heat = HeatEstimate(np.arange(8.0), np.eye(8))
    found = drivers([1.0, 1.0, share, 0.0, 0.0, share, 0.0, 0.0], [9.0, 8.0, 4.0 + share, 4.0, 4.0, 4.0, 4.0, 4.0])
    assert ("flow" in {each.driver for each in found.by(heat, heat)}) is is_told
    assert [each.driver for each in found.per(heat, heat)] == ["outdoor difference"] * is_told
    same = drivers([0.0, 0.0, *[1.0] * 6], [9.0, 9.0, *[4.0] * 6])
    assert "flow" not in {each.driver for each in same.by(heat, heat)}


def made(doubt: float) -> tuple[HeatData, Pieces]:
    """Two days of which each piece is seen with a spread of 1 W, beside something that is as good as constant heat."""
    pieces = Pieces.of(count=16, interval_s=3.0 * 3600.0, start_s=0.0, length_h=3.0)
    missed = -50.0 + np.random.default_rng(1).normal(0.0, 1.0, 16)
    alike = Unknowns(np.ones((16, 1)), np.array([[doubt**2]]))
    return HeatData(missed, np.eye(16), Unknowns.none(16), alike), pieces


def test_what_is_doubted_of_a_room_blurs_heat_and_does_not_take_it() -> None:
    sure, unsure = (estimated(*made(doubt), floor_m2=15.0) for doubt in (0.0, 20.0))
    every = np.full(16, 1.0 / 16.0)
    assert unsure.of(every).value == pytest.approx(50.0, abs=2.0)
    assert sure.of(every).high - sure.of(every).low < 3.0
    assert unsure.of(every).high - unsure.of(every).low == pytest.approx(2.0 * 1.96 * 20.0, rel=0.1)


def test_what_a_healthy_record_has_blurs_pieces_more_than_their_mean() -> None:
    data, pieces = made(0.0)
    heat = estimated(data, pieces, floor_m2=15.0, usual_W=10.0)
    wide = [each.high - each.low for each in (heat.pieces()[3], heat.of(np.full(16, 1.0 / 16.0)))]
    assert wide[0] == pytest.approx(2.0 * 1.96 * 10.0, rel=0.15)
    assert wide[1] < 0.8 * wide[0]


def test_what_a_sentence_says_of_a_sign_is_told_in_words() -> None:
    estimate = HeatEstimate(np.array([-40.0, -50.0]), np.diag([9.0, 16.0]))
    mean = estimate.of(np.array([0.5, 0.5]))
    heat = MissingHeat(mean_before=mean, mean_after=Interval(-2.0, -6.0, 2.0))
    less = "On average 45 W (40 to 50) of heat are missing in the room."
    assert sentence(heat, []) == less
    with_it = f"{less} With infiltration"
    assert sentence(heat, ["infiltration"]) == f"{with_it} none stays as far as can be told (-6.0 to 2.0 W)."
    for after, words in ((-20.0, "20 W (16 to 24) of it stay."), (20.0, "20 W (16 to 24) are too much.")):
        known = replace(heat, mean_after=Interval(after, after - 4.0, after + 4.0))
        assert sentence(known, ["infiltration"]) == f"{with_it} {words}"
    per_kelvin = HeatPer("outdoor difference", "W/K", Interval(-3.1, -4.1, -2.1), Interval(0.0, -1.0, 1.0), 0.5)
    with_cold = sentence(replace(heat, per=(per_kelvin,)), [])
    assert with_cold == f"{less[:-1]}, growing with the cold outside: 3.1 W (2.1 to 4.1) per kelvin."
    even = replace(heat, mean_before=Interval(-8.0, -26.0, 10.0), per=(per_kelvin,))
    assert sentence(even, []).endswith("but heat is missing with the cold outside: 3.1 W (2.1 to 4.1) per kelvin.")
    more = replace(heat, mean_before=Interval(45.0, 40.0, 50.0))
    assert sentence(more, []) == "On average the room gets 45 W (40 to 50) of heat more than is believed."
    assert sentence(MissingHeat(), []) == ""
