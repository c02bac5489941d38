"""`waxstudy blind-test score`"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from waxstudy.cli.bar import Tick, bar
from waxstudy.cli.blind_test.common import failures, key_given
from waxstudy.cli.errors import CHECK_FAILED, USAGE, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out, terminal

if TYPE_CHECKING:
    from waxstudy.blind_test.make import Place
    from waxstudy.blind_test.score import Opened

OUT = "Folder for score.json and score.html  [default: DIR/score]"
FILE = Existing(dir_okay=False, allow_dash=True)


@click.command("score", cls=Command)
@click.argument("folder", metavar="DIR", type=Existing(file_okay=False))
@click.option("--key-file", type=FILE, metavar="FILE", help="File that holds the key, - for stdin; never below DIR.")
@click.option("--out", type=Written(file_okay=False), metavar="DIR", help=OUT)
@click.option("--workers", type=click.IntRange(1, 64), default=2, show_default=True, help="Processes.")
@click.option("--json", "as_json", is_flag=True, help="Print the score as JSON instead of the table.")
@click.option("--quiet", is_flag=True, help="No progress.")
def command(
    folder: Path,
    key_file: Path | None,
    out: Path | None,
    workers: int,
    as_json: bool,
    quiet: bool,
) -> None:
    """Draw the truth again from the key, check it against the seals, and score everybody who answered.

    Exit code 1 if a seal is broken: the score says which, and counts those records all the same, where their box can
    be opened.
    """
    with failures(folder), bar(quiet) as tick:
        from waxstudy.blind_test.make import Place
        from waxstudy.blind_test.score import opened, score

        key = key_given(key_file, folder)
        if key is None:
            raise CommandError("the truth needs --key-file", USAGE)
        place = Place(folder)
        found = opened(place, key)
        told = score(place, found, _shrinkages(place, found, workers, tick))
        _write(out or folder / "score", told)
    print_out(_text(told, as_json))
    if found.broken:
        broken = "\n".join(found.broken)
        raise CommandError(f"{len(found.broken)} seals are broken:\n{broken}", CHECK_FAILED)


def _shrinkages(place: Place, found: Opened, workers: int, tick: Tick) -> dict[str, dict[str, float]]:
    from waxstudy.blind_test.marks import Truth
    from waxstudy.blind_test.score import diagnosers, marks
    from waxstudy.blind_test.shrinkage import true_shrinkages
    from waxstudy.blind_test.solve import OURS

    if OURS not in diagnosers(place):
        return {}
    truths = {name: Truth.read(box) for name, box in found.boxes.items()}
    own = marks(place, OURS, truths)
    return {OURS: true_shrinkages(place, OURS, own, found.boxes, workers, tick)}


def _write(out: Path, told: dict[str, Any]) -> None:
    from waxstudy.report.blind_test.page import as_html
    from waxstudy.results.atomic import whole_file
    from waxstudy.results.json_text import json_text

    out.mkdir(parents=True, exist_ok=True)
    page, text = as_html(told), json_text(told)
    with whole_file(out / "score.html") as report, whole_file(out / "score.json") as figures:
        report.write_text(page, encoding="utf-8")
        figures.write_text(text, encoding="utf-8")


def _text(told: dict[str, Any], as_json: bool) -> str:
    from waxstudy.report.blind_test.tables import as_terminal
    from waxstudy.results.json_text import json_text

    return json_text(told) if as_json else as_terminal(told, *terminal())
