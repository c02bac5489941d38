"""The steps of a study's ladder are effects without parameters."""

from __future__ import annotations

import pytest

from tests.diagnosis.realities import dataset, rows, study
from waxstudy.diagnosis.diagnose import diagnose
from waxstudy.diagnosis.ladder_effects import ladder_effects
from waxstudy.plugin import Belief

STEPS = {effect.name: effect for effect in ladder_effects(study())}


def belief(case: str) -> Belief:
    return Belief(study().cases[case].blocks, study().room)


def test_each_step_is_an_effect_named_by_its_case():
    assert list(STEPS) == ["LATE", "WAX", "REAL", "PWM"]


@pytest.mark.parametrize(("step", "before"), [("LATE", "IDEAL"), ("REAL", "WAX"), ("PWM", "PI")])
def test_a_step_makes_its_case_of_the_case_before(step: str, before: str):
    effect = STEPS[step]
    assert dict(effect.apply(belief(before), effect.Parameters()).blocks) == dict(study().cases[step].blocks)


@pytest.mark.parametrize("step", STEPS)
def test_a_step_does_not_apply_where_its_blocks_are_believed(step: str):
    assert "believed already" in STEPS[step].hindrance(belief(step))


def test_a_sentence_says_the_case_and_its_blocks():
    said = STEPS["LATE"].sentence(STEPS["LATE"].Parameters())
    assert said == "The loop is as in case LATE: sensor 'delay' (delay_s = 600.0)."


@pytest.mark.slow
def test_a_missing_step_is_found_or_shares_a_group_with_the_effect_that_is_the_same():
    found = diagnose(dataset(rows("LATE", days=7), "IDEAL"), study=study(), quick=True).effects
    assert [effect.stage for effect in found] == ["sensor"]
    assert {"LATE", "sensor-delay"} & set(found[0].group)
