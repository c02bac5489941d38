"""Exit codes, and one place where an exception becomes a message."""

from __future__ import annotations

import io
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import Any

import click

from waxstudy.study.visible import visible_lines

DONE, CHECK_FAILED, USAGE, INVALID, PLUGIN, BACKEND, FAILED, INTERRUPTED = 0, 1, 2, 3, 4, 5, 6, 130


class CommandError(Exception):
    """A message for the user and the exit code that goes with it.

    Problems of a file start with its place, as compilers print it, and have no label.
    """

    def __init__(self, message: str, code: int, label: str = "error: ") -> None:
        super().__init__(f"{label}{message}")
        self.code = code


def taken(path: Path) -> CommandError:
    """Nothing is written over."""
    found = f"{path}: there is something of this name already"
    return CommandError(f"{found}: move it away or take another name; nothing was written", USAGE)


def exit_code(command: Callable[[], Any]) -> int:
    """Run a command; print what went wrong on stderr and return the exit code."""
    _make_streams_safe()
    try:
        with _ended_as_by_ctrl_c():
            return int(command() or DONE)
    except click.ClickException as error:
        shown = io.StringIO()
        error.show(shown)
        say(shown.getvalue().rstrip("\n"))
        return USAGE
    except (KeyboardInterrupt, click.Abort) as error:
        if isinstance(error.__cause__, EOFError):  # of a damaged file; click takes it for a terminal that was closed
            raise error.__cause__ from None
        say("interrupted")
        return INTERRUPTED
    except CommandError as error:
        say(str(error))
        return error.code


def say(text: str) -> None:
    """Write to stderr."""
    click.echo(visible_lines(text), err=True)


@contextmanager
def _ended_as_by_ctrl_c() -> Iterator[None]:
    """Let what asks a process to end, and the end of its terminal, take the path of Ctrl-C."""
    numbers = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
    is_main = threading.current_thread() is threading.main_thread()  # no other thread may say so
    # what was told to go on without its terminal does
    taken_over = [each for each in numbers if is_main and signal.getsignal(each) == signal.SIG_DFL]
    for number in taken_over:
        signal.signal(number, signal.default_int_handler)
    try:
        yield
    finally:
        for number in taken_over:
            signal.signal(number, signal.SIG_DFL)


def _make_streams_safe() -> None:
    """Whoever starts the program may have closed a stream, and not every console has a plus-minus."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w"))  # noqa: SIM115 - open to the end
        elif isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")
