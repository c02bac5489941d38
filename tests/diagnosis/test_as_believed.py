"""Claims about a chain without a healthy record: it is weighed against what noise makes of what is believed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, Effects, as_believed, belief, dataset, effects, planted, rows
from waxstudy.diagnosis.assembly import _tried
from waxstudy.diagnosis.calibration import healthy
from waxstudy.diagnosis.calibration.healthy import AsBelieved
from waxstudy.diagnosis.diagnose import _base, record_of, weighed_links
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.conventions import AFTER, BEFORE, Convention
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.select.posterior import posterior
from waxstudy.diagnosis.select.weigh import Weighing
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import Belief
from waxstudy.study.problems import StudyError

MOTOR = ["time", "heating_signal", "displacement"]
CONTROLLER = ["time", "sensor_temperature_C", "air_temperature_C", "control_output"]
DRIVEN = ["outdoor_temperature_C", "solar_gain_W", "internal_gain_W", "supply_temperature_C"]
ROOM = ["time", "flow_L_h", "air_temperature_C", *DRIVEN]


@cache
def motor() -> tuple[Record, Belief, Segment]:
    seen = record_of(dataset(rows("WAX", 4)[MOTOR], "WAX"))
    believed = belief("WAX", seen)
    (link,) = segments(seen, believed)
    return seen, believed, link


def weighing(true: Effects = (), names: Sequence[str] = ("slow-actuator",)) -> Weighing:
    seen, believed, link = motor()
    return as_believed(link, planted(link, seen, believed, true), believed, names, 0.25)


def test_a_link_of_the_chain_is_weighed_without_a_healthy_record_and_a_room_is_not() -> None:
    record = dataset(rows("WAX", 4)[ROOM], "WAX")
    seen = record_of(record)
    assert any(each.with_room for each in segments(seen, belief("WAX", seen)))
    ((segment, found),) = weighed_links(record, None)
    assert segment.stages[-1] == "valve"
    assert posterior(found)["none"] > 0.9


def test_where_no_noise_can_be_simulated_that_of_the_instruments_is_usual(monkeypatch: pytest.MonkeyPatch) -> None:
    found = weighing(effects(slow_actuator={"factor": 1.4}))
    monkeypatch.setattr(healthy, "of_noise", lambda problem, fitted, times: iter(()))
    left = AsBelieved.of(found.problem, found.none).left("displacement")
    assert left
    assert left.whitened == 1.0
    assert found.none.residuals[0].loss() > 4.0 * left.samples  # what the motor misses is not usual


def test_what_is_believed_of_a_chain_and_cannot_be_simulated_is_said_with_its_table() -> None:
    class Impossible:
        problem = SimpleNamespace(segment=SimpleNamespace(stages=("actuator",)))

        @property
        def base(self) -> Hypothesis:
            raise ValueError("what is believed of actuator cannot be simulated")

    work: Any = SimpleNamespace(dataset=dataset(rows("WAX", 4)[MOTOR], "WAX"))
    estimator: Any = Impossible()
    with pytest.raises(StudyError, match=r"\[nominal\].*cannot be simulated"):
        _base(work, estimator)


def test_what_noise_makes_of_what_is_believed_is_usual() -> None:
    found = weighing()
    left = found.healthy.left("displacement")
    assert left
    assert left.whitened == pytest.approx(1.0, rel=0.3)
    assert found.none.residuals[0].loss() == pytest.approx(found.healthy.usual_loss(found.none.residuals[0]), rel=0.3)
    assert found.healthy.scatter(found.none.residuals[0]) == WEIGHTS.part_scatter
    assert found.healthy.had_it([(EFFECTS["slow-actuator"], {"factor": 1.4})])[0] == 0.0


def test_noise_is_as_usual_where_a_motor_moves_as_where_it_rests() -> None:
    """What the form of the believed motor misses is most at the edges of its strokes, and no noise tells it."""
    found = weighing(effects(slow_actuator={"factor": 2.0}))
    slow = found.weighed()[1].fitted
    missed, (left,) = found.none.residuals[0], slow.residuals
    acts = found.healthy.acts(missed, left)
    assert np.ptp(acts[missed.judged]) == 0.0
    assert acts[missed.judged][0] > 0.0
    assert not acts[~missed.judged].any()
    assert found.healthy.usual_where(missed, slow.effects, ()) == (found.healthy.usual(missed), np.inf)


@pytest.mark.parametrize(("factor", "strays"), [(1.04, True), (2.0, False)])
def test_what_real_motors_stray_by_has_no_name_and_is_no_misfit(factor: float, strays: bool) -> None:
    found = weighing(effects(slow_actuator={"factor": factor}))
    none, slow = found.weighed()[:2]
    assert slow.fitted.effects[0][1]["factor"] == pytest.approx(factor, rel=0.02)
    assert slow.names == (() if strays else ("slow-actuator",))
    assert (none.misfit == 0.0) is strays
    assert (posterior([none, slow])["none"] > 0.9) is strays


@pytest.mark.parametrize(("stuck", "is_unknown"), [([3], False), ([3, 6, 9, 12], True)])
def test_a_motor_that_sticks_in_a_single_cycle_is_nothing_unknown(stuck: Sequence[int], is_unknown: bool) -> None:
    seen, believed, link = motor()
    made = planted(link, seen, believed)
    still = np.isin(made.cycle, np.unique(made.cycle)[list(stuck)])
    values = {**made.values, "displacement": np.where(still, 0.0, made.values["displacement"])}
    found = as_believed(link, replace(made, values=values), believed, ["slow-actuator"], 0.25)
    assert (posterior(found.weighed())["unknown"] > 0.5) is is_unknown


def test_effects_of_which_one_takes_the_other_s_place_are_not_tried_together() -> None:
    """All times of a motor, stated anew, and a factor on them say the same twice, and reach times that no motor has."""
    seen, believed, link = motor()
    made = planted(link, seen, believed)
    logged = np.convolve(np.pad(made.values["displacement"], 15, "edge"), np.full(31, 1.0 / 31.0), mode="valid")
    found = as_believed(
        link,
        replace(made, values={**made.values, "displacement": logged}),
        believed,
        ["slow-actuator", "constant-times", "limited-travel"],
    ).weighed()
    tried = {frozenset(each.fitted.names) for each in found}
    assert frozenset({"constant-times", "limited-travel"}) in tried
    assert not [names for names in tried if {"constant-times", "slow-actuator"} <= names]


def test_an_effect_that_leaves_most_of_the_gap_in_its_own_unit_explains_little() -> None:
    """A valve that sticks shut every other time is no smaller flow, though weights make little of an open one."""
    seen = record_of(dataset(rows("REAL", 6)[["time", "displacement", "flow_L_h"]], "REAL"))
    believed = belief("REAL", seen)
    (link,) = segments(seen, believed)
    made = planted(link, seen, believed)
    shut = np.isin(made.cycle, np.unique(made.cycle)[2::2])
    values = {**made.values, "flow_L_h": np.where(shut, 0.0, made.values["flow_L_h"])}
    found = as_believed(link, replace(made, values=values), believed, ["max-flow"], 0.25).weighed()
    small = next(each for each in found if each.names == ("max-flow",) and each.pattern is None)
    assert small.gain > 1e5
    assert small.fitted.residuals[0].gap() > 0.7 * found[0].fitted.residuals[0].gap()
    assert small.left > 0.7
    assert posterior(found)["unknown"] > 0.5


# --- a controller ------------------------------------------------------------------------------------


def of_controller(true: Effects, name: str, thorough: float = 1.0) -> dict[str, float]:
    """The parameters of an effect of an on-off controller that is named."""
    seen = record_of(dataset(rows("LATE", 7, true)[CONTROLLER], "LATE"))
    believed = belief("LATE", seen)
    link = next(each for each in segments(seen, believed) if "controller" in each.stages)
    none, found = as_believed(link, seen, believed, [name], thorough).weighed()[:2]
    assert posterior([none, found])[name] > WEIGHTS.named
    return dict(found.fitted.effects[0][1])


def test_a_quick_look_names_a_dead_band_that_is_wider_by_a_tenth_of_a_kelvin() -> None:
    """Its first points lie a kelvin apart."""
    found = of_controller(effects(dead_band={"dead_band_K": 0.62}), "dead-band", 0.25)
    assert found["dead_band_K"] == pytest.approx(0.62, abs=0.02)


def test_a_small_shift_of_the_setpoint_at_night_is_named_with_its_hours() -> None:
    found = of_controller(effects(setpoint_offset={"offset_K": -0.14, "from_h": 22.5, "to_h": 5.8}), "setpoint-offset")
    assert found["offset_K"] == pytest.approx(-0.14, abs=0.05)
    assert found["from_h"] == pytest.approx(22.5, abs=1.0)
    assert found["to_h"] == pytest.approx(5.8, abs=1.0)


def test_what_another_reading_of_the_record_explains_is_no_effect_s_gain() -> None:
    seen = record_of(dataset(rows("LATE", 4)[CONTROLLER], "LATE"))
    believed = belief("LATE", seen)
    link = next(each for each in segments(seen, believed) if "controller" in each.stages)
    found = as_believed(link, seen, believed, [])

    def read(convention: Convention) -> Hypothesis:
        nothing = found.estimator.refined((), found.none.departures, convention, ALL)
        assert nothing
        return nothing

    after, before = read(AFTER), read(BEFORE)
    found.none, better = max((after, before), key=found._loss), min((after, before), key=found._loss)
    assert found._loss(found.none) > 100.0 + found._loss(better)
    assert found.of(better).gain == 0.0


def test_an_effect_that_was_weighed_at_certain_hours_too_is_told_once_as_it_gains_most() -> None:
    effect = EFFECTS["slow-actuator"]
    of = [SimpleNamespace(gain=gain, p=0.1, share=0.2, channel="displacement") for gain in (1.0, 3.0)]
    tried = [SimpleNamespace(effect=effect, evidence=each) for each in of]
    selection: Any = SimpleNamespace(tried=tried, posterior={"none": 1.0}, found=())
    assert [(each.name, each.gain) for each in _tried(selection, [])] == [("slow-actuator", 3.0)]


@pytest.mark.parametrize("beyond", [0.003, 0.006, 0.02])
def test_a_valve_that_sticks_just_beyond_its_lift_is_no_less_likely_than_a_leak(beyond: float) -> None:
    """Both let the same flow through; a fit of the one must find so small an opening."""
    seen = record_of(dataset(rows("REAL", 6)[["time", "displacement", "flow_L_h"]], "REAL"))
    believed = belief("REAL", seen)
    (valve,) = segments(seen, believed)
    opening = believed.value("valve", "h_min") + beyond
    stuck = planted(valve, seen, believed, effects(stuck_open={"opening": opening}))
    told = posterior(as_believed(valve, stuck, believed, ["let-by", "stuck-open"], 0.35).weighed())
    assert told["let-by"] + told["stuck-open"] > 0.8
    assert told["stuck-open"] == pytest.approx(told["let-by"], rel=0.1)
