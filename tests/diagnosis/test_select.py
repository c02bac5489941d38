"""Claims about selection: nothing of nothing, what was put in, two at once, and names that mean the same together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, Effects, belief, effects, estimator, planted, record
from waxstudy.diagnosis.assembly import _alternative
from waxstudy.diagnosis.criteria import Question, limit
from waxstudy.diagnosis.diagnose import QUICK
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import FIT, SELECT, SHRINK, parts_of
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.select.candidate import Candidate, best_of
from waxstudy.diagnosis.select.evidence import explained
from waxstudy.diagnosis.select.search import Found, Search, Selection, select
from waxstudy.diagnosis.sentences import why_not
from waxstudy.plugin import Belief, Effect, hookimpl
from waxstudy.plugin.registry import Registry, _register

DAYS = 7
CHAIN_STAGES = ("sensor", "actuator", "valve")


@cache
def ready(case: str = "REAL", seed: int = 1) -> tuple[Record, Belief, tuple[Segment, ...]]:
    seen = record(case, days=DAYS, seed=seed)
    believed = belief(case, seen)
    return seen, believed, tuple(segments(seen, believed))


def segment_at(stage: str, cut: Sequence[Segment]) -> Segment:
    return next(segment for segment in cut if stage in segment.stages)


def searched(
    segment: Segment, seen: Record, believed: Belief, more: Sequence[type[Effect]] = (), seed: int = 1
) -> Selection:
    tried = [effect for effect in (*EFFECTS.values(), *more) if effect.stage in segment.stages]
    return select(estimator(segment, seen, believed, QUICK), tried, seed, lambda name: None)


@cache
def of_planted(true: Effects, stage: str, case: str = "REAL") -> Selection:
    seen, believed, cut = ready(case)
    segment = segment_at(stage, cut)
    return searched(segment, planted(segment, seen, believed, true), believed)


def distrusted(selection: Selection) -> list[Found]:
    """What explains too little of the whole record, or of a room that is not understood."""
    return [each.found for each in selection.withdrawn if each.criterion.name == "too much stays"]


def with_evidence(candidate: Candidate, **changes: Any) -> Candidate:
    return replace(candidate, evidence=replace(candidate.evidence, **changes))


# --- nothing of nothing ----------------------------------------------------------------------------------


@pytest.mark.parametrize("case", ["IDEAL", "REAL", "PWM"])
@pytest.mark.parametrize("stage", CHAIN_STAGES)
def test_where_everything_is_as_believed_nothing_is_claimed(case: str, stage: str) -> None:
    seen, believed, cut = ready(case)
    selection = searched(segment_at(stage, cut), seen, believed)
    assert (selection.found, selection.withdrawn) == ((), ())
    assert selection.before is selection.after


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2])
def test_nor_with_the_noise_of_other_instruments(seed: int) -> None:
    seen, believed, cut = ready("REAL", seed)
    for segment in cut:
        if not segment.with_room:
            assert searched(segment, seen, believed, seed=seed).found == ()


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1])
def test_where_a_room_is_as_believed_nothing_is_claimed(seed: int) -> None:
    seen, believed, cut = ready("REAL", seed)
    assert searched(segment_at("room", cut), seen, believed, seed=seed).found == ()


@pytest.mark.parametrize("seed", range(4))
def test_noise_of_another_day_is_no_effect(seed: int) -> None:
    seen, believed, cut = ready()
    segment = segment_at("valve", cut)
    again = planted(segment, seen, believed, seed=seed)
    assert searched(segment, again, believed, seed=seed).found == ()


# --- what was put in -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("stage", "true"),
    [
        ("valve", effects(let_by={"fraction": 0.02})),
        ("valve", effects(max_flow={"factor": 0.85})),
        ("actuator", effects(slow_actuator={"factor": 1.6})),
        ("actuator", effects(limited_travel={"opening": 0.7})),
    ],
)
def test_what_was_put_in_is_claimed_and_nothing_beside_it(stage: str, true: Effects) -> None:
    selection = of_planted(true, stage)
    ((name, _),) = true
    (found,) = selection.found
    assert name in found.group
    assert found.candidate.evidence.p <= 0.01
    assert found.inclusion > 0.9
    assert found.candidate.evidence.share > 0.8


@pytest.mark.slow
@pytest.mark.parametrize("true", [effects(sensor_delay={"delay_s": 900.0}), effects(sensor_bias={"bias_K": -0.4})])
def test_what_is_wrong_in_the_closed_loop_is_claimed_at_its_link(true: Effects) -> None:
    seen = record("IDEAL", days=DAYS, effects=true)
    believed = belief("IDEAL", seen)
    ((name, _),) = true
    for stage in CHAIN_STAGES:
        found = searched(segment_at(stage, segments(seen, believed)), seen, believed).found
        assert [each.group[0] for each in found] == ([name] if stage == "sensor" else [])


def test_what_is_less_than_noticeable_gets_no_name() -> None:
    """A meter without noise would show a leak of a thousandth: so little is not worth a name."""
    seen, believed, cut = ready()
    segment = segment_at("valve", cut)
    fine = replace(seen, stated_noise={"flow_L_h": 0.01, "displacement": 1e-4})
    for fraction, names in ((0.0015, []), (0.01, ["let-by"])):
        leaking = planted(segment, fine, believed, effects(let_by={"fraction": fraction}))
        assert [each.effect.name for each in searched(segment, leaking, believed).found] == names


@pytest.mark.slow
def test_a_room_departs_only_so_far_and_what_needs_more_is_claimed() -> None:
    """Half of the sun is no doubt about the sun any more; a fifth less is."""
    seen, believed, cut = ready("REAL")
    segment = segment_at("room", cut)
    tried = [EFFECTS[name] for name in ("solar-factor", "gain-shift", "infiltration", "neighbour-heat")]

    def of_sun(factor: float) -> Selection:
        made = planted(segment, seen, believed, effects(solar_factor={"factor": factor}))
        return select(estimator(segment, made, believed, QUICK), tried, 1, lambda name: None)

    half = of_sun(0.5)
    assert ["solar-factor" in found.group for found in half.found] == [True]
    less = of_sun(0.8)
    names = [unknown.name for unknown in less.problem.nuisances]
    departure = (less.after.departures / less.problem.sd)[names.index("solar gain")]
    assert (less.found, departure < -1.0) == ((), True)


def test_two_effects_in_one_link_are_both_claimed() -> None:
    """A valve that sticks open a little may be told by the other's name, but is in its group."""
    selection = of_planted(effects(let_by={"fraction": 0.03}, max_flow={"factor": 0.8}), "valve")
    assert len(selection.found) == 2
    for name in ("let-by", "max-flow"):
        assert sum(name in found.group for found in selection.found) == 1
    values = {effect.name: dict(each) for effect, each in selection.after.effects}
    assert values["max-flow"]["factor"] == pytest.approx(0.8, rel=0.02)


