"""`waxstudy calibrate`"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.bar import bar
from waxstudy.cli.errors import INTERRUPTED, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.fit.common import printed, refuse_targets, refuse_unwritable, write
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.simulating import failures
from waxstudy.simulation.threads import use_one_thread

if TYPE_CHECKING:
    from waxstudy.diagnosis.calibration.room import CalibratedRoom

OUT = "TOML file that a study can take its room from."


@click.command("calibrate", cls=Command)
@click.argument("dataset", metavar="DATASET", type=Existing(file_okay=False))
@click.option("--out", required=True, type=Written(), metavar="FILE.toml", help=OUT)
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of the summary.")
@click.option("--quiet", is_flag=True, help="No progress.")
def command(dataset: Path, out: Path, as_json: bool, quiet: bool) -> None:
    """Find how a room was built, from a record of its loop when healthy.

    DATASET is a folder with dataset.toml and data.csv. A study takes the result as its [room], with from = "FILE.toml".
    Without --json, the last line printed is the file.
    """
    use_one_thread()
    refuse_unwritable(out)
    refuse_targets((out,), (dataset / "dataset.toml",))
    try:
        with bar(quiet) as tick:
            tick("calibrating", 0.0)
            found = _calibrated(dataset)
    except KeyboardInterrupt:
        message = "interrupted; no file is half written, the same command begins anew"
        raise CommandError(message, INTERRUPTED, label="") from None
    write({out: _fragment(found)})
    print_out(_json(found) if as_json else f"{_summary(found)}{out}\n")


def _calibrated(dataset: Path) -> CalibratedRoom:
    from waxstudy.dataset.read import read_dataset
    from waxstudy.diagnosis.diagnose import calibrated_room

    with failures(dataset / "dataset.toml", dataset):
        return calibrated_room(read_dataset(dataset))


def _fragment(found: CalibratedRoom) -> str:
    from waxstudy.identification.fragment import text_of

    return text_of("room", found.room.described(), found.about(), f"Its record: {found.origin}" if found.origin else "")


def _json(found: CalibratedRoom) -> str:
    from waxstudy.results.json_text import json_text

    return json_text(found.described())


def _summary(found: CalibratedRoom) -> str:
    from waxstudy.report.diagnosis.calibration import notes, tables

    return printed(tables(found), notes(found))
