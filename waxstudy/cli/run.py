"""`waxstudy run`"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.errors import FAILED, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out, refuse_unwritable_folder
from waxstudy.cli.simulating import failures, progress, resumable
from waxstudy.cli.study import load_study
from waxstudy.sweeps.kinds import KINDS, Kind

if TYPE_CHECKING:
    from waxstudy.study.model import Study


@click.command("run", cls=Command)
@click.argument("study_file", metavar="STUDY.toml", type=Existing())
@click.option("--out", type=Written(), help="Run folder  [default: results/NAME of the study]")
@click.option("--replace", "replaces", is_flag=True, help="Let it take the place of another study's results.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of tables.")
@click.option("--quiet", is_flag=True, help="No progress.")
@click.option("--no-jit", is_flag=True, help="Interpret the blocks instead of compiling them; slow, same results.")
@click.option("--sweep", "sweep_file", type=Existing(dir_okay=False), help="Run it at every point of this file.")
@click.option("--executor", type=click.Choice(KINDS), help="Where a sweep is computed  [default: threads]")
@click.option("--workers", type=click.IntRange(1), help="Points or batches at a time  [default: one for each core]")
@click.option("--scheduler", metavar="ADDRESS", help="Of dask  [default: a cluster on this machine]")
def command(
    study_file: Path,
    out: Path | None,
    replaces: bool,
    as_json: bool,
    quiet: bool,
    no_jit: bool,
    sweep_file: Path | None,
    executor: Kind | None,
    workers: int | None,
    scheduler: str | None,
) -> None:
    """Run every case of a study and print the comparison.

    What is already computed in the run folder for the same inputs is not computed again. The folder belongs to the
    study file that began it: another one's run is refused. Without --json, the last line printed is the
    run folder.

    With --sweep the study is run at many values of its parameters, and the folder holds one table of key figures. A
    study with [activation] calls a fleet of loops instead, and the folder holds what that gives, with a page.
    """
    if sweep_file is None and (executor or scheduler):
        raise click.UsageError("--executor and --scheduler are of a sweep: name its file with --sweep")
    if scheduler and executor != "dask":
        raise click.UsageError("--scheduler is dask's: add --executor dask")
    if sweep_file is not None:
        if replaces or as_json:
            raise click.UsageError("--replace and --json are of a single run")
        _sweep(study_file, sweep_file, out, executor or "threads", workers, scheduler, quiet, not no_jit)
        return
    study = load_study(study_file)
    folder = out or Path("results") / study.name
    refuse_unwritable_folder(folder, FAILED)
    if study.activation:
        if replaces:
            raise click.UsageError("--replace is of a run of cases; this study has [activation]")
        _activate(study, folder, workers, as_json, quiet, not no_jit)
        return
    if workers:
        raise click.UsageError("--workers is of a sweep, named with --sweep, or of a study with [activation]")
    with failures(study_file, folder), progress(quiet) as told:
        from waxstudy.api.running import Results, run

        with resumable():
            results = run(study, folder, jit=not no_jit, progress=told, replace=replaces)
    from waxstudy.cli.report import render

    assert isinstance(results, Results)  # of cases
    text = render(results, "json" if as_json else "table", study.against)
    print_out(text if as_json else f"{text}{folder}\n")


def _activate(study: Study, folder: Path, workers: int | None, as_json: bool, quiet: bool, jit: bool) -> None:
    with failures(study.file or folder, folder), progress(quiet, "batches of loops") as told, resumable():
        from waxstudy.api.activating import activate

        found = activate(study, folder, workers=workers, jit=jit, progress=told)
    from waxstudy.cli.output import terminal
    from waxstudy.report.fleet.tables import render

    text = render(found, "json" if as_json else "table", *terminal())
    print_out(text if as_json else f"{text}{folder}\n")


def _sweep(
    study_file: Path,
    sweep_file: Path,
    out: Path | None,
    kind: Kind,
    workers: int | None,
    scheduler: str | None,
    quiet: bool,
    jit: bool,
) -> None:
    study = load_study(study_file)
    if study.activation:
        raise click.UsageError("a sweep is of a study's cases; this one has [activation]")
    folder = out or Path("results") / f"{study.name}-{sweep_file.stem}"
    refuse_unwritable_folder(folder, FAILED)
    with failures(study_file, folder), progress(quiet, "points") as told, resumable():
        from waxstudy.api.sweeping import sweep

        done = sweep(
            study_file, sweep_file, folder, executor=kind, workers=workers, scheduler=scheduler, jit=jit, progress=told
        )
    from waxstudy.report.words import counted

    print_out(f"{counted(done.points, 'point')}, {len(done.failed)} failed: {done.file}\n{folder}\n")
    if done.failed:
        raise CommandError(f"{len(done.failed)} of {done.points} points failed and were left out", FAILED)
