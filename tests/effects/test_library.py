"""What holds for every effect of the library: its table, its neutral values, its range, and wrapped blocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.effects.believed import CHAINS, EFFECTS, IDEAL, REAL, belief, with_effect
from waxstudy.conformance import blocks
from waxstudy.conformance.beliefs import difference, outcome, sample_inputs
from waxstudy.conformance.stage import Subject
from waxstudy.plugin import CHAIN, STAGES, Actuator, Belief, Choice, Effect, Parameters, Prior, Ring, delayed, parameter
from waxstudy.synthetic.effects import applied
from waxstudy_effects.wrapping import parameter_name

# section 9 of the design: name -> stage, parameters
TABLE: Mapping[str, tuple[str, str]] = {
    "sensor-delay": ("sensor", "delay_s"),
    "sensor-lag": ("sensor", "time_constant_s"),
    "sensor-bias": ("sensor", "bias_K"),
    "dead-band": ("controller", "dead_band_K"),
    "pi-tuning": ("controller", "gain integration_time_s"),
    "setpoint-offset": ("controller", "offset_K from_h to_h"),
    "modulation": ("modulator", "period_s min_pulse_s"),
    "pwm-period": ("modulator", "period_s"),
    "min-pulse": ("modulator", "min_pulse_s"),
    "wax-motor": ("actuator", "dead_time_s rise_time_s hold_time_s fall_time_s past"),
    "constant-times": ("actuator", "dead_time_s rise_time_s hold_time_s fall_time_s"),
    "variable-times": (
        "actuator",
        "dead_a_s dead_b_s dead_tau_s rise_a_s rise_b_s rise_tau_s hold_a_s hold_b_s hold_tau_s fall_s",
    ),
    "slow-actuator": ("actuator", "factor"),
    "limited-travel": ("actuator", "opening"),
    "quick-opening": ("valve", "h_min h_mid v_mid authority"),
    "low-authority": ("valve", "authority"),
    "let-by": ("valve", "fraction"),
    "stuck-open": ("valve", "opening"),
    "max-flow": ("valve", "factor"),
    "supply-offset": ("emitter", "offset_K"),
    "pipe-delay": ("emitter", "volume_L"),
    "floor-cover": ("emitter", "resistance_m2K_W"),
    "infiltration": ("room", "factor"),
    "window-opening": ("room", "flow_L_s from_h to_h"),
    "solar-factor": ("room", "factor"),
    "gain-shift": ("room", "shift_h factor"),
    "thermal-mass": ("room", "factor"),
    "neighbour-heat": ("room", "conductance_W_K"),
    "extra-heat": ("room", "heat_W radiant_share"),
}
EACH = pytest.mark.parametrize("name", sorted(EFFECTS))


def applicable(effect: type[Effect]) -> dict[str, Belief]:
    """The beliefs that an effect applies to, of four chains."""
    all_of = {name: belief(words, sample_inputs()) for name, words in CHAINS.items()}
    return {name: each for name, each in all_of.items() if not effect.hindrance(each)}


def test_the_library_has_every_effect_of_the_table_and_no_other() -> None:
    found = {name: (effect.stage, set(effect.Parameters.model_fields)) for name, effect in EFFECTS.items()}
    assert found == {name: (stage, set(names.split())) for name, (stage, names) in TABLE.items()}
    assert {stage for stage, _ in found.values()} == set(STAGES)


@EACH
def test_at_its_neutral_values_nothing_changes_in_any_chain_that_it_applies_to(name: str) -> None:
    effect = EFFECTS[name]
    beliefs = applicable(effect)
    assert beliefs
    for chain, each in beliefs.items():
        values = effect.neutral(each)
        if values is not None:
            neutral = effect.apply(each, effect.Parameters(**values))
            assert difference(outcome(each), outcome(neutral)) < 1e-9, chain


@EACH
def test_only_a_replaced_block_has_no_neutral_values(name: str) -> None:
    effect = EFFECTS[name]
    neutral = {effect.neutral(each) is not None for each in applicable(effect).values()}
    replacing = {"modulation", "wax-motor", "constant-times"}
    assert neutral == ({False} if name in replacing else {True, False} if name == "sensor-delay" else {True})


def place(prior: Prior, at: float) -> float:
    value = prior.low * (prior.high / prior.low) ** at if prior.is_log else prior.low + at * (prior.high - prior.low)
    return min(prior.high, max(prior.low, value))


@settings(max_examples=60)
@given(st.data())
def test_anywhere_in_its_range_it_runs_or_says_in_a_line_why_it_cannot(data: st.DataObject) -> None:
    effect = EFFECTS[data.draw(st.sampled_from(sorted(EFFECTS)))]
    each = data.draw(st.sampled_from(list(applicable(effect).values())))
    values = {name: place(prior, data.draw(st.floats(0.0, 1.0))) for name, prior in effect.priors.items()}
    try:
        made = effect.apply(each, effect.Parameters(**values))
    except ValueError as error:
        told = (effect.name, str(error).partition(" and ")[0])
        assert told == ("variable-times", "dead_a_s + dead_b_s must not be negative")
        return
    outcome(made)  # each block's output is held against its range


@EACH
def test_a_hindrance_is_told_where_what_it_needs_is_missing(name: str) -> None:
    reason = EFFECTS[name].hindrance(Belief({}))
    own_block = {"sensor-delay", "sensor-lag", "sensor-bias", "wax-motor", "limited-travel", "quick-opening"}
    assert (reason == "") is (name in own_block | {"let-by", "stuck-open"})


@pytest.mark.parametrize(
    ("name", "parameter", "first", "more", "both"),
    [
        ("sensor-lag", "time_constant_s", 60.0, 30.0, 90.0),
        ("sensor-bias", "bias_K", 0.2, -0.5, -0.3),
        ("slow-actuator", "factor", 1.2, 1.5, 1.8),
        ("limited-travel", "opening", 0.9, 0.6, 0.6),
        ("let-by", "fraction", 0.01, 0.03, 0.03),
        ("stuck-open", "opening", 0.1, 0.05, 0.1),
    ],
)
def test_a_block_that_has_the_effect_already_gets_both_in_one(
    name: str, parameter: str, first: float, more: float, both: float
) -> None:
    effect = EFFECTS[name]
    believed = belief(REAL)
    for value in (first, more):
        believed = effect.apply(believed, effect.Parameters(**{parameter: value}))
    assert believed.value(effect.stage, parameter_name(effect, parameter)) == pytest.approx(both)


# --- wrapped blocks --------------------------------------------------------------------------------------


class Offset(Parameters):
    dead_time_s: float = parameter(30.0, unit="s", ge=0, le=90, description="Dead time.", source="chosen for a test")


@dataclass
class Past:
    signals: Ring = field(default_factory=lambda: Ring(0))
    opening: float = 0.0


class Strange(Actuator):
    """A stranger's motor with a dead time in a ring and a lag."""

    name = "strange"
    Parameters = Offset
    State = Past

    @classmethod
    def start(cls, p: Any, dt: float) -> Past:
        return Past(Ring(round(p.dead_time_s / dt)))

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        x.opening += (delayed(x.signals, u) - x.opening) * dt / (dt + 60.0)
        opening: float = x.opening
        return opening


