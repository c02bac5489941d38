"""What speaks for the hypotheses of one link, beside a healthy record: a motor as believed, slow, slow since day 3."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field, replace
from functools import cache, partial
from operator import attrgetter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.diagnosis.realities import EFFECTS, Effects, belief, dataset, effects, rows
from waxstudy.diagnosis.calibration.calibrate import Calibration, calibrate
from waxstudy.diagnosis.calibration.healthy import Healthy, HealthyLeft, UsualWhere
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual, motions_of
from waxstudy.diagnosis.estimate.start_points import Screen
from waxstudy.diagnosis.model.as_built import Knob
from waxstudy.diagnosis.model.conventions import PLAIN, RAW
from waxstudy.diagnosis.model.nuisance import Nuisance
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import ALL, FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.appraise import _of_form, _price
from waxstudy.diagnosis.select.changed import (
    Choice,
    _may_be_blurred,
    _without,
    best_with,
    changed,
    in_place,
    likeliest_with,
)
from waxstudy.diagnosis.select.day import SPANS
from waxstudy.diagnosis.select.gain_spread import gain_spread, strength
from waxstudy.diagnosis.select.patterns import patterns
from waxstudy.diagnosis.select.posterior import Weighed, posterior, score
from waxstudy.diagnosis.select.search import Search
from waxstudy.diagnosis.select.weigh import Weighing, _may_be_beside
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import Effect, FloatArray

DAYS, QUICK = 4, 0.25
NOTHING: Effects = ()
SLOW = effects(slow_actuator={"factor": 1.4})
LIBRARY = [EFFECTS["slow-actuator"], EFFECTS["stuck-open"]]


def seen(before: Effects, since_day_3: Effects) -> Record:
    """What is recorded around a motor that changes at the end of the second of four days, or does not."""
    first, later = (rows("WAX", DAYS, each, seed=3) for each in (before, since_day_3))
    half = len(first) // 2
    return _recorded(pd.concat([first[:half], later[half:]]))


def _recorded(data: pd.DataFrame) -> Record:
    return record_of(dataset(data[["time", "heating_signal", "displacement"]], "WAX"))


@cache
def calibration(was_so: Effects, is_looked_for: bool) -> Calibration:
    healthy = _recorded(rows("WAX", DAYS, was_so, seed=2))
    return calibrate(healthy, belief("WAX", healthy), LIBRARY if is_looked_for else [], QUICK)


@cache
def of(
    before: Effects, since_day_3: Effects, thorough: float = QUICK, was_so: Effects = NOTHING
) -> tuple[Weighing, list[Weighed]]:
    """What is weighed of it; what was so in the healthy record was not looked for there."""
    record, known = seen(before, since_day_3), calibration(was_so, is_looked_for=was_so == NOTHING)
    documented = belief("WAX", record)
    (motor,) = segments(record, documented)
    problem = SegmentProblem(motor, record, documented, as_built=known.as_built, parts=np.full(len(record), FIT))
    weighing = Weighing(problem, LIBRARY, known.healthy[motor.name], thorough, lambda name: None)
    return weighing, weighing.weighed()


def only(weighed: Weighed) -> Residual:
    (residual,) = weighed.fitted.residuals
    return residual


def lasting(missed: Residual, chosen: np.ndarray) -> float:
    """What is missed of chosen samples (root mean square), but for those of the cycle that is missed most."""
    squares, block = missed.whitened[chosen] ** 2, missed.block[chosen]
    worst = max(set(block), key=lambda each: squares[block == each].sum())
    return float(np.sqrt(np.mean(squares[block != worst])))


def test_where_nothing_changed_nothing_has_a_name_and_no_course_or_pair_is_tried() -> None:
    _, found = of(NOTHING, NOTHING)
    assert [each.fitted.names for each in found] == [(), ("slow-actuator",), ("stuck-open",)]
    assert [each.names for each in found] == [()] * 3
    assert max(found, key=score) is found[0]
    assert found[0].misfit < 0.1


def test_a_slow_motor_is_found_and_explains_all_of_it() -> None:
    _, found = of(SLOW, SLOW)
    slow = max(found, key=score)
    assert (slow.names, slow.pattern, len(found)) == (("slow-actuator",), None, 3)
    assert slow.fitted.effects[0][1]["factor"] == pytest.approx(1.4, rel=0.02)
    assert (slow.misfit, slow.left, slow.ease, slow.is_of_room) == (0.0, WEIGHTS.least_share, 0.0, False)
    assert slow.price == WEIGHTS.price - np.log(WEIGHTS.prior)
    assert slow.always < -100.0  # the healthy motor was not slow
    assert (found[0].left, found[0].stands, found[2].left) == (1.0, 0.0, 1.0)


def test_a_gain_is_half_of_what_is_missed_less_in_samples_that_count_and_not_below_what_is_usual() -> None:
    """In each motion by itself."""
    weighing, (none, slow, _) = of(SLOW, SLOW)
    gain, together = 0.0, {each: weighing.healthy.together(each) for each in motions_of("displacement")}
    for old, new in zip(none.fitted.by_motion, slow.fitted.by_motion, strict=True):
        healthy = weighing.healthy.left(new.channel)
        assert healthy
        usual = healthy.whitened**2 * new.judged.sum()
        before, after = (max(float(np.sum(each.whitened**2)), usual) for each in (old, new))
        gain += 0.5 * (before - after) / together[new.channel]
    assert max(together.values()) > 10.0
    assert slow.gain == pytest.approx(gain)
    of_sample = np.array(list(together.values()))[only(none).motion]
    counted = [only(each).whitened / of_sample**0.5 for each in (none, slow)]
    assert (slow.spread, slow.most) == pytest.approx(gain_spread(counted[0], counted[1], weighing.problem.record.cycle))


def test_no_effect_is_told_by_more_than_all_that_is_amiss() -> None:
    for truth in (NOTHING, SLOW):
        weighing, (none, *singles) = of(truth, truth)
        most = weighing.most_told(none.fitted)
        excused = min(0.5 * none.misfit**2, WEIGHTS.unknown_price)
        assert max(each.gain - 0.5 * each.misfit**2 for each in singles) + excused <= most + 1e-9
    assert max(each.gain for each in singles) == pytest.approx(most, rel=0.1)  # the slow motor explains nearly all


@pytest.mark.parametrize("misfit", [0.0, 2.5, 9.0])
def test_an_effect_that_could_not_reach_the_probability_from_which_one_shows_is_not_looked_at_closely(
    misfit: float,
) -> None:
    weighing, (none, slow, _) = of(SLOW, SLOW)
    (effect, _), softness = slow.fitted.effects[0], WEIGHTS.softness(weighing.healthy.is_noise)
    edge, excused = slow.price + softness * float(np.log(WEIGHTS.least_seen)), min(misfit**2 / 2, WEIGHTS.unknown_price)
    for told, shows in ((edge - 0.1, False), (edge + 0.1, True)):
        # what gains that, and leaves nothing of what only something unknown would excuse
        other = replace(slow, gain=told - excused, spread=1.0, always=0.0, misfit=0.0, stands=np.inf)
        beliefs = posterior([replace(none, misfit=misfit), other], unseen=0.0)
        nothing = max(beliefs["none"], beliefs["unknown"])
        assert weighing.may_show(effect, told) is shows
        assert bool(beliefs[effect.name] / nothing > WEIGHTS.least_seen) is shows
    looks = [counted(weighing, effect, least) for least in (1.0, np.inf)]
    assert looks[1] < 0.6 * looks[0]


def counted(weighing: Weighing, effect: type[Effect], least: float) -> int:
    """How many hypotheses are asked for until an effect is fitted that must promise so much for a closer look."""
    asked = list[Any]()
    problem: Any = copy(weighing.problem)
    problem.at = lambda *about: asked.append(about) or weighing.problem.at(*about)
    looking = Estimator(problem, weighing.estimator.thorough, keeps=True)
    assert looking.fit(effect, weighing.none, ALL, Screen(least, weighing.share))
    return len(asked)


def test_what_is_missed_stands_out_where_an_effect_acts_over_what_healthy_records_leave_there() -> None:
    weighing, (none, slow, _) = of(SLOW, SLOW)
    assert not only(none).judged.all()  # what is not judged makes nothing stand out less
    per_cycle, luck = np.zeros((2, int(only(none).block.max()) + 1)), 0.0
    for missed, new in zip(none.fitted.by_motion, slow.fitted.by_motion, strict=True):
        change = missed.judged * (missed.whitened - new.whitened) ** 2
        usual, cycles = weighing.healthy.usual_where(missed, slow.fitted.effects, ())
        both = change * (missed.whitened / usual) ** 2, change
        per_cycle += [np.bincount(missed.block, each, len(per_cycle[0])) for each in both]
        luck += change.sum() / cycles
    acts = per_cycle[1].sum()
    lasts, whole = np.delete(per_cycle, np.argmax(per_cycle[0]), axis=1).sum(axis=1)
    scatter = np.hypot(WEIGHTS.scatter, (0.5 * luck / acts) ** 0.5)
    of_size = weighing._stands(slow.fitted, none.fitted)
    assert of_size == pytest.approx(0.5 * np.log(lasts / whole) / scatter)
    assert slow.stands == max(of_size, weighing._along(slow.fitted, none.fitted))


def test_what_is_usual_where_an_effect_acts_is_of_the_samples_that_it_changes() -> None:
    """A healthy record leaves most at the edges of a slower motor's strokes, and hardly anything where it rests."""
    weighing, (none, slow, *_) = of(NOTHING, SLOW)
    healthy, (_, missed) = weighing.healthy, none.fitted.by_motion
    still = healthy.fitted.by_motion[1]
    made = healthy.problem.at(slow.fitted.effects, healthy.fitted.departures, healthy.fitted.convention)
    assert made
    change = still.judged * (made.by_motion[1].whitened - still.whitened) ** 2
    expected = np.sqrt(np.sum(change * still.whitened**2) / change.sum())
    found = healthy.usual_where(missed, slow.fitted.effects, ())
    assert found.whitened == pytest.approx(max(expected, WEIGHTS.least_left))
    assert 2.0 < found.cycles <= len(np.unique(still.block))
    # what changes nothing has no place of its own, and a channel that was not recorded then none at all
    assert healthy.usual_where(missed, slow.fitted.effects, slow.fitted.effects) == (healthy.usual(missed), np.inf)
    unknown = replace(missed, channel="flow_L_h")
    assert healthy.usual_where(unknown, slow.fitted.effects, ()) == (WEIGHTS.least_left, np.inf)


