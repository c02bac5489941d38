"""Whoever named a record, a room or a file does not get to command the reader's terminal or page."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.diagnosis.houses import Event, made
from tests.diagnosis.test_neighbours import written
from waxstudy.report.formats import markdown, terminal
from waxstudy.report.table import Column, Table, text

NAME = "room\x1b[8m\x1b]0;owned\x07\n2\x9b1m\u202e居$\\x"
COMMANDS = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202e]")  # all but the ends of lines


def test_names_in_a_diagnosis_are_shown_and_not_obeyed(entry: Entry) -> None:
    house = made(0, days=8, events=[Event(2, [(100.0, 108.0)], outside_W_K=30.0)])
    folder = written(Path("house"), house, 5)
    about, data = folder / "dataset.toml", folder / "data.csv"
    named = json.dumps(NAME)[1:-1]
    told = about.read_text().replace("[neighbours.room2]", f'[neighbours."{named}"]')
    told = told.replace('name = "made"', f'name = "{named}"\n"{named}" = 1')
    about.write_text(told)
    done = entry("diagnose", folder, "--out", "out", "--quick", "--quiet")
    assert done.code == 0, done.stderr
    page = Path("out/report.html").read_text()
    for told in (done.stdout, done.stderr, page):
        assert not COMMANDS.search(told)
    assert r"room\x1b[8m" in done.stdout
    assert r"room\x1b[8m" in page
    data.write_text(data.read_text().replace("room1", "r\x1b[2Joom1", 1))
    done = entry("diagnose", folder, "--quiet")
    assert done.code == 3
    assert r"r\x1b[2Joom1" in done.stderr
    assert not COMMANDS.search(done.stderr)


@pytest.mark.skipif(sys.platform == "win32", reason="no file has such a name there")
def test_names_of_files_in_messages_are_shown_and_not_obeyed(entry: Entry) -> None:
    Path("a\x1b[2J").mkdir()
    for command in (("diagnose", "a\x1b[2J"), ("diagnose", "b\x1b[2J"), ("run", "\x9b2J.toml"), ("\x1b[2J",)):
        done = entry(*command)
        assert done.code != 0
        assert not COMMANDS.search(done.stderr), command


def test_a_table_has_no_colour_and_no_line_of_a_name_s() -> None:
    table: Table[str] = Table(NAME, [text("name", str), Column("length", len)], [NAME])
    printed = terminal([table], [NAME], 80, colour=True)
    assert "\x1b[1m" in printed  # ours, of titles
    assert not re.search("\x1b(?!\\[[0-9;]*m)|\x1b\\[8m|\x07|\x9b|\u202e", printed)
    assert sum("room" in line for line in printed.splitlines()) == 3
    lines = [line for line in markdown("t", [table], [NAME]).splitlines() if line]
    assert lines[-1].startswith("- room")
    assert len(lines) == 7
