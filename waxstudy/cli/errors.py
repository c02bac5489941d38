"""Exit codes, and one place where an exception becomes a message."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import Any

import click

DONE, CHECK_FAILED, USAGE, INVALID, PLUGIN, BACKEND, FAILED, INTERRUPTED = 0, 1, 2, 3, 4, 5, 6, 130


class CommandError(Exception):
    """A message for the user and the exit code that goes with it."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code


def exit_code(command: Callable[[], Any]) -> int:
    """Run a command; print what went wrong on stderr and return the exit code."""
    try:
        return int(command() or DONE)
    except click.ClickException as error:
        error.show()
        return USAGE
    except (KeyboardInterrupt, click.Abort):
        click.echo("interrupted; what was finished is kept, the same command goes on from there", err=True)
        return INTERRUPTED
    except CommandError as error:
        click.echo(f"error: {error}" if "\n" not in str(error) else str(error), err=True)
        return error.code
    except BrokenPipeError:
        # the reader has gone; keep Python from complaining when it flushes at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return DONE
