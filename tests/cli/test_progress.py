"""Claims about the bar of long work."""

from __future__ import annotations

import os
import pty
import subprocess
import sys

WORK = """
from waxstudy.cli.simulating import progress
with progress(False) as told:
    told.total(2)
    told.warn("the room [of a:sun:b study] stays cold")
"""


def test_a_warning_stands_on_a_line_of_its_own_above_the_bar() -> None:
    ours, theirs = pty.openpty()
    subprocess.run(
        [sys.executable, "-c", WORK], stderr=theirs, check=True, timeout=60, env=os.environ | {"TERM": "xterm"}
    )
    os.close(theirs)
    shown = os.read(ours, 65536)
    os.close(ours)
    before, _, after = shown.partition(b"warning: the room [of a:sun:b study] stays cold")
    assert before.endswith((b"\x1b[2K", b"\n"))  # the bar's line was erased
    assert after.startswith(b"\r\n")
