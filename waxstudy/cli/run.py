"""`waxstudy run`"""

from __future__ import annotations

from pathlib import Path

import click

from waxstudy.cli.existing import Existing
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.simulating import failures, progress, resumable
from waxstudy.cli.study import load_study


@click.command("run", cls=Command)
@click.argument("study_file", metavar="STUDY.toml", type=Existing())
@click.option("--out", type=click.Path(path_type=Path), help="Run folder  [default: results/NAME of the study]")
@click.option("--replace", "replaces", is_flag=True, help="Let it take the place of another study's results.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of tables.")
@click.option("--quiet", is_flag=True, help="No progress.")
@click.option("--no-jit", is_flag=True, help="Interpret the blocks instead of compiling them; slow, same results.")
def command(study_file: Path, out: Path | None, replaces: bool, as_json: bool, quiet: bool, no_jit: bool) -> None:
    """Run every case of a study and print the comparison.

    What is already computed in the run folder for the same inputs is not computed again. The folder belongs to the
    study file that began it: another one's run is refused. The last line printed is the run folder.
    """
    study = load_study(study_file)
    folder = out or Path("results") / study.name
    with failures(study_file, folder), progress(quiet) as told:
        from waxstudy.api.running import run

        with resumable():
            results = run(study, folder, jit=not no_jit, progress=told, replace=replaces)
    from waxstudy.cli.report import render

    text = render(results, "json" if as_json else "table", study.against)
    print_out(text if as_json else f"{text}{folder}\n")
