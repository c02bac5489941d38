"""`waxstudy run`"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.errors import BACKEND, FAILED, INTERRUPTED, INVALID, PLUGIN, CommandError
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.study import load_study

if TYPE_CHECKING:
    from waxstudy.simulation.run import Progress


@click.command("run", cls=Command)
@click.argument("study_file", metavar="STUDY.toml", type=click.Path(exists=True, path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Run folder  [default: results/NAME of the study]")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of tables.")
@click.option("--quiet", is_flag=True, help="No progress.")
@click.option("--no-jit", is_flag=True, help="Interpret the blocks instead of compiling them; slow, same results.")
def command(study_file: Path, out: Path | None, as_json: bool, quiet: bool, no_jit: bool) -> None:
    """Run every case of a study and print the comparison.

    What is already computed in the run folder for the same inputs is not computed again. The last line printed is
    the run folder.
    """
    study = load_study(study_file)
    folder = out or Path("results") / study.name
    with failures(study_file, folder), progress(quiet) as told:
        from waxstudy.simulation.run import run

        with resumable():
            run(study, folder, jit=not no_jit, progress=told)
    from waxstudy.cli.report import render

    text = render(folder, "json" if as_json else "table", study.against)
    print_out(text if as_json else f"{text}{folder}\n")


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
    from waxstudy.results.run import RunError
    from waxstudy.simulation.run import InputError
    from waxstudy.study.read import problem_at

    try:
        yield
    except InputError as error:
        problem = problem_at(study_file, tuple(error.table.split(".", 1)), str(error), error.key, error.value)
        raise CommandError(str(problem), INVALID, label="") from error
    except PluginError as error:
        raise CommandError(str(error), PLUGIN) from error
    except BackendMissing as error:
        raise CommandError(str(error), BACKEND) from error
    except (SimulationError, RunError) as error:
        raise CommandError(str(error), FAILED) from error
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise CommandError(f"{folder}: the results cannot be written: {reason}", FAILED) from error


def warn(text: str) -> None:
    click.echo(f"warning: {text}", err=True)


@contextmanager
def progress(quiet: bool) -> Iterator[Progress]:
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
        total: Callable[[int], None] = lambda n: bar.update(task, total=n, description="cases")  # noqa: E731
        yield Progress(warn=warn, total=total, done=lambda case, computed: bar.advance(task))
