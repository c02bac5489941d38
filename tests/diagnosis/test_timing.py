"""What switches and outputs are weighed by: noise under the likeliest hypothesis, not under a wrong one."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, Effects, belief, effects, plain, record
from waxstudy.diagnosis.calibration.healthy import AsBelieved
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.start_points import Screen
from waxstudy.diagnosis.model.as_built import AsBuilt
from waxstudy.diagnosis.model.conventions import AFTER, RAW, Convention
from waxstudy.diagnosis.model.edits import Edits
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import ALL, FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals import segment_problem
from waxstudy.diagnosis.residuals.judge import MOST, perturbed_by_noise
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.residuals.switching import Switching
from waxstudy.diagnosis.select.evidence import departure
from waxstudy.diagnosis.select.timing import best_timed, is_moved_by_noise
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import Belief, SimulationError

LIBRARY = [EFFECTS[name] for name in ("dead-band", "sensor-delay")]
OUTPUT = "control_output"


@cache
def problem(true: Effects = (), stage: int = 0) -> SegmentProblem:
    """A link of an on-off loop that is believed to have a dead band of 0.5 K; the first is up to its controller."""
    seen = record("IDEAL", days=6, effects=true, seed=4)
    believed = belief("IDEAL", seen)
    return SegmentProblem(segments(seen, believed)[stage], seen, believed, parts=np.full(len(seen), FIT))


def switches(judged: SegmentProblem) -> Switching:
    way = judged.judge.ways[OUTPUT]
    assert isinstance(way, Switching)
    return way


def typical_s(judged: SegmentProblem) -> float:
    return float(np.median(switches(judged).scale_s))


@pytest.mark.parametrize(("dead_band_K", "as_believed_s"), [(0.46, 1656.0), (0.35, 17.3)])
def test_switches_are_weighed_by_what_noise_does_where_they_are_thrown(
    dead_band_K: float, as_believed_s: float
) -> None:
    """Of peaks that barely reach a wrong threshold noise decides for hours; one that none reaches no noise moves."""
    believed = problem(effects(dead_band={"dead_band_K": dead_band_K}))
    fits, noisy = best_timed(believed, LIBRARY, 1.0)
    ((effect, values),) = fits[0].effects
    assert effect.name == "dead-band"
    assert values["dead_band_K"] == pytest.approx(dead_band_K, abs=0.01)
    assert typical_s(believed) == pytest.approx(as_believed_s, rel=0.1)
    assert typical_s(believed.timed_by(fits, noisy)) == pytest.approx(137.0, rel=0.15)


def test_a_loop_as_believed_is_weighed_as_it_is_believed() -> None:
    believed = problem()
    fits, noisy = best_timed(believed, LIBRARY, 1.0)
    assert all(departure(effect, values, believed.belief) < WEIGHTS.notable for effect, values in fits[0].effects)
    assert typical_s(believed.timed_by(fits, noisy)) == pytest.approx(typical_s(believed), rel=0.15)


def test_what_a_switch_drives_and_a_room_have_no_times_to_be_weighed_by() -> None:
    links = segments(problem().record, problem().belief)
    timed = {link.name: is_moved_by_noise(problem(stage=place)) for place, link in enumerate(links)}
    assert [name for name, has in timed.items() if has] == [problem().name]
    assert len(timed) > 3


def test_what_a_healthy_controller_leaves_is_no_whole_samples_where_another_one_is_believed_to_run_on() -> None:
    """A PI controller is believed where the record switches: noise moves its output by parts of a sample."""
    seen = problem().record
    believed = belief("PI", seen)
    link = next(each for each in segments(seen, believed) if OUTPUT in each.judged)
    other = SegmentProblem(link, seen, believed, parts=np.full(len(seen), FIT))
    usual = AsBelieved.of(other, Estimator(other).base).left(OUTPUT)
    assert usual
    assert 0.3 < usual.whitened < 1.5


def test_a_fit_begins_where_the_first_look_ended_however_the_record_was_read_there() -> None:
    """Under a wrong dead band the record is best read as if its noise were the controller's own."""
    believed = problem(effects(dead_band={"dead_band_K": 0.46}))
    dead_band = EFFECTS["dead-band"]
    fits, noisy = best_timed(believed, [dead_band], 1.0)
    found = believed.timed_by(fits, noisy)
    estimator = Estimator(found, near=found.near)
    assert estimator.base.convention.is_raw
    fitted = estimator.fit(dead_band, estimator.base, ALL, Screen(WEIGHTS.screened, {}))
    assert fitted
    assert not fitted.convention.is_raw
    assert estimator.score(fitted, ALL) <= estimator.score(found.at(*read(fits[0])), ALL)


