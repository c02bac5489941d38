"""`waxstudy reality`"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from waxstudy.cli.errors import INVALID, USAGE, CommandError, taken
from waxstudy.cli.existing import Existing, Written
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.simulating import failures, warn
from waxstudy.cli.study import load_study

if TYPE_CHECKING:
    from waxstudy.plugin import Choice, Component
    from waxstudy.synthetic.instruments import Instruments
    from waxstudy.synthetic.write import Telling

F = TypeVar("F", bound=Callable[..., Any])

BELIEVED = "Case that the modeller believes in  [default: the case itself]"
INTERVAL = "Sampling interval, a multiple of the study's step_s."
EFFECT = "Effect that the reality has and the modeller does not believe in; repeatable."
SET = "Parameter of an effect; of two that share its name, EFFECT.KEY=VALUE; repeatable."
SHIFT = "Added to the study's setpoint_C, -5 to 5 K  [default: 0]"
MISSING = "Share of the samples of measured channels that are lost, in gaps."


def _figures(name: str, metavar: str, about: str) -> Callable[[F], F]:
    """Return a repeatable option of a figure per channel, 0 or more."""
    return click.option(name, multiple=True, callback=_by_channel, metavar=metavar, help=about)


class Finite(click.FloatRange):
    """A range that leaves out what is no number."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = float(super().convert(value, param, ctx))
        if not math.isfinite(number):
            self.fail(f"{value} is not a finite number", param, ctx)
        return number


def _by_channel(ctx: click.Context, param: click.Parameter, texts: Sequence[str]) -> dict[str, float]:
    found: dict[str, float] = {}
    for text in texts:
        name, _, figure = text.partition("=")
        try:
            found[name] = float(figure)
        except ValueError:
            found[name] = math.nan
        if not 0.0 <= found[name] < math.inf:
            raise click.BadParameter(f"'{text}' is not a channel, '=' and a number of 0 or more", ctx, param)
    return found


def _by_key(ctx: click.Context, param: click.Parameter, texts: Sequence[str]) -> dict[str, float]:
    found: dict[str, float] = {}
    for text in texts:
        key, _, figure = text.partition("=")
        try:
            found[key] = float(figure)
        except ValueError:
            raise click.BadParameter(f"'{text}' is not a parameter, '=' and a number", ctx, param) from None
    return found


@click.command("reality", cls=Command)
@click.argument("study_file", metavar="STUDY.toml", type=Existing())
@click.option("--case", required=True, metavar="ID", help="Case that is the reality.")
@click.option("--believed", metavar="ID", help=BELIEVED)
@click.option("--effect", "names", multiple=True, metavar="NAME", help=EFFECT)
@click.option("--set", "values", multiple=True, callback=_by_key, metavar="KEY=VALUE", help=SET)
@click.option("--week", "weeks", multiple=True, metavar="NAME", help="Week; repeatable  [default: the first]")
@click.option("--days", type=click.IntRange(min=1), help="Only the first days of the weeks  [default: all]")
@click.option("--setpoint-shift", "shift_K", type=Finite(-5.0, 5.0), default=0.0, metavar="K", help=SHIFT)
@click.option("--interval-s", type=Finite(0.0, min_open=True), default=60.0, show_default=True, help=INTERVAL)
@click.option("--without", multiple=True, metavar="CHANNEL", help="Channel to leave out; repeatable.")
@_figures("--noise", "CHANNEL=SD", "Standard deviation of a channel's noise, in its unit; repeatable.")
@_figures("--resolution", "CHANNEL=STEP", "Step that a channel is rounded to, 0 for none; repeatable.")
@click.option("--missing", type=Finite(0.0, 0.5), default=0.0, show_default=True, help=MISSING)
@click.option("--seed", type=click.IntRange(min=0), default=1, show_default=True, help="Seed of noise and gaps.")
@click.option("--out", required=True, type=Written(), metavar="DIR", help="Folder of the dataset.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def command(
    study_file: Path,
    case: str,
    believed: str | None,
    names: Sequence[str],
    values: dict[str, float],
    weeks: Sequence[str],
    days: int | None,
    shift_K: float,
    out: Path,
    as_json: bool,
    **measured: Any,
) -> None:
    """Make a dataset of a case, as if its room had been measured.

    DIR gets data.csv and dataset.toml, which says what the modeller believes. The truth goes to DIR-truth.json,
    beside the folder. Weeks given one after another are one record.
    """
    from waxstudy.synthetic.instruments import Instruments
    from waxstudy.synthetic.write import Telling, truth_beside

    truth = truth_beside(out)
    if os.path.lexists(out):
        raise taken(out)
    study, instruments = load_study(study_file), Instruments(**measured)
    weeks = list(weeks or [next(iter(study.weeks))])
    believed = case if believed is None else believed
    _refuse_unknown(("case", [case, believed], study.cases), ("week", weeks, study.weeks), *_channels(instruments))
    _refuse_noise_of_known(instruments)
    setpoint_C = study.comfort.setpoint_C + shift_K
    effects = chosen(names, values)
    with failures(study_file, out):
        telling = Telling(study, study.cases[case], study.cases[believed], weeks, setpoint_C, effects)
        _make(out, telling, days, instruments)
    if as_json:
        print_out(json.dumps({"dataset": str(out), "truth": str(truth)}) + "\n")
    else:
        print_out(f"{truth}\n{out}\n")


