"""From entities to channels on a grid: units, counters, holding, noise."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS, LIGHT, UNITS
from waxstudy.dataset.checks import AS_LOGGED, Record, run
from waxstudy.dataset.limits import MOST_INTERVALS
from waxstudy.dataset.notes import Notes
from waxstudy.importing import units
from waxstudy.importing.asking import Ask, Question
from waxstudy.importing.holding import NS, UNIFORM, Grid, Rhythm, on_grid, rhythm, silences, threshold
from waxstudy.importing.limits import AVERAGED_S, COARSER, DIGITS, FINEST_S, FOREVER_S, HELD, LOW_FLOW, USUAL_S
from waxstudy.importing.matching import Match
from waxstudy.importing.rates import Rises, rates_on, rises
from waxstudy.importing.reading import Logged, refusal
from waxstudy.importing.request import Imported, Request
from waxstudy.importing.seen import Seen, level_unit
from waxstudy.plugin import FloatArray
from waxstudy.study.problems import Problem, StudyError

# tell no interval
SLOW = ("outdoor_temperature_C", "setpoint_C", "solar_gain_W", "neighbour_temperature_C", *LIGHT)
COUNTED = 6.0**-0.5  # standard deviation of a difference of two values that are rounded to 1
MINUTE_NS = 60 * NS  # to which signs of life are told apart
RESTING = ("flow", "gain")  # of which 0 is a state
LIKE = {"kelvins": "K", "tenths": "0.1degC", "hundredths": "0.01degC", "thousandths": "0.001degC"}  # what it looks like
FLOWS = ("m3/h", "L/min", "L/s", "L/h")


@dataclass(frozen=True)
class _Made:
    """An entity in its channel's unit."""

    match: Match
    logged: Logged
    kind: Rhythm
    how: units.Conversion


def channels_of(
    request: Request, matches: Mapping[str, Match], entities: Sequence[Seen], notes: Notes, ask: Ask
) -> Imported:
    """Return the channels on their grid; raise `StudyError` for units that are none or do not fit."""
    if not matches:
        raise refusal(str(request.sources[0]), "none of its names is a channel", "say --map CHANNEL=NAME")
    stated = dict(request.units)
    for match in matches.values():
        if unit := _asked_unit(match, ask):
            stated[match.seen.entity] = unit
    request = replace(request, units=stated)
    _tell_untold(matches, stated, notes)
    made = {channel: _made(match, stated, notes) for channel, match in matches.items()}
    made = {channel: _while_alive(each, entities) for channel, each in made.items()}
    grid = _grid(request, made)
    _tell_stamps(made.values(), grid, notes)
    columns, noise = {}, {}
    for channel, each in made.items():
        columns[channel], sd = _on_grid(each, grid, request.hold_s, notes)
        if sd > 0.0:
            noise[channel] = float(f"{sd:.2g}")
    index = pd.DatetimeIndex(grid.ends_ns, name="time")
    values = pd.DataFrame(columns, index=index).round(DIGITS)
    _refuse_misfits(values, made, grid)
    used = {match.seen.entity for match in matches.values()}
    return Imported(
        request=request,
        matches={channel: each.match for channel, each in made.items()},
        conversions={channel: (each.how.scale, each.how.offset) for channel, each in made.items()},
        values=values,
        noise=noise,
        interval_s=grid.step_ns / NS,
        unused=[each.entity for each in entities if each.entity not in used],
        warnings=notes.warnings,
        assumptions=notes.assumptions,
    )


# --- units --------------------------------------------------------------------------------------------


