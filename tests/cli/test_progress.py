"""Claims about the bar of long work."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

from tests.conftest import WAXSTUDY

WORK = """
from waxstudy.cli.simulating import progress
with progress(False) as told:
    told.total(2)
    told.warn("the room [of a:sun:b study] stays cold")
"""


def on_a_terminal(*command: str | Path) -> bytes:
    """What a command shows on stderr."""
    ours, theirs = pty.openpty()
    with subprocess.Popen(command, stderr=theirs, env=os.environ | {"TERM": "xterm", "COLUMNS": "120"}) as process:
        os.close(theirs)
        shown = b""
        with suppress(OSError):  # the command has ended
            while piece := os.read(ours, 65536):
                shown += piece
    os.close(ours)
    assert process.returncode == 0
    return shown


def test_a_page_shows_how_far_it_is_unless_quiet(small_run: Path) -> None:
    page, table = small_run / "page.html", small_run / "table.csv"
    assert b"drawing figures" in on_a_terminal(WAXSTUDY, "report", small_run, "--out", page)
    assert page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert on_a_terminal(WAXSTUDY, "report", small_run, "--out", table, "--quiet") == b""


def test_a_warning_stands_on_a_line_of_its_own_above_the_bar() -> None:
    shown = on_a_terminal(sys.executable, "-c", WORK)
    before, _, after = shown.partition(b"warning: the room [of a:sun:b study] stays cold")
    assert before.endswith((b"\x1b[2K", b"\n"))  # the bar's line was erased
    assert after.startswith(b"\r\n")