def test_one_of_a_pair_that_is_enough_only_together_is_no_other_name_of_the_other() -> None:
    seen, believed, cut = ready()
    segment = segment_at("valve", cut)
    made = planted(segment, seen, believed, effects(let_by={"fraction": 0.03}, max_flow={"factor": 0.8}))
    fitter = estimator(segment, made, believed)
    search = Search(fitter, [EFFECTS["let-by"], EFFECTS["max-flow"]], np.random.default_rng(1), lambda name: None)
    alone = search.tried(fitter.base)
    first = next(each for each in alone if each.effect.name == "let-by")
    (second,) = search.tried(first.fitted)
    (both,) = search.judged(fitter.base, [(second.effect, second.fitted)])
    told = search.found(first, [*alone, both], fitter.base, ("let-by", "max-flow"))
    assert told.group == ("let-by",)
    assert told.inclusion > 0.9
    assert "max-flow" in search.found(first, [*alone, both], fitter.base).group


def test_each_model_explains_more_than_the_one_before() -> None:
    selection = of_planted(effects(let_by={"fraction": 0.03}, max_flow={"factor": 0.8}), "valve")
    gaps = [model.residuals[0].gap() for model in selection.models]
    assert gaps == sorted(gaps, reverse=True)
    assert [len(model.effects) for model in selection.models] == list(range(len(selection.found) + 1))


