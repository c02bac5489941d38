"""`waxstudy report`"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.bar import Tick, bar
from waxstudy.cli.errors import BACKEND, INVALID, PLUGIN, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out, terminal, write_file
from waxstudy.cli.simulating import failures, progress, resumable
from waxstudy.cli.study import load_study

if TYPE_CHECKING:
    from waxstudy.report.attribution.shares import OrderFree
    from waxstudy.results.run import Run
    from waxstudy.study.model import Study

FORMATS = ("table", "csv", "md", "html", "json")
READ = 0.4  # of the time that a page takes
WHAT = "What to print  [default: what the suffix of --out says, else table]"


@click.command("report", cls=Command)
@click.argument("run_folder", metavar="RUN", type=Existing(file_okay=False))
@click.option("--format", "form", type=click.Choice(FORMATS), help=WHAT)
@click.option("--json", "as_json", is_flag=True, help="The same as --format json.")
@click.option("--against", help="What to put beside the run: published figures, e.g. `paper`, or a run folder.")
@click.option(
    "--attribution",
    is_flag=True,
    help="In its place: what each step of a ladder adds, averaged over all orders; computes the cases that this needs.",
)
@click.option("--sensitivity", is_flag=True, help="Of a sweep by `sobol`: what the variance of each figure comes from.")
@click.option("--out", type=Written(dir_okay=False), help="Write to a file instead of printing.")
@click.option("--quiet", is_flag=True, help="No progress.")
def command(
    run_folder: Path,
    form: str | None,
    as_json: bool,
    against: str | None,
    attribution: bool,
    sensitivity: bool,
    out: Path | None,
    quiet: bool,
) -> None:
    """Print the comparison of a run again, or what each step of its ladders adds whatever their order.

    Of a fleet that was called, print its tables. The cases that --attribution computes are kept in the run folder;
    those that it holds are not computed again.
    """
    if as_json and form not in (None, "json"):
        raise click.UsageError(f"--json stands for --format json and goes with no --format {form}")
    form = "json" if as_json else form or _by_suffix(out)
    if attribution and against is not None:
        raise click.UsageError("--attribution stands in place of the comparison and goes with no --against")
    if sensitivity and (attribution or against is not None or form == "html"):
        raise click.UsageError("--sensitivity goes with --format table, csv, md or json only")
    if not sensitivity:
        _refuse_sweep(run_folder)
    text = _of_fleet(run_folder, form, attribution or sensitivity or against is not None, out)
    if not text and sensitivity:
        text = render_sensitivity(run_folder, form, out)
    elif not text and attribution:
        text = render_attribution(run_folder, form, quiet, out)
    elif not text:
        with bar(quiet) as tick:
            text = render(run_folder, form, None if against is None else _folder_or_name(against), tick, out)
    if out is None:
        print_out(text)
    else:
        write_file(out, text)


def _refuse_sweep(folder: Path) -> None:
    from waxstudy.sweeps.result import TABLE

    if (folder / TABLE).is_file():
        raise CommandError(f"{folder}: this is a sweep; {TABLE} in it has a row for each point", INVALID)


def _of_fleet(folder: Path, form: str, has_options: bool, out: Path | None) -> str:
    """Return the report of an activation; nothing for other folders."""
    from waxstudy.fleet.folder import holds_activation

    if not holds_activation(folder):
        return ""
    from waxstudy.fleet.result import read_activated
    from waxstudy.results.folder import RunError

    if has_options:
        raise click.UsageError("--attribution, --sensitivity and --against are of a run of cases, not of an activation")
    try:
        found = read_activated(folder)
        if form == "html":
            from waxstudy.report.fleet.page import as_html

            return as_html(found)
        from waxstudy.report.fleet.tables import render

        return render(found, form, *terminal(out))
    except RunError as error:
        raise CommandError(str(error), INVALID) from error


def _by_suffix(out: Path | None) -> str:
    suffix = out.suffix[1:].lower() if out and out.suffix else "txt"
    form = {"htm": "html", "txt": "table"}.get(suffix, suffix)
    if form not in FORMATS:
        allowed = "a name that ends in .txt, .csv, .md, .html or .json, or a --format"
        raise click.UsageError(f"{out}: a report has no such format; give {allowed}")
    return form


def _folder_or_name(word: str) -> Path | str:
    """Return the run folder of this path or, if it holds no run, the word as the name of a registered reference."""
    from waxstudy.plugin.registry import PluginError, installed
    from waxstudy.results.folder import holds_run

    folder = Path(word)
    if holds_run(folder):
        return folder
    try:
        return installed().get("reference", word).name
    except PluginError as error:
        no_folder = f"the folder '{word}' holds no run" if os.path.isdir(folder) else f"there is no run folder '{word}'"
        raise _plugin_error(f"{error}; {no_folder}", word) from error


def _plugin_error(message: str, against: Path | str | None) -> CommandError:
    """An unknown name is a plugin's fault only if one is broken that may hold it."""
    from waxstudy.plugin.registry import installed

    registry = installed()
    blamed = registry.broken or ("reference", against) in registry.components
    return CommandError(message, PLUGIN if blamed else INVALID)


