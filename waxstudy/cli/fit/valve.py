"""`waxstudy fit valve`"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.errors import INVALID, USAGE, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.fit.common import (
    beside,
    column_option,
    failures,
    printed,
    refuse_targets,
    refuse_unwritable,
    write,
)
from waxstudy.cli.output import Command, print_out

if TYPE_CHECKING:
    from waxstudy.identification.valve import ValveFit

FILE = Existing(dir_okay=False)
OUT = "TOML file that a study can take its valve from; a page and all figures as JSON go beside it."
DROPS = "Pressure drop of the open valve and of the pump [kPa], which give the authority."
SHARE = click.FloatRange(0.0, 1.0, min_open=True)
DROP = click.FloatRange(0.0, min_open=True)
MOST_KPA = 1000.0  # ten bar: no heating circuit has as much


@click.command("valve", cls=Command)
@click.argument("record", metavar="FLOW_RECORD", type=FILE)
@click.option("--actuator", required=True, type=FILE, metavar="FILE.toml", help="Actuator, as `fit actuator` wrote it.")
@click.option("--authority", type=SHARE, metavar="N", help="Authority of the valve  [default: fitted]")
@click.option("--pressure-drops", type=(DROP, DROP), metavar="VALVE PUMP", help=DROPS)
@column_option
@click.option("--out", type=Written(), default=Path("my_valve.toml"), show_default=True, help=OUT)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of search and resampling.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of the summary.")
def command(
    record: Path,
    actuator: Path,
    authority: float | None,
    pressure_drops: tuple[float, float] | None,
    columns: dict[str, str],
    out: Path,
    seed: int,
    as_json: bool,
) -> None:
    """Find the curve of a quick-opening valve in a record of flow and heating signal.

    The opening is modelled from the signal. A study takes the result as valve = { from = "FILE.toml" }. A page,
    which is named before it, and figures as JSON lie beside. Without --json, the last line printed is the file.
    """
    if authority is not None and pressure_drops is not None:
        raise CommandError("--authority and --pressure-drops say the same: give one of them", USAGE)
    refuse_unwritable(out)
    from waxstudy.identification.description import DESCRIPTION

    refuse_targets((out, *beside(out)), (record, actuator, record.parent / DESCRIPTION))
    given, how = _authority(authority, pressure_drops)
    with failures():
        found = _fit(record, actuator, columns, given, how, seed)
    page, figures = beside(out)
    write({out: found.fragment(), page: _page(found), figures: _json(found)})
    print_out(_json(found) if as_json else f"{_summary(found)}{out.with_suffix('.html')}\n{out}\n")


def _authority(authority: float | None, drops: tuple[float, float] | None) -> tuple[float | None, str]:
    if authority is not None:
        return authority, "given"
    if drops is None:
        return None, "fitted"
    if max(drops) > MOST_KPA:
        raise CommandError(f"--pressure-drops: they are in kPa, at most {MOST_KPA:g}; 1000 Pa are 1 kPa", USAGE)
    if drops[0] > drops[1]:
        raise CommandError("--pressure-drops: the valve cannot take more than the pump gives", USAGE)
    from waxstudy.identification.valve import authority_of

    return authority_of(
        *drops
    ), f"from pressure drops of {drops[0]:g} kPa in the valve and {drops[1]:g} kPa of the pump"


def _fit(path: Path, actuator: Path, columns: dict[str, str], authority: float | None, how: str, seed: int) -> ValveFit:
    from waxstudy.api.fitting import fit_valve

    try:
        return fit_valve(path, actuator=actuator, authority=authority, how_authority=how, columns=columns, seed=seed)
    except ValueError as error:
        raise CommandError(f"{actuator}: [actuator]: {error}", INVALID, label="") from error


def _page(found: ValveFit) -> str:
    from waxstudy.report.identification.page import valve_page

    return valve_page(found)


def _json(found: ValveFit) -> str:
    from waxstudy.results.json_text import json_text

    return json_text(found.described())


def _summary(found: ValveFit) -> str:
    from waxstudy.report.identification.tables import valve_notes, valve_tables

    return printed(valve_tables(found), valve_notes(found))