def test_a_misfit_is_told_in_standard_deviations_of_what_cycles_tell() -> None:
    weighing, (none, _, _) = of(SLOW, SLOW)
    missed = none.fitted.by_motion[1]  # the strokes are missed most
    healthy = weighing.healthy.left(missed.channel)
    assert healthy
    count, cycles = int(missed.judged.sum()), len(np.unique(missed.block[missed.judged]))
    over = lasting(missed, missed.judged) / healthy.whitened
    together = min(weighing.healthy.together(missed.channel), count / cycles)
    scatter = np.sqrt(WEIGHTS.scatter**2 + 0.5 * together / count + 0.5 * together / healthy.samples)
    assert none.misfit == pytest.approx(np.log(over) / scatter)


def test_what_an_effect_leaves_is_excused_by_a_tenth_of_what_it_explains() -> None:
    weighing, (none, slow, _) = of(NOTHING, SLOW)[0], of(NOTHING, SLOW)[1][:3]
    missed = slow.fitted.by_motion[1]
    healthy = weighing.healthy.left(missed.channel)
    assert healthy
    count = int(missed.judged.sum())
    explained = (none.fitted.by_motion[1].loss() - missed.loss()) / count
    cycles = len(np.unique(missed.block[missed.judged]))
    usual = np.sqrt(healthy.whitened**2 + WEIGHTS.form**2 * explained)
    together = min(weighing.healthy.together(missed.channel), count / cycles)
    scatter = np.sqrt(WEIGHTS.scatter**2 + 0.5 * together / count + 0.5 * together / healthy.samples)
    assert slow.misfit == pytest.approx(np.log(lasting(missed, missed.judged) / usual) / scatter)
    left, before = 0.0, 0.0
    for old, new in zip(none.fitted.by_motion, slow.fitted.by_motion, strict=True):
        over = [max(0.0, each.loss() - weighing.healthy.usual_loss(each)) for each in (old, new)]
        before, left = before + over[0], left + max(over[1], weighing._kept(old, new) * over[0])
    assert slow.left == pytest.approx(np.sqrt(left / before))