def render(
    of: Path | Run,
    form: str,
    against: Path | str | None,
    tick: Tick = lambda what, share: None,
    out: Path | None = None,
) -> str:
    """Return a run's report in one of the formats, against another run's folder or a registered reference's name.

    What is wrong with a run becomes exit code 3 or 4.
    """
    tick("reading the run", 0.0)
    from waxstudy.plugin.registry import PluginError
    from waxstudy.report.content import gather
    from waxstudy.results.folder import RunError
    from waxstudy.results.run import Run

    try:
        run = of if isinstance(of, Run) else Run(of)
        other = Run(against) if isinstance(against, Path) else against
        content = gather(run, load_study(run.study_file, needs_files=False), other)
        if form == "html":
            tick("drawing figures", READ)
            from waxstudy.report.page import as_html

            return as_html(content, lambda share: tick("drawing figures", READ + (1.0 - READ) * share))
    except PluginError as error:
        raise _plugin_error(str(error), against) from error
    except (RunError, ValueError) as error:
        raise CommandError(str(error), INVALID) from error
    from waxstudy.report import render as formats

    if form == "table":
        return formats.as_terminal(content, *terminal(out))
    return {"csv": formats.as_csv, "md": formats.as_markdown, "json": formats.as_json}[form](content)


def render_attribution(folder: Path, form: str, quiet: bool, out: Path | None) -> str:
    """Return the order-free ladder of a run in one of the formats; compute what it needs and the folder lacks."""
    from waxstudy.results.folder import RunError
    from waxstudy.results.run import Run

    try:
        run = Run(folder)
        study = load_study(run.study_file)
        found = _attributed(run, study, quiet)
    except (RunError, ValueError) as error:
        raise CommandError(str(error), INVALID) from error
    if form == "html":
        from waxstudy.report.attribution.page import as_html

        return as_html(found)
    from waxstudy.report.attribution import render as formats

    if form == "table":
        return formats.as_terminal(found, *terminal(out))
    return {"csv": formats.as_csv, "md": formats.as_markdown, "json": formats.as_json}[form](found)


def _attributed(run: Run, study: Study, quiet: bool) -> OrderFree:
    from waxstudy.report.attribution.shares import attribute
    from waxstudy.report.attribution.simulate import OtherSources

    with failures(run.study_file, run.folder), progress(quiet) as told, resumable():
        try:
            return attribute(run, study, told)
        except OtherSources as error:
            raise CommandError(str(error), INVALID) from error


def render_sensitivity(folder: Path, form: str, out: Path | None) -> str:
    """Return the Sobol indices of a sweep in one of the formats."""
    from waxstudy.plugin import BackendMissing
    from waxstudy.report import sensitivity
    from waxstudy.results.folder import RunError
    from waxstudy.sweeps.result import read_swept

    try:
        swept = read_swept(folder)
        return sensitivity.render(sensitivity.indices(swept), swept, form, *terminal(out))
    except BackendMissing as error:
        raise CommandError(str(error), BACKEND) from error
    except RunError as error:
        raise CommandError(str(error), INVALID) from error
