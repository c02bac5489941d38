"""Claims about marks and figures, on truths and answers whose right figures can be told by hand."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from waxstudy.blind_test.answer import Answer, NoAnswer
from waxstudy.blind_test.figures import median, share
from waxstudy.blind_test.goals import described_goals
from waxstudy.blind_test.marks import Mark, TrueCause, Truth
from waxstudy.blind_test.score import figures, posteriors, scored

STAGE = {
    "let-by": "valve",
    "stuck-open": "valve",
    "low-authority": "valve",
    "sensor-bias": "sensor",
    "max-flow": "valve",
}


def cause(
    name: str, *alike: str, over: float = 5.0, family: bool = False, stages: str = "", **values: float
) -> TrueCause:
    places = frozenset(stages.split()) or frozenset({STAGE.get(name, "valve")})
    return TrueCause(name, places, family, values, over, over, frozenset(alike))


def truth(*causes: TrueCause, kind: str = "", departs: str = "", **changes: Any) -> Truth:
    kinds = {0: "null", 1: "family" if causes and causes[0].is_family else "single", 2: "pair"}
    about: dict[str, Any] = {
        "channels": "all",
        "noise_factor": 1.0,
        "interval_s": 60.0,
        "days": 14,
        "is_measured": False,
    }
    return Truth(
        name=changes.pop("name", "x"),
        stratum="goal",
        kind=kind or kinds[len(causes)],
        engine="fast-room",
        causes=causes,
        departs=frozenset(departs.split()),
        **{**about, **changes},
    )


def effect(*group: str, stage: str = "", **parameters: tuple[float, float, float]) -> dict[str, Any]:
    said = {name: dict(zip(("value", "low", "high"), v, strict=True)) for name, v in parameters.items()}
    return {"name": group[0], "stage": stage or STAGE[group[0]], "group": list(group), "parameters": said}


def mark(true: Truth, *effects: dict[str, Any], unexplained: str = "", verdict: str = "") -> Mark:
    verdict = verdict or ("effect" if effects else ("unknown" if unexplained else "none"))
    open_ = [{"stage": stage} for stage in unexplained.split()]
    return Mark(true, Answer.read({"verdict": verdict, "effects": list(effects), "unexplained": open_}))


LET_BY = cause("let-by", "stuck-open")
ALONE = cause("let-by")


@pytest.mark.parametrize(("true", "is_covered"), [(-12.0, True), (12.0, True), (11.0, False)])
def test_twelve_hours_later_is_twelve_hours_earlier(true: float, is_covered: bool) -> None:
    shifted = cause("gain-shift", shift_h=true)
    shift = effect("gain-shift", stage="room", shift_h=(11.95, 11.8, 12.0))
    ((_, near, (_, low, high)),) = mark(truth(shifted), shift).parameters
    assert (low <= near <= high) is is_covered


def test_a_group_is_right_if_it_holds_the_truth_and_nothing_outside_its_class() -> None:
    assert mark(truth(LET_BY), effect("stuck-open", "let-by")).right_group
    assert mark(truth(LET_BY), effect("let-by")).right_group
    assert not mark(truth(ALONE), effect("let-by", "stuck-open")).right_group
    assert not mark(truth(LET_BY), effect("stuck-open")).right_group
    assert not mark(truth(LET_BY), effect("let-by"), effect("sensor-bias")).right_group
    assert not mark(truth(LET_BY)).right_group


def test_of_houses_as_built_the_room_and_the_chain_before_it_have_goals_of_their_own() -> None:
    floor = cause("floor-cover", stages="emitter")
    named, missed = (
        mark(truth(floor, has_baseline=True), effect("floor-cover", stage="emitter")),
        mark(truth(floor, has_baseline=True)),
    )
    chain = mark(truth(ALONE, has_baseline=True), effect("let-by"))
    told = {
        goal["name"]: goal
        for goal in described_goals([named, missed, chain], [], {})
        if goal["where"].startswith("as built")
    }
    counts = {
        name: (told[name]["count"], told[name]["of"], told[name]["met"])
        for name in told
        if name.startswith("right group")
    }
    assert counts == {
        "right group": (2, 3, None),
        "right group, room and emitter": (1, 2, False),
        "right group, sensor to valve": (1, 1, True),
    }


def test_top_1_is_the_truth_named_alone() -> None:
    assert mark(truth(ALONE), effect("let-by")).top_1
    assert not mark(truth(LET_BY), effect("let-by", "stuck-open")).top_1
    assert mark(truth(ALONE), effect("let-by")).is_nameable
    assert not mark(truth(LET_BY), effect("let-by")).is_nameable


def test_to_name_one_where_nobody_could_is_an_over_claim() -> None:
    assert mark(truth(LET_BY), effect("let-by")).over_claim
    assert not mark(truth(LET_BY), effect("let-by", "stuck-open")).over_claim
    assert not mark(truth(ALONE), effect("let-by")).over_claim


def test_a_stage_is_right_by_claims_else_by_what_stays_open() -> None:
    assert mark(truth(ALONE), effect("low-authority")).right_stage
    assert mark(truth(ALONE), unexplained="actuator+valve").right_stage
    assert not mark(truth(ALONE), unexplained="valve sensor").right_stage
    assert not mark(truth(ALONE), effect("sensor-bias"), unexplained="valve").right_stage


def test_a_claim_on_a_null_is_a_false_alarm_and_elsewhere_a_misdiagnosis() -> None:
    assert mark(truth(), effect("let-by")).false_alarm
    assert not mark(truth(), effect("let-by")).misdiagnosis
    assert mark(truth(ALONE), effect("sensor-bias")).misdiagnosis
    assert not mark(truth(LET_BY), effect("stuck-open")).misdiagnosis
    assert not mark(truth(ALONE)).misdiagnosis


def test_something_outside_the_library_is_to_stay_open_at_its_stage() -> None:
    sticking = truth(cause("sticking-valve", family=True, stages="valve actuator"))
    assert mark(sticking, unexplained="valve").unknown_found
    assert not mark(sticking, unexplained="room").unknown_found
    assert not mark(sticking, effect("let-by"), unexplained="valve").unknown_found
    assert not mark(sticking).unknown_found
    explained = truth(cause("sticking-valve", "low-authority", family=True))
    assert mark(explained, effect("low-authority")).unknown_found


def test_with_the_true_effect_left_out_the_honest_answer_is_open_or_of_its_class() -> None:
    assert mark(truth(LET_BY), effect("stuck-open")).left_out_honestly
    assert mark(truth(LET_BY), unexplained="valve").left_out_honestly
    assert not mark(truth(LET_BY), effect("max-flow")).left_out_honestly
    assert not mark(truth(LET_BY)).left_out_honestly


def test_both_of_two_are_found_in_groups_of_their_own() -> None:
    both = truth(ALONE, cause("sensor-bias"))
    assert mark(both, effect("let-by"), effect("sensor-bias")).right_group
    assert not mark(both, effect("let-by")).right_group
    assert not mark(both, effect("let-by"), effect("sensor-bias"), effect("max-flow")).right_group


def test_findings_where_the_model_differs_in_form_are_counted_apart() -> None:
    null = mark(truth(departs="valve room"), effect("low-authority"), unexplained="room")
    assert not null.false_alarm
    assert not null.unknown_claimed
    assert null.has_apart
    assert mark(truth(departs="valve"), effect("sensor-bias")).false_alarm
    slow = effect("slow-actuator", stage="actuator")
    assert mark(truth(ALONE, departs="valve actuator"), effect("let-by"), slow).right_group


def test_who_saw_a_healthy_record_is_not_excused_by_the_model_s_form() -> None:
    named = mark(truth(departs="valve room", has_baseline=True), effect("low-authority"), unexplained="room")
    assert not named.false_alarm
    seen = replace(named, saw_baseline=True)
    assert (seen.false_alarm, seen.has_apart) == (True, False)


def test_a_wrong_name_at_the_cause_s_own_stage_is_wrong_whatever_the_model_s_form() -> None:
    named = mark(truth(ALONE, departs="valve"), effect("low-authority"))
    assert named.misdiagnosis
    assert not mark(truth(ALONE, departs="valve"), effect("let-by"), effect("low-authority")).right_group


def test_to_name_every_effect_where_the_model_differs_in_form_is_worth_nothing() -> None:
    everything = [effect(name) for name in STAGE]
    places = "valve sensor room"
    assert mark(truth(departs=places), *everything, unexplained=places).false_alarm
    listed = mark(truth(ALONE, departs=places), *everything, unexplained=places)
    assert (listed.right_group, listed.top_1, listed.misdiagnosis) == (False, False, True)


def test_a_bare_unknown_is_a_claim_of_something_unknown() -> None:
    assert mark(truth(), verdict="unknown").unknown_claimed
    assert mark(truth(departs="room"), verdict="unknown").unknown_claimed
    assert not mark(truth(departs="room"), unexplained="room").unknown_claimed


def test_a_measured_house_may_be_untestable() -> None:
    bias = truth(cause("sensor-bias"), is_measured=True)
    said = {"verdict": "none", "untestable": [{"name": "sensor-bias", "reason": "no channel"}]}
    assert Mark(bias, Answer.read(said)).right_or_untestable
    assert not mark(bias).right_or_untestable
    assert not Mark(bias, Answer.failed()).right_or_untestable


def test_a_model_s_form_alone_is_no_finding() -> None:
    said = {"verdict": "none", "unexplained": [{"stage": "room", "is_room_form": True}]}
    assert Answer.read(said).open_stages == ()


@pytest.mark.parametrize(
    "said",
    [None, [], {}, {"verdict": "maybe"}, {"verdict": "effect", "effects": [{}]}, {"verdict": "none", "effects": 3}],
)
def test_what_is_no_diagnosis_is_refused(said: Any) -> None:
    with pytest.raises(NoAnswer):
        Answer.read(said)


def test_figures_are_what_can_be_counted_by_hand() -> None:
    """Four singles: one right with its value in the interval, one with two names, one missed, one wrong; two nulls."""
    value = truth(cause("let-by", fraction=0.02), name="a")
    own = [
        mark(value, effect("let-by", fraction=(0.021, 0.019, 0.023))),
        mark(truth(LET_BY), effect("stuck-open", "let-by")),
        mark(truth(ALONE)),
        mark(truth(ALONE), effect("sensor-bias")),
        mark(truth()),
        mark(truth(), unexplained="valve"),
    ]
    told = figures(own)
    assert (told["right_group"].count, told["right_group"].of) == (2, 4)
    assert (told["top_1"].count, told["top_1"].of) == (1, 3)
    assert (told["stage"].count, told["stage"].of) == (2, 4)
    assert (told["detection"].count, told["detection"].of) == (3, 4)
    assert (told["misdiagnosis"].count, told["misdiagnosis"].of) == (1, 4)
    assert (told["false_alarm"].count, told["false_alarm"].of) == (0, 2)
    assert (told["unknown_claimed"].count, told["unknown_claimed"].of) == (1, 6)
    assert told["group_size"].value == 1.5
    assert (told["coverage"].count, told["coverage"].of) == (1, 1)
    assert told["parameter_error"].value == pytest.approx(0.05)
    assert told["both"].of == 0
    goals = {(goal["name"], goal["where"]): goal for goal in scored(own, 6, [], {})["goals"]}
    assert goals["right group", "fast room"]["value"] == 0.5
    assert goals["right group", "fast room"]["met"] is False
    assert goals["right group", "other physics"]["value"] is None
    assert goals["false alarms on nulls", "fast room"]["met"] is True


def test_goals_take_full_channels_nominal_noise_and_gaps_above_twice_the_floor() -> None:
    small = cause("let-by", over=1.9)
    others = [truth(small), truth(ALONE, channels="no flow"), truth(ALONE, noise_factor=2.0)]
    own = [mark(truth(ALONE), effect("let-by")), *(mark(each) for each in others)]
    goals = {(goal["name"], goal["where"]): goal for goal in scored(own, 4, [], {})["goals"]}
    assert (goals["right group", "fast room"]["count"], goals["right group", "fast room"]["of"]) == (1, 1)


def test_temperatures_only_count_with_up_to_twice_the_nominal_noise() -> None:
    noises = [truth(ALONE, channels="temperatures only", noise_factor=factor) for factor in (0.5, 1.9, 2.1)]
    goals = {
        (goal["name"], goal["where"]): goal for goal in scored([mark(each) for each in noises], 3, [], {})["goals"]
    }
    assert goals["temperatures only: right group", "fast room"]["of"] == 2


def test_failures_are_listed_with_their_truth() -> None:
    own = [mark(truth(cause("let-by", fraction=0.02), name="a"), effect("sensor-bias")), mark(truth(name="b"))]
    (failure,) = scored(own, 2, [], {})["failures"]
    assert (failure["record"], failure["truth"], failure["said"]) == ("a", "let-by", "sensor-bias")
    assert failure["values"] == {"let-by": {"fraction": 0.02}}


def test_shares_have_wilson_s_interval_and_medians_one_of_cases_drawn_again() -> None:
    """Wilson 1927 for 45 of 50: 0.786 to 0.957."""
    figure = share([True] * 45 + [False] * 5)
    assert figure.low == pytest.approx(0.786, abs=0.001)
    assert figure.high == pytest.approx(0.957, abs=0.001)
    middle = median([float(n) for n in range(101)])
    assert middle.value == 50.0
    assert middle.low is not None
    assert middle.high is not None
    assert 35.0 < middle.low < 50.0 < middle.high < 65.0


# --- probabilities and hours ------------------------------------------------------------------------


def believing(true: Truth, **posterior: float) -> Mark:
    said = {"verdict": "none", "posterior": {name.replace("_", "-"): value for name, value in posterior.items()}}
    return Mark(true, Answer.read(said))


def test_a_brier_score_is_of_all_hypotheses_that_of_the_truth_among_them() -> None:
    assert believing(truth(), none=1.0).brier == 0.0
    assert believing(truth(ALONE), none=1.0).brier == 2.0
    half = believing(truth(ALONE), let_by=0.5, none=0.25, unknown=0.25)
    assert half.brier == pytest.approx(0.25 + 2 * 0.0625)
    assert half.log_score == pytest.approx(math.log(2.0))
    assert believing(truth(ALONE), none=1.0).log_score == pytest.approx(math.log(1e4))
    assert mark(truth(ALONE)).brier is None


def test_names_that_are_counted_apart_do_not_count_in_hypotheses_either() -> None:
    """A motor of another form than believed is slow in its way; a second name there, or a baseline, excuses nothing."""
    plant = truth(ALONE, departs="actuator room")
    assert believing(plant, **{"let-by+slow-actuator": 0.7, "let-by+slow-actuator+thermal-mass": 0.3}).brier == 0.0
    assert believing(plant, **{"let-by+sensor-bias": 1.0}).brier == 2.0
    assert believing(plant, **{"constant-times+let-by+slow-actuator": 1.0}).brier == 2.0
    healthy = truth(departs="actuator room")
    assert believing(healthy, slow_actuator=0.8, none=0.2).stated == [(1.0, True)]
    assert replace(believing(healthy, slow_actuator=0.8, none=0.2), saw_baseline=True).stated == [
        (0.8, False),
        (0.2, True),
    ]
    assert believing(truth(cause("slow-actuator"), departs="actuator"), slow_actuator=1.0).brier == 0.0


def test_something_unknown_does_not_count_in_hypotheses_where_all_that_is_open_is_counted_apart() -> None:
    def said(stage: str) -> Mark:
        unexplained = [{"stage": stage}] if stage else []
        told = {"verdict": "unknown", "unexplained": unexplained, "posterior": {"unknown": 0.9, "none": 0.1}}
        return Mark(truth(departs="valve room"), Answer.read(told))

    assert [said(stage).brier for stage in ("valve", "sensor", "")] == pytest.approx([0.0, 1.62, 1.62])


def test_a_failure_costs_what_knowing_nothing_costs_and_is_no_silent_null() -> None:
    failed = Mark(truth(), Answer.failed())
    found = figures([believing(truth(), none=1.0), failed])
    assert found["brier"].value == 0.5
    assert found["log_score"].value == pytest.approx(0.5 * math.log(1e4))
    assert found["false_alarm"].of == 1
    assert posteriors([believing(truth(), none=1.0), failed])["fast room"]["failed"] == 1
    assert figures([mark(truth()), failed])["brier"].value is None  # of one who never states any


def test_who_fails_makes_no_wrong_claims_and_gets_no_credit_for_that() -> None:
    own = [Mark(true, Answer.failed()) for true in (truth(), truth(ALONE), truth(LET_BY, ALONE))]
    found = figures([*own, mark(truth(LET_BY), effect("let-by"))])
    wrong = [found[name] for name in ("misdiagnosis", "over_claim", "unknown_claimed")]
    assert [(each.count, each.of) for each in wrong] == [(0, 1), (1, 1), (0, 1)]
    goals = {(goal["name"], goal["where"]): goal for goal in scored(own, 3, [], {})["goals"]}
    assert [goals[name, "fast room"]["of"] for name in ("misdiagnosis", "unknown falsely claimed")] == [0, 0]
    assert goals["right group", "fast room"]["of"] == 1


def test_an_hour_of_the_day_is_missed_by_hours_and_by_no_share_of_it() -> None:
    late = truth(cause("window-opening", from_h=22.0, flow_L_s=10.0))
    said = effect("window-opening", stage="room", from_h=(19.0, 18.0, 20.0), flow_L_s=(12.0, 9.0, 15.0))
    own = [mark(late, said)]
    assert figures(own)["parameter_error"].value == pytest.approx(0.2)
    told = scored(own, 1, [], {})["parameters"]
    assert told["window-opening.from_h"]["error"]["value"] is None
    assert told["window-opening.from_h"]["coverage"]["value"] == 0.0


def test_hypotheses_are_names_joined_in_any_order_and_a_family_is_unknown() -> None:
    two = truth(ALONE, cause("sensor-bias"))
    for spelling in ("let-by+sensor-bias", "sensor-bias+let-by"):
        assert Mark(two, Answer.read({"verdict": "none", "posterior": {spelling: 1.0}})).brier == 0.0
    assert believing(truth(cause("stove", family=True)), unknown=1.0).brier == 0.0
    mixed = truth(ALONE, cause("stove", family=True))
    assert Mark(mixed, Answer.read({"verdict": "none", "posterior": {"let-by+unknown": 1.0}})).brier == 0.0


@pytest.mark.parametrize("posterior", [{"none": 0.5}, {"none": 1.5, "unknown": -0.5}, ["none"], {"none": "much"}])
def test_probabilities_that_are_none_are_told(posterior: Any) -> None:
    with pytest.raises(NoAnswer, match="posterior"):
        Answer.read({"verdict": "none", "posterior": posterior})


def test_stated_probabilities_stand_in_five_bins_beside_what_was_true() -> None:
    (found,) = posteriors([believing(truth(), none=0.9, unknown=0.1), believing(truth(ALONE), none=1.0)]).values()
    assert [each["count"] for each in found["every"]] == [1, 0, 0, 0, 2]
    assert found["every"][4]["stated"] == pytest.approx(0.95)
    assert (found["every"][4]["true"]["value"], found["every"][0]["true"]["value"]) == (0.5, 0.0)
    assert [each["count"] for each in found["first"]] == [0, 0, 0, 0, 2]
    assert posteriors([mark(truth())]) == {}


def acting(name: str, *spans: tuple[float, float], **how: Any) -> TrueCause:
    return replace(cause(name, **how), when=spans)


def test_hours_that_are_told_are_held_against_those_in_which_a_cause_acts() -> None:
    opened = truth(acting("window-opening", (7.0, 9.0), (31.0, 33.0), stages="room"))
    said = effect("window-opening", stage="room")

    def found(**when: Any) -> Any:
        return mark(opened, {**said, **when}).overlaps

    assert found(when={"spans_h": [[7.0, 9.0], [31.0, 33.0]]}) == [(True, 1.0)]
    assert found(when={"spans_h": [[7.0, 8.0]]}) == [(True, 0.25)]
    assert found(when={"spans_h": []}) == [(True, 0.0)]
    assert found() == found(when=None) == []
    assert mark(opened, {**effect("let-by"), "when": {"spans_h": [[7.0, 9.0]]}}).overlaps == []
    always = truth(acting("let-by", (0.0, 336.0)))
    assert mark(always, {**effect("let-by"), "when": {"spans_h": [[0.0, 168.0]]}}).overlaps == [(False, 0.5)]
    stove = truth(acting("stove", (18.0, 22.0), family=True, stages="room emitter"))
    assert mark(stove, {**effect("extra", stage="room"), "when": {"spans_h": [[18.0, 21.0]]}}).overlaps == [
        (True, 0.75)
    ]


@pytest.mark.parametrize("spans", [[[2.0, 1.0]], [[0.0, 2.0], [1.0, 3.0]], [1.0], [[0.0, float("nan")]]])
def test_hours_that_are_none_are_told(spans: Any) -> None:
    with pytest.raises(NoAnswer, match="cannot be read"):
        Answer.read({"verdict": "effect", "effects": [{**effect("let-by"), "when": {"spans_h": spans}}]})
