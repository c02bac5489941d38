"""Claims about the fast room's departures: nobody's effect, in every record alike, and no part of any size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.blind_test.test_engines import measured, recorded
from waxstudy.blind_test.draw import Case
from waxstudy.blind_test.record import without_noise
from waxstudy.blind_test.sizes.missed import gaps
from waxstudy.blind_test.sizes.record import Record
from waxstudy.blind_test.sizes.refit import Refit
from waxstudy.blind_test.sizes.stretch import stretch_of
from waxstudy.blind_test.truth import Stand, sizes
from waxstudy.plugin.trial import Scene
from waxstudy_trials.as_built import MOST_SD
from waxstudy_trials.fast_room import HEAT_SD, FastRoom, study

SOLVED_K = 0.005  # what steps of 15 s leave of the same room in steps of 5 s, and two numbers of how warm it began
RETURN_K = 0.1  # of the first minutes of each flow
DAYS = 3


def scene(seed: int, causes: list[str]) -> Scene:
    return FastRoom.draw(np.random.default_rng(seed), causes, DAYS)


def case_of(found: Scene) -> Case:
    return Case("record", "test", "single", "fast-room", 0, measured("fast-room", DAYS), found)


def null(seed: int) -> Case:
    return case_of({**scene(seed, ["let-by"]), "causes": []})


def test_what_strays_is_drawn_alike_with_any_cause_and_within_what_is_declared() -> None:
    drawn = [scene(seed, [cause])["departures"] for seed in range(30) for cause in ("let-by", "infiltration")]
    assert drawn[::2] == drawn[1::2]
    room = study().room
    declared = [each.name for each in room.component.uncertainties(room.parameters)]
    assert list(drawn[0]) == [*declared, *HEAT_SD]
    values = np.array([list(each.values()) for each in drawn[::2]])
    assert np.abs(values).max() <= MOST_SD
    # 30 draws of 13: the mean lies within 3 / sqrt(390), the spread within 3 / sqrt(780)
    assert abs(values.mean()) < 0.16
    assert values.std() == pytest.approx(0.99, abs=0.11)


def test_the_truth_strays_by_what_was_drawn_and_what_is_recorded_and_told_does_not(tmp_path: Path) -> None:
    case = null(1)
    plain = FastRoom.make({**case.scene, "departures": {}})
    strayed, seen = recorded(case, tmp_path)
    assert strayed.described == plain.described
    for channel in ("solar_gain_W", "internal_gain_W", "outdoor_C", "supply_C"):
        np.testing.assert_array_equal(strayed.channels[channel], plain.channels[channel])
    assert np.abs(strayed.channels["air_C"] - plain.channels["air_C"]).max() > 0.05
    assert seen.room == study().room.changed(gains=seen.room.parameters.gains)  # as the documents have it
    spreads = {each.name: each.sd for each in seen.room.component.uncertainties(seen.room.parameters)} | HEAT_SD
    expected = {name: sd * spreads[name] for name, sd in case.scene["departures"].items()}
    assert strayed.departures == pytest.approx(expected)


@pytest.mark.parametrize("seed", range(4))
def test_a_null_is_given_again_by_the_room_that_strays_and_not_by_the_believed_one(seed: int, tmp_path: Path) -> None:
    case = null(seed)
    staged, seen = recorded(case, tmp_path)
    free = Record.of(without_noise(staged, case.measured).values, seen)
    stretch = stretch_of("room", free, free.belief(seen))
    assert stretch
    left, missed = (
        gaps(Refit(stretch, free, belief, dict.fromkeys(stretch.judged, SOLVED_K), room_tolerance=0.0).base.missed)
        for belief in (Stand(seen, free, (), staged.departures).truth(free), free.belief(seen))
    )
    assert left["air_temperature_C"] < SOLVED_K
    assert missed["air_temperature_C"] > 5.0 * SOLVED_K


def test_the_gap_of_a_cause_is_against_the_same_house_without_it(tmp_path: Path) -> None:
    """However the house strays: the same leak has nearly the same gap in it, and nothing of what strays counts."""
    drawn = scene(4, ["infiltration"])
    found = []
    for departures in ({}, drawn["departures"]):
        case = case_of({**drawn, "departures": departures})
        (size,) = sizes(case, *recorded(case, tmp_path), with_alike=False)
        assert size
        found.append(size.gap)
    assert found[1] == pytest.approx(found[0], rel=0.5)


def test_a_refit_begins_at_the_truth_and_goes_no_farther_from_what_is_believed_than_ever(tmp_path: Path) -> None:
    case = null(2)
    staged, seen = recorded(case, tmp_path)
    free = Record.of(without_noise(staged, case.measured).values, seen)
    stretch = stretch_of("room", free, free.belief(seen))
    assert stretch
    stand = Stand(seen, free, (), staged.departures)
    limits = {**dict.fromkeys(stretch.judged, SOLVED_K), "return_temperature_C": RETURN_K}
    refit: Refit = stand.refit(stretch, free, (), limits)
    assert refit.beyond < 1.0
    strayed = refit.base.departures[: len(staged.departures)]  # behind them how warm it was at first
    assert np.abs(strayed).max() < 0.5
