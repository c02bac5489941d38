"""Weighing what may differ at a link: probabilities, courses over time, heat at hours."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, study
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.model.conventions import PLAIN
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.select.gain_spread import gain_spread, told_apart
from waxstudy.diagnosis.select.patterns import concentrated, patterns
from waxstudy.diagnosis.select.posterior import (
    UNKNOWN,
    Weighed,
    _gains,
    _is_within,
    _mimicked,
    _with_peers,
    _with_unseen,
    posterior,
    score,
)
from waxstudy.diagnosis.select.timed import can_be_timed, timed
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import Belief, Inputs, open_share

NOTHING = Weighed(
    fitted=Hypothesis((), PLAIN, np.zeros(0), ()),
    names=(),
    gain=0.0,
    ease=0.0,
    always=0.0,
    misfit=0.0,
    price=0.0,
    spread=1.0,
    most=0.0,
    by_cycle=np.ones(9),
)
LEAK = replace(
    NOTHING,
    fitted=Hypothesis(((EFFECTS["infiltration"], {"factor": 2.0}),), PLAIN, np.zeros(0), ()),
    names=("infiltration",),
    gain=30.0,
    price=6.0,
    most=50.0,
    always=-20.0,
    left=0.05,
)
SLOW = replace(LEAK, stands=20.0, most=200.0)  # an effect of a chain


# --- how far a gain is one of all cycles -------------------------------------------------------------


def _gained(cycles: int, missed: float) -> tuple[float, float]:
    """What is told of an effect that takes the same away from one switch of each of some cycles."""
    before = np.full(cycles, missed)
    return gain_spread(before, np.zeros(cycles), np.arange(cycles))


def test_two_switches_that_agree_to_the_sample_tell_little() -> None:
    assert _gained(2, 4.6)[1] < 4.0 < 0.5 * 2 * 4.6**2


def test_more_cycles_tell_more_and_never_more_than_what_is_gained() -> None:
    most = [_gained(cycles, 4.6)[1] for cycles in (2, 4, 8, 16, 64)]
    assert most == sorted(most)
    assert all(each <= 0.5 * cycles * 4.6**2 for each, cycles in zip(most, (2, 4, 8, 16, 64), strict=True))


@pytest.mark.parametrize("cycles", [2, 5, 40])
def test_what_cycles_tell_is_the_logarithm_of_student_s_t(cycles: int) -> None:
    """Of errors of 3 in each cycle that an effect takes away: t squared is 9 times the degrees of freedom."""
    spread, most = _gained(cycles, 3.0)
    assert spread == 1.0
    assert most == pytest.approx(0.5 * cycles * np.log1p(9.0))


def test_a_gain_that_all_days_say_alike_varies_by_no_more_than_noise_however_much_each_of_them_tells() -> None:
    """Of an effect that would have to be two and a half times as large."""
    change = np.array([3.0, 6.0, 9.0, 12.0])
    assert gain_spread(2.5 * change, 1.5 * change, np.arange(4))[0] == 1.0


def test_an_effect_that_changes_nothing_gains_nothing() -> None:
    errors = np.array([1.0, -2.0, 3.0])
    assert gain_spread(errors, errors, np.arange(3)) == (1.0, 0.0)


@given(st.lists(st.floats(-5.0, 5.0), min_size=2, max_size=30))
def test_a_gain_varies_at_least_as_errors_that_are_independent_do(missed: list[float]) -> None:
    spread, most = gain_spread(np.array(missed), np.zeros(len(missed)), np.arange(len(missed)) // 2)
    assert spread >= 1.0
    assert most >= 0.0


def test_a_gain_of_one_day_among_many_is_no_effect_s() -> None:
    """An effect changes all days alike, and one day alone is missed so: as much is gained as if all of them were."""
    day = np.arange(100) // 10
    once, always = np.where(day == 3, 10.0, 0.0), np.full(100, 1.0)
    (spread, most), (_, always_most) = (gain_spread(each, each - 1.0, day) for each in (once, always))
    assert spread == pytest.approx(90.0)  # that day is off by 90, nine others by 10 each, over 100
    assert most < 0.2 * always_most


# --- how far cycles tell two effects apart -----------------------------------------------------------


def test_cycles_tell_two_effects_apart_as_far_as_their_difference_stands_out_of_its_scatter() -> None:
    """Each cycle prefers one by 2, and by 1 more or less: t squared is 4 times the degrees of freedom, 16 less 1."""
    worse = 1.0 + np.array([6.0, 2.0] * 8)
    assert told_apart(np.ones(16), worse) == pytest.approx(0.5 * 16 * np.log1p(4.0))


def test_cycles_of_which_each_prefers_another_effect_tell_nothing_however_much_they_differ() -> None:
    assert told_apart(np.array([0.0, 50.0, 0.0, 50.0]), np.array([50.0, 0.0, 50.0, 0.5])) < 1e-3


def test_one_cycle_among_many_does_not_tell_two_effects_apart() -> None:
    worse = np.zeros(50)
    worse[7] = 1e4
    assert told_apart(np.zeros(50), worse) == pytest.approx(0.5, abs=0.02)
    assert told_apart(worse, np.zeros(50)) == 0.0


def test_cycles_that_all_say_the_same_set_no_limit_and_a_single_one_tells_nothing() -> None:
    assert told_apart(np.zeros(3), np.ones(3)) == np.inf
    assert told_apart(np.ones(3), np.zeros(3)) == 0.0
    assert told_apart(np.zeros(1), np.ones(1)) == 0.0


# --- probabilities -----------------------------------------------------------------------------------


def _of(*names: str) -> Hypothesis:
    return Hypothesis(tuple((EFFECTS[name], {}) for name in names), PLAIN, np.zeros(0), ())


def test_an_effect_of_a_chain_that_leaves_something_amiss_is_outdone_by_the_square_of_that() -> None:
    first, second = (replace(SLOW, misfit=misfit, by_cycle=np.full(9, misfit)) for misfit in (0.0, 3.0))
    told = _with_peers([NOTHING, first, second], [0.0, 100.0, 10.0])
    assert told == pytest.approx([0.0, 100.0, 100.0 - WEIGHTS.unknown_price - 9.0 * WEIGHTS.sure])
    of_room = [NOTHING, *(replace(each, stands=np.inf) for each in (first, second))]
    assert _with_peers(of_room, [0.0, 100.0, 10.0]) == [0.0, 100.0, 10.0]


@pytest.mark.parametrize(("left", "is_peer"), [(0.05, True), (0.7, True), (0.72, False), (1.0, False)])
def test_only_an_effect_of_a_chain_that_takes_half_of_the_squares_away_is_outdone_by_little(
    left: float, is_peer: bool
) -> None:
    """One that hardly explains anything is no coarse name of what explains all."""
    first, second = (replace(SLOW, left=each, by_cycle=np.full(9, each)) for each in (0.01, left))
    told = _with_peers([NOTHING, first, second], [0.0, 100.0, 10.0])
    assert told == pytest.approx([0.0, 100.0, 100.0 - WEIGHTS.unknown_price if is_peer else 10.0])


def test_an_effect_of_a_chain_outdoes_another_only_as_far_as_cycles_tell_them_apart() -> None:
    """Both leave much amiss, and cycles prefer the one or the other in turn."""
    scattered = (np.array([0.0, 5.0] * 4 + [0.0]), np.array([5.0, 0.0] * 4 + [5.0]))
    first, second = (replace(SLOW, misfit=9.0, left=0.9, by_cycle=each) for each in scattered)
    most = told_apart(*scattered)
    assert 0.0 < most < 0.2
    assert _with_peers([NOTHING, first, second], [0.0, 100.0, 90.0]) == pytest.approx([0.0, 100.0, 100.0 - most])
    assert _with_peers([NOTHING, first, second], [0.0, 100.0, 99.95]) == [0.0, 100.0, 99.95]


@pytest.mark.parametrize("most", [8.0, 15.0, 40.0, 80.0])
def test_an_effect_that_leaves_nothing_amiss_is_not_held_down_by_how_sure_a_better_one_is(most: float) -> None:
    first, second = (replace(SLOW, left=each, by_cycle=np.full(9, each)) for each in (0.01, 0.3))
    second, nothing = replace(second, most=most), 100.0 - SLOW.most
    told = _with_peers([NOTHING, first, second], [nothing, 100.0, -60.0])
    as_good, by_itself = 100.0 - WEIGHTS.unknown_price, 100.0 - WEIGHTS.beyond_doubt + most
    assert told == pytest.approx([nothing, 100.0, min(as_good, by_itself)])
    for amiss in (replace(second, misfit=1.5), replace(second, left=0.8, by_cycle=np.full(9, 5.0))):
        assert _with_peers([NOTHING, first, amiss], [nothing, 100.0, -60.0])[2] <= max(-60.0, nothing + most)


def test_an_effect_that_cycles_do_not_tell_from_a_better_one_must_stand_out_by_itself() -> None:
    """Else nothing is left of it, nor does it make something unknown likelier that looks like it."""
    scattered = (np.array([0.0, 5.0] * 4 + [0.0]), np.array([5.0, 0.0] * 4 + [5.0]))
    best, other = (replace(SLOW, gain=gain, by_cycle=each) for gain, each in zip((100.0, 9.0), scattered, strict=True))
    faint = replace(other, fitted=_of("solar-factor"), names=("solar-factor",), left=0.9)
    seen, *unseen = (
        posterior([NOTHING, best, replace(faint, **kept)]) for kept in ({}, {"stands": 2.0}, {"most": 5.0})
    )
    assert seen["solar-factor"] == pytest.approx(seen["infiltration"], rel=0.1)
    for each in unseen:
        assert each["solar-factor"] < 1e-9
        assert each[UNKNOWN] / each["infiltration"] == pytest.approx(seen[UNKNOWN] / seen["infiltration"])


def test_what_speaks_for_a_hypothesis_by_itself_is_a_sum_of_logarithms() -> None:
    told = replace(LEAK, gain=30.0, spread=2.0, ease=3.0, always=4.0, misfit=2.0, price=6.0)
    assert score(told) == pytest.approx(30.0 / 2.0 + 3.0 - 4.0 - 0.5 * 4.0 - 6.0)
    assert score(replace(told, always=-4.0)) == pytest.approx(10.0)


def test_nothing_is_outdone_by_no_more_than_days_can_tell_nor_by_more_than_stands_out() -> None:
    far = replace(LEAK, gain=1e4, spread=2.0, ease=1.0, most=7.0)
    assert _gains([NOTHING, far], far) == pytest.approx([5e3 - 7.0, 5e3 + 1.0])
    assert _gains([replace(NOTHING, gain=5.0), far], NOTHING) == pytest.approx([5.0, 5e3 + 1.0])  # by its own spread
    near = replace(LEAK, gain=100.0, stands=2.0)
    assert _gains([NOTHING, near], NOTHING)[0] == pytest.approx(100.0 - 4.0 * WEIGHTS.sure)
    pair = replace(near, fitted=_of("infiltration", "dead-band"), gain=150.0, stands=3.0)
    assert _gains([NOTHING, near, pair], NOTHING)[1] == pytest.approx(150.0 - 9.0 * WEIGHTS.sure)


def test_in_a_room_others_come_near_the_best_one_by_its_spread_and_do_not_outdo_it() -> None:
    steady = replace(LEAK, gain=20.0, spread=1.5, most=50.0, is_of_room=True)
    erratic = replace(
        steady, fitted=_of("extra-heat"), names=("extra-heat",), gain=32.0, spread=6.0, ease=-2.0, price=8.0
    )
    assert score(steady) > score(erratic)
    told = _gains([NOTHING, steady, erratic], steady)
    assert told[1] - steady.price == pytest.approx(told[2] - erratic.price)
    far = _gains([NOTHING, steady, replace(erratic, gain=15.0)], steady)
    assert far[2] == pytest.approx(15.0 / 1.5 - 2.0)
    # nor with something unknown beside it, which excuses what it leaves
    amiss = replace(erratic, gain=60.0, misfit=5.0)
    found = posterior([NOTHING, steady, amiss], unseen=0.0)
    assert found["extra-heat"] < found["extra-heat+unknown"] <= found["infiltration"] * (1.0 + 1e-9)


def test_an_effect_always_and_on_some_days_is_one_name_and_no_other_effect_gains_by_the_choice() -> None:
    """Its gain on some days leaves out the best day, and varies less: held against that, another effect comes level."""
    always = replace(LEAK, gain=9300.0, spread=3.0, most=70.0, always=0.0, is_of_room=True)
    some_days = replace(always, gain=7000.0, spread=2.2)
    other = replace(always, fitted=_of("extra-heat"), names=("extra-heat",), gain=9250.0, spread=17.0)
    assert score(some_days) > score(always) > score(other)
    found = posterior([replace(NOTHING, is_of_room=True), some_days, always, other])
    assert found["infiltration"] > 0.9 > 0.1 > found["extra-heat"]


def test_what_looks_like_an_effect_is_something_unknown_the_rather_the_more_that_leaves() -> None:
    told = replace(LEAK, always=4.0, price=6.0, left=0.5)
    free = 6.0 + np.log(WEIGHTS.prior)
    expected = 20.0 - 4.0 - free + WEIGHTS.alike * np.log(0.5) - WEIGHTS.unknown_price
    assert _mimicked(told, 20.0) == pytest.approx(expected)
    assert _mimicked(replace(told, always=-4.0), 20.0) == pytest.approx(expected + 4.0)


def test_odds_are_the_softened_difference_of_what_speaks_for_each() -> None:
    told = replace(LEAK, gain=8.0, price=6.0, misfit=1.0, always=-1.0)
    found = posterior([NOTHING, told], soft=2.0, unseen=0.0)
    assert found["infiltration"] / found["none"] == pytest.approx(np.exp((8.0 - 6.0 - 0.5) / 2.0))
    assert found["infiltration+unknown"] / found["none"] == pytest.approx(
        np.exp((8.0 - 6.0 - WEIGHTS.unknown_price) / 2.0)
    )
    was_there = posterior([NOTHING, replace(told, gain=30.0, always=1.0, unlike=3.0)], soft=2.0, unseen=0.0)
    assert was_there["infiltration"] / was_there["none"] == pytest.approx(np.exp((-1.0 + 3.0) / 2.0))


def test_a_pair_is_within_what_it_was_added_to_alone() -> None:
    pair = _of("floor-cover", "infiltration")
    assert _is_within(_of("floor-cover"), pair)
    assert not _is_within(_of("dead-band"), pair)
    assert not _is_within(_of("infiltration"), pair)


def test_what_would_not_show_is_asked_of_effects_that_were_weighed_alone() -> None:
    pair = replace(LEAK, fitted=_of("floor-cover", "infiltration"))
    told = _with_unseen({"none": 1.0}, [NOTHING, LEAK, pair], 0.1)
    assert told == pytest.approx({"none": 0.9, "infiltration": 0.1})
    cover = replace(LEAK, fitted=_of("floor-cover"))
    told = _with_unseen({"none": 1.0}, [NOTHING, LEAK, cover], 0.1)
    assert told == pytest.approx({"none": 0.9, "infiltration": 0.05, "floor-cover": 0.05})


@given(
    st.lists(
        st.builds(
            lambda gain, always, misfit, name: replace(LEAK, names=(name,), gain=gain, always=always, misfit=misfit),
            st.floats(-50.0, 1e5),
            st.floats(-50.0, 50.0),
            st.floats(0.0, 20.0),
            st.sampled_from(["a", "b", "c"]),
        ),
        max_size=6,
    )
)
def test_probabilities_sum_to_one_whatever_is_weighed(others: list[Weighed]) -> None:
    found = posterior([NOTHING, *others])
    assert sum(found.values()) == pytest.approx(1.0)
    assert all(0.0 <= each <= 1.0 for each in found.values())
    assert {"none", "unknown"} <= set(found)


def test_what_gains_much_is_probable_and_what_gains_little_is_not() -> None:
    assert posterior([NOTHING, LEAK])["infiltration"] > 0.9
    assert posterior([NOTHING, replace(LEAK, gain=2.0)])["none"] > 0.9


def test_what_leaves_much_may_as_well_be_something_unknown() -> None:
    assert posterior([NOTHING, replace(LEAK, misfit=2.5, left=0.9)])["unknown"] > 0.5
    assert posterior([NOTHING, replace(LEAK, misfit=2.5, left=0.05)])["infiltration"] > 0.7


def test_two_effects_at_once_that_leave_much_may_as_well_be_one_that_is_unknown() -> None:
    """A stove in the evenings looks like warmer water and less mass together, and something stays."""
    cover = (EFFECTS["floor-cover"], {"resistance_m2K_W": 0.05})
    both = replace(LEAK.fitted, effects=(*LEAK.fitted.effects, cover))
    pair = replace(LEAK, fitted=both, names=("floor-cover", "infiltration"), gain=60.0, price=12.0, most=90.0)
    assert posterior([NOTHING, LEAK, replace(pair, misfit=5.0, left=0.5)])["unknown"] > 0.8
    assert posterior([NOTHING, LEAK, replace(pair, left=0.03)])["floor-cover+infiltration"] > 0.6


def test_of_two_that_leave_nothing_the_finer_name_must_be_earned() -> None:
    coarse = replace(LEAK, names=("coarse",), gain=20.0, price=6.0, stands=5.0)
    fine = replace(LEAK, names=("fine",), gain=24.0, price=12.0, stands=5.0)
    assert posterior([NOTHING, coarse, fine])["coarse"] > 0.5
    amiss = replace(coarse, misfit=4.0, by_cycle=np.full(9, 4.0))
    assert posterior([NOTHING, amiss, fine])["fine"] > 0.6


def test_what_no_more_than_noise_stands_out_for_is_no_effect() -> None:
    """Likelihood alone is not calibrated: on records of nothing gains of a hundred occur."""
    assert posterior([NOTHING, replace(LEAK, gain=100.0, stands=1.0)])["none"] > 0.8
    assert posterior([NOTHING, replace(LEAK, gain=100.0, stands=5.0)])["infiltration"] > 0.9


def test_what_was_so_from_the_start_is_no_change() -> None:
    found = posterior([NOTHING, replace(LEAK, always=25.0)])
    assert found["none"] > 0.9


def test_few_days_can_tell_only_so_much() -> None:
    found = posterior([NOTHING, replace(LEAK, gain=1e4, most=7.0)])
    assert 0.05 < found["none"] < 0.95


def test_what_a_healthy_record_would_not_leave_is_unknown() -> None:
    found = posterior([replace(NOTHING, misfit=6.0), replace(LEAK, gain=1.0, misfit=6.0)])
    assert found["unknown"] > 0.9


# --- courses over time -------------------------------------------------------------------------------


def record(days: int, start_h: float = 0.0, first_weekday: int | None = None) -> Record:
    values = {"flow_L_h": np.ones(days * 144)}
    return Record(600.0, 3600.0 * start_h, values, {}, (), first_weekday=first_weekday)


def spans_h(words: str, seen: Record) -> list[tuple[float, float]]:
    (found,) = [each for each in patterns(seen) if each.words == words]
    return list(found.spans_h)


@pytest.mark.parametrize(
    ("days", "start_h", "first_weekday"),
    [(1, 0.0, None), (5, 0.0, None), (5, 7.5, 2), (2, 0.0, 4), (9, 0.0, 5), (16, 3.0, 0)],
)
def test_each_course_acts_in_its_hours_and_in_no_others(days: int, start_h: float, first_weekday: int | None) -> None:
    seen = record(days, start_h, first_weekday)
    time_h = (np.arange(len(seen)) + 0.5) / 6.0
    tried = list(patterns(seen))
    assert len({each.words for each in tried}) == len(tried)
    assert len({each.strength.tobytes() for each in tried}) == len(tried)
    for each in tried[1:]:
        assert 0.0 < each.strength.mean() < 1.0  # else it acts always, or never
        told = sum(((time_h >= begin) & (time_h < end)).astype(float) for begin, end in each.spans_h)
        assert np.array_equal(each.strength, np.broadcast_to(told, len(seen)))


def test_a_course_between_hours_goes_by_the_clock() -> None:
    evening = next(each for each in patterns(record(3, 12.0)) if each.words == "every day from 22:00 to 06:00")
    assert evening.spans_h == ((10.0, 18.0), (34.0, 42.0), (58.0, 66.0))


def test_courses_of_the_week_go_by_the_calendar() -> None:
    from_friday = record(9, 12.0, first_weekday=4)
    assert spans_h("on Saturdays and Sundays", from_friday) == [(12.0, 60.0), (180.0, 216.0)]
    assert spans_h("from Mondays to Fridays", from_friday) == [(0.0, 12.0), (60.0, 180.0)]
    assert spans_h("on Saturdays", from_friday) == [(12.0, 36.0), (180.0, 204.0)]
    assert spans_h("on day 3 only", from_friday) == [(36.0, 60.0)]
    words = {each.words for each in patterns(from_friday)}
    assert "on Mondays" not in words  # there is but one: that is day 4
    unknown = {each.words for each in patterns(record(9))}
    assert not {"on Saturdays", "on Saturdays and Sundays", "from Mondays to Fridays"} & unknown


def test_what_grows_is_as_strong_as_always_in_the_mean() -> None:
    growing = next(iter(patterns(record(4))))
    assert growing.words == "growing"
    assert growing.strength.mean() == pytest.approx(1.0)
    assert np.all(np.diff(growing.strength) > 0.0)


# --- when what is unknown shows ----------------------------------------------------------------------


def missed(seen: Record, more: np.ndarray, seed: int) -> Residual:
    """Return a residual of noise, and of thrice as much where `more` is."""
    whitened = np.random.default_rng(seed).normal(size=len(seen)) * np.where(more, 3.0, 1.0)
    judged, sample = np.ones(len(seen), dtype=bool), np.arange(len(seen))
    return Residual("flow_L_h", "L/h", whitened, whitened, judged, seen.day, seen.day, sample)


@pytest.mark.parametrize("seed", range(5))
def test_what_is_missed_by_more_in_the_evenings_is_told_so(seed: int) -> None:
    seen = record(6)
    hour = (np.arange(len(seen)) + 0.5) / 6.0 % 24.0
    course = concentrated(missed(seen, hour >= 18.0, seed), 1.0, seen)
    assert course is not None
    assert course.words == "every day from 18:00 to 00:00"


def test_what_is_missed_alike_at_all_times_has_no_times() -> None:
    seen = record(6)
    never = np.zeros(len(seen), dtype=bool)
    assert [concentrated(missed(seen, never, seed), 1.0, seen) for seed in range(20)] == [None] * 20


# --- heat at hours -----------------------------------------------------------------------------------


def driven(count: int = 288) -> Belief:
    zero = np.zeros(count)
    air_C = 21.0 + np.sin(np.arange(count) / 23.0)
    inputs = Inputs(600.0, 0.0, zero, zero + 30.0, zero, zero + 50.0, air_C)
    return Belief({}, study().room, inputs)


def test_constant_heat_can_come_at_hours_and_nothing_else_can() -> None:
    assert {name for name, effect in EFFECTS.items() if can_be_timed(effect, driven())} == {"extra-heat"}


def test_heat_at_hours_is_the_same_heat_in_those_hours_and_none_beside_them() -> None:
    effect, believed = EFFECTS["extra-heat"], driven()
    always = effect.apply(believed, effect.Parameters(heat_W=80.0, radiant_share=0.2)).inputs
    at_night = timed(effect)
    values = {"heat_W": 80.0, "radiant_share": 0.2, "from_h": 22.0, "to_h": 6.0}
    found = at_night.apply(believed, at_night.Parameters(**values)).inputs
    assert believed.inputs
    assert always
    assert found
    assert always.extra_W is not None
    assert found.extra_W is not None
    share = open_share(believed.inputs, 22.0, 6.0)
    assert share.mean() == pytest.approx(8.0 / 24.0)
    assert found.extra_W == pytest.approx(share * always.extra_W)
    assert found.gains_W - 50.0 == pytest.approx(share * (always.gains_W - 50.0))
    assert at_night.hours(at_night.Parameters(**values)) == (22.0, 6.0)
    assert "every day from 22:00 to 06:00" in at_night.sentence(at_night.Parameters(**values))
