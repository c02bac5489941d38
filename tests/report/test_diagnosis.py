"""A diagnosis as people read it: every verdict says what it found, and every figure of it can be traced."""

from __future__ import annotations

import doctest
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.conftest import ROOT
from tests.report.diagnoses import (
    ALL,
    CHANGED,
    EFFECT,
    GROUP,
    LACKING_HEAT,
    LET_BY,
    MOTOR_FOUND,
    NONE,
    PIECES_W,
    ROOM,
    STUCK,
    TOGETHER,
    UNKNOWN,
    UNTESTABLE,
    VALVE,
)
from tests.report.test_page import Page, needs_browser, scroll_width
from waxstudy.diagnosis.result import Diagnosis, Interval, Lack, Measurement, Tried, Untestable, When
from waxstudy.diagnosis.sentences import group_sentence
from waxstudy.report.diagnosis import words
from waxstudy.report.diagnosis.figures.missing_heat import figure_missing_heat
from waxstudy.report.diagnosis.figures.ranking import figure_ranking
from waxstudy.report.diagnosis.figures.switchings import figure_switchings
from waxstudy.report.diagnosis.figures.traces import course
from waxstudy.report.diagnosis.figures.waterfall import figure_waterfall
from waxstudy.report.diagnosis.focus import by_day, main_stages, shown_days
from waxstudy.report.diagnosis.page import as_html
from waxstudy.report.diagnosis.summary import VERDICTS as VERDICT_WORDS
from waxstudy.report.diagnosis.summary import as_terminal, how_sure, impact_words, lines
from waxstudy.report.figures.plot import Lacking
from waxstudy.results.json_text import json_text

VERDICTS = pytest.mark.parametrize("diagnosis", ALL.values(), ids=ALL)
FIGURE = re.compile(r"(?<![\w.-])[-+]?\d+(?:\.\d+)?(?![\w.]|-\d)")
COUNTED = re.compile(r"\d+ (?:more|other) ?|(?:below 1|over 99) %")  # how many of a list are not shown, and bounds
COLOURS = re.compile(r"\x1b\[[0-9;]*m")


