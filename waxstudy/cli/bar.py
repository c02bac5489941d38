"""A bar for long work whose share done is known."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Tick = Callable[[str, float], None]


@contextmanager
def bar(quiet: bool) -> Iterator[Tick]:
    """A bar on stderr, on a terminal only."""
    if quiet or not sys.stderr.isatty():
        yield lambda what, share: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (BarColumn(), TaskProgressColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    text = TextColumn("{task.description}")
    with Progress(*columns, text, console=Console(stderr=True), transient=True) as shown:
        task = shown.add_task("beginning", total=1.0)
        yield lambda what, share: shown.update(task, completed=share, description=what)
