"""`waxstudy report`"""

from __future__ import annotations

import shutil
from pathlib import Path

import click

from waxstudy.cli.errors import FAILED, INVALID, PLUGIN, CommandError
from waxstudy.cli.output import Command, print_out, stdout
from waxstudy.cli.study import load_study

FORMATS = ("table", "csv", "md", "html", "json")


@click.command("report", cls=Command)
@click.argument("run_folder", metavar="RUN", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("--format", "form", type=click.Choice(FORMATS), default="table", show_default=True, help="What to print.")
@click.option("--json", "as_json", is_flag=True, help="The same as --format json.")
@click.option("--against", help="Published figures to put beside the run's, e.g. `paper`.")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help="Write to a file instead of printing.")
def command(run_folder: Path, form: str, as_json: bool, against: str | None, out: Path | None) -> None:
    """Print the comparison of a run again."""
    text = render(run_folder, "json" if as_json else form, against)
    if out is None:
        print_out(text)
        return
    from waxstudy.results.atomic import whole_file

    try:
        with whole_file(out) as path:
            path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise CommandError(f"{out}: cannot be written: {error.strerror}", FAILED) from error


def render(folder: Path, form: str, against: str | None) -> str:
    """Return a run's report in one of the formats; turn what is wrong with the run into exit code 3 or 4."""
    from waxstudy.plugin.registry import PluginError, installed
    from waxstudy.report.content import gather
    from waxstudy.results.run import Run, RunError

    try:
        run = Run(folder)
        content = gather(run, load_study(run.study_file, needs_files=False), against)
        if form == "html":
            from waxstudy.report.page import as_html

            return as_html(content)
    except PluginError as error:
        # an unknown name is a plugin's fault only if one is broken that may hold it
        registry = installed()
        blamed = registry.broken or ("reference", against) in registry.components
        raise CommandError(str(error), PLUGIN if blamed else INVALID) from error
    except (RunError, ValueError) as error:
        raise CommandError(str(error), INVALID) from error
    from waxstudy.report import render as formats

    if form == "table":
        colour = stdout().isatty()
        return formats.as_terminal(content, shutil.get_terminal_size((120, 24)).columns, colour)
    return {"csv": formats.as_csv, "md": formats.as_markdown, "json": formats.as_json}[form](content)
