"""`waxstudy blind-test solve`"""

from __future__ import annotations

import json
from pathlib import Path

import click

from waxstudy.cli.bar import bar
from waxstudy.cli.blind_test.common import failures, key_given
from waxstudy.cli.errors import USAGE, CommandError
from waxstudy.cli.existing import Existing
from waxstudy.cli.output import Command, print_out

WITH = "Diagnoser: ours, or a baseline (refit, forward, rules, random)."
NAME = "Name that an external command's answers are kept under."
LEAVE = "Ask ours again with each record's true effect taken out of its library; needs the key."
WITHOUT = "Take the baseline out of the records that have one; kept under NAME-without-baselines."
SHARE = "Only this share of the records."
TIMEOUT = "Seconds after which a diagnoser is ended; that counts as a failure."
FILE = Existing(dir_okay=False, allow_dash=True)


@click.command("solve", cls=Command, context_settings={"ignore_unknown_options": False})
@click.argument("folder", metavar="DIR", type=Existing(file_okay=False))
@click.argument("external", metavar="[-- COMMAND...]", nargs=-1, type=click.UNPROCESSED)
@click.option("--with", "who", metavar="NAME", help=WITH)
@click.option("--name", metavar="NAME", default="external", show_default=True, help=NAME)
@click.option("--leave-one-out", is_flag=True, help=LEAVE)
@click.option("--without-baselines", is_flag=True, help=WITHOUT)
@click.option("--key-file", type=FILE, metavar="FILE", help="File that holds the key, - for stdin; never below DIR.")
@click.option("--share", type=click.FloatRange(0.0, 1.0, min_open=True), default=1.0, show_default=True, help=SHARE)
@click.option("--timeout-s", type=click.FloatRange(1.0), default=1800.0, show_default=True, help=TIMEOUT)
@click.option("--workers", type=click.IntRange(1, 64), default=2, show_default=True, help="Records at a time.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--quiet", is_flag=True, help="No progress.")
def command(
    folder: Path,
    external: tuple[str, ...],
    who: str | None,
    name: str,
    leave_one_out: bool,
    without_baselines: bool,
    key_file: Path | None,
    share: float,
    timeout_s: float,
    workers: int,
    as_json: bool,
    quiet: bool,
) -> None:
    """Let a diagnoser loose on every record, each alone in a temporary folder.

    A COMMAND gets the folder of a dataset in place of {}, or as its last argument, and prints a diagnosis as JSON, as
    `waxstudy diagnose --json` does. What is answered already is kept.
    """
    if (who is not None) + bool(external) + leave_one_out != 1:
        raise CommandError("give --with NAME, or --leave-one-out, or -- and a command", USAGE)
    if leave_one_out and without_baselines:
        raise CommandError("--leave-one-out asks of records without a baseline: leave --without-baselines out", USAGE)
    with failures(folder), bar(quiet) as tick:
        from waxstudy.blind_test import solve
        from waxstudy.blind_test.hidden import out_of_sight
        from waxstudy.blind_test.make import Place

        place = Place(folder.absolute())
        names = place.names()
        if leave_one_out:
            key = key_given(key_file, folder)
            if key is None:
                raise CommandError("--leave-one-out needs --key-file", USAGE)
            place.check_key(key)
            diagnoser, names = solve.leaving_one_out(place, key)
        else:
            diagnoser = solve.diagnoser(who) if who else solve.external(name, external)
            if without_baselines:
                diagnoser, names = solve.without_baselines(place, diagnoser)
        names = solve.chosen(names, share)
        with out_of_sight():
            failed = solve.solve(place, diagnoser, names, workers, timeout_s, tick)
    said = {"diagnoser": diagnoser.name, "records": len(names), "failed": failed}
    told = f"{diagnoser.name}: {len(names)} records answered, {failed} of them by a failure\n"
    print_out(json.dumps(said) + "\n" if as_json else told)
