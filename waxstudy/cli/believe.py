"""`waxstudy believe`"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.asking import Asking, doubts
from waxstudy.cli.errors import FAILED, INVALID, PLUGIN, USAGE, CommandError
from waxstudy.cli.existing import Existing
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.simulating import warn

if TYPE_CHECKING:
    from waxstudy.believing.believe import Believed

SET = "Answer to a question, such as year=1998; repeatable. --set help lists them."
FROM = "Take what is believed from another dataset.toml, or the room of a study."
OF_CHAIN = ("thermostat", "dead_band_K", "motor", "valve")
# that a thermostat is one is asked, its numbers are not: hardly an owner knows them
PI_TIMES = "the PI controller's gain, times and pulses (of Parts et al.; [nominal] takes those of its manual)"
YES = "Take every default, and ask nothing."


def _answers(context: click.Context, option: click.Parameter, texts: Sequence[str]) -> dict[str, str]:
    if "help" in texts:
        from waxstudy.believing.questions import QUESTIONS

        click.echo("\n".join(f"{each.key:18}{each.text}" for each in QUESTIONS))
        context.exit()
    pairs = [text.partition("=") for text in texts]
    for text, (key, mark, _) in zip(texts, pairs, strict=True):
        if not mark or not key:
            raise click.BadParameter(f"'{text}' is no KEY=VALUE", context, option)
    return {key: value.strip() for key, _, value in pairs}


@click.command("believe", cls=Command)
@click.argument("dataset", metavar="DIR", type=Existing(file_okay=False))
@click.option("--set", "stated", multiple=True, callback=_answers, metavar="KEY=VALUE", help=SET)
@click.option("--from", "other", type=Existing(dir_okay=False), metavar="FILE.toml", help=FROM)
@click.option("--yes", is_flag=True, help=YES)
def command(dataset: Path, stated: dict[str, str], other: Path | None, yes: bool) -> None:
    """Say what is believed of a dataset's room and loop, in the words of its owner.

    Each question has a default with its source. What is guessed widens [dataset] room_tolerance. DIR/dataset.toml gets
    [nominal], [building], [site] and [believe]; what is there already, comments too, stays. The last line is DIR.
    """
    from waxstudy.believing.believe import Request, believe
    from waxstudy.believing.write import stays, write
    from waxstudy.plugin.files import read_file
    from waxstudy.plugin.registry import PluginError
    from waxstudy.study.problems import StudyError

    _refuse_unknown(stated)
    asking = Asking(is_terminal=sys.stdin.isatty() and not yes, takes_proposals=yes)
    try:
        with asking.kept():
            try:
                believed = believe(Request(dataset, stated, other), asking)
            finally:
                asking.refuse_unsettled()
            own = stays(read_file(dataset / "dataset.toml").decode("utf-8-sig"), believed)
            write(dataset, believed)
    except StudyError as error:
        raise CommandError(str(error), PLUGIN if error.is_plugin_fault else INVALID, label="") from error
    except PluginError as error:
        raise CommandError(str(error), PLUGIN) from error
    except OSError as error:
        raise CommandError(f"{dataset}: it cannot be written: {error.strerror or error}", FAILED) from error
    for sentence in (*believed.told, *doubts(dataset)):
        warn(sentence)
    then = shlex.join(["waxstudy", "diagnose", str(dataset)])
    print_out("\n".join([*_told(believed, own), "", f"next: {then}", str(dataset)]) + "\n")


def _refuse_unknown(stated: dict[str, str]) -> None:
    from waxstudy.believing.questions import KEYS
    from waxstudy.plugin.registry import hint

    for key in stated:
        if key not in KEYS:
            raise CommandError(f"--set {key}: no such question{hint(key, KEYS)} (there are: {', '.join(KEYS)})", USAGE)


def _told(believed: Believed, own: float | None) -> Iterator[str]:
    """Yield the answers, and by how much guesses among them widen the room."""
    rows: list[tuple[str, ...]] = [("question", "answer", "from")]
    rows += [(a.key, a.text, f"guessed: {a.source}" if a.is_guess else a.source) for a in believed.answers]
    yield from _lines(rows) if believed.answers else ["Nothing is asked: all is believed already."]
    yield from _of_chain(believed)
    if not believed.widened:
        return
    yield ""
    rows = [("uncertain of the room", "own", "with guesses", "factor", "guessed")]
    for each in believed.widened:
        names = ", ".join(f"{guess.key} {guess.spread:g}" for guess in each.guesses)
        rows.append((each.unknown, f"{each.own:.2g}", f"{each.with_guesses:.2g}", f"{each.factor:.1f}", names))
    yield from _lines(rows)
    if own is not None:
        yield f"room_tolerance = {own:g} stays as it was written; the guesses ask for {believed.room_tolerance:g}."
    else:
        yield f"room_tolerance = {believed.room_tolerance:g}, the largest: so far a diagnosis may move the room."
    reasons = {guess.key: guess.why for each in believed.widened for guess in each.guesses}
    yield from (f"  {key}: {why}" for key, why in reasons.items())


def _of_chain(believed: Believed) -> Iterator[str]:
    """Yield what of the chain nobody has told: no tolerance widens it."""
    guessed = [a.key for a in believed.answers if a.is_guess and a.key in OF_CHAIN]
    guessed += [PI_TIMES for a in believed.answers if (a.key, a.value) == ("thermostat", "pi")]
    if guessed:
        yield f"No tolerance widens the chain: what is found of {', '.join(guessed)} may be the guess."


def _lines(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
