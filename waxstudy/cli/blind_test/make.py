"""`waxstudy blind-test make`"""

from __future__ import annotations

import json
import secrets
from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.bar import bar
from waxstudy.cli.blind_test.common import failures, key_given
from waxstudy.cli.errors import USAGE, CommandError
from waxstudy.cli.existing import Written
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.simulating import warn

if TYPE_CHECKING:
    from waxstudy.blind_test.key import Key
    from waxstudy.blind_test.make import Place
    from waxstudy.blind_test.plan import Plan

CASES = "Records of a mixture of everything but what is kept for judged runs."
JUDGED = "A judged run: every stratum, with the families and engines that are kept for it."
SHARE = "Share of every stratum of a judged run, rounded up."
STRATUM = "Only this stratum of a judged run; repeatable."
KEY_FILE = "File that gets the key, or holds the one of a run to go on with (- for stdin); never below DIR."
FILE = click.Path(dir_okay=False, allow_dash=True, path_type=Path)


@click.command("make", cls=Command)
@click.option("--cases", type=click.IntRange(1, 100_000), metavar="N", help=CASES)
@click.option("--judged", is_flag=True, help=JUDGED)
@click.option("--share", type=click.FloatRange(0.0, 1.0, min_open=True), default=1.0, show_default=True, help=SHARE)
@click.option("--stratum", "strata", multiple=True, metavar="NAME", help=STRATUM)
@click.option("--seed", type=click.IntRange(0, 10**18 - 1), help="Seed of the key  [default: drawn]")
@click.option("--out", required=True, type=Written(file_okay=False), metavar="DIR", help="Folder.")
@click.option("--key-file", type=FILE, metavar="FILE", help=KEY_FILE)
@click.option("--workers", type=click.IntRange(1, 64), default=2, show_default=True, help="Processes.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--quiet", is_flag=True, help="No progress.")
def command(
    cases: int | None,
    judged: bool,
    share: float,
    strata: tuple[str, ...],
    seed: int | None,
    out: Path,
    key_file: Path | None,
    workers: int,
    as_json: bool,
    quiet: bool,
) -> None:
    """Make records whose effect is sealed; the key is printed once, before the work.

    Whoever holds the key can read the truth. What is made already is kept: the same command with the key goes on.
    """
    if judged == (cases is not None):
        raise CommandError("give --cases N for a mixture, or --judged", USAGE)
    if not judged and (share != 1.0 or strata):
        raise CommandError("--share and --stratum are of a judged run", USAGE)
    with failures(out):
        from waxstudy.blind_test.make import Place, begun, make

        place, plan = Place(out), _plan(cases, share, strata)
        key, is_new = _key(place, seed, key_file)
        records = len(plan.slots(key))
        with begun(place, plan, key) as plan:
            _tell(out, key if is_new else None, records, as_json)
            with bar(quiet) as tick:
                make(place, plan, key, workers, tick)


def _plan(cases: int | None, share: float, strata: tuple[str, ...]) -> Plan:
    from waxstudy.blind_test.plan import DRAW, Plan, available, left_out

    for name, reason in left_out(is_judged=not cases).items():
        warn(f"no records of engine '{name}': {reason}")
    return Plan(cases or 0, share, strata, available(is_judged=not cases), DRAW)


def _key(place: Place, seed: int | None, file: Path | None) -> tuple[Key, bool]:
    """Return the key, and whether it is a new one."""
    from waxstudy.blind_test.key import Key
    from waxstudy.blind_test.make import ABOUT
    from waxstudy.results.atomic import whole_file

    given = key_given(file, place.folder)
    if given:
        if seed not in (None, given.seed):
            raise CommandError(f"the key's seed is {given.seed}, not {seed}", USAGE)
        return given, False
    if (place.folder / ABOUT).exists():
        raise CommandError(f"{place.folder}: records are there already; to go on, give their --key-file", USAGE)
    key = Key.new(secrets.randbelow(10**9) if seed is None else seed)
    if file:
        file.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(file, 0o600) as path:
            path.write_text(f"{key}\n", encoding="utf-8")
    return key, True


def _tell(out: Path, key: Key | None, records: int, as_json: bool) -> None:
    if as_json:
        said = {"out": str(out), "records": records, **({"key": str(key)} if key else {})}
        print_out(json.dumps(said) + "\n")
    else:
        print_out((f"key {key}\n" if key else "") + f"{records} records\n{out}\n")
