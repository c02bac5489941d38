"""What both fits share: column names, what goes wrong, and the files that are written."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from waxstudy.cli.errors import FAILED, INVALID, PLUGIN, USAGE, CommandError
from waxstudy.cli.output import terminal

if TYPE_CHECKING:
    from waxstudy.report.table import Table

F = TypeVar("F", bound=Callable[..., Any])
COLUMN = "Column that holds the time, signal, displacement or flow, if its name does not tell; repeatable."
KNOWN = ("time", "signal", "displacement", "flow")


def column_option(function: F) -> F:
    option = click.option("--column", "columns", multiple=True, callback=_columns, metavar="WHAT=NAME", help=COLUMN)
    decorated: F = option(function)
    return decorated


def _columns(ctx: click.Context, param: click.Parameter, texts: Sequence[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for text in texts:
        what, _, name = text.partition("=")
        if what not in KNOWN or not name:
            raise click.BadParameter(f"'{text}' is not one of {', '.join(KNOWN)}, '=' and a column's name", ctx, param)
        found[what] = name
    return found


@contextmanager
def failures() -> Iterator[None]:
    """Turn what is wrong with records and plugins into messages and exit codes."""
    from waxstudy.plugin import SimulationError
    from waxstudy.plugin.registry import PluginError
    from waxstudy.study.problems import StudyError

    try:
        yield
    except StudyError as error:
        raise CommandError(str(error), INVALID, label="") from error
    except PluginError as error:
        raise CommandError(str(error), PLUGIN) from error
    except SimulationError as error:
        raise CommandError(str(error), FAILED) from error


def beside(out: Path) -> tuple[Path, Path]:
    """Return the page and the figures that go beside a fragment."""
    return out.with_suffix(".html"), out.with_suffix(".json")


def refuse_unwritable(out: Path) -> None:
    """Say before the work, not after it, that its results could not be written."""
    if out.suffix.lower() != ".toml":
        raise CommandError(f"{out}: the name of a file that ends in .toml is needed", USAGE)
    if not out.parent.is_dir() or not os.access(out.parent, os.W_OK | os.X_OK):
        raise CommandError(f"{out}: {out.parent} is no folder to write to", USAGE)
    refuse_targets((out,), ())


def refuse_targets(targets: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Say before the work that a file cannot be written, or would take the place of what is read."""
    read = {path.resolve() for path in inputs}
    for path in targets:
        try:
            is_folder, is_read = path.is_dir(), path.resolve() in read or _is_one_of(path, read)
        except OSError as error:  # a name that is too long, say
            raise CommandError(f"{path}: cannot be written: {os.strerror(error.errno or 0)}", USAGE) from error
        if is_folder:
            raise CommandError(f"{path}: this is a folder; a file is to be written there", USAGE)
        if is_read:
            raise CommandError(f"{path}: this file is read; choose another name with --out", USAGE)


def _is_one_of(path: Path, others: Iterable[Path]) -> bool:
    """Whether it is the same file under another name: a link, or another case where that does not count."""
    return path.exists() and any(other.exists() and path.samefile(other) for other in others)


def write(texts: Mapping[Path, str]) -> None:
    """Write all files whole, the first last."""
    from waxstudy.results.atomic import whole_file

    try:
        with ExitStack() as files:
            for path, text in texts.items():
                files.enter_context(whole_file(path)).write_text(text, encoding="utf-8")
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise CommandError(f"the results cannot be written: {reason}", FAILED) from error


def printed(tables: Sequence[Table[Any]], notes: Sequence[str]) -> str:
    from waxstudy.report import formats

    return formats.terminal(tables, notes, *terminal())
