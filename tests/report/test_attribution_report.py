"""The order-free ladder as tables, notes and a page, from two ladders and two weeks."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from tests.report.test_page import Page
from waxstudy.report.attribution.notes import notes
from waxstudy.report.attribution.page import as_html
from waxstudy.report.attribution.render import as_terminal, tables
from waxstudy.report.attribution.shares import FIGURES, OrderFree, attribute
from waxstudy.report.comparison import COLUMNS, CORRECTED
from waxstudy.report.content import Content


@pytest.fixture(scope="module")
def found(small: Content) -> OrderFree:
    return attribute(small.run, small.study)


@pytest.fixture(scope="module")
def text(found: OrderFree) -> str:
    return as_html(found)


def test_every_figure_of_the_comparison_is_shared_out_in_every_ladder_and_week(found: OrderFree) -> None:
    assert set(FIGURES) == {*COLUMNS} - {CORRECTED}
    names = [(of.subsets.ladder.name, of.week) for of in found.attributions]
    assert names == [(ladder, week) for week in ("cold", "sunny") for ladder in ("switching", "steady")]
    assert all(set(of.differences) == set(FIGURES) for of in found.attributions)
    assert [ladder.ladder.name for ladder in found.ladders] == ["switching", "steady"]


def test_a_ladder_of_one_step_gives_it_everything(found: OrderFree) -> None:
    for of in found.attributions:
        if of.subsets.ladder.name == "switching":
            for difference in of.differences.values():
                (share,) = difference.shares
                assert share.order_free == share.in_ladder == difference.total
                assert share.of_its_place.mean == 0.0


def test_shares_sum_to_the_total_in_all_of_them(found: OrderFree) -> None:
    for of in found.attributions:
        for difference in of.differences.values():
            assert abs(difference.remainder) < 1e-12
    assert notes(found)[0].startswith("the order-free shares of the steps sum to the total difference")


def test_what_is_not_resolved_stands_in_brackets(found: OrderFree) -> None:
    for of, table in zip(found.attributions, tables(found)[::2], strict=True):
        for step, row in enumerate(table.texts[:-1]):
            for figure, text in zip(of.differences, row[2::2], strict=True):
                share = of.differences[figure].shares[step].order_free
                assert text.startswith("(") is not share.excludes_zero


def test_cases_that_are_not_at_equal_comfort_are_named(found: OrderFree) -> None:
    of = found.attributions[1]
    off = replace(of, hours_below=dict(of.hours_below) | {frozenset({1}): 40.0})
    said = notes(replace(found, attributions=[found.attributions[0], off]))
    assert "steady, cold: not at 33 h below the limit: usual + motor (40.0 h)" in said


@pytest.mark.parametrize("width", [60, 120])
def test_a_narrow_terminal_hides_no_share(found: OrderFree, width: int) -> None:
    printed = as_terminal(found, width, colour=False).replace(" ± ", "±")  # a narrow one is set tighter
    assert "…" not in printed
    for table in tables(found):
        assert all(cell.replace(" ± ", "±") in printed for row in table.texts for cell in row)


def test_the_page_holds_every_table_word_for_word(found: OrderFree, text: str) -> None:
    shown = Page(text).texts
    for table in tables(found):
        assert table.names in shown
        assert all(row in shown for row in table.texts)


def test_figures_in_brackets_stand_in_their_column(text: str) -> None:
    assert not any(style == "text" and cell.startswith("(") for row in Page(text).rows for cell, style in row)


def test_the_page_needs_nothing_from_outside_and_is_the_same_every_time(found: OrderFree, text: str) -> None:
    page = Page(text)
    assert "http" not in text
    assert {tag for tag, _, _ in page.attributes} & {"script", "link", "iframe", "object", "img"} == set()
    ids = page.values("id")
    assert len(ids) == len(set(ids))
    references = re.findall(r"url\(#([^)]*)\)", text)
    references += [value[1:] for value in page.values("href") + page.values("xlink:href")]
    assert set(references) <= set(ids)
    assert text.count("<svg id") == 1
    assert as_html(found) == text


def test_the_summary_tells_ladders_sets_and_what_all_steps_do_to_the_heat(text: str) -> None:
    words = " ".join(Page(text).words)
    assert "(switching: 1 step, 2 sets of them; steady: 2 steps, 4 sets of them; 2 members per case)" in words
    assert "Ladder steady, sunny: all steps together change the heat by" in words
