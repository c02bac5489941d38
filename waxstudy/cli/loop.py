"""`waxstudy loop`"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import click

from waxstudy.cli.errors import USAGE, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out, terminal, write_file
from waxstudy.cli.simulating import failures, progress
from waxstudy.cli.study import known, load_study


@click.command("loop", cls=Command)
@click.argument("study_file", metavar="STUDY.toml", type=Existing())
@click.option("--case", "cases", multiple=True, metavar="ID", help="Case to look at; repeatable  [default: all]")
@click.option("--week", "weeks", multiple=True, metavar="NAME", help="Week to look at; repeatable  [default: all]")
@click.option("--out", type=Written(), metavar="FILE.html", help="Write a page with the open loops.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of tables.")
@click.option("--quiet", is_flag=True, help="No progress.")
@click.option("--no-jit", is_flag=True, help="Interpret the blocks instead of compiling them; slow, same results.")
def command(
    study_file: Path,
    cases: Sequence[str],
    weeks: Sequence[str],
    out: Path | None,
    as_json: bool,
    quiet: bool,
    no_jit: bool,
) -> None:
    """Print stability, wear and useful duty of every case's loop.

    Gain and phase margin of the linearised loop, the gain and period at which it would just swing, how often signal
    and valve move, and the least duty that is of use.
    """
    study = load_study(study_file)
    known("--case", cases, list(study.cases))
    known("--week", weeks, list(study.weeks))
    if out is not None:
        _refuse_unwritable(out)
    with failures(study_file, out or Path()), progress(quiet) as told:
        from waxstudy.loop.loops import loops
        from waxstudy.report.tuning.loops import Loops

        found = Loops(
            study.name, loops(study, cases or list(study.cases), weeks or list(study.weeks), told, not no_jit)
        )
    from waxstudy.report import formats
    from waxstudy.report.tuning.loops import as_html, notes, summary, tables
    from waxstudy.report.tuning.loops import as_json as told_as_json
    from waxstudy.results.json_text import json_text

    if out is not None:
        write_file(out, as_html(found))
    text = json_text(told_as_json(found)) if as_json else ""
    written = "" if out is None else f"{out}\n"
    print_out(text or f"{summary(found)}\n{formats.terminal(tables(found), notes(found), *terminal())}{written}")


def _refuse_unwritable(out: Path) -> None:
    """Say before the work, not after it, that the page could not be written."""
    if out.is_dir() or not out.absolute().parent.is_dir() or not os.access(out.absolute().parent, os.W_OK | os.X_OK):
        raise CommandError(f"{out}: no file can be written there", USAGE)
