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

from tests.diagnosis.realities import EFFECTS, Effects, belief, effects, planted, record, selected
from waxstudy.diagnosis.assembly import _alternative
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.model.conventions import PLAIN
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import HELD_OUT, parts_of
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.select.selection import Candidate, Selection, strongest
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


def searched(segment: Segment, seen: Record, believed: Belief, more: Sequence[type[Effect]] = ()) -> Selection:
    tried = [effect for effect in (*EFFECTS.values(), *more) if effect.stage in segment.stages]
    return selected(segment, seen, believed, tried)


@cache
def of_planted(true: Effects, stage: str, case: str = "REAL") -> Selection:
    seen, believed, cut = ready(case)
    segment = segment_at(stage, cut)
    return searched(segment, planted(segment, seen, believed, true), believed)


# --- nothing of nothing ----------------------------------------------------------------------------------


@pytest.mark.parametrize("case", ["IDEAL", "REAL", "PWM"])
@pytest.mark.parametrize("stage", CHAIN_STAGES)
def test_where_everything_is_as_believed_nothing_is_claimed(case: str, stage: str) -> None:
    seen, believed, cut = ready(case)
    selection = searched(segment_at(stage, cut), seen, believed)
    assert selection.found == ()
    assert selection.before is selection.after


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2])
def test_nor_with_the_noise_of_other_instruments(seed: int) -> None:
    seen, believed, cut = ready("REAL", seed)
    for segment in cut:
        if not segment.with_room:
            assert searched(segment, seen, believed).found == ()


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1])
def test_where_a_room_is_as_believed_nothing_is_claimed(seed: int) -> None:
    seen, believed, cut = ready("REAL", seed)
    assert searched(segment_at("room", cut), seen, believed).found == ()


@pytest.mark.parametrize("seed", range(4))
def test_noise_of_another_day_is_no_effect(seed: int) -> None:
    seen, believed, cut = ready()
    segment = segment_at("valve", cut)
    again = planted(segment, seen, believed, seed=seed)
    assert searched(segment, again, believed).found == ()


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
    assert found.probability >= 0.8
    tried = next(each for each in selection.tried if each.effect.name == name)
    assert tried.share(selection.floor) > 0.8


CURVE = effects(quick_opening={"h_min": 0.25, "h_mid": 0.6, "v_mid": 0.2, "authority": 0.8})


@pytest.mark.parametrize(("true", "names"), [(CURVE, ["quick-opening"]), ((), [])])
def test_another_curve_is_claimed_though_other_circuits_take_from_all_of_the_flow(
    true: Effects, names: Sequence[str]
) -> None:
    seen, believed, cut = ready("WAX")
    segment = segment_at("valve", cut)
    made = planted(segment, seen, believed, true)
    pressure = 1.0 + 0.009 * np.sin(2.0 * np.pi * np.arange(len(made)) * made.interval_s / (5 * 3600.0))
    shared = replace(made, values={**made.values, "flow_L_h": made.values["flow_L_h"] * pressure})
    assert [each.effect.name for each in searched(segment, shared, believed).found] == names


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
        return selected(segment, made, believed, tried)

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


def test_each_model_explains_more_than_the_one_before() -> None:
    selection = of_planted(effects(let_by={"fraction": 0.03}, max_flow={"factor": 0.8}), "valve")
    gaps = [model.residuals[0].gap() for model in selection.models]
    assert gaps == sorted(gaps, reverse=True)
    assert [len(model.effects) for model in selection.models] == list(range(len(selection.found) + 1))


def test_an_effect_that_later_days_do_not_confirm_is_not_named() -> None:
    """A valve that leaks until the days that are held out."""
    seen, believed, cut = ready()
    segment = segment_at("valve", cut)
    leaking = planted(segment, seen, believed, effects(let_by={"fraction": 0.03})).values["flow_L_h"]
    tight = planted(segment, seen, believed).values["flow_L_h"]
    flow = np.where(parts_of(seen) == HELD_OUT, tight, leaking)
    assert searched(segment, replace(seen, values={**seen.values, "flow_L_h": flow}), believed).found == ()


def test_an_actuator_within_what_real_ones_stray_is_not_called_another() -> None:
    """It is seen, and yet no finding: what is published of the believed one covers it."""
    selection = of_planted(effects(slow_actuator={"factor": 1.04}), "actuator")
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
    assert found.probability > 0.9


def test_effects_that_the_record_tells_apart_are_not_in_one_group() -> None:
    (found,) = of_planted(effects(max_flow={"factor": 0.85}), "valve").found
    assert found.group == ("max-flow",)


def of_gap(before: float, after: float) -> Candidate:
    """A candidate by which a gap of one size becomes one of another."""
    every, at = np.ones(3, dtype=bool), np.arange(3)
    both = [Residual("flow_L_h", "L/h", size * every, size * every, every, at, at, at) for size in (before, after)]
    return Candidate(EFFECTS["max-flow"], {"factor": 0.8}, 1.0, *both)


@given(st.floats(0.0, 1e3), st.floats(0.0, 1e3), st.floats(0.0, 1e3))
def test_no_more_than_all_of_a_gap_is_explained(before: float, after: float, least: float) -> None:
    candidate = of_gap(before, after)
    before, after = candidate.before.gap(), candidate.after.gap()
    share = candidate.share(NoiseFloor({"flow_L_h": least}, {}))
    assert share <= 1.0 + 1e-9
    if before <= least:
        assert share == 0.0
    elif after <= least:
        assert share == pytest.approx(1.0)
    elif after >= before:
        assert share <= 1e-9


@given(st.lists(st.floats(0.01, 100.0), min_size=2, max_size=4, unique=True))
def test_an_effect_acts_where_it_gains_most(sizes: list[float]) -> None:
    every, at = np.ones(3, dtype=bool), np.arange(3)

    def model(missed: Sequence[float]) -> Hypothesis:
        pairs = enumerate(missed)
        residuals = [Residual(f"{n}", "K", size * every, size * every, every, at, at, at) for n, size in pairs]
        return Hypothesis((), PLAIN, np.zeros(0), residuals)

    before, _ = strongest(model(sizes), model([0.0] * len(sizes)))
    assert before.channel == f"{np.argmax(sizes)}"


def test_the_same_record_gives_the_same_selection() -> None:
    seen, believed, cut = ready()
    segment = segment_at("valve", cut)
    leaking = planted(segment, seen, believed, effects(let_by={"fraction": 0.02}))
    one, other = (searched(segment, leaking, believed) for _ in range(2))
    assert [(c.effect.name, c.gain) for c in one.tried] == [(c.effect.name, c.gain) for c in other.tried]
    assert one.posterior == other.posterior


def test_an_effect_that_is_not_named_says_what_is_likelier() -> None:
    leaking, still = of_planted(effects(let_by={"fraction": 0.02}), "valve"), of_planted((), "valve")
    assert why_not(leaking) == "less likely than what is named"
    assert why_not(still) == "less likely than that nothing is amiss"
    assert why_not(replace(still, posterior={"none": 0.4, "unknown": 0.6})) == "less likely than something unknown"


def test_of_two_that_leave_only_noise_the_one_with_fewer_parameters_is_named() -> None:
    (found,) = of_planted(effects(slow_actuator={"factor": 2.0}), "actuator").found
    assert found.effect.name == "slow-actuator"