def read(fitted: Hypothesis) -> tuple[Edits, np.ndarray, Convention]:
    return fitted.effects, fitted.departures, fitted.convention


def test_noise_that_the_controller_is_said_to_have_read_is_not_drawn_twice() -> None:
    here = problem()
    raw, plain = (perturbed_by_noise(here.segment, here.record, here.belief, each) for each in (RAW, AFTER))
    assert all(np.array_equal(one[OUTPUT], other[OUTPUT]) for one, other in zip(raw, plain, strict=True))
    as_raw, as_after = (here.at((), np.zeros(0), each) for each in (RAW, AFTER))
    assert as_raw
    assert as_after
    usual = [AsBelieved.of(here, each).left(OUTPUT) for each in (as_raw, as_after)]
    assert usual[0] == usual[1]


@pytest.mark.parametrize(("fails", "drawn"), [(0, 0), (1, MOST), (MOST, MOST)])
def test_a_draw_that_cannot_be_simulated_is_left_out_and_without_the_model_itself_there_is_none(
    fails: int, drawn: int
) -> None:
    """The first is the model without noise."""
    asked = iter(range(MOST + 1))

    class Failing:
        with_room, conventions = False, (AFTER,)

        def predict(self, *about: Any) -> int:
            number = next(asked)
            if number == fails:
                raise SimulationError("impossible")
            return number

    here, link = problem(), Failing()
    assert len(list(perturbed_by_noise(link, here.record, here.belief))) == drawn  # type: ignore[arg-type]


def test_a_hypothesis_whose_noise_cannot_be_drawn_is_not_the_surest(monkeypatch: pytest.MonkeyPatch) -> None:
    believed = problem(effects(dead_band={"dead_band_K": 0.46}))
    effects_, drawn_from = [EFFECTS["dead-band"]], perturbed_by_noise

    def only_of_belief(segment: Segment, record: Record, of: Belief, *way: Any) -> Iterator[Predicted]:
        return drawn_from(segment, record, of, *way) if of == believed.belief else iter(())

    monkeypatch.setattr(segment_problem, "perturbed_by_noise", only_of_belief)
    fits, _ = best_timed(believed, effects_, 1.0)
    assert fits[0].effects == ()


def drawn(off_s: list[float]) -> Switching:
    """What so many draws of noise say, of which each moves all switches by so much but the first, which none moves."""
    seen, segment = problem().record, problem().segment
    still = Predicted({OUTPUT: np.zeros(len(seen))})
    way = Switching(OUTPUT, segment, seen, np.zeros(len(seen)), still)
    first = np.flatnonzero(np.diff(way.windows, prepend=0))
    for each in off_s:
        moved = np.zeros(len(seen))
        moved[first] = each / seen.interval_s
        way.see(Predicted({OUTPUT: moved}))
    return way


def test_a_switch_is_weighed_by_the_root_mean_square_of_what_draws_do_to_it() -> None:
    """Also by what one of many does: a switch that noise seldom throws hours away tells little."""
    assert drawn([30.0, 40.0] * 10).scale_s == pytest.approx(1250.0**0.5)
    assert drawn([60.0] * 19 + [7200.0]).scale_s == pytest.approx(((19 * 60.0**2 + 7200.0**2) / 20) ** 0.5)


def test_no_switch_is_surer_than_most_or_than_sampling_lets_it_be() -> None:
    way = drawn([100.0] * 10)
    assert way.scale_s[0] == way.scale_s[1]
    assert drawn([0.0] * 10).scale_s == pytest.approx(60.0 / np.sqrt(12.0))