def test_what_is_there_since_some_day_is_told_so_at_a_price_and_changes_no_day_before() -> None:
    weighing, found = of(NOTHING, SLOW)
    none, always = found[:2]
    late = max(found, key=score)
    assert late.pattern
    assert (late.names, late.pattern.words, len(found)) == (("slow-actuator",), "from day 3 on", 4)
    tried = list(patterns(weighing.problem.record))
    assert late.price == pytest.approx(always.price + WEIGHTS.price + np.log(len(tried)))
    assert late.gain > 1.2 * always.gain
    half = len(only(none).whitened) // 2
    for of_it in (attrgetter("whitened"), attrgetter("error")):
        assert np.array_equal(of_it(only(late))[:half], of_it(only(none))[:half])
        assert not np.array_equal(of_it(only(late))[half:], of_it(only(none))[half:])


def test_a_course_has_the_strength_that_leaves_least() -> None:
    _, found = of(NOTHING, SLOW)
    none, always, late = (only(each).whitened for each in (found[0], found[1], found[3]))
    half = len(none) // 2
    change = always[half:] - none[half:]
    strength = float((late[half:] - none[half:]) @ change / (change @ change))
    assert 1.0 < strength < WEIGHTS.strongest
    losses = [np.sum((none[half:] + each * change) ** 2) for each in strength + np.array([-0.05, 0.0, 0.05])]
    assert np.argmin(losses) == 1
    errors = [only(each).error[half:] for each in (found[0], found[1], found[3])]
    assert errors[2] == pytest.approx(errors[0] + strength * (errors[1] - errors[0]))


def test_a_second_effect_gains_no_more_than_its_cycles_can_tell() -> None:
    """What keeps the valve from closing leaves all of a slow motor: that is added to it, and not to what is open."""
    _, found = of(SLOW, SLOW, 1.0)
    slow, pair = found[1], found[3]
    assert len(found) == 4
    assert pair.fitted.names == ("stuck-open", "slow-actuator")
    assert pair.gain == pytest.approx(slow.most, rel=1e-4)
    assert pair.price == pytest.approx(2.0 * slow.price)
    assert pair.most == found[2].most


def test_a_second_effect_gains_what_it_adds_beyond_the_form_of_the_first() -> None:
    """Also beside one that is there since day 3, and with its own spread over cycles."""
    weighing, found = of(NOTHING, SLOW, 1.0)
    both = found[5].fitted
    assert found[5] == weighing.beside(found[1], both)
    for given in (found[1], found[3]):
        pair = weighing.beside(given, both)
        counted = [only(each).whitened * only(each).weights(weighing.share) for each in (given, pair)]
        spread, told = gain_spread(counted[0], counted[1], weighing.problem.record.cycle)
        gained, may = weighing.of(pair.fitted).gain - given.gain, 0.0
        for none, one, two in zip(*(each.fitted.by_motion for each in (found[0], given, pair)), strict=True):
            change, first, both_, of_form = none.whitened - one.whitened, one.whitened, two.whitened, 0.0
            for cycle in set(two.block):
                here = two.judged & (two.block == cycle)
                for left, sign in ((first[here], 1.0), (both_[here], -1.0)):
                    along = np.clip(left @ change[here] / max(change[here] @ change[here], 1e-12), -0.1, 0.1)
                    of_form += sign * (left @ left - np.sum((left - along * change[here]) ** 2))
            most = max(0.0, weighing._losses(given.fitted)[two.channel] - weighing._losses(pair.fitted)[two.channel])
            may += 0.5 * min(max(0.0, of_form / weighing.share[two.channel]), most)
        more = gained - may
        assert pair.gain == pytest.approx(given.gain + min(more / spread, told))
        assert pair.spread == given.spread
        assert pair.fitted.names == ("slow-actuator", "stuck-open")
    assert WEIGHTS.open < found[3].misfit < found[1].misfit  # so more is looked for beside both


def test_what_each_judged_cycle_is_missed_by_is_the_loss_of_its_samples() -> None:
    """Cycles of the hours that are not judged are none, and count for nothing."""
    weighing, found = of(NOTHING, SLOW)
    for each in found[:2]:
        missed = only(each)
        losses = [motion.loss() / weighing.share[motion.channel] for motion in missed.by_motion]
        assert each.by_cycle.sum() == pytest.approx(sum(losses))
        assert len(each.by_cycle) == len(set(missed.block[missed.judged])) < len(set(missed.block))


@pytest.mark.parametrize(("from_h", "to_h", "hours"), [(0.0, 24.0, 1), (22.0, 6.0, SPANS)])
def test_hours_cost_as_many_as_are_tried_and_those_of_what_acts_always_nothing(
    from_h: float, to_h: float, hours: int
) -> None:
    price = _price(EFFECTS["setpoint-offset"], {"offset_K": 0.3, "from_h": from_h, "to_h": to_h})
    assert price == pytest.approx(WEIGHTS.price - np.log(WEIGHTS.prior) + np.log(hours))


def test_what_a_first_effect_told_of_one_channel_is_no_excuse_in_another() -> None:
    """A sensor's bias tells much of the sensor, and nothing of when its controller has another setpoint."""
    weighing = bare(is_room=False)
    weighing.problem.sd = np.zeros(0)
    made: dict[str, Any] = {
        name: leaving(residual(sensor, "s"), residual(output, "c"))
        for name, sensor, output in (
            ("none", [100.0] * 20, [4.0, 0.0] * 10),
            ("bias", [5.0] * 20, [3.0, 0.0] * 10),
            ("both", [4.0] * 20, [0.0] * 20),
        )
    }
    rest: Any = weighing
    rest._losses = lambda fitted: {each.channel: each.loss() for each in fitted.residuals}
    rest._none_read = lambda convention: made["none"]
    bias: Any = SimpleNamespace(fitted=made["bias"])
    # of the sensor all that is gained; of the output what a tenth more of the bias would do there
    of_sensor, of_output = 0.5 * 20 * (25.0 - 16.0), 0.5 * 10 * (3.0**2 - 2.9**2)
    assert weighing._form_may_tell(bias, made["both"]) == pytest.approx(of_sensor + of_output)