def _asked_unit(match: Match, ask: Ask) -> str:
    """Return the unit of an entity whose values do not tell it, asked for; "" where it is known."""
    each, quantity = match.seen, CHANNELS[match.channel].quantity
    if each.unit or each.logged.is_words:
        return ""
    option = f"--unit {each.entity}="
    where = each.logged.where
    if quantity == "flow" and not each.is_counter and each.high < LOW_FLOW:
        text = f"{each.entity} goes up to {each.high:.3g} and has no unit. In which one is it"
        return ask(Question(text, FLOWS, None, option, where, FLOWS[0]))
    if quantity in ("flow", "gain") and each.is_counter:
        text = f"{each.entity} is a counter without a unit ({each.low:.4g} to {each.high:.4g}). What does it count"
        return ask(Question(text, (), "L" if quantity == "flow" else "kWh", option, where))
    if quantity == "level" and each.states and not each.states.startswith("0/"):
        low, high = each.states.split("/")
        text = f"{each.entity} is {low} or {high}. Which is on: {high}, as {low}/{high}, or {low}, as {high}/{low}"
        return ask(Question(text, (f"{low}/{high}", f"{high}/{low}"), None, option, where, each.states))
    if quantity == "level" and level_unit(each) == "0-10 V":
        text = f"{each.entity} goes up to {each.high:.3g} and has no unit. In which one is it"
        return ask(Question(text, ("0-10 V", "%", "1"), "0-10 V", option, where))
    return ""


def _tell_untold(matches: Mapping[str, Match], stated: Mapping[str, str], notes: Notes) -> None:
    """Say which units nothing tells but the values."""
    untold: dict[str, list[str]] = {}
    for channel, match in matches.items():
        each = match.seen
        if not each.is_unit_written and not each.logged.is_words and each.entity not in stated:
            quantity = CHANNELS[channel].quantity
            shown = each.unit or (level_unit(each) if quantity == "level" else UNITS[quantity])
            untold.setdefault(f"{shown} {each.why_unit}".strip(), []).append(each.entity)
    for taken, entities in untold.items():
        notes.assume(f"No unit is written for {', '.join(entities)}: taken as {taken}.")


def _made(match: Match, stated: Mapping[str, str], notes: Notes) -> _Made:
    """Return an entity with its conversion; raise `StudyError` for a unit that is none, or of something else."""
    each, quantity = match.seen, CHANNELS[match.channel].quantity
    unit = stated.get(each.entity) or each.unit
    taken = unit or (level_unit(each) if quantity == "level" else units.BASE[quantity])
    mend = f"say --unit '{each.entity}=UNIT', or --map {match.channel}=NAME"
    try:
        how = units.conversion("1" if each.logged.is_words else taken or "1", quantity)
    except ValueError as error:
        more = f"say what one is: --unit '{each.entity}=10 L'" if isinstance(error, units.CountsPulses) else mend
        raise refusal(each.logged.where, f"{each.entity}: {error}", more) from error
    if how is None:
        wrong = f"{each.entity} is in '{taken}', which is no unit of {match.channel} [{UNITS[quantity]}]"
        raise refusal(each.logged.where, wrong, mend)
    shown = unit or (taken if quantity == "level" else UNITS[quantity]) or "1"
    match = replace(match, seen=replace(each, unit=shown))
    logged = each.logged
    if logged.said is not None and quantity != "level":
        count = int(np.isfinite(logged.said).sum())
        instead = ", and the last setpoint holds there" if match.channel == "setpoint_C" else ""
        notes.warn(f"{logged.where}: {each.entity}: {count} readings are words among numbers: missing{instead}")
        logged = logged._replace(said=None)
    return _Made(match, logged, rhythm(logged.ns, logged.values), how)


def _refuse_misfits(values: pd.DataFrame, made: Mapping[str, _Made], grid: Grid) -> None:
    """Refuse a unit that does not fit its values, with what datasets check of them."""
    found = []
    temperatures = [channel for channel in made if channel.endswith("_C")]  # which tell of each other's unit
    for beside in (temperatures, *([channel] for channel in made if channel not in temperatures)):
        notes = Notes("")
        run(AS_LOGGED, Record(values[beside].copy(), grid.step_ns / NS), notes)
        found += [_misfit(one, made[one.key].match) for one in notes.problems]
    if found:
        raise StudyError(found)


