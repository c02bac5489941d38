"""Claims about one table in every format."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from dataclasses import dataclass, replace

import pytest
from rich.cells import cell_len

from tests.report.test_page import Page
from waxstudy.report.formats import csv_text, markdown, terminal
from waxstudy.report.html import filled
from waxstudy.report.table import Column, Table, text
from waxstudy.results.json_text import json_text

COLOUR = re.compile(r"\x1b\[([0-9;]*)m")
WORDS = "a sentence of several words, long enough to be broken where the terminal is narrow"


@dataclass(frozen=True)
class Motor:
    name: str
    time_s: float | None
    theirs_s: float
    remark: str
    figures: str
    verdict: str


MOTORS = [
    Motor("A", 7.25, 7.0, WORDS, "1 K; 2 K; 3 K; 4 K; 5 K", "held"),
    Motor("B long", 1234.5, math.nan, "", "1 K", "not held"),
    Motor("C", None, -3.0, "short", "", "not resolved"),
]
COLUMNS: list[Column[Motor]] = [
    text("name", heading="motor"),
    Column("time_s", form=".1f", heading="time", unit="s"),
    Column("theirs_s", form="+.2f", heading="paper", kind="theirs"),
    text("remark", kind="prose"),
    text("figures", kind="list"),
    text("verdict", kind="verdict"),
]
TABLE = Table("times of `motors`", COLUMNS, MOTORS)
NONE = Table("nobody's times", COLUMNS, [])


def lines(table: Table[Motor], width: int = 200) -> list[str]:
    return terminal([table], [], width, colour=False).splitlines()


def on_a_page(*tables: Table[Motor]) -> str:
    words = dict.fromkeys(("title", "simulated", "summary", "version"), "")
    lists = dict.fromkeys(("untold", "steps", "warnings", "sources"), ())
    return filled("identification.html.j2", tables=tables, figures={}, **words, **lists)


def page_rows(*tables: Table[Motor]) -> list[list[tuple[str, str]]]:
    return Page(on_a_page(*tables)).rows


# --- cells -------------------------------------------------------------------------------------------


def test_a_heading_has_its_unit_and_is_the_key_where_nothing_else_is_said() -> None:
    assert TABLE.names == ["motor", "time s", "paper", "remark", "figures", "verdict"]
    assert Column("share", unit="%").name == "share %"
    assert Column("").name == ""
    for shown in (lines(TABLE)[2], markdown("x", [TABLE], []), on_a_page(TABLE)):
        assert "time s" in shown


def test_a_figure_is_written_as_its_column_says_and_a_word_in_its_place_as_it_is() -> None:
    assert [row[1] for row in TABLE.texts] == ["7.2", "1234.5", ""]
    assert [row[2] for row in TABLE.texts] == ["+7.00", "", "-3.00"]
    never: Column[float] = Column("time", lambda value: value if value < 9.0 else "never", ".1f")
    assert [never.text(value) for value in (1.0, 9.0)] == ["1.0", "never"]
    count: Column[int] = Column("count", lambda value: value)
    assert [count.text(value) for value in (0, 3)] == ["0", "3"]


def test_none_and_nan_leave_their_cells_empty_in_every_format() -> None:
    assert "| C |  | -3.00 | short |  | not resolved |" in markdown("x", [TABLE], [])
    assert csv_text(TABLE).splitlines()[2:] == ["B long,1234.5,,,1 K,not held", "C,,-3.00,short,,not resolved"]
    assert [text for text, _ in page_rows(TABLE)[3]] == ["C", "", "-3.00", "short", "", "not resolved"]
    every = (*lines(TABLE), markdown("x", [TABLE], []), csv_text(TABLE), on_a_page(TABLE))
    assert not any(re.search(r"\b(nan|None)\b", shown) for shown in every)
    assert json.loads(json_text({"time_s": [math.nan, math.inf, 1.5]})) == {"time_s": [None, None, 1.5]}


# --- the terminal ------------------------------------------------------------------------------------


def test_in_the_terminal_figures_end_at_the_right_and_words_begin_at_the_left() -> None:
    title, _, head, rule, *rows, _ = lines(TABLE)
    assert title == "times of `motors`"
    assert set(rule.strip()) == {"─"}
    for name in ("time s", "paper"):
        end = head.index(name) + len(name)
        assert {row[end - 1] != " " or not row[end - 6 : end].strip() for row in rows} == {True}
        assert {row[end] for row in rows} == {" "}
    assert [row[head.index("time s") : head.index("time s") + 6] for row in rows] == ["   7.2", "1234.5", "      "]
    for name, first in (("motor", "A"), ("remark", "a sentence"), ("figures", "1 K"), ("verdict", "held")):
        assert rows[0][head.index(name) :].startswith(first)
    assert rows[2][head.index("verdict") :].strip() == "not resolved"


def test_a_narrow_terminal_breaks_prose_and_cuts_nothing() -> None:
    for width in (20, 60, 80, 120):
        shown = lines(TABLE, width)
        assert "…" not in "".join(shown)
        flat = " ".join(" ".join(shown).split())
        for word in ("1234.5", "B long", "-3.00", "not resolved", *WORDS.split()):
            assert word in flat, width
    head, *_ = [line for line in lines(TABLE, 80) if "motor" in line and "time s" in line]
    assert len(head) <= 80
    assert not any(WORDS in line for line in lines(TABLE, 80))
    assert any(WORDS in line for line in lines(TABLE, 200))


def test_a_table_of_figures_alone_is_as_wide_as_it_must_be_however_narrow_the_terminal() -> None:
    """A narrow one is set tighter, no more."""
    many: Table[Motor] = Table("many", [text("name"), *(Column(f"time_s{i}", lambda m: 1e5) for i in range(9))], MOTORS)
    narrow, wide = (lines(many, width)[1:] for width in (20, 500))
    assert narrow[-1].split() == next(line for line in reversed(wide) if line.strip()).split()
    assert 80 < len(narrow[-1]) < len(wide[-1])


def test_wide_letters_are_given_the_room_that_they_take() -> None:
    wide = replace(TABLE, rows=[replace(MOTORS[0], name="電動弁 電動弁 電動弁", remark="")])
    _, _, head, _, row, _ = lines(wide)
    assert cell_len(row[: row.index("7.2")]) == cell_len(head[: head.index("time s")]) + len("time s") - len("7.2")
    assert "電動弁 電動弁 電動弁" in "".join(lines(replace(wide, columns=COLUMNS[:2]), 20))


def test_of_a_list_the_terminal_shows_the_first_three_and_says_where_the_others_are() -> None:
    assert "1 K; 2 K; 3 K; 2 more in --format html" in "\n".join(lines(TABLE))
    assert not any("4 K" in line for line in lines(TABLE))
    for shown in (markdown("x", [TABLE], []), csv_text(TABLE), on_a_page(TABLE)):
        assert "1 K; 2 K; 3 K; 4 K; 5 K" in shown


def test_the_other_side_s_figures_are_dim_and_only_where_there_are_colours() -> None:
    coloured = terminal([TABLE], [], 200, colour=True)
    (row,) = [line for line in coloured.splitlines() if "-3.00" in line]
    parts = zip(COLOUR.findall(row), COLOUR.split(row)[2::2], strict=True)
    assert [style for style, shown in parts if "-3.00" in shown] == ["2"]
    assert COLOUR.sub("", coloured) == terminal([TABLE], [], 200, colour=False)


def test_brackets_and_colons_are_no_markup_in_the_terminal() -> None:
    odd = replace(TABLE, title="[red]x[/red] :warning:", rows=[replace(MOTORS[0], name="[bold]A")])
    shown = terminal([odd], ["a [b]note[/b]"], 200, colour=False)
    for words in ("[red]x[/red] :warning:", "[bold]A", "note: a [b]note[/b]"):
        assert words in shown


# --- Markdown, CSV, HTML -----------------------------------------------------------------------------


def test_markdown_has_a_heading_a_rule_and_escaped_pipes() -> None:
    shown = markdown("study", [replace(TABLE, rows=[replace(MOTORS[0], name="a|b")])], ["a note"])
    title, _, heading, _, head, rule, row, *rest = shown.splitlines()
    assert (title, heading) == ("# study", "## Times of `motors`")
    assert head == "| motor | time s | paper | remark | figures | verdict |"
    assert rule == "| --- | --- | --- | --- | --- | --- |"
    assert row.startswith("| a\\|b | 7.2 | +7.00 |")
    assert rest == ["", "## Notes", "", "- a note"]


def test_csv_is_headed_by_keys_and_is_read_back_as_it_was() -> None:
    odd = replace(TABLE, rows=[replace(MOTORS[0], name='a,"b"\nc')])
    (row,) = csv.DictReader(io.StringIO(csv_text(odd)))
    assert list(row) == ["name", "time_s", "theirs_s", "remark", "figures", "verdict"]
    assert (row["name"], row["time_s"], row["remark"]) == ('a,"b"\nc', "7.2", WORDS)


def test_a_page_escapes_what_it_shows_and_names_columns_in_quotation_marks() -> None:
    shown = on_a_page(replace(TABLE, title="<b>`x`</b>", rows=[replace(MOTORS[0], name="<i>&")]))
    assert "<h3>&lt;b&gt;“x”&lt;/b&gt;</h3>" in shown
    assert "&lt;i&gt;&amp;" in shown
    assert "<h3>Times of “motors”</h3>" in on_a_page(TABLE)


def test_on_a_page_a_column_s_kind_says_how_it_looks_whatever_stands_in_it() -> None:
    head, *rows = page_rows(TABLE)
    assert [style for _, style in head] == ["text", "", "published", "text", "text long", "text"]
    assert [row[-1][1] for row in rows] == ["text good", "text bad", "text open"]
    unlike = replace(TABLE, rows=[replace(MOTORS[0], name="12", remark="no", verdict="held", figures="held")])
    assert [style for _, style in page_rows(unlike)[1]] == ["text", "", "published", "text", "text long", "text good"]


def test_a_table_without_rows_is_left_out() -> None:
    assert terminal([NONE], ["a note"], 80, colour=False) == "note: a note\n"
    assert markdown("study", [NONE], []) == "# study\n"
    assert "<table" not in on_a_page(NONE)
    assert on_a_page(NONE, TABLE).count("<table") == 1
    assert csv_text(NONE) == "name,time_s,theirs_s,remark,figures,verdict\n"


@pytest.mark.parametrize("key", ["time", "name_"])
def test_a_column_of_what_no_row_has_is_no_empty_column(key: str) -> None:
    with pytest.raises(AttributeError, match=key):
        _ = replace(TABLE, columns=[Column(key)]).texts