def test_what_a_second_effect_leaves_along_the_first_one_it_does_not_pay_for() -> None:
    """A first effect leaves a twentieth of it, and the second one takes away only what lies across."""
    weighing = bare(is_room=False)
    along, across = np.full(20, 5.0), np.array([3.0, -3.0] * 10)
    first, both = (leaving(residual(each, "c")) for each in (along + across, along))
    rest: Any = weighing
    rest._losses = lambda fitted: {each.channel: each.loss() for each in fitted.residuals}
    rest._none_read = lambda convention: leaving(residual(along + across + 100.0, "c"))
    given: Any = SimpleNamespace(fitted=first)
    second: Any = both
    assert weighing._form_may_tell(given, second) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("share", "left"), [(0.05, 0.0), (-0.05, 0.0), (0.11, 0.01), (0.3, 0.2), (-0.3, 0.2)])
def test_form_excuses_an_effect_that_is_stronger_or_weaker_by_a_tenth_and_nothing_across_it(
    share: float, left: float
) -> None:
    """Each of ten cycles has two samples, which the effect changes alike."""
    change, across = np.full(20, 10.0), np.array([3.0, -3.0] * 10)
    after = residual(share * change + across)
    assert _of_form(after, change) == pytest.approx(np.full(10, (share**2 - left**2) * 2.0 * 10.0**2))
    assert _of_form(after, np.zeros(20)) == pytest.approx(np.zeros(10))
    assert len(_of_form(replace(after, judged=np.zeros(20, dtype=bool)), change)) == 0


def test_what_the_healthy_record_says_for_an_effect_varies_over_cycles_as_its_gain_does() -> None:
    """A motor was a little slow from the start, and nobody looked for that."""
    weighing, found = of(
        NOTHING, effects(slow_actuator={"factor": 1.15}), was_so=effects(slow_actuator={"factor": 1.09})
    )
    slow = found[1]
    had_it, _ = weighing.healthy.had_it(slow.fitted.effects)
    assert had_it > 0.5
    assert slow.spread > 1.1
    assert slow.always == pytest.approx(had_it / slow.spread)


# --- one thing that is weighed, without fits ---------------------------------------------------------


def bare(
    is_room: bool,
    left: HealthyLeft | None = None,
    pair: tuple[Hypothesis, Hypothesis] | None = None,
    **problem: Any,
) -> Weighing:
    """What weighs a link whose healthy record left so much of each channel; a pair is it without an effect and with."""
    made: Any = object.__new__(Weighing)
    segment = SimpleNamespace(with_room=is_room, judged=("air_temperature_C", "return_temperature_C", "heating_signal"))
    record = SimpleNamespace(flow_step_L_h=0.0)
    own = {"segment": segment, "record": record, "sd": np.zeros(0), "as_built": None}
    made.problem = SimpleNamespace(**{**own, "past_switch": lambda fitted: [], **problem})
    made.filtered = SimpleNamespace(squares=lambda fitted, nothing: {})
    usual: Any = Healthy
    made.healthy = SimpleNamespace(
        left=lambda channel: left,
        stands_scatter=WEIGHTS.scatter,
        scatter=partial(usual.scatter, None),
        tolerated_travel=0.0,
        past_switch_K=0.0,
        usual=lambda residual: usual.usual(made.healthy, residual),
        _usual_square=lambda residual: usual._usual_square(made.healthy, residual),
        usual_where=lambda residual, effects, given: UsualWhere(usual.usual(made.healthy, residual)),
        acts=partial(usual.acts, None),
        pair=lambda given, effects, way: pair,
    )
    made.share = {}
    weighing: Weighing = made
    return weighing


def residual(
    whitened: FloatArray | list[float], channel: str = "air_temperature_C", unit: str = "K", cycles: int = 10
) -> Residual:
    values = np.asarray(whitened, dtype=float)
    sample = np.arange(len(values))
    block = sample * cycles // len(values)
    return Residual(channel, unit, values, values, np.ones(len(values), dtype=bool), block, 0 * block, sample)


def leaving(*residuals: Residual, departures: FloatArray | None = None) -> Hypothesis:
    return Hypothesis((), PLAIN, np.zeros(0) if departures is None else departures, residuals)