def test_switches_that_are_an_exception_cost_what_is_as_likely_anywhere() -> None:
    way = drawn([100.0] * 10)
    none, some, far = (way.likelihood(np.full(len(way.scale_s), each)) for each in (0.0, 60.0, 7200.0))
    assert none > some > far
    assert far == pytest.approx(way.likelihood(np.full(len(way.scale_s), 9000.0)))


@pytest.mark.parametrize("is_heating", [True, False])
def test_a_thermostat_that_began_within_its_dead_band_is_believed_to_log_what_it_reads(is_heating: bool) -> None:
    """Nobody knows its state then: a first switch that was a whole day off made it read noise in a wider dead band."""
    hour = np.arange(8 * 24 * 60) / 60.0
    sign = 1.0 if is_heating else -1.0
    reading_C = 21.0 + sign * np.interp((hour + 4.0) % 36.0, [0.0, 20.0, 36.0], [-0.3, 0.3, -0.3])
    is_on = [is_heating]
    for each in reading_C[1:]:
        is_on.append(each < 20.75 if abs(each - 21.0) > 0.25 else is_on[-1])
    noisy_C = reading_C + 0.03 * np.random.default_rng(1).normal(size=len(hour))
    logged = {"sensor_temperature_C": noisy_C, OUTPUT: np.array(is_on, dtype=float)}
    seen = plain({**logged, "setpoint_C": np.full(len(hour), 21.0)})
    believed = belief("IDEAL", seen)
    link = SegmentProblem(segments(seen, believed)[0], seen, believed, parts=np.full(len(seen), FIT))
    base = Estimator(link).base
    assert not base.convention.is_raw
    (switched,) = (each for each in base.residuals if each.channel == OUTPUT)
    assert switched.loss() < 3.0 * switched.judged.sum()


# --- an output that runs on --------------------------------------------------------------------------

TUNED = {"gain": 30.0, "integration_time_s": 20_000.0}


@cache
def of_pi(is_tuned: bool) -> SegmentProblem:
    """The controller of a PI loop that is believed to be the paper's, tuned otherwise or not."""
    seen = record("PI", days=6, effects=effects(pi_tuning=TUNED) if is_tuned else (), seed=4)
    believed = belief("PI", seen)
    link = next(each for each in segments(seen, believed) if OUTPUT in each.judged)
    ways = {link.name: link.conventions}
    read = {link.name: link.conventions[0]}
    was_healthy = AsBuilt((), np.zeros(0), np.zeros((0, 0)), conventions=read, ways=ways)
    return SegmentProblem(link, seen, believed, as_built=was_healthy, parts=np.full(len(seen), FIT))


def left_of_output(judged: SegmentProblem, edits: Edits = ()) -> float:
    """Return what is left of a controller's output, over what it is weighed by."""
    fitted = judged.at(edits, np.zeros(len(judged.sd)), judged.conventions[0])
    assert fitted
    left = fitted.residual_of(OUTPUT)
    return float(np.sqrt(left.loss() / left.judged.sum()))


def test_an_output_is_weighed_by_what_noise_does_to_the_controller_that_it_is_of() -> None:
    """Noise moves it as far as gain and time have it: the right controller leaves no more than that."""
    believed, tuning = of_pi(is_tuned=True), EFFECTS["pi-tuning"]
    assert is_moved_by_noise(believed)
    fits, noisy = best_timed(believed, [tuning, EFFECTS["sensor-delay"]], 1.0)
    assert fits[0].names == ("pi-tuning",)
    found = believed.timed_by(fits, noisy)
    best = fits[0].effects
    assert left_of_output(believed, best) > 1.5
    assert left_of_output(found, best) < 1.2
    assert left_of_output(found) > 1.5 * left_of_output(found, best)


def test_an_output_of_a_controller_that_nobody_saw_when_healthy_is_weighed_as_it_is_believed() -> None:
    seen = of_pi(is_tuned=True)
    assert not is_moved_by_noise(SegmentProblem(seen.segment, seen.record, seen.belief))


def test_an_output_as_believed_is_weighed_as_it_is_believed() -> None:
    believed = of_pi(is_tuned=False)
    fits, noisy = best_timed(believed, [EFFECTS["pi-tuning"], EFFECTS["sensor-delay"]], 1.0)
    assert left_of_output(believed.timed_by(fits, noisy)) == pytest.approx(left_of_output(believed), rel=0.15)