STRANGE = Choice(Strange, Offset())
WRAPPED = {
    "sensor-lag": ("time_constant_s", 300.0, "sensor"),
    "sensor-bias": ("bias_K", 0.4, "sensor"),
    "slow-actuator": ("factor", 1.7, "actuator"),
    "limited-travel": ("opening", 0.7, "actuator"),
    "let-by": ("fraction", 0.02, "valve"),
    "stuck-open": ("opening", 0.3, "valve"),
}


@pytest.mark.parametrize("chain", ["ideal", "real", "modulated", "strange"])
@pytest.mark.parametrize("name", WRAPPED)
def test_a_wrapped_block_does_all_that_a_block_must(name: str, chain: str) -> None:
    parameter, value, kind = WRAPPED[name]
    to = belief(CHAINS.get(chain, REAL))
    to = to.with_block("actuator", STRANGE) if chain == "strange" else to
    if EFFECTS[name].hindrance(to):
        assert (name, chain) == ("slow-actuator", "ideal")
        return
    made = with_effect(name, to, **{parameter: value}).blocks[kind]
    subject = Subject(made.component, {}, {"wrapped": made.parameters})
    for stage in blocks.STAGES:
        if stage.name != "step-halving":
            assert list(stage.problems(subject)) == [], stage.name


def test_effects_around_one_block_do_not_disturb_each_other() -> None:
    closed = outcome(belief(REAL))["valve"]
    leaking = with_effect("let-by", belief(REAL), fraction=0.01)
    both = with_effect("stuck-open", leaking, opening=0.25)
    flows = outcome(both)["valve"]
    assert flows.min() > outcome(leaking)["valve"].min() > closed.min() == 0.0
    assert both.blocks["valve"].component.name == "quick-opening with let-by with stuck-open"


@pytest.mark.parametrize(
    ("replaced", "around", "kind"),
    [
        ("quick-opening", "let-by", "valve"),
        ("sensor-delay", "sensor-bias", "sensor"),
        ("sensor-delay", "sensor-lag", "sensor"),
        ("wax-motor", "limited-travel", "actuator"),
    ],
)
def test_an_effect_that_replaces_a_block_leaves_what_acts_on_it_whatever_comes_first(
    replaced: str, around: str, kind: str
) -> None:
    chosen = [Choice.of(EFFECTS[name], {}) for name in (around, replaced)]
    one, other = (applied(each, belief(IDEAL)).blocks[kind] for each in (chosen, chosen[::-1]))
    assert one.component.name == other.component.name
    assert one.component.name.endswith(f" with {around}")


def test_a_modulation_says_that_there_is_no_controller_to_modulate() -> None:
    assert EFFECTS["modulation"].hindrance(Belief({})) == "no controller is believed"


def test_a_block_that_was_not_believed_takes_its_place_in_the_chain() -> None:
    short = Belief({kind: choice for kind, choice in belief(IDEAL).blocks.items() if kind == "controller"})
    for name, values in {"let-by": {"fraction": 0.1}, "sensor-bias": {"bias_K": 1.0}}.items():
        short = with_effect(name, short, **values)
    assert list(short.blocks) == [kind for kind in CHAIN if kind in short.blocks] == ["sensor", "controller", "valve"]
