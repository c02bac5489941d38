"""Claims about the process that runs an engine: who asked it may stop at any moment."""

from __future__ import annotations

import subprocess
import sys
import threading

import pytest

from waxstudy.simulation.own_process import _exchange


def test_a_question_to_a_process_that_nobody_waits_for_any_more_prints_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C may close the pipe before the question is written: its traceback would stand beside "interrupted"."""
    told: list[threading.ExceptHookArgs] = []
    monkeypatch.setattr(threading, "excepthook", told.append)
    with subprocess.Popen([sys.executable, "-c", ""], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdin
        process.stdin.close()
        assert _exchange(process, b"job", lambda: False) == b""
    assert told == []
