"""What speaks for the hypotheses of one link, beside a healthy record: a motor as believed, slow, slow since day 3."""

from __future__ import annotations

from functools import cache
from operator import attrgetter

import numpy as np
import pandas as pd
import pytest

from tests.diagnosis.realities import EFFECTS, Effects, belief, dataset, effects, rows
from waxstudy.diagnosis.calibration.calibrate import Calibration, calibrate
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.gain_spread import gain_spread
from waxstudy.diagnosis.select.patterns import patterns
from waxstudy.diagnosis.select.posterior import Weighed, score
from waxstudy.diagnosis.select.weigh import Weighing
from waxstudy.diagnosis.weights import WEIGHTS

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
def calibration(was_so: Effects) -> Calibration:
    healthy = _recorded(rows("WAX", DAYS, was_so, seed=2))
    return calibrate(healthy, belief("WAX", healthy), LIBRARY, QUICK)


@cache
def of(
    before: Effects, since_day_3: Effects, thorough: float = QUICK, was_so: Effects = NOTHING
) -> tuple[Weighing, list[Weighed]]:
    record, known = seen(before, since_day_3), calibration(was_so)
    believed = known.as_built.believed(belief("WAX", record))
    (motor,) = segments(record, believed)
    problem = SegmentProblem(motor, record, believed, as_built=known.as_built, parts=np.full(len(record), FIT))
    weighing = Weighing(problem, LIBRARY, known.healthy[motor.name], thorough, lambda name: None)
    return weighing, weighing.weighed()


def only(weighed: Weighed) -> Residual:
    (residual,) = weighed.fitted.residuals
    return residual


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
    weighing, (none, slow, _) = of(SLOW, SLOW)
    together, healthy = weighing.healthy.together("displacement"), weighing.healthy.left("displacement")
    assert healthy
    usual = healthy.whitened**2 * only(slow).judged.sum()
    before, after = (float(np.sum(only(each).whitened ** 2)) for each in (none, slow))
    assert together > 10.0
    assert slow.gain == pytest.approx(0.5 * (before - max(after, usual)) / together)
    counted = [only(each).whitened / together**0.5 for each in (none, slow)]
    assert (slow.spread, slow.most) == pytest.approx(gain_spread(counted[0], counted[1], weighing.problem.record.cycle))


def test_what_is_missed_stands_out_by_its_size_over_what_healthy_records_leave() -> None:
    weighing, (none, slow, _) = of(SLOW, SLOW)
    healthy = weighing.healthy.left("displacement")
    assert healthy
    size = np.sqrt(np.mean(only(none).whitened ** 2))
    assert slow.stands == pytest.approx(np.log(size / healthy.whitened) / WEIGHTS.scatter)


def test_a_misfit_is_told_in_standard_deviations_of_what_cycles_tell() -> None:
    weighing, (none, _, _) = of(SLOW, SLOW)
    healthy, missed = weighing.healthy.left("displacement"), only(none)
    assert healthy
    count, cycles = int(missed.judged.sum()), len(np.unique(missed.block[missed.judged]))
    more = max(1.0, (cycles / count) / (healthy.cycles / healthy.samples))  # of a valve that moves more often
    over = np.sqrt(np.sum(missed.whitened**2) / count / more) / healthy.whitened
    together = min(weighing.healthy.together("displacement"), count / cycles)
    scatter = np.sqrt(WEIGHTS.scatter**2 + 0.5 * together / count + 0.5 * together / healthy.samples)
    assert none.misfit == pytest.approx(np.log(over) / scatter)


def test_what_an_effect_leaves_is_excused_by_a_tenth_of_what_it_explains() -> None:
    weighing, (none, slow, _) = of(NOTHING, SLOW)[0], of(NOTHING, SLOW)[1][:3]
    healthy, missed = weighing.healthy.left("displacement"), only(slow)
    assert healthy
    count = int(missed.judged.sum())
    explained = (only(none).loss() - missed.loss()) / count
    cycles = len(np.unique(missed.block[missed.judged]))
    more = max(1.0, (cycles / count) / (healthy.cycles / healthy.samples))
    usual = np.sqrt(more * healthy.whitened**2 + WEIGHTS.form**2 * explained)
    together = min(weighing.healthy.together("displacement"), count / cycles)
    scatter = np.sqrt(WEIGHTS.scatter**2 + 0.5 * together / count + 0.5 * together / healthy.samples)
    assert slow.misfit == pytest.approx(np.log(np.sqrt(missed.loss() / count) / usual) / scatter)
    over = [each.loss() - weighing.healthy.usual_loss(each) for each in (missed, only(none))]
    assert slow.left == pytest.approx(np.sqrt(over[0] / over[1]))


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
    for given in (found[1], found[3]):
        pair = next(each for each in found[4:] if each.most == given.most)
        counted = [only(each).whitened / weighing.share["displacement"] ** 0.5 for each in (given, pair)]
        spread, most = gain_spread(counted[0], counted[1], weighing.problem.record.cycle)
        more = weighing.of(pair.fitted).gain - given.gain - WEIGHTS.form**2 * given.gain
        assert pair.gain == pytest.approx(given.gain + min(more / spread, most))
        assert pair.spread == given.spread
        assert pair.fitted.names == ("slow-actuator", "stuck-open")


def test_what_the_healthy_record_says_for_an_effect_varies_over_cycles_as_its_gain_does() -> None:
    """A motor was a little slow from the start, by too little to be calibrated."""
    weighing, found = of(
        NOTHING, effects(slow_actuator={"factor": 1.15}), was_so=effects(slow_actuator={"factor": 1.09})
    )
    slow = found[1]
    had_it, _ = weighing.healthy.had_it(slow.fitted.effects)
    assert had_it > 0.5
    assert slow.spread > 1.1
    assert slow.always == pytest.approx(had_it / slow.spread)