def _make(out: Path, telling: Telling, days: int | None, instruments: Instruments) -> None:
    from waxstudy.synthetic.effects import EffectError, with_effects
    from waxstudy.synthetic.simulate import RealityError, reality_loop, simulate
    from waxstudy.synthetic.write import OtherTruth, write

    study, case, weeks, setpoint_C = telling.study, telling.case, telling.weeks, telling.setpoint_C
    try:
        loop = reality_loop(study, case, weeks, days)
        for warning in loop.warnings:
            warn(warning)
        if telling.effects:
            case, reality = with_effects(study, case, weeks, days, setpoint_C, telling.effects)
        else:
            reality = simulate(loop, study, setpoint_C)
        write(out, replace(telling, case=case), reality, instruments)
    except RealityError as error:
        raise CommandError(str(error), USAGE) from error
    except EffectError as error:
        raise CommandError(str(error), INVALID) from error
    except OtherTruth as error:
        raise taken(Path(str(error))) from error


def chosen(names: Sequence[str], values: Mapping[str, float]) -> list[Choice]:
    """Return effects with their parameters; raise `CommandError`."""
    from waxstudy.plugin.registry import installed

    if repeated := next((name for name in names if names.count(name) > 1), ""):
        raise CommandError(f"effect '{repeated}' is asked for twice", USAGE)
    registry = installed()
    _refuse_unknown(("effect", names, registry.names("effect")))
    models = {name: registry.components["effect", name].component.Parameters.model_fields for name in names}
    if values and not names:
        raise CommandError(f"--set {next(iter(values))}: is of an effect: name one with --effect", USAGE)
    given: dict[str, dict[str, float]] = {name: {} for name in names}
    for key, value in values.items():
        name, parameter = _place(key, models)
        given[name][parameter] = value
    effects = [_checked(registry.components["effect", name].component, given[name]) for name in names]
    for effect in effects:
        if not given[effect.component.name]:
            said = ", ".join(f"{key} = {value:g}" for key, value in dict(effect.parameters).items())
            warn(f"effect '{effect.component.name}' has its defaults: {said}")
    return effects


def _place(key: str, models: Mapping[str, Iterable[str]]) -> tuple[str, str]:
    """Return the effect and the parameter that a key of --set means."""
    spelled = {f"{name}.{parameter}": (name, parameter) for name in models for parameter in models[name]}
    plain = [place for place in spelled.values() if place[1] == key]
    if len(plain) > 1:
        whole = " or ".join(f"{name}.{parameter}" for name, parameter in plain)
        raise CommandError(f"--set {key}: more than one effect has it; write {whole}", USAGE)
    known = spelled | {parameter: (name, parameter) for name, parameter in spelled.values()}
    _refuse_unknown(("parameter", [key], known))
    return known[key]


def _checked(effect: type[Component], values: Mapping[str, float]) -> Choice:
    from waxstudy.plugin import Choice

    try:
        return Choice.of(effect, values)
    except ValueError as error:
        raise CommandError(f"effect '{effect.name}': {error}", USAGE) from error


Words = tuple[str, Iterable[str], Iterable[str]]  # what they are, those given, those known


def _channels(instruments: Instruments) -> list[Words]:
    from waxstudy.dataset.channels import CHANNELS

    return [("channel", names, CHANNELS) for names in (instruments.without, instruments.noise, instruments.resolution)]


def _refuse_noise_of_known(instruments: Instruments) -> None:
    from waxstudy.dataset.channels import CHANNELS

    for name in instruments.noise:
        if CHANNELS[name].is_assumed:
            noisy = ", ".join(channel.name for channel in CHANNELS.values() if not channel.is_assumed)
            known = f"--noise {name}: the modeller knows this channel without measuring it, so it has no noise"
            raise CommandError(f"{known} (noise can be had on: {noisy})", USAGE)


def _refuse_unknown(*words: Words) -> None:
    from waxstudy.plugin.registry import hint

    for what, given, known in words:
        for name in given:
            if name not in known:
                raise CommandError(f"no {what} '{name}'{hint(name, known)} (there are: {', '.join(known)})", USAGE)
