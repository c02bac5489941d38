"""Claims about the text formats."""

from __future__ import annotations

import csv
import io
import json

import pytest

from waxstudy.report.comparison import COLUMNS
from waxstudy.report.content import Content
from waxstudy.report.render import as_csv, as_json, as_markdown, as_terminal, tables


@pytest.mark.parametrize("width", [60, 80, 120, 200])
def test_a_narrow_terminal_hides_no_figure(small: Content, width: int) -> None:
    text = as_terminal(small, width, colour=False)
    assert "…" not in text
    for row in small.rows:
        assert f"{row.heat_kWh_m2_week.mean:.2f} ± " in text


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
    assert header == ["case", "week", *figures, "cycles_per_week", "resolved"]


def test_no_table_has_a_row_of_another_length(small: Content) -> None:
    for title, headings, rows in tables(small):
        assert {len(row) for row in rows} <= {len(headings)}, title
