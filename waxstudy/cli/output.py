"""What a command prints: on stdout its results alone, on stderr what plugins print meanwhile."""

from __future__ import annotations

import io
import os
import re
import shutil
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any, TextIO

import click

from waxstudy.cli.errors import FAILED, PLUGIN, USAGE, CommandError
from waxstudy.study.visible import visible_lines

COLUMNS = 120  # where no terminal tells
COLOUR = re.compile("(\x1b\\[[0-9;]*m)")
MOST_PRINTED = 10  # lines; a block that prints does so at every step


class Aside(io.TextIOBase):
    """Where plugins print: the first lines go to stderr, the rest nowhere."""

    def __init__(self) -> None:
        super().__init__()
        self.lines = 0

    def write(self, text: str) -> int:
        if self.lines < MOST_PRINTED:
            sys.stderr.write(text)
            self.lines += text.count("\n")
            if self.lines >= MOST_PRINTED:
                sys.stderr.write("... (what plugins print from here on is left out)\n")
        return len(text)


class Command(click.Command):
    """A command that leaves stdout to `print_out`, and does not let a plugin end it."""

    def invoke(self, ctx: click.Context) -> Any:
        ctx.obj = sys.stdout
        try:
            with redirect_stdout(Aside()):
                return super().invoke(ctx)
        except SystemExit as error:
            from waxstudy.plugin.registry import described

            raise CommandError(f"a plugin ended the program: {described(error)}", PLUGIN) from error


def stdout() -> TextIO:
    """Return the stream for results, which is not `sys.stdout` while a command runs."""
    stream: TextIO = click.get_current_context().obj
    return stream


def terminal(out: Path | None = None) -> tuple[int, bool]:
    """Return how many columns the reader's terminal has, and whether it shows colours; a file has 120 and none."""
    if out is not None:
        return COLUMNS, False
    return shutil.get_terminal_size((COLUMNS, 24)).columns, stdout().isatty()


def print_out(text: str) -> None:
    """Write to stdout; a reader that has seen enough and closed it is no failure."""
    parts = COLOUR.split(text) if stdout().isatty() else [text]
    # every second one is a colour, of ours: what `console` prints brings none with a name
    safe = "".join(part if place % 2 else visible_lines(part) for place, part in enumerate(parts))
    try:
        click.echo(safe, file=stdout(), nl=False)
    except OSError as error:
        # keep Python from complaining once more when it flushes at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), stdout().fileno())
        if not isinstance(error, BrokenPipeError):
            raise CommandError(f"the output cannot be written: {error.strerror or error}", FAILED) from error


def refuse_unwritable_folder(out: Path, code: int = USAGE) -> None:
    """Say before the work, not after it, that its results could not be written, with an exit code."""
    there = next(path for path in (out, *out.absolute().parents) if os.path.exists(path))
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        raise CommandError(f"{out}: the results cannot be written: {there} is no folder to write to", code)


def write_file(out: Path, text: str) -> None:
    """Write a file whole; a device or pipe is written to, as a file in its place would take it from everyone."""
    from waxstudy.results.atomic import whole_file

    try:
        if out.exists() and not out.is_file():
            out.write_text(text, encoding="utf-8")
            return
        with whole_file(out) as path:
            path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise CommandError(f"{out}: cannot be written: {error.strerror}", FAILED) from error
