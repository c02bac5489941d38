"""Claims about the text formats."""

from __future__ import annotations

import csv
import doctest
import io
import json
from collections.abc import Sequence
from dataclasses import replace
from types import ModuleType

import pytest
from hypothesis import given
from hypothesis import strategies as st

from waxstudy.plugin import Finding, PublishedRow, Reference
from waxstudy.report import formats, words
from waxstudy.report.against import Published, published
from waxstudy.report.comparison import COLUMNS
from waxstudy.report.content import Content
from waxstudy.report.diagnosis.words import number
from waxstudy.report.render import all_notes, as_csv, as_json, as_markdown, as_terminal, tables


@pytest.mark.parametrize("width", [60, 80, 120, 200])
def test_a_narrow_terminal_hides_no_figure(small: Content, width: int) -> None:
    text = as_terminal(small, width, colour=False)
    assert "…" not in text
    for row in small.rows:
        assert f"{row.heat_kWh_m2_week.mean:.2f} ± " in text.replace(" ± ", "±").replace("±", " ± ")


def test_the_tables_of_a_run_fit_100_columns_beside_published_figures_as_well(small: Content) -> None:
    beside = replace(small, against=published(Book, small.run, small.rows))
    for content in (small, beside):
        lines = as_terminal(content, 100, colour=False).splitlines()
        assert max(map(len, lines)) <= 100


@given(st.floats(1e-4, 9.9e5) | st.floats(-9.9e5, -1e-4))
def test_a_figure_of_a_diagnosis_has_three_significant_digits(value: float) -> None:
    text = number(value)
    assert float(text) == pytest.approx(value, rel=0.0051)
    if abs(value) < 1000.0 and value != round(value):
        assert len(text.lstrip("-").replace(".", "").lstrip("0")) in (3, 4)  # 9.999 becomes 10.00


def test_every_format_tells_the_same_heat(small: Content) -> None:
    lines = {(line["case"], line["week"]): line for line in csv.DictReader(io.StringIO(as_csv(small)))}
    said = {(row["case"], row["week"]): row for row in json.loads(as_json(small))["rows"]}
    for row in small.rows:
        key, heat = (row.case, row.week), row.heat_kWh_m2_week.mean
        assert float(lines[key]["heat_kWh_m2_week"]) == pytest.approx(heat, abs=1e-5)
        assert said[key]["heat_kWh_m2_week"]["mean"] == heat
        assert f"| {row.case} | " in as_markdown(small)


def test_csv_has_the_columns_of_table_5_each_with_its_spread(bare: Content) -> None:
    header = as_csv(bare).splitlines()[0].split(",")
    figures = [name for column in COLUMNS for name in (column, f"{column}_sd")]
    raw = ["case", "week", *figures[:8], "cycles_per_week", "resolved", "single_run_share"]
    assert header == [*raw, *figures[8:], "corrected_resolved", "corrected_single_run_share"]


def test_no_table_has_a_row_of_another_length(small: Content) -> None:
    for table in tables(small):
        assert {len(row) for row in table.texts} <= {len(table.names)}, table.title


class Book(Reference):
    """Figures of one case in one week."""

    name = "book"
    description = "made up"

    @classmethod
    def rows(cls) -> Sequence[PublishedRow]:
        return [PublishedRow("rough", "cold", 0.5, 0.6, 2.5, 5.7)]


class Other(Book):
    """Figures of nothing that the small study has."""

    @classmethod
    def rows(cls) -> Sequence[PublishedRow]:
        return [PublishedRow("elsewhere", "cold", 0.5, 0.6, 2.5, 5.7)]


def test_weeks_without_a_published_figure_have_no_empty_columns_and_a_note_says_why(small: Content) -> None:
    shown = {}
    for reference in (Book, Other):
        against = replace(small, against=published(reference, small.run, small.rows))
        shown[reference] = [table.names.count("book") for table in tables(against)[:4:2]], all_notes(against)[-2:]
    lacking = (
        "cases of which book has no figures: precise, usual, pulsed, motor",
        "weeks of which book has no figures: sunny",
    )
    assert shown[Book] == ([4, 0], list(lacking))
    assert shown[Other] == ([0, 0], [lacking[0].replace("precise", "rough, precise"), lacking[1]])


def test_the_terminal_shows_three_figures_of_a_finding_and_says_where_the_others_are(small: Content) -> None:
    finding = Finding("X", "many", "held", "1 K; 2 K; 3 K; 4 K; 5 K")
    against = replace(small, against=Published("book", (), (), [finding]))
    text = as_terminal(against, 200, colour=False)
    assert "1 K; 2 K; 3 K; 2 more in --format html" in text
    assert "`the mean decides`, or not where its 95 % interval reaches over a limit" in text
    assert "1 K; 2 K; 3 K; 4 K; 5 K" in as_markdown(against)


def test_titles_say_what_counts_by_the_week_and_the_study_s_actuators_are_marked(small: Content) -> None:
    shown = {table.title: table.texts for table in tables(small)}
    assert sum(title.endswith("; heat and cycles per week") for title in shown) == 2
    actuators = next(rows for title, rows in shown.items() if title.endswith("; * in this study"))
    assert [row[0] for row in actuators if row[0].endswith("*")] == ["variable-times, product B *"]
    assert len(actuators) > 1


@pytest.mark.parametrize(("module", "examples"), [(formats, 2), (words, 6)], ids=["formats", "words"])
def test_the_examples_of_how_texts_are_written_hold(module: ModuleType, examples: int) -> None:
    assert doctest.testmod(module) == (0, examples)