def texts(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from (key, *texts(item))
    elif isinstance(value, list | tuple):
        for item in value:
            yield from texts(item)
    elif isinstance(value, str):
        yield value


def figures(value: Any) -> Iterator[float]:
    """Every number, and how many entries every list and table has."""
    if isinstance(value, dict | list | tuple):
        yield float(len(value))
        for item in value.values() if isinstance(value, dict) else value:
            yield from figures(item)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield float(value)


def is_traced(token: str, data: Any) -> bool:
    """Whether a printed figure is one of the JSON, rounded as it is printed; a share may be in per cent."""
    places = len(token.partition(".")[2])
    half = 0.5 * 10.0**-places * 1.0001
    return any(abs(float(token) - value) <= half for v in figures(data) for value in (v, 100.0 * v))


def described(diagnosis: Diagnosis) -> Any:
    return json.loads(json_text(diagnosis.described()))


def untraced(text: str, data: Any) -> list[str]:
    """Return the figures of a text that its JSON does not hold."""
    told = {token for sentence in texts(data) for token in FIGURE.findall(sentence)}
    counted = COUNTED.sub("", text)
    return [token for token in FIGURE.findall(counted) if token not in told and not is_traced(token, data)]


drawn: dict[int, str] = {}


def page_of(diagnosis: Diagnosis) -> str:
    """The page of one of the diagnoses of these tests, drawn once: they never change, and it takes a second."""
    if id(diagnosis) not in drawn:
        drawn[id(diagnosis)] = as_html(diagnosis)
    return drawn[id(diagnosis)]


def page_text(text: str) -> str:
    """The words of the page but for the last section, which explains it and has figures of its own."""
    words = " ".join(Page(text[: text.index('<section id="reading">')] + "</main></body></html>").words)
    return re.sub(r"with 95 % intervals|and 95 % interval", "", words)


@VERDICTS
def test_every_figure_of_the_summary_is_in_the_json(diagnosis: Diagnosis) -> None:
    text = as_terminal(diagnosis, 120, colour=False)
    assert len(FIGURE.findall(text)) > 1
    assert untraced(text, described(diagnosis)) == []


@VERDICTS
def test_every_figure_of_the_page_is_in_the_json(diagnosis: Diagnosis) -> None:
    text = page_text(page_of(diagnosis))
    assert len(FIGURE.findall(text)) > 3
    assert untraced(text, described(diagnosis)) == []


def test_a_figure_that_is_not_in_the_json_would_be_noticed() -> None:
    assert untraced("off by 5.23 L/h, of 5.24 and 93 %", described(EFFECT)) == ["5.24"]


@VERDICTS
def test_the_json_is_strict_and_says_everything_but_the_traces(diagnosis: Diagnosis) -> None:
    data = json.loads(json_text(diagnosis.described()), parse_constant=lambda word: pytest.fail(word))
    assert set(data) == set(vars(diagnosis)) - {"traces"}
    assert data["verdict"] == diagnosis.verdict
    assert [stage["over_floor"] for stage in data["stages"]] == [stage.over_floor for stage in diagnosis.stages]


def test_an_interval_that_nobody_knows_is_null_in_the_json_and_left_out_in_words() -> None:
    data = json.loads(json_text(GROUP.described()))
    hold = data["effects"][1]["parameters"]["hold_time_s"]
    assert hold == {"value": 62.0, "low": None, "high": None}
    assert "hold time 62 s, fall time 388 s (341 to 431)" in flat(GROUP)


# --- the summary -------------------------------------------------------------------------------------


def flat(diagnosis: Diagnosis) -> str:
    return " ".join(as_terminal(diagnosis, 120, colour=False).split())


@VERDICTS
def test_the_summary_takes_about_ten_lines_within_the_terminal(diagnosis: Diagnosis) -> None:
    shown = as_terminal(diagnosis, 120, colour=False).splitlines()
    more = 4 if diagnosis.posterior else 0  # what it was compared with, what was so from the start, what else is likely
    assert len(lines(diagnosis)) <= 10 + 3 * max(0, len(diagnosis.effects) - 1) + more
    assert max(map(len, shown)) <= 120
    narrow = as_terminal(diagnosis, 60, colour=False).splitlines()
    assert max(map(len, narrow)) <= 60
    assert " ".join(" ".join(shown).split()[:20]) in " ".join(" ".join(narrow).split())


@VERDICTS
def test_the_first_two_lines_say_dataset_verdict_and_what_it_means(diagnosis: Diagnosis) -> None:
    first, *rest = as_terminal(diagnosis, 120, colour=False).splitlines()
    assert first.startswith("room-7: ")
    assert " ".join(rest).startswith(diagnosis.summary)


def test_a_found_effect_is_told_with_place_cause_certainty_and_shrinkage() -> None:
    for part in (
        "valve: flow is off by 5.23 L/h, 4.8 times its noise floor; by itself this puts heat off by +6.8 %, air by",
        "2 other channels judged; off by most is air temperature, by 1.2 times its noise floor",
        "let-by: fraction 0.0712 (0.0688 to 0.0741).",
        "Found again in 98 % of resampled records; p = 0.0025.",
        "let-by takes away 93 % (90 to 95) of the gap of flow on held-out days; in all 5.19 → 1.40 L/h, floor 1.08",
        "heat off by -10 → -0.35 %",
        "cycles 5.3 → 4.7 a day (measured 4.6)",
        "displacement 0.0312, floor 0.0118, p = 0.0025; no finding: it is within the believed model's published",
        "closed loop (its controller reacts, so that signs may turn): heat off by",
        "actuator: displacement is off by 0.0312, 2.6 times its noise floor (no finding: see unexplained)",
        "not tested supply-offset, floor-cover: return_temperature_C was not recorded; 2 more for other reasons",
        "return_temperature_C at the circuit; it would settle supply-offset, floor-cover",
        "flow_L_h: 0.3 % of the samples are missing.",
    ):
        assert part in flat(EFFECT)


def test_of_a_gap_that_may_be_noise_it_is_said_that_no_share_can_be_told() -> None:
    effects = [replace(each, shrink=Interval(np.nan, np.nan, np.nan)) for each in EFFECT.effects]
    told = flat(replace(EFFECT, effects=effects))
    noise = "the gap of flow on held-out days may be noise: how much let-by takes away of it cannot be told"
    assert f"{noise}; in all 5.19 → 1.40 L/h, floor 1.08" in told
    assert "nan" not in told


def test_with_a_baseline_it_says_what_changed_since_how_likely_and_when() -> None:
    told = flat(CHANGED)
    assert (
        "compared with room-7-before, 2023-12-01 to 2023-12-14, taken as healthy; its air is followed to 0.175 K"
        in told
    )
    assert "lies on the floor (resistance 0.0181 to 0.0319 m²K/W)." in told
    assert "The controller reads the temperature of 65 s ago." in told
    assert "film-walls" not in told
    assert "let-by: fraction 0.0712 (0.0688 to 0.0741). Probability 73 %; every day from 22:00 to 06:30." in told
    likely = "likely 70 % let-by, 20 % neighbour-heat, 6 % nothing amiss, 3 % let-by and something unknown how far"
    assert likely in told
    assert "something unknown 3 % probable" in told


def test_with_a_baseline_nothing_is_told_by_a_p() -> None:
    assert "p = " not in flat(CHANGED)
    text = page_text(page_of(CHANGED))
    assert "p = " not in text
    assert "found again" not in text


def test_the_page_has_the_baseline_with_its_fit_and_what_was_so_from_the_start() -> None:
    page = Page(page_of(CHANGED))
    rows = [tuple(row) for row in page.texts]
    assert "Baseline" in page.headings
    assert ("air temperature", "0.175 K", "0.80 %", "0.09 %") in rows
    assert ("film-walls", "room", "1.00", "0.542 (0.409 to 0.718)", "factor on films") in rows
    delay = ("sensor-delay delay", "chain", "120 s", "65 s", "The controller reads the temperature of 65 s ago.")
    assert delay in rows
    assert ("let-by and something unknown", "3 %") in rows
    assert "Baseline" not in Page(page_of(EFFECT)).headings


def test_members_of_a_group_are_told_as_such() -> None:
    assert "effects found that this record cannot tell apart" in flat(GROUP)
    assert "let-by: fraction 0.0712 (0.0688 to 0.0741). This record cannot tell it from stuck-open (fitted: " in flat(
        GROUP
    )
    assert "(fitted: opening 0.0321)." in flat(GROUP)
    assert "This record cannot tell it from constant-times." in flat(GROUP)
    assert "let-by or stuck-open" in Page(page_of(GROUP)).headings
    rows = [tuple(row) for row in Page(page_of(GROUP)).texts]
    assert ("stuck-open", "opening", "0.0321") in rows
    assert "only of let-by intervals were looked for" in page_text(page_of(GROUP))


def test_a_probability_of_a_group_is_not_one_of_its_first_member() -> None:
    group = replace(TOGETHER, probability=0.999, when=When("always", ()))
    assert how_sure(group) == "Together over 99 % probable; always."
    assert how_sure(replace(group, group=("let-by",))) == "Probability over 99 %; always."
    shown = as_html(replace(EFFECT, effects=(group,)))
    assert "Together over 99 % probable; always." in page_text(shown)
    assert "over 99 % together" in page_text(shown)


def test_every_member_of_a_group_has_its_say_and_of_a_long_one_the_first_three() -> None:
    (together, _) = GROUP.effects
    both = (
        "Either the closed valve lets 7.1 % of its flow through at the pressure of an open one, or the valve never "
        "closes beyond 3.2 % of its travel."
    )
    assert group_sentence(together) == both
    assert both in page_text(page_of(GROUP))
    more = [replace(STUCK, name=name, sentence=f"PI {name}.") for name in ("b", "c", "d", "e")]
    long = replace(together, group=("let-by", *(each.name for each in more)), alternatives=more)
    assert group_sentence(long).endswith("of an open one, or PI b, or PI c, or one of: d, e.")
    assert group_sentence(replace(long, group=("let-by", "b", "c", "d"))).endswith(", or PI c, or d.")
    assert group_sentence(LET_BY) == LET_BY.sentence


def test_a_quick_look_says_so_before_anything_else_and_where_the_cause_is_told() -> None:
    quick = replace(EFFECT, is_quick=True)
    assert "quick look" not in dict(lines(EFFECT))
    (label, text), *_ = lines(quick)
    assert (label, "not all alternatives were compared" in text) == ("quick look", True)
    assert "compared" not in page_text(page_of(EFFECT))
    cause = as_html(quick).partition('<section id="cause">')[2].partition("</section>")[0]
    assert "Not all alternatives were compared" in cause
    nothing_judged = replace(UNTESTABLE, is_quick=True)
    assert "quick look" not in dict(lines(nothing_judged))
    assert "alternatives were compared" not in page_text(page_of(nothing_judged))


def test_where_nothing_was_tried_a_quick_look_and_likelihoods_are_not_spoken_of() -> None:
    rooms_only = replace(NONE, is_quick=True, tried=(), compared_with="before", posterior={})
    assert not {"quick look", "likely"} & set(dict(lines(rooms_only)))


def test_days_told_by_their_number_have_the_date_of_the_first() -> None:
    on_days = replace(LET_BY, when=When("from day 3 on", [(48.0, 240.0)]))
    traces = EFFECT.traces.set_axis(EFFECT.traces.index - EFFECT.traces.index[0] + pd.Timestamp("2026-01-11"))
    told = replace(EFFECT, effects=[on_days], traces=traces)  # its first sample ends the day before
    assert dict(lines(told))["days"] == "day 1 is 2026-01-11"
    assert "day 1 is 2026-01-11" in page_text(as_html(told))
    assert "days" not in dict(lines(replace(EFFECT, traces=traces)))


def test_a_value_at_the_end_of_what_is_tried_is_said_to_be_one() -> None:
    least = replace(LET_BY, at_end=["fraction"])
    assert "; fraction may be further off: nothing beyond is tried." in flat(replace(EFFECT, effects=[least]))
    assert "nothing beyond" not in flat(EFFECT)


def test_a_gap_without_a_cause_claims_none() -> None:
    assert "gap without a known cause" in flat(UNKNOWN)
    assert "emitter and room: air temperature 0.421 K, floor 0.0711, p = 0.0025" in flat(UNKNOWN)
    assert "cause" not in dict(lines(UNKNOWN))
    assert "how far" not in dict(lines(UNKNOWN))


def test_the_form_of_the_room_s_model_is_no_finding() -> None:
    assert "no effect found" in flat(NONE)
    assert "in what could be judged" not in flat(NONE)
    as_such = "no finding: a model of this form misses as much where nothing is wrong"
    assert f"0.0831 K, floor 0.0711, p = 0.0075; {as_such}" in flat(NONE)
    assert "(no finding: see unexplained)" in dict(lines(NONE))["where"]
    assert "no finding" not in dict(lines(UNKNOWN))["where"]
    assert "no finding" not in dict(lines(GROUP))["where"]


def test_what_could_not_be_judged_is_not_called_free_of_gaps() -> None:
    assert "not testable with this record" in flat(UNTESTABLE)
    assert "nothing that stands out" not in flat(UNTESTABLE)
    assert "No gap is left" not in page_text(page_of(UNTESTABLE))
    assert "nothing that stands out of the noise" in flat(replace(NONE, unexplained=()))


def test_one_measurement_that_settles_two_things_is_told_once() -> None:
    of_both = [Measurement("record displacement", splits) for splits in (("let-by",), ("actuator+valve", "let-by"))]
    shown = replace(EFFECT, next_measurements=of_both)
    assert dict(lines(shown))["measure next"] == "record displacement; it would settle let-by, actuator and valve"
    assert ("record displacement", "let-by, actuator and valve") in [tuple(row) for row in Page(as_html(shown)).texts]


def test_without_days_kept_apart_the_summary_does_not_speak_of_them() -> None:
    short = replace(EFFECT, effects=[replace(each, is_held_out=False) for each in EFFECT.effects])
    assert "on held-out days" not in flat(short)
    assert "where its fit has not seen" in flat(short)


def test_colours_change_nothing_but_the_looks() -> None:
    coloured = as_terminal(EFFECT, 120, colour=True)
    assert "\x1b[1m" in coloured
    plain = [line.rstrip() for line in COLOURS.sub("", coloured).splitlines()]
    assert plain == as_terminal(EFFECT, 120, colour=False).splitlines()


def test_where_a_part_of_the_loop_was_not_judged_nothing_found_is_said_of_the_rest_only() -> None:
    partly = replace(NONE, not_judged=["sensor", "room"], compared_with="before", posterior={"none": 0.92})
    assert "no effect found in what could be judged" in flat(partly)
    assert dict(lines(partly))["likely"] == "92 % nothing amiss; sensor and room could not be judged"


def test_a_gap_above_no_floor_is_many_times_it_and_none_is_none() -> None:
    stages = (replace(VALVE, noise_floor=0.0), replace(ROOM, gap=0.0, noise_floor=0.0))
    found = replace(EFFECT, stages=stages)
    assert "flow is off by 5.23 L/h;" in flat(found)
    assert json.loads(json_text(found.described()))["stages"][0]["over_floor"] is None
    assert stages[1].over_floor == 0.0


def test_of_a_room_the_air_s_gap_is_told_once_and_beside_other_channels() -> None:
    only_air = {"air_K": ROOM.gap}
    assert impact_words(replace(ROOM, impact=only_air)) == ""
    assert impact_words(replace(ROOM, channel="return_temperature_C", impact=only_air)) == "air is off by 0.083 K"


# --- what is shown first -----------------------------------------------------------------------------


def test_found_stages_come_first_then_unexplained_ones_then_none() -> None:
    assert [stage.channel for stage in main_stages(EFFECT)] == ["flow_L_h", "displacement"]
    assert [stage.channel for stage in main_stages(UNKNOWN)] == ["air_temperature_C", "displacement"]
    quiet = replace(NONE, unexplained=())
    assert [stage.over_floor for stage in main_stages(quiet)] == [max(s.over_floor for s in quiet.stages)]


def test_the_worst_day_is_the_one_with_the_largest_error_and_midnight_ends_a_day() -> None:
    worst, typical = shown_days(EFFECT, "flow_L_h")
    assert (worst.what, worst.date) == ("worst day", "2024-01-17")  # on which twice as much water is let by
    assert typical.date != worst.date
    assert str(worst.traces.index[-1]) == "2024-01-18 00:00:00"
    assert len(worst.traces) == 1440


def test_a_day_of_a_few_samples_is_not_shown() -> None:
    scrap = EFFECT.traces.iloc[: 2 * 1440 + 60].copy()
    scrap.iloc[2 * 1440 :, scrap.columns.get_loc("flow_L_h_before")] = 1e3
    dates = {day.date for day in shown_days(replace(EFFECT, traces=scrap), "flow_L_h")}
    assert "2024-01-17" in set(by_day(scrap))
    assert dates == {"2024-01-15", "2024-01-16"}


def test_a_record_of_one_day_shows_that_day_once() -> None:
    (day,) = shown_days(replace(EFFECT, traces=EFFECT.traces.iloc[:1440]), "flow_L_h")
    assert day.what == "only day"


def test_a_line_is_broken_where_nothing_is_known_and_goes_on_between_rare_samples() -> None:
    times = pd.date_range("2024-01-15 00:01", periods=1440, freq="min")
    seen = pd.Series(1.0, index=times)
    hours, values = course(seen[(times.hour < 6) | (times.hour >= 12)])
    (place,) = np.flatnonzero(np.isnan(values))
    assert (hours[place - 1] < 6.0, hours[place + 1]) == (True, 12.0)
    for whole in (seen, seen[::15], seen.drop(seen.index[[100, 101]]), seen[:1], seen[:0]):
        assert len(course(whole)[1]) == len(whole)


# --- the page ----------------------------------------------------------------------------------------


@VERDICTS
def test_the_page_has_its_parts_in_the_order_that_a_reader_needs(diagnosis: Diagnosis) -> None:
    headings = Page(page_of(diagnosis)).headings
    order = ("Diagnosis of", "Where", "Cause", "How far", "What stays open", "Measure next", "Record", "How to read")
    places = [next(i for i, heading in enumerate(headings) if heading.startswith(start)) for start in order]
    assert places == sorted(places)


@VERDICTS
def test_nothing_of_the_page_is_fetched_or_executed_and_every_id_is_its_own(diagnosis: Diagnosis) -> None:
    text = page_of(diagnosis)
    page = Page(text)
    assert "http" not in text
    assert {tag for tag, _, _ in page.attributes} & {"script", "link", "iframe", "object", "img"} == set()
    ids = page.values("id")
    assert len(ids) == len(set(ids))
    references = re.findall(r"url\(#([^)]*)\)", text)
    references += [value.removeprefix("#") for value in page.values("href") + page.values("xlink:href")]
    assert set(references) <= set(ids)


DRAWN = {"effect": 5, "group": 5, "unknown": 4, "none": 4, "untestable": 0}


@VERDICTS
def test_what_can_be_drawn_is_drawn_and_the_rest_gives_its_reason(diagnosis: Diagnosis) -> None:
    text = page_of(diagnosis)
    shown = DRAWN[diagnosis.verdict] + bool(diagnosis.posterior)
    also = sum(f'id="figure-{name}"' in text for name in ("switchings", "record"))  # left out without a word
    assert text.count("<svg id") == shown + also
    assert len(re.findall(r"Not drawn: [a-z][^<]+\.</p>", text)) == 5 + bool(diagnosis.posterior) - shown


def test_the_page_has_a_row_for_everything_that_the_diagnosis_holds() -> None:
    rows = [tuple(row) for row in Page(page_of(GROUP)).texts]
    assert ("valve", "flow", "5.23 L/h", "1.08 L/h", "4.8", "1.32 L/h", "+6.8 %", "0.23 K", "0.97") in rows
    assert ("valve", "flow", "undercool", "16.9 L/h", "16", "83 %") in rows
    assert ("let-by", "fraction", "0.0712 (0.0688 to 0.0741)") in rows
    assert ("let-by", "flow", "5.19 L/h", "1.40 L/h", "1.08 L/h", "93 % (90 to 95)", "98 %", "p = 0.0025") in rows
    assert ("heat", "2.31", "2.07", "2.30", "kWh/m² a week") in rows
    assert ("mean air temperature", "21.11", "20.99", "21.10", "°C") in rows
    assert (
        "stuck-open",
        "valve",
        "flow",
        "95 %",
        "20987",
        "p = 0.0025",
        "cannot be told from one that was found",
    ) in rows
    slow = "slow-actuator", "actuator", "displacement", "31 %", "402", "p = 0.013", "not found: explains too little"
    assert slow in rows
    assert ("return_temperature_C was not recorded", "supply-offset, floor-cover") in rows
    assert ("solar gain", "-1.13") in rows
    assert ("shrinkage", "2024-01-25", "2024-01-28") in rows


def test_hypotheses_below_one_per_cent_are_not_listed() -> None:
    page = Page(as_html(CHANGED))
    first = {row[0][0]: row[-1][0] for row in page.rows}
    assert first["let-by and something unknown"] == "3 %"
    assert "something unknown" not in first
    assert "How likely each hypothesis is (others are below 1 %)" in page.headings


def test_the_ranking_says_why_an_effect_is_not_named_and_of_one_that_stands_twice_the_channel() -> None:
    twice = [Tried("supply-offset", "emitter", 1.0, 0.2, 0.1, f"{of}_temperature_C") for of in ("return", "supply")]
    (panel,) = figure_ranking(replace(EFFECT, tried=(*EFFECT.tried, *twice))).axes
    names = [each.get_text() for each in panel.get_yticklabels()]
    assert len(names) == len(set(names))
    assert {"supply-offset  (emitter, return temperature)", "let-by  (valve)"} <= set(names)
    beside = [each.get_text() for each in panel.texts]
    assert {"p 0.0025", "p 0.013; explains too little", "p 0.62; may be chance"} <= set(beside)


@pytest.mark.parametrize(("share", "first"), [(0.02, 0.0), (-0.6, -25.0)])
def test_the_ranking_begins_below_nothing_only_where_an_effect_makes_a_gap_larger(share: float, first: float) -> None:
    (panel,) = figure_ranking(replace(NONE, tried=(*NONE.tried, Tried("pipe-delay", "emitter", 1.0, 0.5, share)))).axes
    assert panel.get_xlim()[0] == panel.get_xticks()[0] == first


def test_a_noise_floor_that_crosses_a_figure_of_the_waterfall_lies_behind_it() -> None:
    (panel, *_) = figure_waterfall(EFFECT).axes
    (floor,) = (line for line in panel.lines if line.get_label() == "noise floor")
    assert panel.texts
    assert all(text.get_zorder() > floor.get_zorder() and text.get_bbox_patch() for text in panel.texts)


def test_merged_stages_name_the_channel_that_would_tell_them_apart() -> None:
    told = " ".join(page_text(page_of(EFFECT)).split())
    assert "Sensor and controller are judged as one." in told
    assert "What would tell them apart is not in the record: control_output" in told


def test_foreign_words_are_shown_and_never_become_markup() -> None:
    odd = replace(EFFECT, dataset="<b>a&b</b>", untestable=(Untestable("<i>x</i>", "1 < 2", Lack.NOT_EXCITED),))
    text = as_html(odd)
    assert "<b>a&" not in text
    assert "<i>x" not in text
    assert "&lt;b&gt;a&amp;b" in text
    assert "<b>a&b</b>" in as_terminal(odd, 120, colour=False)


def test_the_page_is_small_and_the_same_every_time() -> None:
    text = page_of(GROUP)
    assert as_html(GROUP) == text
    assert len(text.encode()) < 2_000_000


def test_a_room_effect_and_one_without_parameters_are_shown_too() -> None:
    effect = replace(LET_BY, name="plain", stage="room", channel="air_temperature_C", parameters={})
    text = as_html(replace(EFFECT, effects=(effect,), traces=EFFECT.traces.drop(columns="flow_L_h_before")))
    assert "Not drawn" not in text.replace("Not drawn: no effect was found", "")


@pytest.mark.parametrize("frame", [pd.DataFrame(), EFFECT.traces.iloc[:0]], ids=["no traces", "no rows"])
def test_without_traces_the_page_is_drawn_but_for_the_days(frame: pd.DataFrame) -> None:
    text = as_html(replace(EFFECT, traces=frame))
    assert re.findall(r"Not drawn: ([^<]+)</p>", text) == ["no channel was judged on a whole day."]


def test_all_switchings_are_aligned_where_a_signal_and_what_it_moves_were_recorded() -> None:
    signal = EFFECT.traces["heating_signal_measured"]
    comes = int(((signal > 0.5) & (signal.shift() < 0.5)).sum())
    assert figure_switchings(EFFECT).axes[0].get_title(loc="left") == f"signal comes: {comes} times"
    without = replace(EFFECT, traces=EFFECT.traces.drop(columns="heating_signal_measured"))
    assert figure_switchings.plot(without).missing.startswith("no signal that only switches")


@needs_browser
@pytest.mark.parametrize("width", [1200, 390])
def test_the_page_never_scrolls_sideways(width: int, tmp_path: Path) -> None:
    assert scroll_width(tmp_path, page_of(GROUP), width) <= width


@pytest.mark.parametrize("module", [words])
def test_the_examples_of_how_figures_are_written_hold(module: ModuleType) -> None:
    tried = doctest.testmod(module)
    assert tried.attempted == 15
    assert tried.failed == 0


def keys(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from (key, *keys(item))
    elif isinstance(value, list):
        for item in value:
            yield from keys(item)


def test_the_page_on_diagnoses_names_every_key_of_the_json_and_every_verdict() -> None:
    page = "".join((ROOT / "docs" / name).read_text(encoding="utf-8") for name in ("diagnose.md", "diagnosis-json.md"))
    free = {*EFFECT.departures, *EFFECT.closed_loop, *LET_BY.parameters, *MOTOR_FOUND.parameters, *STUCK.parameters}
    free |= {*CHANGED.posterior, *(channel for stage in CHANGED.stages for channel in stage.posterior)}
    data = {**json.loads(json_text(CHANGED.described())), "group": json.loads(json_text(GROUP.described()))}
    free |= {"group"}
    assert [key for key in dict.fromkeys(keys(data)) if key not in free and f"`{key}`" not in page] == []
    assert all(f"| `{verdict}` | {words} |" in page for verdict, words in VERDICT_WORDS.items())


# --- missing heat ------------------------------------------------------------------------------------

HEATED = replace(EFFECT, missing_heat=LACKING_HEAT)


def test_missing_heat_has_a_line_where_it_is_resolved_and_none_else() -> None:
    assert dict(lines(HEATED))["heat"] == LACKING_HEAT.sentence
    unsure = replace(HEATED, missing_heat=replace(LACKING_HEAT, is_resolved=False))
    assert "heat" not in dict(lines(unsure))
    assert LACKING_HEAT.sentence in page_text(as_html(unsure))


def test_every_figure_of_missing_heat_is_in_the_json() -> None:
    assert untraced(page_text(as_html(HEATED)), described(HEATED)) == []
    assert described(HEATED)["missing_heat"]["before"][0]["heat_W"] == PIECES_W[0]


def test_a_phone_shows_the_course_of_missing_heat_before_what_it_may_depend_on() -> None:
    boxes = [[float(side) for side in part.split()] for part in figure_missing_heat.plot(HEATED).parts]
    course, *drivers, _legend = boxes
    assert all(each[1] > course[1] for each in drivers)
    assert [each[0] for each in drivers] == sorted(each[0] for each in drivers)


def test_missing_heat_is_drawn_by_its_drivers_with_and_without_effects() -> None:
    drawn = figure_missing_heat(HEATED)
    assert [panel.get_xlabel() for panel in drawn.axes] == [
        "hour of the day",
        "room warmer than outside",
        "days since the record began",
    ]
    *_, over = drawn.axes
    labels = over.get_legend_handles_labels()[1]
    assert set(labels) == {"interval as believed", "as believed", "with effects", "usual"}
    same = replace(HEATED, missing_heat=replace(LACKING_HEAT, after=LACKING_HEAT.before, by=(), usual_W=np.nan))
    assert set(figure_missing_heat(same).axes[0].get_legend_handles_labels()[1]) == {
        "interval as believed",
        "as believed",
    }


def test_without_a_room_nothing_is_said_of_heat() -> None:
    assert "Missing heat" not in page_text(page_of(EFFECT))
    assert described(EFFECT)["missing_heat"]["before"] == []
    with pytest.raises(Lacking):
        figure_missing_heat(EFFECT)
