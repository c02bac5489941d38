"""A ladder's steps as edits: which may change places, and which case each set of them makes."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path

import pytest

from tests.conftest import ROOT
from waxstudy.plugin.registry import installed
from waxstudy.report.attribution.subsets import CannotAttribute, Subsets, ladder_edits, made_by, needs, subsets
from waxstudy.study.model import Study
from waxstudy.study.read import read_study

HEAD = """
[study]
name = "steps"
[room]
use = "nzeb"
[weather.january]
use = "tallinn-week"
month = "january"
[ladder.one]
reference = "start"
start = { id = "start", controller = { use = "on-off", dead_band_K = 2.0 }, valve = { use = "linear" } }
steps = [
"""


def study_of(tmp_path: Path, *steps: str) -> Study:
    file = tmp_path / "study.toml"
    file.write_text(HEAD + "".join(f"  {{ id = 's{n}', {step} }},\n" for n, step in enumerate(steps)) + "]\n")
    return read_study(file, installed())


def found(study: Study) -> Subsets:
    return subsets(study, study.ladders["one"])


def needed(study: Study) -> list[set[int]]:
    return [set(before) for before in needs(ladder_edits(study, study.ladders["one"]))]


QUICK = 'valve = { use = "quick-opening" }'
AUTHORITY = "valve = { authority = 0.5 }"
H_MID = "valve = { h_mid = 0.3 }"
DELAY = 'sensor = { use = "delay", delay_s = 60.0 }'
PRECISE = "controller = { dead_band_K = 0.5 }"


def test_every_set_of_the_paper_s_steps_makes_sense() -> None:
    study = read_study(ROOT / "studies" / "table5.toml", installed())
    on_off, pi = (subsets(study, ladder) for ladder in study.ladders.values())
    assert (len(on_off.case), len(on_off.new)) == (16, 11)
    assert (len(pi.case), len(pi.new)) == (32, 26)
    assert not on_off.refused
    assert not pi.refused
    assert [set(edit) for edit in pi.edits] == [{"controller"}, {"sensor"}, {"valve"}, {"modulator"}, {"actuator"}]
    assert pi.edits[0] == {"controller": {"gain": 18.0, "integration_time_s": 2300.0}}


def test_the_sets_that_the_ladder_goes_through_are_its_own_cases() -> None:
    study = read_study(ROOT / "studies" / "table5.toml", installed())
    for ladder in study.ladders.values():
        of = subsets(study, ladder)
        assert [of.case[chosen] for chosen in of.prefixes] == list(ladder.cases)


def test_a_set_s_case_has_its_steps_and_no_others() -> None:
    study = read_study(ROOT / "studies" / "table5.toml", installed())
    of = subsets(study, study.ladders["on-off"])
    id = of.case[frozenset({1, 3})]
    assert id == "on-off.0101"
    blocks, whole = of.new[id].blocks, study.cases["O_WM"].blocks
    assert {kind: blocks[kind] for kind in ("sensor", "actuator")} == {k: whole[k] for k in ("sensor", "actuator")}
    assert {kind: blocks[kind] for kind in ("controller", "valve")} == dict(study.cases["O_0"].blocks)


@pytest.mark.parametrize(
    ("steps", "expected"),
    [
        ([QUICK, AUTHORITY], [set(), {0}]),
        ([QUICK, DELAY, AUTHORITY], [set(), set(), {0}]),
        ([QUICK, AUTHORITY, H_MID], [set(), {0}, {0}]),
        ([QUICK, AUTHORITY, "valve = { authority = 0.7 }"], [set(), {0}, {0, 1}]),
        ([QUICK, AUTHORITY, 'valve = { use = "linear" }'], [set(), {0}, {0, 1}]),
        ([PRECISE, DELAY], [set(), set()]),
        ([PRECISE, 'controller = { use = "pi" }'], [set(), {0}]),
        ([DELAY, 'sensor = { use = "delay", delay_s = 120.0 }'], [set(), {0}]),
        ([QUICK, 'valve = { use = "quick-opening" }, sensor = { use = "ideal" }'], [set(), set()]),
    ],
)
def test_a_step_stays_after_those_whose_block_it_changes(
    tmp_path: Path, steps: list[str], expected: list[set[int]]
) -> None:
    assert needed(study_of(tmp_path, *steps)) == expected


def test_whatever_the_order_in_which_a_set_s_steps_are_taken_its_case_is_the_same(tmp_path: Path) -> None:
    study = study_of(tmp_path, PRECISE, QUICK, DELAY, AUTHORITY, H_MID)
    ladder, edits = study.ladders["one"], ladder_edits(study, study.ladders["one"])
    before, kept = needs(edits), 0
    for order in permutations(range(len(edits))):
        if all(before[step] <= set(order[: order.index(step)]) for step in order):
            case, problems = made_by(study, ladder, (edits[step] for step in order))
            assert not problems
            assert case.described() | {"id": ""} == study.cases["s4"].described() | {"id": ""}
            kept += 1
    assert kept == 40  # of 120: the valve's choice before both of its parameters


def test_a_step_that_changes_nothing_makes_no_case_of_its_own(tmp_path: Path) -> None:
    of = found(study_of(tmp_path, DELAY, "controller = { dead_band_K = 2.0 }", PRECISE))
    assert of.edits[1] == {}
    assert len(of.case) == 8
    assert all(of.case[chosen] == of.case[chosen - {1}] for chosen in of.case)
    assert len(of.new) == 1  # only the precise controller without the delay


def test_a_set_that_a_component_refuses_is_left_out_and_told(tmp_path: Path) -> None:
    motor = 'actuator = { use = "variable-times", product = "B" }'
    of = found(study_of(tmp_path, motor, "actuator = { dead_b_s = 600.0 }", "actuator = { dead_a_s = -500.0 }"))
    assert of.refused.keys() == {frozenset({0, 2})}
    assert "must not be negative" in of.refused[frozenset({0, 2})]
    assert frozenset({0, 1, 2}) in of.case


def test_an_id_of_the_user_s_is_never_taken(tmp_path: Path) -> None:
    study = study_of(tmp_path, DELAY, PRECISE)
    file = tmp_path / "study.toml"
    file.write_text(file.read_text().replace("'s0'", "'one.01'"))
    study = read_study(file, installed())
    of = found(study)
    assert of.new.keys() & study.cases.keys() == set()
    assert len(of.new) == 1


def test_a_ladder_of_too_many_steps_is_refused_by_name(tmp_path: Path) -> None:
    study = study_of(tmp_path, *(f"sensor = {{ use = 'delay', delay_s = {n + 1}.0 }}" for n in range(13)))
    with pytest.raises(CannotAttribute, match="ladder 'one' has over 12 steps"):
        found(study)
