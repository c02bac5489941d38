"""What commands that simulate say meanwhile: progress, warnings, and why they stopped."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from waxstudy.cli.errors import BACKEND, FAILED, INTERRUPTED, INVALID, PLUGIN, USAGE, CommandError, say
from waxstudy.study.visible import visible_lines

if TYPE_CHECKING:
    from waxstudy.simulation.run import Progress


@contextmanager
def resumable() -> Iterator[None]:
    """Say of an interrupted run what is kept of it."""
    try:
        yield
    except KeyboardInterrupt:
        kept = "interrupted; what was finished is kept, the same command goes on from there"
        raise CommandError(kept, INTERRUPTED, label="") from None


@contextmanager
def failures(study_file: Path, folder: Path) -> Iterator[None]:
    from waxstudy.plugin import BackendMissing, SimulationError
    from waxstudy.plugin.registry import PluginError
    from waxstudy.results.folder import OtherStudy, RunError
    from waxstudy.simulation.run import InputError
    from waxstudy.study.read import StudyError, problem_at

    try:
        yield
    except InputError as error:
        problem = problem_at(study_file, error.path, str(error), error.key, error.value)
        raise CommandError(str(problem), INVALID, label="") from error
    except StudyError as error:
        raise CommandError(str(error), PLUGIN if error.is_plugin_fault else INVALID, label="") from error
    except PluginError as error:
        raise CommandError(str(error), PLUGIN) from error
    except BackendMissing as error:
        raise CommandError(str(error), BACKEND) from error
    except OtherStudy as error:
        raise CommandError(str(error), USAGE) from error
    except (SimulationError, RunError) as error:
        raise CommandError(str(error), FAILED) from error
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise CommandError(f"{folder}: the results cannot be written: {reason}", FAILED) from error


def warn(text: str) -> None:
    say(f"warning: {text}")


@contextmanager
def progress(quiet: bool, of: str = "cases") -> Iterator[Progress]:
    """A bar on stderr, on a terminal only."""
    from waxstudy.simulation.run import Progress

    if quiet or not sys.stderr.isatty():
        yield Progress(warn=warn)
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("preparing", total=None)
        total: Callable[[int], None] = lambda n: bar.update(task, total=n, description=of)  # noqa: E731
        # above the bar, which it would else be glued to
        above: Callable[[str], None] = lambda text: bar.console.print(  # noqa: E731
            visible_lines(f"warning: {text}"), markup=False, emoji=False, highlight=False, soft_wrap=True
        )
        yield Progress(warn=above, total=total, done=lambda case, computed: bar.advance(task))