def test_an_effect_that_later_days_do_not_confirm_is_withdrawn() -> None:
    """A valve that leaks until the days that nobody looks at."""
    seen, believed, cut = ready()
    segment = segment_at("valve", cut)
    leaking = planted(segment, seen, believed, effects(let_by={"fraction": 0.03})).values["flow_L_h"]
    tight = planted(segment, seen, believed).values["flow_L_h"]
    flow = np.where(parts_of(seen) == SHRINK, tight, leaking)
    selection = searched(segment, replace(seen, values={**seen.values, "flow_L_h": flow}), believed)
    assert selection.found == ()
    (withdrawn,) = selection.withdrawn
    assert "let-by" in withdrawn.found.group
    assert why_not(selection, withdrawn.found.candidate) == "the last days do not confirm it"


def test_what_explains_less_than_half_of_a_room_over_the_whole_record_is_not_claimed() -> None:
    """On the days that choose it explains nearly all: on the others the room is missed for another reason."""
    seen, believed, cut = ready()
    segment = segment_at("room", cut)
    warm = planted(segment, seen, believed, effects(supply_offset={"offset_K": 2.0}))
    is_other = parts_of(seen, days_in_turn=True) != SELECT
    other_K = is_other * 0.17 * np.sin(2.0 * np.pi * np.arange(len(seen)) / (7.0 * 3600.0 / seen.interval_s))
    odd = {name: warm.values[name] + other_K for name in ("air_temperature_C", "operative_temperature_C")}
    for values, is_claimed in ((warm.values, True), ({**warm.values, **odd}, False)):
        tried = [EFFECTS["supply-offset"]]
        selection = select(
            estimator(segment, replace(warm, values=values), believed, QUICK), tried, 1, lambda name: None
        )
        named = selection.found if is_claimed else distrusted(selection)
        assert [each.effect.name for each in named] == ["supply-offset"]
        assert bool(selection.found) is is_claimed
        why = "another explains more" if is_claimed else "too much stays"
        assert why_not(selection, named[0].candidate) == why


CURVE = effects(quick_opening={"h_min": 0.25, "h_mid": 0.6, "v_mid": 0.2, "authority": 0.8})


@pytest.mark.parametrize(("true", "is_form"), [(CURVE, True), (effects(max_flow={"factor": 0.8}), False)])
def test_a_form_of_several_parameters_is_claimed_only_where_little_else_is_left(true: Effects, is_form: bool) -> None:
    """On the days that choose it explains nearly all: on the others the flow is missed for another reason."""
    seen, believed, cut = ready("WAX")
    segment = segment_at("valve", cut)
    ((name, _),) = true
    flow = planted(segment, seen, believed, true).values["flow_L_h"]
    wave = 0.3 * np.sin(2.0 * np.pi * np.arange(len(seen)) / 60.0) * (parts_of(seen) == FIT)
    for values, is_claimed in ((flow, True), (flow * (1.0 + wave), not is_form)):
        record = replace(seen, values={**seen.values, "flow_L_h": values})
        selection = select(estimator(segment, record, believed, QUICK), [EFFECTS[name]], 1, lambda name: None)
        assert [each.effect.name for each in (selection.found if is_claimed else distrusted(selection))] == [name]
        assert bool(selection.found) is is_claimed


def test_an_actuator_within_what_real_ones_stray_is_not_called_another() -> None:
    """It is seen, and yet no finding: what is published of the believed one covers it."""
    selection = of_planted(effects(slow_actuator={"factor": 1.04}), "actuator")
    slow = next(each for each in selection.tried if each.effect.name == "slow-actuator")
    assert slow.evidence.p <= limit(Question.CLAIM, "p", slow.evidence)
    assert slow.evidence.gain_per_form >= limit(Question.CLAIM, "gain_per_form", slow.evidence)
    assert slow.evidence.travel <= limit(Question.CLAIM, "travel", slow.evidence)
    assert slow.why_not == "real motors stray as much"
    assert selection.found == ()


# --- groups ----------------------------------------------------------------------------------------------


