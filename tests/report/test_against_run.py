"""Claims about two runs side by side."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.report.conftest import computed
from waxstudy.report.comparison import (
    COLUMNS,
    CORRECTED_DIFFERENCE,
    CORRECTED_FIGURES,
    DIFFERENCE,
    FIGURES,
    estimate,
    unpaired_interval,
)
from waxstudy.report.content import Content, gather
from waxstudy.report.figures.overview import figure_overview
from waxstudy.report.input_differences import differences
from waxstudy.report.other_run import OtherRun, Step
from waxstudy.report.page import as_html
from waxstudy.report.render import all_notes, as_csv, as_json, as_markdown, as_terminal, tables
from waxstudy.report.score import Cell, cells
from waxstudy.results.run import Run

STUDY = """
[study]
name = "base"
step_s = 20
[room]
use = "nzeb"
[weather.cold]
use = "tallinn-week"
month = "january"
[ensemble]
members = 4
[output]
trace_members = 0
[ladder.switching]
reference = "precise"
start = { id = "rough", controller = { use = "on-off", dead_band_K = 2.0 }, valve = { use = "linear" } }
steps = [
  { id = "middle", controller = { dead_band_K = 0.5 } },
  { id = "precise", controller = { dead_band_K = 0.4 }, actuator = { use = "variable-times" } },
]
"""


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Content:
    return computed(STUDY, tmp_path_factory.mktemp("base"))


@pytest.fixture(scope="module")
def changed(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """`rough` and `middle` change places, so that the first step turns round."""
    text = STUDY.replace("2.0", "swap").replace("0.5", "2.0").replace("swap", "0.5")
    return computed(text, tmp_path_factory.mktemp("changed")).run


@pytest.fixture(scope="module")
def single(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """One member, and another reference case."""
    text = STUDY.replace("members = 4", "members = 1").replace('"precise"\nstart', '"middle"\nstart')
    return computed(text, tmp_path_factory.mktemp("single")).run


def held(content: Content, other: Run) -> tuple[Content, OtherRun]:
    beside = gather(content.run, content.study, other)
    assert isinstance(beside.against, OtherRun)
    return beside, beside.against


def test_a_run_does_not_differ_from_itself_in_any_figure(base: Content) -> None:
    _, against = held(base, Run(base.run.folder))
    assert len(against.cells) == 3 * len(COLUMNS) - 2  # the reference case has no difference, of neither heat
    assert {(cell.difference, cell.resolved) for cell in against.cells} == {(0.0, False)}
    assert {(s.rmse, s.mean_error, s.within_range - s.n) for s in against.scores} == {(0.0, 0.0, 0)}
    assert against.steps[0].verdict == "agrees"
    assert "differs" not in {step.verdict for step in against.steps}
    assert "0 differ from" in against.summary


def test_one_member_has_no_range_to_lie_in(single: Run, base: Content) -> None:
    alone = gather(single, base.study, base.run)
    assert isinstance(alone.against, OtherRun)
    assert {cell.within_single_run_range for cell in alone.against.cells} == {None}
    assert {score.within_range for score in alone.against.scores} == {None}
    assert {tuple(row[-2:]) for row in alone.against.tables()[0].texts} == {("", "")}


def test_what_was_changed_is_resolved_and_what_was_not_is_no_difference(base: Content, changed: Run) -> None:
    _, against = held(base, changed)
    found = {(cell.case, cell.column): cell for cell in against.cells}
    assert found["rough", "mae_K"].resolved
    assert found["rough", "mae_K"].difference > 0.1
    assert found["middle", "mae_K"].resolved
    assert found["middle", "mae_K"].difference == pytest.approx(-found["rough", "mae_K"].difference)
    assert (found["precise", "mae_K"].difference, found["precise", "mae_K"].resolved) == (0.0, False)
    score = next(score for score in against.scores if score.column == "mae_K")
    assert score.rmse == pytest.approx(found["rough", "mae_K"].difference * np.sqrt(2.0 / 3.0))
    assert score.within_range == 1


def test_each_week_counts_its_own_members_and_weathers_that_runs_share_are_told(tmp_path: Path) -> None:
    """Of the cold week two weathers with two starts each, of the sunny one two starts."""
    sunny = '[weather.sunny]\nuse = "tallinn-week"\nmonth = "february"\n[ensemble]\n'
    text = STUDY.replace("members = 4", "members = 2").replace("[ensemble]\n", sunny)
    found = computed(text + "[ensemble.weather.cold]\nseed = [1, 2]\n", tmp_path)
    _, against = held(found, found.run)
    assert {(cell.week, cell.members, cell.their_members) for cell in against.cells} == {
        ("cold", 4, 4),
        ("sunny", 2, 2),
    }
    for row in found.rows:
        assert np.isnan(row.setpoint_shift_K.runs) == (row.week == "sunny")
        assert np.isnan(row.mae_K.runs) == (row.week == "sunny")


def test_a_difference_that_nobody_knows_is_no_zero(base: Content) -> None:
    of_reference = next(row for row in base.rows if row.resolved is None)
    unknown = replace(base.rows[0], heat_vs_most_detailed_percent=estimate(np.array([np.nan, 1.0])), resolved=None)
    difference = next(column.value for column in FIGURES if column.key == DIFFERENCE)
    assert difference
    assert [difference(row) for row in (of_reference, unknown)] == ["0", "not known"]


def test_a_corrected_difference_that_is_known_is_no_zero_where_the_other_is_not(base: Content) -> None:
    """The reference of one member took no heat from the water, but from its floor."""
    row = next(row for row in base.rows if row.resolved is not None)
    row = replace(row, heat_vs_most_detailed_percent=estimate(np.array([np.nan, 1.0])), resolved=None)
    said = {column.key: column.value(row) for column in (*FIGURES, *CORRECTED_FIGURES) if column.value}
    assert said[DIFFERENCE] == "not known"
    assert said[CORRECTED_DIFFERENCE] == row.heat_corrected_vs_most_detailed_percent
    beside = {cell.column for cell in cells([row], [row], {row.week: 2})}
    assert (DIFFERENCE in beside, CORRECTED_DIFFERENCE in beside) == (False, True)
    of_reference = next(row for row in base.rows if row.corrected_resolved is None)
    assert not {DIFFERENCE, CORRECTED_DIFFERENCE} & {
        cell.column for cell in cells([of_reference], [of_reference], {of_reference.week: 2})
    }
    assert [column.value(of_reference) for column in CORRECTED_FIGURES if column.value][1] == "0"


def test_what_is_called_resolved_is_written_as_no_zero() -> None:
    one, two, other = (estimate(np.array(values)) for values in ([1.0, 1.001], [1.004, 1.005], [0.0, 2.0]))
    assert f"{Cell('a', 'w', 'heat', one, 2, two, 2):.2f}".startswith("-0.004 ± 0.00")
    assert f"{Cell('a', 'w', 'heat', one, 2, other, 2):.2f}".startswith("0.00 ± ")


def test_steps_whose_heat_changes_the_other_way_are_named(base: Content, changed: Run) -> None:
    _, against = held(base, changed)
    assert [step.name for step in against.steps] == ["rough to middle", "middle to precise"]
    assert against.steps[0].verdict == "differs"
    title = next(t.title for t in tables(replace(base, against=against)) if t.title.startswith("sign of"))
    assert re.match(r"sign of resolved steps: . agrees?, 1 differs: rough to middle \(cold\);", title)


def test_a_step_is_judged_only_where_both_runs_resolve_it() -> None:
    up, down, open_ = (estimate(np.array(values)) for values in ([1.0, 1.1], [-1.0, -1.1], [-1.0, 1.1]))
    verdicts = [Step("a", "b", "w", ours, theirs).verdict for ours, theirs in ((up, up), (up, down), (up, open_))]
    assert verdicts == ["agrees", "differs", "not resolved"]


def test_cases_and_weeks_that_only_one_run_has_are_noted(base: Content, small: Content) -> None:
    there, against = held(base, small.run)
    assert list(against.notes) == [
        "cases that only this run has: middle",
        "cases that only the other run has: usual, pulsed, motor",
        "weeks that only the other run has: sunny",
        "not the same in both runs: case rough: valve (linear, none)",
        "not the same in both runs: case precise: controller.dead_band_K (0.4, 0.5), "
        "actuator (variable-times, none), valve (linear, none)",
    ]
    assert {(cell.case, cell.week) for cell in against.cells} == {("rough", "cold"), ("precise", "cold")}
    assert against.steps == []  # no neighbours here are both there
    for text in (as_terminal(there, 200, colour=False), as_markdown(there), as_html(there)):
        assert "cases that only the other run has: usual, pulsed, motor" in text
    assert set(against.notes) <= set(json.loads(as_json(there))["notes"])


def test_what_differs_behind_the_same_names_is_noted(base: Content, tmp_path: Path) -> None:
    text = STUDY.replace("january", "february").replace("[ensemble]", "[comfort]\nsetpoint_C = 20.5\n[ensemble]")
    text = text.replace('"variable-times"', '"constant-times"').replace("[room]", "[room]\nwall_U_W_m2K = 0.2")
    _, against = held(base, computed(text.replace("step_s = 20", "step_s = 30"), tmp_path).run)
    assert list(against.notes) == [
        "not the same in both runs: study: step_s (20.0, 30.0)",
        "not the same in both runs: room: wall_U_W_m2K (0.12, 0.2)",
        "not the same in both runs: weather cold: month (january, february), outdoor_mean_C (-1.9, -6.8), "
        "solar_gain_kWh_m2_week (0.15, 0.82), sun_by_day (..., ...)",
        "not the same in both runs: comfort: setpoint_C (21.0, 20.5)",
        "not the same in both runs: case precise: actuator.use (variable-times, constant-times)",
    ]


def test_weather_files_are_told_apart_without_the_folders_they_lie_in() -> None:
    one, two, three = ({"use": "epw", "path": path} for path in ("/a/tallinn.epw", "/b/tallinn.epw", "/b/oslo.epw"))
    assert list(differences(one, two)) == ["path (tallinn.epw, tallinn.epw, in another folder)"]
    assert list(differences(one, three)) == ["path (tallinn.epw, oslo.epw)"]
    assert list(differences(one, one)) == []


def test_runs_without_a_common_case_are_shown_with_a_note_and_no_scores(bare: Content, base: Content) -> None:
    there, against = held(bare, base.run)
    assert (against.cells, against.scores) == ([], [])
    assert against.notes[0] == "cases that only this run has: single"
    assert "No difference from" in as_html(there)


def test_a_run_of_one_member_leaves_every_difference_open(base: Content, single: Run) -> None:
    beside, against = held(base, single)
    assert {cell.resolved for cell in against.cells} == {None}
    assert against.steps == ()
    assert "a run with one member per case: no difference between the two runs can be called resolved" in against.notes
    assert "nan" not in as_terminal(beside, 200, colour=False)


def test_differences_from_another_reference_case_are_not_compared(base: Content, single: Run) -> None:
    beside, against = held(base, single)
    assert {cell.column for cell in against.cells} == {*COLUMNS} - {DIFFERENCE, CORRECTED_DIFFERENCE}
    told = "rough (precise, middle), middle (precise, middle), precise (precise, middle)"
    assert f"differences not compared, as their reference case here and there differs: {told}" in all_notes(beside)


# --- formats ----------------------------------------------------------------------------------------


def test_csv_has_the_other_run_s_mean_and_spread_of_each_figure(base: Content, changed: Run) -> None:
    beside, against = held(base, changed)
    lines = list(csv.DictReader(io.StringIO(as_csv(beside))))
    theirs = [f"{column}{end}" for column in COLUMNS for end in ("_other", "_other_sd")]
    assert list(lines[0])[-len(theirs) :] == theirs
    assert list(lines[0])[: -len(theirs)] == as_csv(base).splitlines()[0].split(",")
    found = {(cell.case, cell.column): cell.theirs for cell in against.cells}
    for line in lines:
        assert float(line["mae_K_other"]) == pytest.approx(found[line["case"], "mae_K"].mean, abs=1e-5)
        assert float(line["mae_K_other_sd"]) == pytest.approx(found[line["case"], "mae_K"].sd, abs=1e-5)
    assert lines[2]["heat_vs_most_detailed_percent_other"] == ""


def test_json_says_the_interval_of_each_difference_and_each_step(base: Content, changed: Run) -> None:
    beside, against = held(base, changed)
    said = json.loads(as_json(beside))["against"]
    assert (said["name"], said["folder"], said["members"]) == (against.name, str(changed.folder), 4)
    for cell in said["cells"]:
        assert cell["difference_low"] <= cell["difference"] <= cell["difference_high"]
        assert cell["difference"] == pytest.approx(cell["ours"]["mean"] - cell["other"]["mean"])
        assert cell["resolved"] is not (cell["difference_low"] <= 0.0 <= cell["difference_high"])
    assert [step["verdict"] for step in said["steps"]] == [step.verdict for step in against.steps]


def test_text_formats_show_the_other_mean_with_its_spread_and_every_table(base: Content, changed: Run) -> None:
    beside, against = held(base, changed)
    mae = next(cell.theirs for cell in against.cells if (cell.case, cell.column) == ("rough", "mae_K"))
    for text in (as_terminal(beside, 120, colour=False), as_markdown(beside), as_html(beside)):
        assert f"{mae.mean:.3f}±{mae.sd:.3f}" in text.replace(" ± ", "±")  # a narrow terminal sets it tight
        plain = re.sub(r"\s+", " ", text)
        for title in ("gainst", "his run minus", "1 differs: rough to middle (cold)"):
            assert title in plain
    for table in tables(beside):
        assert {len(row) for row in table.texts} <= {len(table.names)}, table.title


def test_the_page_shows_the_other_run_where_it_shows_published_figures(base: Content, changed: Run) -> None:
    beside, against = held(base, changed)
    page = as_html(beside)
    assert f"<h2>Against {against.name}</h2>" in page
    assert "Dim columns are the other run" in page
    assert str(changed.folder.parent) not in page
    left, middle, right = figure_overview(beside).axes
    for axes, column in ((left, DIFFERENCE), (middle, CORRECTED_DIFFERENCE), (right, "mae_K")):
        crosses = [line.get_xdata()[0] for line in axes.get_lines() if line.get_marker() == "x"]
        assert crosses == [cell.theirs.mean for cell in against.cells if cell.column == column]
    legend = [text.get_text() for text in left.figure.legends[0].get_texts()]
    assert f"{against.name} (mean of 4 members)" in legend


def test_two_folders_of_one_name_are_told_apart(base: Content, changed: Run) -> None:
    assert base.run.folder.name == changed.folder.name == "run"
    assert held(base, changed)[1].name == f"{changed.folder.parent.name}/run"


def test_brackets_and_braces_in_a_folder_s_name_are_shown_as_they_are(base: Content, tmp_path: Path) -> None:
    link = tmp_path / "b[red]{x}"
    link.mkdir()
    for part in base.run.folder.iterdir():
        (link / part.name).symlink_to(part)
    beside, _ = held(base, Run(link))
    for text in (as_terminal(beside, 200, colour=False), as_markdown(beside), as_html(beside)):
        assert "gainst b[red]{x}" in text


# --- statistics -------------------------------------------------------------------------------------

samples = st.lists(st.floats(-10.0, 10.0), min_size=2, max_size=20).filter(lambda values: np.std(values) > 1e-3)


@given(samples, samples)
def test_the_interval_of_a_difference_is_that_of_welch_s_test(a: list[float], b: list[float]) -> None:
    from scipy.stats import ttest_ind

    found = unpaired_interval(estimate(np.array(a)), len(a), estimate(np.array(b)), len(b))
    expected = ttest_ind(a, b, equal_var=False).confidence_interval(0.95)
    assert found == pytest.approx((expected.low, expected.high), rel=1e-9, abs=1e-9)


def test_means_without_any_spread_differ_by_exactly_what_they_differ() -> None:
    one, two = estimate(np.array([1.0, 1.0])), estimate(np.array([2.0, 2.0]))
    assert unpaired_interval(one, 2, two, 2) == (-1.0, -1.0)
    assert unpaired_interval(one, 2, one, 2) == (0.0, 0.0)
