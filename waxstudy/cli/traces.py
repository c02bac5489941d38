"""`waxstudy traces`"""

from __future__ import annotations

from pathlib import Path

import click

from waxstudy.cli.errors import BACKEND, INVALID, USAGE, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out, write_file
from waxstudy.cli.study import load_study

CASE = "Of a run: a case; may be given several times.  [default: the first ladder's simplest and its reference]"


@click.command("traces", cls=Command)
@click.argument("folder", metavar="FOLDER", type=Existing(file_okay=False))
@click.option("--case", "cases", multiple=True, metavar="ID", help=CASE)
@click.option("--week", metavar="NAME", help="Of a run: a week or other record.  [default: the first]")
@click.option("--out", type=Written(dir_okay=False), help="File to write.  [default: traces.html in FOLDER]")
def command(folder: Path, cases: tuple[str, ...], week: str | None, out: Path | None) -> None:
    """Write a page on which the traces of a run or a diagnosis zoom.

    FOLDER is that of a run, or what `diagnose --out` wrote. The page is one file of 5 MB that needs no network. The
    extra `interactive` is needed. The last line printed is the file.
    """
    from waxstudy.plugin import BackendMissing
    from waxstudy.report.traces.run import Unknown
    from waxstudy.results.folder import RunError

    out = folder / "traces.html" if out is None else out
    try:
        text = _page(folder, cases, week)
    except BackendMissing as error:
        raise CommandError(str(error), BACKEND) from error
    except Unknown as error:
        raise CommandError(str(error), USAGE) from error
    except RunError as error:
        raise CommandError(str(error), INVALID) from error
    write_file(out, text)
    print_out(f"{out}\n")


def _page(folder: Path, cases: tuple[str, ...], week: str | None) -> str:
    from waxstudy.api.provenance import FILE, read_diagnosis
    from waxstudy.report.traces.diagnosis import of_diagnosis
    from waxstudy.report.traces.page import as_html
    from waxstudy.report.traces.run import of_run
    from waxstudy.results.run import Run

    if not (folder / FILE).is_file():
        run = Run(folder)
        return as_html(of_run(run, load_study(run.study_file, needs_files=False), cases, week))
    if cases or week is not None:
        raise CommandError("--case and --week are of a run, not of a diagnosis", USAGE)
    return as_html(of_diagnosis(folder, str(read_diagnosis(folder).get("dataset", ""))))