def _misfit(problem: Problem, match: Match) -> Problem:
    """Return what a check refuses with the units to say: what it looks like, or another than made the misfit."""
    entity, unit, channel = match.seen.entity, match.seen.unit, match.channel
    other = "degC" if units.plain_unit(unit).lower() == "degf" else "degF"
    usual = other if channel.endswith("_C") else UNITS[CHANNELS[channel].quantity]
    looks = sorted((problem.wrong.find(words), written) for words, written in LIKE.items() if words in problem.wrong)
    options = " or ".join(f"--unit '{entity}={each}'" for each in [written for _, written in looks] or [usual])
    mend = f"say its unit: {options} or what it is; or another: --map {channel}=NAME"
    return replace(problem, file=match.seen.logged.where, key=f"{entity} in '{unit}' as {channel}", allowed=mend)


# --- states -------------------------------------------------------------------------------------------


def _while_alive(each: _Made, entities: Sequence[Seen]) -> _Made:
    """Return what is logged when it changes as if it rested whenever its source logged anything else.

    A valve is shut and a meter shows 0 for days: a logger that lives and says nothing of them says that they rest.
    """
    is_state = each.logged.is_words or _has_states(each.match)
    if each.kind.is_regular or not (is_state or CHANNELS[each.match.channel].quantity in RESTING):
        return each
    logged = each.logged
    own = [one.logged for one in entities if one.logged.is_of_house]
    beside = [one.ns for one in own if _folder(one) == _folder(logged)]
    minutes = np.unique(np.concatenate([ns // MINUTE_NS for ns in beside])) * MINUTE_NS
    signs = minutes[(minutes > logged.ns[0]) & ~np.isin(minutes, logged.ns)]
    last = np.searchsorted(logged.ns, signs, side="right") - 1
    rests = is_state | (logged.values[last] == 0.0)
    signs, last = signs[rests], last[rests]
    order = np.argsort(np.concatenate([logged.ns, signs]), kind="stable")
    ns, values, rows = (
        np.concatenate([whole, more])[order]
        for whole, more in (
            (logged.ns, signs),
            (logged.values, logged.values[last]),
            (logged.rows, logged.rows[last]),
        )
    )
    return replace(each, logged=logged._replace(ns=ns, values=values, rows=rows))


def _folder(logged: Logged) -> Path:
    return Path(logged.where.partition(", ")[0]).parent


# --- grid ---------------------------------------------------------------------------------------------


def _grid(request: Request, made: Mapping[str, _Made]) -> Grid:
    """Return the grid: by the finest clock of channels that move, from the first to the last reading of these."""
    moving = [each for channel, each in made.items() if channel not in SLOW] or list(made.values())
    by_clock = [each.kind.usual_s for each in moving if each.kind.is_regular]
    interval_s = request.interval_s or max(FINEST_S, round(min(by_clock, default=USUAL_S)))
    step = round(interval_s * NS)
    phase = _phase([each for each in moving if each.kind.is_regular], step)
    first, last = min(each.logged.ns[0] for each in moving), max(each.logged.ns[-1] for each in moving)
    begin, end = -((phase - int(first)) // step), -((phase - int(last)) // step)
    if end - begin + 1 > MOST_INTERVALS:
        span = f"from {pd.Timestamp(first)} to {pd.Timestamp(last)}"
        wrong = f"{span} there are {end - begin + 1} intervals of {interval_s:g} s"
        raise refusal(str(request.sources[0]), wrong, "say --interval '5 min'")
    return Grid((np.arange(begin, end + 1) * step + phase).astype(np.int64), step)


def _tell_stamps(made: Iterable[_Made], grid: Grid, notes: Notes) -> None:
    """Say how stamps of long intervals are taken, where no source says what they stamp."""
    interval_s = grid.step_ns / NS
    if interval_s >= AVERAGED_S and not any(each.logged.is_mean for each in made):
        notes.assume(
            f"A row every {interval_s / 60.0:g} min is taken as of its stamp, and flow and gains as means up to it. If "
            'rows are stamped where their interval starts, add stamps = "start" to [dataset] of dataset.toml.'
        )


def _phase(regular: Sequence[_Made], step: int) -> int:
    """Return where readings by the clock lie most of the time, else at whole intervals of the day."""
    if not regular:
        return 0
    phases, counts = np.unique(np.concatenate([each.logged.ns % step for each in regular]), return_counts=True)
    return int(phases[np.argmax(counts)]) if 2 * counts.max() > counts.sum() else 0


def _on_grid(each: _Made, grid: Grid, hold_s: float, notes: Notes) -> tuple[FloatArray, float]:
    """Return a channel on the grid in its unit, and the noise that the way of logging gives it."""
    channel, logged, interval_s = CHANNELS[each.match.channel], each.logged, grid.step_ns / NS
    if channel.name == "setpoint_C":
        hold_s = FOREVER_S
    longest_s = HELD * each.kind.usual_s if each.kind.is_regular else hold_s
    _tell_silence(each, hold_s, notes)
    if each.how.is_counter:
        found = rises(logged.ns, logged.values)
        _tell_counter(each, found, notes)
        rates = rates_on(found, grid.ends_ns, grid.step_ns, round(longest_s * NS))
        return each.how.scale * rates, each.how.scale * COUNTED * found.resolution * 3600.0 / interval_s
    ns = logged.ns
    if logged.is_mean and each.kind.usual_s > COARSER * interval_s:  # of an interval that ended: it was there before
        usual_ns = round(each.kind.usual_s * NS)
        ns = ns - (usual_ns - grid.step_ns if channel.is_mean else usual_ns // 2)  # a sample stamps its end, too
    values = each.how.scale * logged.values + each.how.offset
    if logged.said is not None:
        values = np.where(np.isnan(logged.said), values, logged.said)
    taken = on_grid(ns, values, each.kind, grid, hold_s, channel.is_mean)
    # where readings come as often as samples, these tell their noise themselves
    is_held = each.kind.usual_s > COARSER * interval_s
    if not is_held or _has_states(each.match) or channel.is_assumed:
        return taken, 0.0
    return taken, UNIFORM * threshold(values, each.kind.is_regular)


def _has_states(match: Match) -> bool:
    """Whether readings are off and on; a thermometer may show two whole numbers as well."""
    return match.seen.is_binary or (CHANNELS[match.channel].quantity == "level" and match.seen.is_two_state)


def _tell_silence(each: _Made, hold_s: float, notes: Notes) -> None:
    count, longest_s, place = silences(each.logged.ns, hold_s)
    if count and not each.kind.is_regular:
        since = f"{pd.Timestamp(each.logged.ns[place]):%Y-%m-%d %H:%M} (row {each.logged.rows[place]})"
        times = "once" if count == 1 else f"{count} times"
        longest_h = longest_s / 3600.0
        silent = f"nothing for over {hold_s / 3600.0:g} h {times}, at most for {longest_h:.1f} h from {since}"
        mend = f"if nothing changed while the logger ran, say --hold '{longest_h + 1.0:.0f} h'"
        notes.warn(f"{each.logged.where}: {each.logged.entity}: {silent}: missing beyond; {mend}")


def _tell_counter(each: _Made, found: Rises, notes: Notes) -> None:
    logged = each.logged
    for places, what in ((found.resets, "begins anew"), (found.jumps, "jumps, as no meter does")):
        if len(places):
            place = places[0]
            stamp = f"{pd.Timestamp(logged.ns[place]):%Y-%m-%d %H:%M} (row {logged.rows[place]})"
            times = "once" if len(places) == 1 else f"{len(places)} times"
            ending = "" if what == "begins anew" else ": missing there"
            notes.warn(f"{logged.where}: {logged.entity} {what} {times}, first at {stamp}{ending}")
