"""Claims about the records that the diagnosis is held against on itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.self_consistency_outcome import Size, datasets
from benchmarks.self_consistency_records import NULL_CASES, SEVERITIES, TABLE, Made, nulls, study, with_effect
from waxstudy.diagnosis.diagnose import installed_effects
from waxstudy.plugin import Belief, Choice, Inputs
from waxstudy.synthetic.effects import applied

DAY = np.full(1440, 20.0)


def inputs() -> Inputs:
    return Inputs(60.0, 0.0, DAY - 25.0, DAY + 10.0, DAY, DAY, DAY, flow_L_h=DAY)


def test_every_effect_of_the_library_is_there_in_three_severities() -> None:
    ours = [effect.name for effect in installed_effects() if effect.__module__.startswith("waxstudy_effects")]
    assert sorted(TABLE) == sorted(ours)
    assert len(with_effect(SEVERITIES)) == 3 * len(ours)
    assert {made.severity for made in with_effect(["clear"])} == {"clear"}


@pytest.mark.parametrize("made", with_effect(SEVERITIES), ids=lambda made: made.name)
def test_each_applies_to_its_case_and_a_fit_would_look_for_it_there(made: Made) -> None:
    case, (chosen,) = study().cases[made.case], made.effects
    assert isinstance(chosen, Choice)
    effect = next(each for each in installed_effects() if each.name == made.effect)
    assert applied([chosen], Belief(case.blocks, study().room, inputs()))
    assert all(effect.priors[name].low <= value <= effect.priors[name].high for name, value in made.values.items())
    assert set(made.values) == set(effect.priors)


def test_nulls_take_cases_weeks_and_setpoints_in_turn_with_noise_of_their_own() -> None:
    made = nulls(200)
    assert len({each.seed for each in made}) == 200
    assert {each.case for each in made} == set(NULL_CASES)
    assert len({tuple(each.weeks) for each in made}) == 4
    assert len({each.shift_K for each in made}) == 3
    assert not any(each.effects for each in made)


def test_a_true_gap_stands_beside_what_the_truth_misses_of_the_noisy_record() -> None:
    """A leak of 1.5 % at the authority of the case is 4.8 % of 125.6 L/h, and the valve is closed most of the time."""
    made = replace(next(each for each in with_effect(["clear"]) if each.effect == "let-by"), weeks=("january",))
    size = Size.of(made.effects, *datasets(made))
    assert size.channel == "flow_L_h"
    assert 4.0 < size.gap < 6.1
    assert 0.5 < size.floor < 1.5
    assert size.beyond == pytest.approx(size.gap / size.floor)
    assert not size.tells_apart("stuck-open")  # both are the least that flows
    assert size.tells_apart("low-authority")
    assert size.tells_apart("infiltration")