@pytest.mark.parametrize(("gain", "ease"), [(100.0, 0.0), (60.0, 40.0), (100.0, -30.0), (-20.0, 30.0)])
def test_beside_an_effect_of_a_room_what_its_form_may_leave_is_no_second_one(
    gain: float, ease: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A share of all that speaks for the first: what it explains, and what the room need not depart."""
    _, (first, *_) = of(NOTHING, NOTHING)
    first = replace(first, gain=gain, ease=ease)
    both = replace(first, gain=gain + 10.0)
    monkeypatch.setattr(Weighing, "of", lambda self, fitted, given=None, pattern=None: both)
    monkeypatch.setattr(Weighing, "_spread", lambda self, fitted, given=None: (1.0, np.inf))
    more = bare(is_room=True).beside(first, both.fitted).gain - gain
    assert more == pytest.approx(10.0 - 0.2**2 * (max(0.0, gain) + max(0.0, ease)))


@pytest.mark.parametrize(("channels", "strays"), [(["air_temperature_C"], False), (motions_of("displacement"), True)])
def test_a_motor_strays_from_itself_where_its_strokes_are_told_apart(channels: list[str], strays: bool) -> None:
    weighing: Any = bare(is_room=False)
    weighing.none = leaving(*(residual([1.0], channel) for channel in channels))
    assert weighing._may_stray(None) is strays
    weighing.healthy.tolerated_travel = 1.0  # nobody knows the motor
    assert weighing._may_stray(None)


@pytest.mark.parametrize("moved", [0.0, 0.5, -2.0, -0.2])
def test_a_record_is_less_likely_by_how_far_what_it_tells_lies_from_what_calibration_would_have_found(
    moved: float,
) -> None:
    """Of one parameter that both tell, with its variance from each; what else the record alone tells does not move."""
    slopes = np.array([[3.0, 0.0], [4.0, 0.0], [0.0, 2.0]])
    sd = np.array([0.5, 2.0])
    known = [Nuisance(name, 1.0, lambda believed, departure: believed) for name in ("calibrated", "of the record", "a")]
    of_both: dict[str, Any] = {"sd": sd, "nuisances": known[:2], "prior": np.eye(2)}
    weighing: Any = bare(True, **of_both, as_built=SimpleNamespace(knobs=[known[0]]))
    weighing.share = {"air_temperature_C": 4.0}  # of its samples count as one
    weighing.healthy.problem = SimpleNamespace(nuisances=known[::-1])  # it has another that the record lacks
    weighing.estimator = SimpleNamespace(slopes_at=lambda fitted: slopes)
    fitted = leaving(residual([1.0, 2.0, 0.5]), departures=np.array([0.3, -1.0]))
    told, variance = 0.3 - (3.0 + 8.0) / 25.0, 4.0 / 25.0 + 0.5**2
    expected = 0.5 * ((told - moved) ** 2 - told**2) / variance
    assert weighing._unlike(fitted, np.array([7.0, 9.0, moved])) == pytest.approx(max(0.0, expected))
    assert bare(True, sd=sd)._unlike(fitted, np.array([moved, 9.0])) == 0.0  # nothing was calibrated
    assert bare(False, as_built=weighing.problem.as_built)._unlike(fitted, np.array([moved])) == 0.0


@pytest.mark.parametrize("left", [2.0, None])
def test_what_stands_out_is_told_where_it_is_changed(left: float | None) -> None:
    weighing = bare(False, HealthyLeft(left, 100, 10, 0.0, left) if left else None)
    missed, rest = [6.0, 0.0, 6.0, 0.0, 6.0, 0.0], [0.0, 0.0, 6.0, 0.0, 0.0, 0.0]
    signal = {"channel": "heating_signal", "unit": "s"}
    for way, least in ((signal, WEIGHTS.least_off), ({}, WEIGHTS.least_left)):
        found = weighing._stands(leaving(residual(rest, **way)), leaving(residual(missed, **way)))
        assert found == pytest.approx(np.log(6.0 / (left or least)) / WEIGHTS.scatter)
        assert weighing._stands(leaving(residual(missed, **way)), leaving(residual(missed, **way))) == 0.0
        slight = [leaving(residual([each, 0.0, each, 0.0], **way)) for each in (0.0, 0.01)]
        assert weighing._stands(slight[0], slight[1]) == 0.0
        once = [leaving(residual([each, 0.0, 0.0, 0.0], **way)) for each in (0.0, 60.0)]
        assert weighing._stands(once[0], once[1]) == 0.0
    assert bare(True)._stands(leaving(residual(rest)), leaving(residual(missed))) == np.inf


@pytest.mark.parametrize(
    ("channel", "unit", "own", "least"),
    [
        ("air_temperature_C", "K", WEIGHTS.scatter, WEIGHTS.least_left),
        ("return_temperature_C", "K", WEIGHTS.coarse_scatter, WEIGHTS.least_left),
        ("heating_signal", "s", WEIGHTS.coarse_scatter, WEIGHTS.least_off),
    ],
)
@pytest.mark.parametrize(("is_room", "cycles", "more"), [(True, 4, 1.0), (False, 4, 1.25), (False, 10, 1.0)])
def test_a_misfit_is_over_what_the_healthy_record_left_and_not_below_what_any_may(
    channel: str, unit: str, own: float, least: float, is_room: bool, cycles: int, more: float
) -> None:
    """Over more, where a chain moves more often than it did in the healthy record."""
    missed = leaving(residual(np.full(100, 8.0), channel, unit))
    scatter = np.sqrt(own**2 + 0.5 * 6.0 / 100 + 0.5 * 6.0 / 50)
    for left in (0.1, 2.0):
        weighing = bare(is_room, HealthyLeft(left, 50, cycles, 0.0, left))
        weighing.none, weighing.share = missed, {channel: 6.0}
        usual = max(left, least) * more**0.5
        assert weighing.misfit(missed) == pytest.approx(np.log(8.0 / usual) / scatter)
        weighing.share = {channel: 30.0}  # more hang together than are of one cycle
        scatter_10 = np.sqrt(own**2 + 0.5 * 10.0 / 100 + 0.5 * 10.0 / 50)
        assert weighing.misfit(missed) == pytest.approx(np.log(8.0 / usual) / scatter_10)
    weighing.none = leaving(residual(np.full(100, 0.5 * least), channel, unit))
    assert weighing.misfit(weighing.none) == 0.0


@pytest.mark.parametrize(("cycles", "is_missed"), [(0, False), (1, False), (2, True)])
def test_what_is_missed_in_one_cycle_alone_is_no_misfit(cycles: int, is_missed: bool) -> None:
    weighing = bare(False, HealthyLeft(1.0, 100, 10, 0.0, 1.0))
    weighing.none = leaving(residual(np.where(np.arange(100) < 10 * cycles, 50.0, 1.0)))
    assert (weighing.misfit(weighing.none) > 3.0) is is_missed
    assert (weighing.misfit(weighing.none) > 0.0) is is_missed


@pytest.mark.parametrize(("gap", "kept"), [(1.4, 0.0), (3.0, (9.0 - 2.25) / 100.0), (10.0, 0.9775), (30.0, 1.0)])
def test_what_is_kept_of_a_gap_is_told_in_its_unit_beyond_what_a_healthy_record_may_leave(
    gap: float, kept: float
) -> None:
    weighing, none = bare(False, HealthyLeft(1.0, 100, 10, 0.0, 1.0)), residual(np.full(100, 10.0))
    by_weights_little = replace(none, error=np.full(100, gap), whitened=np.full(100, 0.1))
    assert weighing._kept(none, by_weights_little) == pytest.approx(kept)
    assert bare(False)._kept(none, by_weights_little) == 0.0  # nobody knows what is usual
    once = replace(none, error=np.where(np.arange(100) < 10, 500.0, 0.0))
    assert weighing._kept(none, once) == 0.0  # a cycle that slipped
    assert weighing._kept(replace(none, unit="s"), replace(by_weights_little, unit="s")) == 0.0
    assert weighing._kept(residual(np.zeros(100)), by_weights_little) == 0.0


def test_what_is_taken_off_the_gap_bounds_what_an_effect_explains_and_its_form_excuses() -> None:
    left: Any = HealthyLeft(1.0, 100, 10, 0.0, 1.0)
    weighing, none = bare(False, left), residual(np.full(100, 10.0))
    weighing.none, weighing.read = leaving(none), {}
    weighing._nothing = lambda fitted: weighing.none  # type: ignore[method-assign]
    weighing.healthy.usual_loss = lambda each: 100.0  # type: ignore[method-assign]
    whole, weighed_only = (
        leaving(replace(none, error=np.full(100, error), whitened=np.full(100, 2.0))) for error in (1.0, 10.0)
    )
    kept = (100.0 - 2.25) / 100.0
    assert weighing._left(whole) == pytest.approx((300.0 / 9900.0) ** 0.5)
    assert weighing._left(weighed_only) == pytest.approx(kept**0.5)
    usual = [(1.0 + WEIGHTS.form**2 * explained) ** 0.5 for explained in (96.0, (1.0 - kept) * 100.0)]
    found = [weighing.misfit(each) for each in (whole, weighed_only)]
    assert found[1] / found[0] == pytest.approx(np.log(2.0 / usual[1]) / np.log(2.0 / usual[0]))


def test_an_effect_is_not_tried_beside_one_that_takes_its_place_in_either_order() -> None:
    slow, constant, limited = (EFFECTS[name] for name in ("slow-actuator", "constant-times", "limited-travel"))
    for given, other, may in ((slow, constant, False), (constant, slow, False), (limited, slow, True)):
        assert _may_be_beside(other, replace(leaving(), effects=((given, {}),))) is may
    assert not _may_be_beside(slow, replace(leaving(), effects=((slow, {}),)))


def test_where_nothing_is_judged_or_known_there_is_no_misfit_and_of_several_channels_the_largest_counts() -> None:
    weighing, large, small = bare(True, HealthyLeft(1.0, 100, 10, 0.0, 1.0)), np.full(100, 9.0), np.full(100, 3.0)
    nowhere = replace(residual(0.0 * large), judged=np.zeros(100, dtype=bool))
    weighing.none = leaving(residual(small), residual(large), nowhere)
    one = leaving(residual(large))
    found = weighing.misfit(weighing.none)
    weighing.none = one
    assert found == weighing.misfit(one) > 0.0
    weighing.none = leaving(nowhere)
    assert weighing.misfit(leaving(nowhere)) == 0.0
    unknown = bare(True)
    unknown.none = one
    assert unknown.misfit(one) == 0.0


def test_what_a_room_misses_is_weighed_by_its_healthy_record_and_told_by_quarters_of_days() -> None:
    weighing: Any = bare(True, record=SimpleNamespace(interval_s=600.0))
    weighing.estimator = SimpleNamespace(strain=lambda fitted: 2.5)
    weighing.healthy = SimpleNamespace(room_loss=lambda fitted: 40.0)
    fitted = leaving(residual(np.ones(144)))
    assert weighing._loss(fitted) == 42.5
    assert weighing._left(fitted) == WEIGHTS.least_share
    assert weighing._block(fitted.residuals[0]).tolist() == np.repeat([0, 1, 2, 3], 36).tolist()
    assert bare(False)._block(fitted.residuals[0]) is fitted.residuals[0].block


def test_nothing_is_fitted_again_from_where_the_best_three_effects_led_the_room() -> None:
    losses = {0.0: 9.0, 1.0: 5.0, 2.0: 1.0, 3.0: 3.0, 4.0: 2.0, -2.0: 7.0, -3.0: 6.0}
    weighing: Any = bare(True, sd=np.ones(1))
    asked: list[float] = []

    def nuisance_fit(
        effects: Any, departures: FloatArray, convention: Any, parts: Any, known: Any
    ) -> Hypothesis | None:
        assert known is weighing.estimator.base_slopes
        asked.append(float(departures[0]))
        return None if departures[0] == 4.0 else at(-float(departures[0]))

    def at(place: float) -> Hypothesis:
        return leaving(departures=np.array([place]))

    weighing.estimator = SimpleNamespace(
        strain=lambda fitted: 0.0, nuisance_fit=nuisance_fit, base_slopes=np.ones((1, 1))
    )
    weighing.healthy = SimpleNamespace(room_loss=lambda fitted: losses[float(fitted.departures[0])])
    weighing.none = at(0.0)
    weighing._settle([at(each) for each in (1.0, 2.0, 3.0, 4.0)])
    assert asked == [2.0, 4.0, 3.0]
    assert weighing.none.departures.tolist() == [-3.0]
    losses[-3.0] = 10.0
    losses[-2.0] = 12.0
    weighing.none = at(0.0)
    weighing._settle([at(2.0), at(3.0)])
    assert weighing.none.departures.tolist() == [0.0]


def test_of_what_was_calibrated_is_known_how_much_was_there() -> None:
    """The healthy record is asked of other effects alone."""
    slow, stuck = LIBRARY
    calibrated = Knob("slow", 1.0, lambda believed, _: believed, effect=slow)
    weighing: Any = bare(False, as_built=SimpleNamespace(knobs=[calibrated]))
    weighing.healthy = SimpleNamespace(had_it=lambda effects: (float(len(effects)), np.ones(1)))
    both = replace(leaving(), effects=((slow, {}), (stuck, {})))
    assert weighing._always(both)[0] == 1.0
    assert weighing._always(replace(both, effects=both.effects[:1]))[0] == 0.0
    weighing.problem.as_built = None
    assert weighing._always(both)[0] == 2.0


def test_an_effect_in_the_place_of_what_was_calibrated_was_not_there_from_the_start() -> None:
    """The healthy record tells how heavy the walls are: heavier ones are a change, though other walls might hide it."""
    heavy = EFFECTS["thermal-mass"]
    walls = Nuisance("boards-capacity", 0.2, lambda believed, _: believed)
    weighing: Any = bare(False, as_built=SimpleNamespace(knobs=[walls]))
    weighing.healthy = SimpleNamespace(had_it=lambda effects: (float(len(effects)), np.ones(1)))
    heavier = replace(leaving(), effects=((heavy, {}),))
    assert weighing._always(heavier)[0] == 0.0
    weighing.problem.as_built.knobs = []
    assert weighing._always(heavier)[0] == 1.0


def test_more_is_looked_for_beside_all_of_a_room_and_of_a_chain_beside_what_leaves_something() -> None:
    _, (first, *_) = of(NOTHING, NOTHING)
    some = [replace(first, misfit=misfit) for misfit in (0.0, WEIGHTS.open, WEIGHTS.open + 0.01)]
    assert bare(True)._open(some) == some
    assert bare(False)._open(some) == some[2:]


def test_nothing_is_weighed_as_its_best_fit_leaves_it() -> None:
    weighing: Any = bare(True)
    weighing.none = "first"

    def singles() -> list[Hypothesis]:
        weighing.none = "better"
        return []

    weighing._singles, weighing._patterned = singles, lambda best: []
    weighing.of = lambda fitted: SimpleNamespace(fitted=fitted)
    assert [each.fitted for each in weighing.weighed()] == ["better"]


@pytest.mark.parametrize(
    ("stage", "misfit", "pattern", "without", "may_be"),
    [
        ("valve", 0.9, None, 1.5, True),
        ("valve", 0.9, "always", 1.5, False),
        ("valve", 0.9, None, 9.0, False),
        ("room", 0.9, None, 1.5, True),
        ("room", 0.9, None, 9.0, False),
        ("actuator", 0.9, None, 9.0, True),
        ("actuator", 0.9, "always", 9.0, False),
    ],
)
def test_an_effect_is_blurred_away_where_it_takes_away_little_of_what_is_amiss_or_is_a_motor_s(
    stage: str, misfit: float, pattern: str | None, without: float, may_be: bool
) -> None:
    weighed: Any = SimpleNamespace(misfit=misfit, pattern=pattern)
    nothing: Any = SimpleNamespace(misfit=without)
    found: Any = SimpleNamespace(effect=SimpleNamespace(stage=stage))
    assert _may_be_blurred(weighed, nothing, found) == may_be


@dataclass(frozen=True)
class Told:
    """What `changed` returns, as far as it is looked at here."""

    names: list[str]
    posterior: dict[str, float] = field(default_factory=dict)
    off_by: None = None


def told_of(
    monkeypatch: pytest.MonkeyPatch,
    beliefs: dict[str, float],
    misfits: dict[str, float],
    *sure: str,
    with_room: bool = False,
) -> Told:
    """What is told of hypotheses of a link with these misfits; the intervals of all but some hold what is believed."""
    weighed = [
        SimpleNamespace(
            names=tuple(n.split("+")) if n != "none" else (), misfit=m, pattern=None, fitted=None, off_by=None
        )
        for n, m in misfits.items()
    ]
    place = "waxstudy.diagnosis.select.changed."
    search: Any = SimpleNamespace(
        problem=SimpleNamespace(segment=SimpleNamespace(with_room=with_room)),
        estimator=SimpleNamespace(before=None, thorough=1.0),
        selection=lambda found, tried, intervals, last: Told([each.effect.name for each in found]),
        effects=[],
    )
    weighing = SimpleNamespace(weighed=lambda: weighed, estimator=SimpleNamespace(followed=None, thorough=1.0))
    monkeypatch.setattr(place + "Weighing", lambda *given: weighing)
    monkeypatch.setattr(place + "posterior", lambda weighed: beliefs)
    for way in ("best_with", "likeliest_with"):
        monkeypatch.setattr(place + way, lambda all_, names: next(w for w in all_ if set(w.names) == set(names)))
    monkeypatch.setattr(place + "_tried", lambda *given: [])
    monkeypatch.setattr(place + "_of_all_days", lambda *given: (None, {}))
    monkeypatch.setattr(place + "distinct_in", lambda problem, last, effect, intervals: float(effect.name in sure))
    monkeypatch.setattr(
        place + "_found",
        lambda search, weighed, choice, beliefs: [
            SimpleNamespace(effect=SimpleNamespace(name=g[0], stage="valve"), group=g) for g in choice.groups
        ],
    )
    anything: Any = None
    found: Any = changed(search, anything, anything, anything)
    return Told(found.names, found.posterior)


def test_whether_an_effect_may_be_nothing_is_asked_of_each_beside_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first takes the misfit of a room away; the second, which takes none, may as well be nothing."""
    beliefs, misfits = {"a+b": 0.95, "a": 0.04, "none": 0.01}, {"none": 6.0, "a": 0.9, "b": 5.9, "a+b": 0.85}
    told = told_of(monkeypatch, beliefs, misfits, with_room=True)
    assert told.names == ["a"]
    assert told.posterior == pytest.approx({"a+b": 0.475, "a": 0.515, "none": 0.01})


def test_of_a_group_only_what_may_be_nothing_loses_its_probability(monkeypatch: pytest.MonkeyPatch) -> None:
    beliefs, misfits = {"a": 0.5, "b": 0.48, "none": 0.02}, {"none": 0.5, "a": 0.0, "b": 0.0}
    told = told_of(monkeypatch, beliefs, misfits, "b")
    assert told.names == []
    assert told.posterior == pytest.approx({"b": 0.48, "none": 0.52})


def test_of_hypotheses_with_the_same_names_that_with_fewer_effects_is_told() -> None:
    """A second effect that is too small for a name would change what is told of the first."""
    alone, beside = (
        SimpleNamespace(names=("a",), fitted=SimpleNamespace(effects=effects), gain=gain, spread=1.0, ease=0.0)
        for effects, gain in (("a", 5.0), ("ab", 9.0))
    )
    for each in (alone, beside):
        each.always, each.misfit, each.price = 0.0, 0.0, 1.0
    given: Any = [beside, alone]
    assert best_with(given, ["a"]) is alone


def test_what_leaves_least_without_an_effect_may_have_others_too_small_for_a_name() -> None:
    """Else an effect would be needed for a misfit that something which counts as nothing takes away as well."""
    plain, with_small, other = (
        SimpleNamespace(names=names, fitted=SimpleNamespace(effects=effects), gain=gain, spread=1.0, ease=0.0)
        for names, effects, gain in (((), "", 0.0), ((), "a", 9.0), (("b",), "b", 99.0))
    )
    for each in (plain, with_small, other):
        each.always, each.misfit, each.price = 0.0, 0.0, 1.0
    given: Any = [plain, with_small, other]
    assert likeliest_with(given, []) is with_small


@pytest.mark.parametrize(
    ("name", "beside", "told"), [("c", ["b"], ("b", "c")), ("c", [], ("c",)), ("d", ["b"], ("d",)), ("e", ["b"], None)]
)
def test_an_alternative_is_told_as_it_is_fitted_beside_what_else_is_named(
    name: str, beside: list[str], told: tuple[str, ...] | None
) -> None:
    given: Any = [
        SimpleNamespace(
            fitted=SimpleNamespace(names=names), gain=9.0, spread=1.0, ease=0.0, always=0.0, misfit=0.0, price=1.0
        )
        for names in (("b",), ("c",), ("b", "c"), ("d",))
    ]
    found = in_place(given, name, beside)
    assert (found.names if found else None) == told


@pytest.mark.parametrize(("kept", "named"), [(0.0, 0.0), (0.5, 0.45)])
def test_what_may_as_well_be_nothing_is_none_but_for_a_share_and_all_still_sums_to_one(
    kept: float, named: float
) -> None:
    beliefs = {"a": 0.8, "a+b": 0.1, "none": 0.06, "unknown": 0.04}
    found = _without(beliefs, {"a"}, kept)
    assert sum(found.values()) == pytest.approx(1.0)
    assert sum(p for name, p in found.items() if "a" in name.split("+")) == pytest.approx(named)
    assert found["none"] == pytest.approx(0.06 + (1.0 - kept) * 0.8)
    assert found["b"] == pytest.approx((1.0 - kept) * 0.1)
    assert not Choice.of(found).groups


def test_what_changed_is_told_of_all_days_though_the_last_are_kept_to_show_what_it_explains() -> None:
    """A motor that is slower still on the last three of seven days is told slower than the others have it."""
    first, later = (rows("WAX", 7, each, seed=3) for each in (SLOW, effects(slow_actuator={"factor": 1.6})))
    record = _recorded(pd.concat([first[: len(first) * 4 // 7], later[len(first) * 4 // 7 :]]))
    documented, healthy = belief("WAX", record), calibration(NOTHING, is_looked_for=True)
    (motor,) = segments(record, documented)
    make = partial(SegmentProblem, motor, record, documented, as_built=healthy.as_built)
    search = Search(Estimator(make(), QUICK, keeps=True), LIBRARY, np.random.default_rng(1), lambda name: None)
    whole = make(parts=np.full(len(record), FIT))
    selection = changed(search, healthy.healthy[motor.name], whole, lambda name: None)
    (told,), (kept,) = ((*each.values(),) for each in (selection.intervals, dict(selection.after.effects)))
    assert kept["factor"] == pytest.approx(1.4, rel=0.03)
    assert kept["factor"] * 1.04 < told["factor"].value < 1.6
    assert told["factor"].low <= told["factor"].value <= told["factor"].high


@pytest.mark.parametrize(("of_it", "over"), [(0.0, np.inf), (0.2, 5.0), (0.5, 2.0), (1.0, 1.0)])
def test_what_lies_along_an_effect_stands_out_where_a_healthy_record_has_less(of_it: float, over: float) -> None:
    """However much else both leave: errors across an effect are no sign of it."""
    way, across = np.tile([1.0, -1.0, 1.0, -1.0], 10), np.tile([3.0, 3.0, -3.0, -3.0], 10)

    def pair(strength: float) -> tuple[Hypothesis, Hypothesis]:
        left = across + strength * way
        return leaving(residual(left, "displacement")), leaving(residual(left - way, "displacement"))

    weighing, (given, fitted) = bare(False, HealthyLeft(3.0, 40, 10, 0.0, 3.0), pair(of_it)), pair(1.0)
    scatter = np.hypot(WEIGHTS.scatter, (0.5 / 10.0 + 0.5 / 9.0) ** 0.5)  # of the later one a cycle is left out
    assert weighing._along(fitted, given) == pytest.approx(np.log(min(over, 1.0 / WEIGHTS.form)) / scatter)
    assert weighing._stands(fitted, given) < 0.5  # by its size
    assert weighing._along(replace(fitted, convention=RAW), given) == 0.0
    assert bare(True, pair=pair(of_it))._along(fitted, given) == 0.0
    once = (leaving(residual(np.repeat([2.0, 0.0], [4, 36]))), leaving(residual(np.repeat([1.0, -1.0], [4, 36]))))
    assert strength(*weighing._signed(*once)) == pytest.approx((4.0 / 10.0, 10.0))
    assert strength(*weighing._signed(*once), is_lasting=True) == pytest.approx((0.0, 9.0))
    switches = [leaving(residual(each.whitened, "heating_signal", "s")) for each in (given, fitted)]
    assert strength(*weighing._signed(switches[0], switches[1])) is None  # they have no sign


@pytest.mark.parametrize(
    ("names", "is_told", "has_pattern"),
    [(("let-by",), True, False), ((), False, False), (("max-flow",), False, False), (("let-by",), False, True)],
)
def test_what_lies_along_an_effect_counts_where_that_one_has_a_name_and_no_pattern(
    names: tuple[str, ...], is_told: bool, has_pattern: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of two effects that of the one which was added."""
    weighing, (_, slow, _) = of(SLOW, SLOW)
    named = [(EFFECTS[name], {}) for name in ("max-flow", "let-by")]
    monkeypatch.setattr(Weighing, "_notable", lambda self, fitted, pattern: iter(names))
    monkeypatch.setattr(Weighing, "_along", lambda self, fitted, given: 1e6)
    monkeypatch.setattr("waxstudy.diagnosis.select.appraise._price", lambda effect, values: 0.0)
    monkeypatch.setattr(Weighing, "_always", lambda self, fitted: (0.0, np.zeros(0)))
    pattern: Any = SimpleNamespace() if has_pattern else None
    found = weighing.of(replace(slow.fitted, effects=tuple(named)), pattern=pattern)
    assert (found.stands == 1e6) is is_told


def test_each_channel_of_a_link_stands_out_where_it_is_changed_itself() -> None:
    given = leaving(residual(np.full(4, 6.0), "displacement"), residual(np.full(6, 3.0), "flow_L_h"))
    fitted = leaving(residual(np.zeros(4), "displacement"), residual(np.zeros(6), "flow_L_h"))
    # of both the cycle that stands out most is left out
    over = (3 * 36.0 * 36.0 + 5 * 9.0 * 9.0) / (3 * 36.0 + 5 * 9.0) / WEIGHTS.least_left**2
    assert bare(False)._stands(fitted, given) == pytest.approx(0.5 * np.log(over) / WEIGHTS.scatter)
