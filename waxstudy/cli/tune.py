"""`waxstudy tune`"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.errors import USAGE, CommandError
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out, terminal
from waxstudy.cli.simulating import failures, progress, resumable
from waxstudy.cli.study import known, load_study

if TYPE_CHECKING:
    from waxstudy.tuning.tune import Tuned

OBJECTIVE = (
    "What to make small: tracking (error of the air temperature), comfort (hours below the limit at equal heat), "
    "switches, travel; repeatable, weighted against each other  [default: tracking]"
)
VARY = (
    "Parameter to tune, as controller.gain=0.5..20, or without bounds as its plugin declares; repeatable  "
    "[default: the controller's]"
)
WEEK = "Week to tune on; repeatable. What else the study has of weather is tested on  [default: the first]"
Bounds = tuple[float, float] | None


def _weights(ctx: click.Context, param: click.Parameter, texts: Sequence[str]) -> dict[str, float]:
    found: dict[str, float] = {}
    for text in texts:
        name, mark, weight = text.partition("=")
        value = _number(weight) if mark else 1.0
        if not (math.isfinite(value) and value > 0.0):
            raise click.BadParameter(f"'{text}': the weight must be a number above 0", ctx, param)
        if name in found:
            raise click.BadParameter(f"'{name}' is given twice", ctx, param)
        found[name] = value
    return found


def _vary(ctx: click.Context, param: click.Parameter, texts: Sequence[str]) -> dict[str, Bounds]:
    found: dict[str, Bounds] = {}
    for text in texts:
        key, mark, bounds = text.partition("=")
        low, dots, high = bounds.partition("..")
        ends = (_number(low), _number(high))
        if mark and not (dots and ends[0] < ends[1] and all(map(math.isfinite, ends))):
            raise click.BadParameter(f"'{text}' is not KEY=LOW..HIGH with two numbers, LOW below HIGH", ctx, param)
        if key in found:
            raise click.BadParameter(f"'{key}' is given twice", ctx, param)
        found[key] = ends if mark else None
    return found


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


@click.command("tune", cls=Command)
@click.argument("study_file", metavar="STUDY.toml", type=Existing())
@click.option("--case", "case_id", required=True, metavar="ID", help="Case whose parameters are tuned.")
@click.option("--objective", "weights", multiple=True, callback=_weights, metavar="NAME[=WEIGHT]", help=OBJECTIVE)
@click.option("--vary", multiple=True, callback=_vary, metavar="KEY[=LOW..HIGH]", help=VARY)
@click.option("--week", "weeks", multiple=True, metavar="NAME", help=WEEK)
@click.option("--budget", type=click.IntRange(40, 100_000), default=80, show_default=True, help="Settings to evaluate.")
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of the search.")
@click.option("--workers", type=click.IntRange(1), help="Settings at a time  [default: one for each core]")
@click.option("--out", type=Written(), help="Folder  [default: results/NAME of the study-CASE-tuned]")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of tables.")
@click.option("--quiet", is_flag=True, help="No progress.")
@click.option("--no-jit", is_flag=True, help="Interpret the blocks instead of compiling them; slow, same results.")
def command(
    study_file: Path,
    case_id: str,
    weights: dict[str, float],
    vary: dict[str, Bounds],
    weeks: Sequence[str],
    budget: int,
    seed: int,
    workers: int | None,
    out: Path | None,
    as_json: bool,
    quiet: bool,
    no_jit: bool,
) -> None:
    """Find better parameters for a case, at equal comfort, and test them on weather that took no part.

    The folder gets tuned.toml, from which a study takes them (controller = { from = "tuned.toml" }), a page with the
    landscape and what textbook rules give, and all figures as JSON. Every evaluation is kept as soon as it is finished:
    the same command goes on from there. Without --json, the last line printed is the folder.
    """
    study = load_study(study_file)
    folder = out or Path("results") / f"{study.name}-{case_id}-tuned"
    weights = weights or {"tracking": 1.0}
    known("--case", [case_id], list(study.cases))
    known("--week", weeks, list(study.weeks))
    with failures(study_file, folder):
        from waxstudy.tuning.objectives import OBJECTIVES, Goal, NoObjective
        from waxstudy.tuning.space import axes_of
        from waxstudy.tuning.tune import tune

        known("--objective", list(weights), list(OBJECTIVES))
        axes = axes_of(study, study.cases[case_id], vary)
        with progress(quiet, "settings") as told, resumable():
            try:
                found = tune(
                    study,
                    case_id,
                    Goal(weights),
                    axes,
                    folder,
                    weeks=weeks or list(study.weeks)[:1],
                    budget=budget,
                    seed=seed,
                    workers=workers or os.cpu_count() or 1,
                    told=told,
                    jit=not no_jit,
                )
            except NoObjective as error:
                raise CommandError(str(error), USAGE) from error
        _write(found, folder)
    print_out(_json(found) if as_json else f"{_summary(found)}{folder}\n")


def _write(found: Tuned, folder: Path) -> None:
    """Write all that a reader takes, the fragment last."""
    from waxstudy.report.tuning.page import as_html
    from waxstudy.results.atomic import whole_file
    from waxstudy.tuning.fragment import fragment

    for name, text in (("report.html", as_html(found)), ("tuning.json", _json(found)), ("tuned.toml", fragment(found))):
        with whole_file(folder / name) as path:
            path.write_text(text, encoding="utf-8")


def _json(found: Tuned) -> str:
    from waxstudy.results.json_text import json_text
    from waxstudy.tuning.fragment import as_json

    return json_text(as_json(found))


def _summary(found: Tuned) -> str:
    from waxstudy.report import formats
    from waxstudy.report.tuning.tables import notes, tables, verdict

    said = formats.terminal(tables(found), notes(found), *terminal())
    return f"{verdict(found)}\n{said}"
