"""What the commands of the blind test share: their failures, their bar, the key."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from waxstudy.cli.errors import FAILED, INTERRUPTED, PLUGIN, USAGE, CommandError

if TYPE_CHECKING:
    from waxstudy.blind_test.key import Key

THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")
Tick = Callable[[str, float], None]


@contextmanager
def failures(folder: Path) -> Iterator[None]:
    """Turn what goes wrong into a message and an exit code."""
    from concurrent.futures import BrokenExecutor

    from waxstudy.blind_test.key import KeyProblem
    from waxstudy.blind_test.make import BlindTestError
    from waxstudy.blind_test.plan import PlanProblem
    from waxstudy.plugin.registry import PluginError
    from waxstudy.plugin.trial import Unmakeable

    # the matrices are small: threads of the linear algebra library would only wait for each other
    if not set(THREADS) & set(os.environ):
        os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    except (BlindTestError, KeyProblem, PlanProblem) as error:
        raise CommandError(str(error), USAGE) from error
    except PluginError as error:
        raise CommandError(str(error), PLUGIN) from error
    except Unmakeable as error:
        raise CommandError(str(error), FAILED) from error
    except BrokenExecutor as error:
        ended = "a worker was ended, by lack of memory perhaps; what was finished is kept, take fewer --workers"
        raise CommandError(ended, FAILED) from error
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise CommandError(f"{folder}: {reason}", FAILED) from error
    except KeyboardInterrupt:
        kept = "interrupted; what was finished is kept, the same command goes on from there"
        raise CommandError(kept, INTERRUPTED, label="") from None


def key_given(text: str | None, file: Path | None) -> Key | None:
    """Return the key of --key or --key-file, None where neither holds one; raise `KeyProblem` or `OSError`."""
    from waxstudy.blind_test.key import Key, KeyProblem

    if text and file:
        raise KeyProblem("give --key or --key-file, not both")
    if text:
        return Key.read(text)
    return Key.read(file.read_text(encoding="utf-8")) if file and file.exists() else None


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
