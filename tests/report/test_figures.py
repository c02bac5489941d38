"""The figures show what the run holds: curves, labels, legends, and a reason where there is nothing to show."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import study as gap_study
from waxstudy.plugin import OutsideRoom, PublishedRow, changed
from waxstudy.report.activation import activations
from waxstudy.report.against import Published
from waxstudy.report.comparison import Estimate, estimate, members_by_week
from waxstudy.report.content import Content
from waxstudy.report.figures import (
    PAPER_FIGURES,
    figure_12,
    figure_17,
    figure_18,
    figure_19,
    figure_20,
    figure_21,
    figure_22,
    figure_b1,
)
from waxstudy.report.figures.overview import figure_overview
from waxstudy.report.figures.places import steps
from waxstudy.report.figures.plot import Drawing, Lacking
from waxstudy.report.score import cells, scores

UNITS = {"min", "h", "days", "%", "K", "°C", "L/h", "W/m²", "–"}
CASES = ["rough", "precise", "usual", "pulsed", "motor"]


@pytest.fixture(scope="module", params=[figure_overview, *PAPER_FIGURES], ids=lambda drawing: drawing.name)
def drawn(request: pytest.FixtureRequest, small: Content) -> tuple[Drawing[Content], Any]:
    """A drawing and its figure of the small run, laid out once for all claims."""
    figure = request.param(small)
    figure.draw_without_rendering()
    return request.param, figure


def line(axes: Any, label: str) -> Any:
    return next(line for line in axes.get_lines() if line.get_label() == label)


def legend_texts(figure: Any) -> list[str]:
    legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes if axes.get_legend())]
    return [text.get_text() for legend in legends for text in legend.get_texts()]


def test_an_overview_is_drawn_without_one_known_error(small: Content) -> None:
    unknown = estimate(np.array([np.nan]))
    figure = figure_overview(replace(small, rows=[replace(row, mae_K=unknown) for row in small.rows]))
    figure.draw_without_rendering()
    assert not np.isfinite(figure.axes[2].dataLim.x1)


def test_every_axis_has_a_label_that_ends_in_its_unit_or_shares_one_that_has(
    drawn: tuple[Drawing[Content], Any],
) -> None:
    drawing, figure = drawn
    for axes in figure.axes:
        for get, shared in (
            ("get_xlabel", axes.get_shared_x_axes()),
            ("get_ylabel", axes.get_shared_y_axes()),
        ):
            labels = [getattr(other, get)() for other in shared.get_siblings(axes)] + [getattr(axes, get)()]
            said = [label for label in labels if label]
            cases_name_the_rows = drawing is figure_overview and get == "get_ylabel"
            assert said or cases_name_the_rows
            assert all(label.split(",")[-1].strip() in UNITS for label in said)


def test_all_text_is_at_least_9_points_on_a_page_1100_pixels_wide(drawn: tuple[Drawing[Content], Any]) -> None:
    from matplotlib.text import Text

    _, figure = drawn
    sizes = [text.get_fontsize() for text in figure.findobj(Text) if text.get_text()]
    assert min(sizes) >= 9.0
    assert figure.get_figwidth() * 96 <= 1100


def test_legends_lie_inside_the_figure_and_beside_the_data(drawn: tuple[Drawing[Content], Any]) -> None:
    _, figure = drawn
    legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes if axes.get_legend())]
    for legend in legends:
        box = legend.get_window_extent()
        assert figure.bbox.x0 <= box.x0
        assert box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0
        assert box.y1 <= figure.bbox.y1
        assert not any(box.overlaps(axes.bbox) for axes in figure.axes)
        assert not any(box.overlaps(axes.xaxis.label.get_window_extent()) for axes in figure.axes)
        assert not any(box.overlaps(other.get_window_extent()) for other in legends if other is not legend)


@pytest.mark.parametrize(
    ("figure", "reason"),
    [
        (figure_17, "keeps no traces"),
        (figure_19, "keeps no traces"),
        (figure_20, "keeps no traces"),
        (figure_22, "single"),
    ],
    ids=lambda value: getattr(value, "name", None),
)
def test_a_figure_that_lacks_its_data_says_what_is_missing(figure: Any, reason: str, bare: Content) -> None:
    with pytest.raises(Lacking, match=reason):
        figure(bare)


def test_a_ladder_of_a_single_case_has_no_last_step(small: Content) -> None:
    alone = [replace(ladder, cases=[ladder.reference]) for ladder in small.run.ladders]
    shortened = replace(small, run=_with_ladders(small, alone))
    with pytest.raises(Lacking, match="no ladder has a step"):
        figure_22(shortened)


def _with_ladders(content: Content, ladders: Any) -> Any:
    from waxstudy.results.run import Run

    run = Run(content.run.folder)
    run.ladders = ladders
    return run


def test_without_traces_the_cumulative_figures_are_drawn_all_the_same(bare: Content) -> None:
    for figure in (figure_overview, figure_12, figure_18, figure_21):
        assert figure(bare).axes


def test_activation_curves_are_the_reports_own_and_the_limit_is_5_minutes(small: Content) -> None:
    left, right = figure_12(small).axes
    for curve in small.activations:
        np.testing.assert_array_equal(line(left, curve.actuator).get_ydata(), curve.opening_s / 60.0)
        np.testing.assert_array_equal(line(right, curve.actuator).get_ydata(), curve.flow_s / 60.0)
        np.testing.assert_array_equal(line(left, curve.actuator).get_xdata(), curve.off_min)
    assert any(list(limit.get_ydata()) == [5.0, 5.0] for limit in left.get_lines())
    assert len(small.activations) >= 5


def test_the_day_shows_the_second_case_of_each_ladder_with_its_shifted_setpoint(small: Content) -> None:
    for axes, case in zip(figure_17(small).axes, ("precise", "pulsed"), strict=True):
        assert axes.get_title(loc="left") == f"{case}, cold, day 4"
        kpis = small.run.kpis.query("case == @case and week == 'cold'")
        assert line(axes, "setpoint").get_ydata()[0] == pytest.approx(21.0 + kpis["setpoint_shift_K"].iloc[0])
        trace = small.run.traces(case, "cold")
        day = trace[(trace["time_s"] > 3 * 86400) & (trace["time_s"] <= 4 * 86400)]
        np.testing.assert_array_equal(line(axes, "air").get_ydata(), day["air_C"])
        np.testing.assert_array_equal(line(axes, "operative").get_ydata(), day["operative_C"])
        np.testing.assert_allclose(line(axes, "air").get_xdata(), day["time_s"].astype(float) / 3600 - 72)


def test_cumulative_temperatures_are_the_members_mean_and_meet_at_equal_comfort(small: Content) -> None:
    figure = figure_18(small)
    assert legend_texts(figure) == CASES
    for axes, week in zip(figure.axes, ("cold", "sunny"), strict=True):
        for case in CASES:
            spans = small.run.durations(case, week)
            members = [group["operative_C"].to_numpy() for _, group in spans.groupby("member")]
            assert len(members) == 2
            np.testing.assert_allclose(line(axes, case).get_ydata(), np.mean(members, axis=0))
            # 33 of 168 hours lie below 21 C: 19.6 %
            assert line(axes, case).get_ydata()[20] == pytest.approx(21.0, abs=0.1)


def test_ladders_differ_by_dash_and_the_most_detailed_cases_are_black_and_thickest(small: Content) -> None:
    axes = figure_18(small).axes[0]
    assert {line(axes, case).get_linestyle() for case in ("rough", "precise")} == {"-"}
    assert {line(axes, case).get_linestyle() for case in ("usual", "pulsed", "motor")} == {"--"}
    widths = {case: line(axes, case).get_linewidth() for case in CASES}
    assert min(widths["precise"], widths["motor"]) > max(widths[case] for case in ("rough", "usual", "pulsed"))
    assert line(axes, "precise").get_color() == line(axes, "motor").get_color() == "#000000"


def test_the_excerpt_follows_the_modulated_case_from_output_to_flow(small: Content) -> None:
    axes = figure_19(small).axes
    assert axes[0].get_title(loc="left").startswith("motor, cold, day ")
    start_h, end_h = axes[-1].get_xlim()
    assert end_h - start_h == 4.0
    output, signal, opening, flow = (panel.get_lines()[0].get_ydata() for panel in axes)
    assert len(output) == 4 * 60
    assert np.ptp(signal) == np.ptp(opening) == 1.0
    first_signal, first_opening = np.argmax(signal > 0.5), np.argmax(opening > 0.5)
    assert first_signal < first_opening  # the wax takes minutes
    trace = small.run.traces("motor", "cold")
    day = int(axes[0].get_title(loc="left").split()[-1]) - 1
    shown = trace[(trace["time_s"] > (24 * day + start_h) * 3600) & (trace["time_s"] <= (24 * day + end_h) * 3600)]
    np.testing.assert_array_equal(flow, shown["flow_L_h"])


def test_the_week_shows_simplest_second_and_most_detailed_case_between_helper_lines(small: Content) -> None:
    switching, steady = figure_20(small).axes
    assert [text.get_text() for text in switching.get_legend().get_texts()] == ["rough", "precise"]
    assert [text.get_text() for text in steady.get_legend().get_texts()] == ["usual", "pulsed", "motor"]
    constant = {float(a.get_ydata()[0]) for a in steady.get_lines() if len(a.get_ydata()) == 2}
    assert constant == {20.75, 21.25}
    rough = line(switching, "rough")
    assert rough.get_xdata()[-1] == pytest.approx(7.0, abs=0.01)
    assert np.ptp(rough.get_ydata()) > 2.0  # the dead band of 2 K


@pytest.mark.parametrize(("row", "channel"), list(enumerate(("flow_L_h", "return_C", "floor_heat_W_m2"))))
def test_cumulative_loads_are_the_members_mean(row: int, channel: str, small: Content) -> None:
    figure = figure_21(small)
    assert legend_texts(figure) == CASES
    ladders = (("rough", "precise"), ("usual", "pulsed", "motor"))
    for column, cases in enumerate(ladders):
        for case in cases:
            spans = small.run.durations(case, "cold").pivot_table(index="percent", columns="member", values=channel)
            shown = line(figure.axes[2 * row + column], case).get_ydata()
            np.testing.assert_allclose(shown, spans.mean(axis=1))


def test_the_supply_lies_above_every_return_temperature(small: Content) -> None:
    for axes in figure_21(small).axes[2:4]:
        *returns, supply = axes.get_lines()
        assert supply.get_linestyle() == "--"
        assert all(np.all(supply.get_ydata() > curve.get_ydata()) for curve in returns)


def test_the_last_step_is_shown_on_three_days_around_the_warmest_hour(small: Content) -> None:
    axes = figure_22(small).axes
    shown = [[a.get_label() for a in panel.get_lines()] for panel in axes[:2]]
    assert shown[0] == ["rough air", "rough operative", "precise air", "precise operative"]
    assert shown[1] == ["pulsed air", "pulsed operative", "motor air", "motor operative"]
    first, last = axes[2].get_xlim()
    assert last - first == 3.0
    warmest = small.run.traces("precise", "sunny")
    warmest_day = warmest["time_s"][warmest["operative_C"].argmax()] / 86400
    assert first <= warmest_day <= last


def test_the_overview_marks_what_is_resolved_and_what_was_published(small: Content) -> None:
    published = [
        PublishedRow("rough", "cold", 0.5, 0.6, 2.5, 5.7),
        PublishedRow("precise", "cold", 0.1, 0.2, 2.4, 0.0),
    ]
    paired = cells(small.rows, published, members_by_week(small.run))
    told = [replace(row, resolved=row.case == "usual" if row.resolved is not None else None) for row in small.rows]
    shown = replace(small, rows=told, against=Published("book", paired, scores(paired), ()))
    left, middle, right = figure_overview(shown).axes
    rows = [row for row in told if row.resolved is not None]
    dots = [a for a in left.get_lines() if len(a.get_xdata()) == 1 and a.get_marker() != "x"]
    means = sorted((row.heat_vs_most_detailed_percent.mean, bool(row.resolved)) for row in rows)
    assert sorted((a.get_xdata()[0], a.get_markerfacecolor() != "white") for a in dots) == means
    crosses = [[a.get_xdata()[0] for a in axes.get_lines() if a.get_marker() == "x"] for axes in (left, middle, right)]
    assert crosses == [[5.7], [5.7], [0.6, 0.2]]
    assert [text.get_text() for text in left.get_yticklabels()] == CASES


def test_no_point_of_the_overview_lies_outside_the_common_scale_of_both_heats(small: Content) -> None:
    far = [
        replace(row, heat_corrected_vs_most_detailed_percent=Estimate(20.0, 0.1, 19.9, 20.1))
        if row.resolved is not None
        else row
        for row in small.rows
    ]
    left, middle, _ = figure_overview(replace(small, rows=far)).axes
    assert left.get_xlim() == middle.get_xlim()
    assert middle.get_xlim()[1] > 20.0


@given(st.lists(st.sampled_from([0.0, 0.5, 1.0]), min_size=1, max_size=40))
def test_dropping_the_rows_between_two_changes_leaves_the_steps_as_they_were(values: list[float]) -> None:
    frame = pd.DataFrame({"time_s": 60.0 * (1 + np.arange(len(values))), "flow": values})
    kept = steps(frame, "flow")
    # a value holds until its time stamp: the first kept row at or after each time tells it
    index = np.searchsorted(kept["time_s"].to_numpy(), frame["time_s"].to_numpy())
    np.testing.assert_array_equal(kept["flow"].to_numpy()[index], values)


def test_an_actuator_with_other_numbers_has_a_curve_of_its_own() -> None:
    study = gap_study()
    plain = [curve.actuator for curve in activations(study)]
    wax = study.cases["WAX"]
    actuator = wax.blocks["actuator"]
    slower = replace(actuator, parameters=changed(actuator.parameters, dead_a_s=-150.0))
    with_slower = replace(study, cases={**study.cases, "WAX": replace(wax, blocks={**wax.blocks, "actuator": slower})})
    found = activations(with_slower)
    assert [curve.actuator for curve in found] == [*plain, "variable-times, WAX"]


def test_the_heating_curve_is_the_room_s_and_its_weeks_lie_on_it(small: Content) -> None:
    axes = figure_b1(small).axes[0]
    outdoor_C, supply_C = line(axes, "nzeb").get_data()
    assert np.interp([-22.0, -1.0, 20.0], outdoor_C, supply_C) == pytest.approx([34.0, 28.0, 22.0])
    for week in small.run.weeks:
        used = small.run.traces("precise", week)["supply_C"]
        part = line(axes, week).get_ydata()
        assert [part.max(), part.min()] == pytest.approx([used.max(), used.min()], abs=0.1)


def test_a_room_whose_engine_has_its_own_water_has_no_heating_curve(small: Content) -> None:
    class Theirs(OutsideRoom):
        """A room of another engine."""

        name = "theirs"
        has_own_water = True

    room = replace(small.study.room, component=Theirs)
    with pytest.raises(Lacking, match="as warm as the model of this room says"):
        figure_b1(replace(small, study=replace(small.study, room=room)))