def stranger() -> ModuleType:
    """A plugin whose effect is the library's leaking valve under another name."""

    original = EFFECTS["let-by"]

    class Seeping(Effect):
        """What the library calls a let-by."""

        name = "seeping"
        api_version = "1.0"
        stage = original.stage
        Parameters = original.Parameters
        priors = original.priors

        @classmethod
        def hindrance(cls, belief: Belief) -> str:
            return original.hindrance(belief)

        @classmethod
        def apply(cls, belief: Belief, p: Any) -> Belief:
            return original.apply(belief, p)

        @classmethod
        def sentence(cls, p: Any) -> str:
            return "The valve seeps."

    def register_all(register: Any) -> None:
        register(Seeping)

    module = ModuleType("stranger")
    setattr(module, "waxstudy_register", hookimpl(register_all))  # noqa: B010
    return module


def test_effects_that_are_the_same_thing_are_one_group() -> None:
    registry = Registry()
    _register(registry, stranger(), "stranger", "1.0")
    twin = registry.get("effect", "seeping")
    assert issubclass(twin, Effect)
    seen, believed, cut = ready()
    segment = segment_at("valve", cut)
    leaking = planted(segment, seen, believed, effects(let_by={"fraction": 0.03}))
    (found,) = searched(segment, leaking, believed, more=[twin]).found
    assert {"let-by", "seeping"} <= set(found.group)
    assert found.group[0] == found.effect.name
    assert tuple(each.effect.name for each in found.others) == found.group[1:]
    other = next(_alternative(each) for each in found.others if each.effect.name in ("let-by", "seeping"))
    assert other.parameters["fraction"].value == pytest.approx(0.03, rel=0.1)
    assert found.inclusion > 0.9


def test_effects_that_the_record_tells_apart_are_not_in_one_group() -> None:
    (found,) = of_planted(effects(max_flow={"factor": 0.85}), "valve").found
    assert found.group == ("max-flow",)


@given(st.floats(0.0, 1e6), st.floats(0.0, 1e6), st.floats(0.0, 1e6))
def test_no_more_than_all_of_a_gap_is_explained(before: float, after: float, least: float) -> None:
    share = explained(before, after, least)
    assert share <= 1.0 + 1e-9
    if before <= least:
        assert share == 0.0
    elif after <= least:
        assert share == pytest.approx(1.0)
    elif after >= before:
        assert share <= 0.0


def test_the_same_seed_gives_the_same_selection() -> None:
    seen, believed, cut = ready()
    segment = segment_at("valve", cut)
    leaking = planted(segment, seen, believed, effects(let_by={"fraction": 0.02}))
    one, other = (searched(segment, leaking, believed, seed=5) for _ in range(2))
    assert [(c.effect.name, c.evidence) for c in one.tried] == [(c.effect.name, c.evidence) for c in other.tried]
    assert [(f.group, f.inclusion) for f in one.found] == [(f.group, f.inclusion) for f in other.found]


def test_an_effect_that_may_not_be_claimed_says_which_condition_it_fails() -> None:
    tried = of_planted(effects(slow_actuator={"factor": 2.0}), "actuator").tried
    claimed = next(each for each in tried if each.effect.name == "slow-actuator")
    assert claimed.why_not == ""
    for fails, why in (
        ({"p": 0.5}, "may be chance"),
        ({"gain": 1.0}, "hardly better than without"),
        ({"over": 1.0}, "the gap is within noise"),
        ({"departure": 1.0}, "too slight to be named"),
        ({"share": 0.1}, "explains too little"),
    ):
        assert with_evidence(claimed, **fails).why_not == why


def test_of_two_that_cannot_be_told_apart_the_one_with_fewer_parameters_is_named() -> None:
    tried = of_planted(effects(slow_actuator={"factor": 2.0}), "actuator").tried
    by_name = {each.effect.name: each for each in tried}
    simple, rich = by_name["slow-actuator"], by_name["constant-times"]
    gain, loss = simple.evidence.gain, simple.evidence.loss
    ahead = with_evidence(rich, gain=gain + 500.0, loss=loss - 8.9, missed=1.0, strain=simple.evidence.strain)
    assert best_of([simple, ahead]).effect.name == "slow-actuator"
    assert best_of([simple, with_evidence(ahead, loss=loss - 9.1)]).effect.name == "constant-times"
    assert best_of([simple, with_evidence(rich, gain=gain - 500.0)]).effect.name == "slow-actuator"
