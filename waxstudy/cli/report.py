"""`waxstudy report`"""

from __future__ import annotations

import os
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
@click.option("--against", help="What to put beside the run: published figures, e.g. `paper`, or a run folder.")
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help="Write to a file instead of printing.")
def command(run_folder: Path, form: str, as_json: bool, against: str | None, out: Path | None) -> None:
    """Print the comparison of a run again."""
    other = None if against is None else _folder_or_name(against)
    text = render(run_folder, "json" if as_json else form, other)
    if out is None:
        print_out(text)
        return
    from waxstudy.results.atomic import whole_file

    try:
        with whole_file(out) as path:
            path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise CommandError(f"{out}: cannot be written: {error.strerror}", FAILED) from error


def _folder_or_name(word: str) -> Path | str:
    """Return the run folder of this path or, if it holds no run, the word as the name of a registered reference."""
    from waxstudy.plugin.registry import PluginError, installed
    from waxstudy.results.run import holds_run

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


def render(folder: Path, form: str, against: Path | str | None) -> str:
    """Return a run's report in one of the formats, against another run's folder or a registered reference's name.

    What is wrong with a run becomes exit code 3 or 4.
    """
    from waxstudy.plugin.registry import PluginError
    from waxstudy.report.content import gather
    from waxstudy.results.run import Run, RunError

    try:
        run = Run(folder)
        other = Run(against) if isinstance(against, Path) else against
        content = gather(run, load_study(run.study_file, needs_files=False), other)
        if form == "html":
            from waxstudy.report.page import as_html

            return as_html(content)
    except PluginError as error:
        raise _plugin_error(str(error), against) from error
    except (RunError, ValueError) as error:
        raise CommandError(str(error), INVALID) from error
    from waxstudy.report import render as formats

    if form == "table":
        colour = stdout().isatty()
        return formats.as_terminal(content, shutil.get_terminal_size((120, 24)).columns, colour)
    return {"csv": formats.as_csv, "md": formats.as_markdown, "json": formats.as_json}[form](content)
