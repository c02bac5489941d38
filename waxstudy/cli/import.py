"""`waxstudy import`"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from waxstudy.cli.asking import Asking, doubts
from waxstudy.cli.errors import FAILED, INVALID, USAGE, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.simulating import warn

if TYPE_CHECKING:
    import pandas as pd

    from waxstudy.importing.request import Imported

MAP = "Which name of the sources a channel is, or nothing for one that was not measured; repeatable."
UNIT = "Unit of a name of the sources, such as degF, m3/h or '10 L' for a pulse; repeatable."
TIMEZONE = "Zone of the room, such as Europe/Tallinn; summer time is taken out.  [default: found, or asked]"
TIME_FORMAT = "Format of the stamps, such as '%d/%m/%Y %H:%M', or the unit of times from --begin on.  [default: found]"
BEGIN = "Begin of a simulation whose times have no date or no year, such as 2026-01-31."
HOLD = "How long a value is held that is logged when it changes."
INTERVAL = "Interval of the dataset.  [default: the finest of the readings, else 1 min]"
YES = "Take what is proposed, and ask nothing."
MOST_TOLD = 5  # names that are not used
REPLACE = "Take the place of another import in DIR."


class Duration(click.ParamType[float]):
    """A time such as '6 h', in seconds."""

    name = "duration"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        if isinstance(value, float):
            return value
        import pandas as pd

        try:
            seconds = pd.Timedelta(str(value)).total_seconds()
        except ValueError:
            seconds = 0.0
        if not 1.0 <= seconds <= 366 * 86_400.0:
            self.fail(f"{value!r} is no time from 1 s to a year: write it as '6 h' or '90 s'", param, ctx)
        return seconds


class Day(click.ParamType["pd.Timestamp"]):
    """A day, or a day and a time, of a clock on the wall."""

    name = "day"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> pd.Timestamp:
        import pandas as pd

        found = pd.to_datetime(str(value), format="ISO8601", errors="coerce")
        if pd.isna(found) or found.tz is not None:
            self.fail(f"{value!r} is no day: write it as 2026-01-31 or 2026-01-31T12:00", param, ctx)
        return found


def _pairs(what: str) -> Callable[[click.Context, click.Parameter, Sequence[str]], dict[str, str]]:
    def convert(ctx: click.Context, param: click.Parameter, texts: Sequence[str]) -> dict[str, str]:
        # a name may hold '=', a channel or a unit does not
        pairs = [text.partition("=") if what.startswith("CHANNEL") else text.rpartition("=") for text in texts]
        for text, (key, mark, _) in zip(texts, pairs, strict=True):
            if not mark or not key.strip():
                raise click.BadParameter(f"'{text}' is no {what}", ctx, param)
        return {key.strip(): value.strip() for key, _, value in pairs}

    return convert


@click.command("import", cls=Command)
@click.argument("sources", metavar="SOURCE...", nargs=-1, required=True, type=Existing())
@click.option("--out", required=True, type=Written(), metavar="DIR", help="Folder of the dataset.")
@click.option("--room", metavar="NAME", help="Room, as the names of the sources tell it.  [default: asked if needed]")
@click.option("--map", "entities", multiple=True, callback=_pairs("CHANNEL=NAME"), metavar="CHANNEL=NAME", help=MAP)
@click.option("--unit", "units", multiple=True, callback=_pairs("NAME=UNIT"), metavar="NAME=UNIT", help=UNIT)
@click.option("--timezone", metavar="ZONE", help=TIMEZONE)
@click.option("--time-format", metavar="FORMAT", help=TIME_FORMAT)
@click.option("--begin", type=Day(), metavar="TIME", help=BEGIN)
@click.option("--hold", "hold_s", type=Duration(), default="6 h", show_default=True, metavar="TIME", help=HOLD)
@click.option("--interval", "interval_s", type=Duration(), metavar="TIME", help=INTERVAL)
@click.option("--yes", is_flag=True, help=YES)
@click.option("--replace", "replaces", is_flag=True, help=REPLACE)
def command(out: Path, yes: bool, replaces: bool, **stated: Any) -> None:
    """Make a dataset of what a house has logged: files of any common layout, or folders of them.

    DIR gets data.csv and dataset.toml, which says what each channel was made of and why. No source is written to.
    The last line printed is DIR.
    """
    from waxstudy.importing.bring import bring
    from waxstudy.importing.request import Request
    from waxstudy.importing.write import OtherImport, refuse_other, write
    from waxstudy.study.problems import StudyError

    _refuse_unknown(stated)
    request = Request(**stated)
    asking = Asking(is_terminal=sys.stdin.isatty() and not yes, takes_proposals=yes)
    try:
        refuse_other(out, request, replaces=replaces or request.room is None)  # which may be asked for
        with asking.kept():
            try:
                imported = bring(request, asking)
            finally:
                asking.refuse_unsettled()  # before what may only follow from them
            write(out, imported, replaces=replaces)
    except StudyError as error:
        raise CommandError(str(error), INVALID, label="") from error
    except OtherImport as error:
        raise CommandError(str(error), USAGE) from error
    except OSError as error:
        raise CommandError(f"{out}: the dataset cannot be written: {error.strerror or error}", FAILED) from error
    for sentence in (*imported.warnings, *doubts(out)):
        warn(sentence)
    print_out(_told(imported) + f"{out}\n")


def _refuse_unknown(stated: dict[str, Any]) -> None:
    from waxstudy.dataset.channels import CHANNELS
    from waxstudy.dataset.zones import is_zone, zone_hint
    from waxstudy.plugin.registry import hint

    for channel in stated["entities"]:
        if channel not in CHANNELS:
            raise CommandError(
                f"--map {channel}: no such channel{hint(channel, CHANNELS)} (there are: {', '.join(CHANNELS)})", USAGE
            )
    zone = stated["timezone"]
    if zone is not None and not is_zone(zone):
        raise CommandError(f"--timezone {zone}: no such time zone{zone_hint(zone)}", USAGE)


def _told(imported: Imported) -> str:
    """Return the table of what each channel is."""
    rows = [("channel", "name in the sources", "unit", "sure", "samples")]
    for channel, match in imported.matches.items():
        share = f"{imported.values[channel].notna().mean():.0%}"
        rows.append((channel, match.seen.entity, match.seen.unit, f"{match.confidence:.0%}", share))
    widths = [max(len(row[place]) for row in rows) for place in range(5)]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    time = imported.values.index
    span = f"{time[0]} to {time[-1]}, every {imported.interval_s:g} s"
    return "\n".join([*lines, "", span, *imported.assumptions, *_unused(imported.unused)]) + "\n"


def _unused(names: Sequence[str]) -> list[str]:
    """Return the line of what is no channel; of many the first few."""
    if not names:
        return []
    if len(names) == 1:
        return [f"not used: {names[0]} (to use it, say {shlex.join(['--map', f'CHANNEL={names[0]}'])})"]
    more = f" and {len(names) - MOST_TOLD} more, listed in dataset.toml" if len(names) > MOST_TOLD else ""
    return [f"not used: {', '.join(names[:MOST_TOLD])}{more} (to use one, say --map CHANNEL=NAME)"]
