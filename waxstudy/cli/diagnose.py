"""`waxstudy diagnose`"""

from __future__ import annotations

import os
import shutil
from contextlib import ExitStack
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from waxstudy.cli.bar import Tick, bar
from waxstudy.cli.errors import FAILED, INTERRUPTED, USAGE, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out, refuse_unwritable_folder, terminal
from waxstudy.cli.simulating import failures
from waxstudy.cli.study import load_study
from waxstudy.simulation.threads import use_one_thread

if TYPE_CHECKING:
    import pandas as pd

    from waxstudy.api.diagnosing import Found
    from waxstudy.diagnosis.result import Diagnosis

OUT = "Folder for diagnosis.json, report.html and traces.parquet  [default: nothing is written]"
STUDY = Existing(dir_okay=False)
BASELINE = "Folder of a healthy record of the same loop: what changed since?  [default: as dataset.toml says]"
BASELINE_DAYS = "Days of the record that are such a baseline, as 2026-01-01..2026-01-10; those after them are judged."


class Days(click.ParamType[tuple[str, str]]):
    """Two days, both included."""

    name = "days"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, str]:
        first, _, last = str(value).partition("..")
        try:
            found = (date.fromisoformat(first).isoformat(), date.fromisoformat(last).isoformat())
        except ValueError:
            self.fail(f"{value!r} is no span of days: write two days as 2026-01-01..2026-01-10", param, ctx)
        return found


def _print_criteria(context: click.Context, option: click.Parameter, is_asked: bool) -> None:
    """Print every limit that decides, and nothing else."""
    if is_asked:
        from waxstudy.report.diagnosis.criteria import as_terminal

        click.echo(as_terminal(shutil.get_terminal_size((120, 24)).columns), nl=False)
        context.exit()


@click.command("diagnose", cls=Command)
@click.argument("dataset", metavar="DATASET", type=Existing(file_okay=False))
@click.option("--out", type=Written(file_okay=False), metavar="DIR", help=OUT)
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of the summary.")
@click.option("--baseline", type=Existing(file_okay=False), metavar="DIR", help=BASELINE)
@click.option("--baseline-days", type=Days(), metavar="FROM..TO", help=BASELINE_DAYS)
@click.option("--quick", is_flag=True, help="Fewer trials, for a first answer.")
@click.option("--study", type=STUDY, metavar="STUDY", help="Study file; the steps of its ladders are tried as effects.")
@click.option(
    "--criteria",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_print_criteria,
    help="Print every limit that decides, with reason and source, and exit.",
)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of resampling.")
@click.option("--quiet", is_flag=True, help="No progress.")
def command(
    dataset: Path,
    out: Path | None,
    as_json: bool,
    baseline: Path | None,
    baseline_days: tuple[str, str] | None,
    quick: bool,
    study: Path | None,
    seed: int,
    quiet: bool,
) -> None:
    """Find where a record and what is believed disagree, which effect causes it, and how far the gap shrinks.

    DATASET is a folder with dataset.toml and data.csv. With --out and without --json, the last line printed is the
    folder.
    """
    if baseline and baseline_days:
        raise CommandError("--baseline and --baseline-days: give one of them", USAGE)
    use_one_thread()
    if out is not None:
        refuse_unwritable_folder(out)
    try:
        with bar(quiet) as tick:
            found = _found(dataset, baseline or baseline_days, study, seed, quick, tick)
        if out is not None:
            _write(found, out)
    except KeyboardInterrupt:
        message = "interrupted; no file is half written, the same command begins anew"
        raise CommandError(message, INTERRUPTED, label="") from None
    print_out(_json(found) if as_json else _summary(found.diagnosis, out))


def _found(
    dataset: Path, healthy: Path | tuple[str, str] | None, study: Path | None, seed: int, quick: bool, tick: Tick
) -> Found:
    """Read a dataset and diagnose it; turn what is wrong into a message and an exit code."""
    from waxstudy.api.diagnosing import diagnose

    with failures(dataset / "dataset.toml", dataset):
        steps = load_study(study, needs_files=False) if study else None
        return diagnose(dataset, healthy, study=steps, seed=seed, quick=quick, progress=tick)


def _json(found: Found) -> str:
    from waxstudy.results.json_text import json_text

    return json_text(found.described())


def _summary(diagnosis: Diagnosis, out: Path | None) -> str:
    from waxstudy.report.diagnosis.summary import as_terminal

    text = as_terminal(diagnosis, *terminal())
    return text if out is None else f"{text}{out}\n"


# --- files -------------------------------------------------------------------------------------------


def _write(found: Found, out: Path) -> None:
    """Write the three files whole; diagnosis.json, which says what the others belong to, comes last."""
    from waxstudy.report.diagnosis.page import as_html
    from waxstudy.results.atomic import whole_file
    from waxstudy.results.parquet import write_parquet

    diagnosis = found.diagnosis
    page, text = as_html(diagnosis), _json(found)
    try:
        out.mkdir(parents=True, exist_ok=True)
        with ExitStack() as files:
            names = ("diagnosis.json", "report.html", "traces.parquet")
            described, report, traces = (files.enter_context(whole_file(out / name)) for name in names)
            write_parquet(diagnosis.traces, traces, _units(diagnosis.traces))
            report.write_text(page, encoding="utf-8")
            described.write_text(text, encoding="utf-8")
    except OSError as error:
        reason = os.strerror(error.errno) if error.errno else str(error)
        raise CommandError(f"{out}: the results cannot be written: {reason}", FAILED) from error


def _units(traces: pd.DataFrame) -> dict[str, str]:
    """Return the unit of each column: of `flow_L_h_before`, that of channel `flow_L_h`."""
    from waxstudy.dataset.channels import CHANNELS
    from waxstudy.results.parquet import TIME

    channels = {str(name): str(name).rpartition("_")[0] for name in traces}
    return {"time": TIME} | {name: CHANNELS[channel].unit for name, channel in channels.items()}
