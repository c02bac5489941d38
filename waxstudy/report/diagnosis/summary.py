"""A diagnosis in ten to twenty lines, for a plant engineer at five o'clock."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator, Mapping, Sequence

from rich.table import Table as Grid

from waxstudy.diagnosis.result import (
    BeforeAfter,
    Diagnosis,
    FoundEffect,
    Interval,
    Measurement,
    NeighbourEvent,
    StageGap,
    Unexplained,
)
from waxstudy.diagnosis.select.testability import in_words
from waxstudy.report.diagnosis.calibration import clear_words
from waxstudy.report.diagnosis.focus import by_reason, left_at, main_stages, measurements, other_stages, unit_of
from waxstudy.report.diagnosis.words import (
    OF_LOOP,
    chance,
    channel_words,
    hypothesis,
    interval,
    loop_words,
    named,
    number,
    percent,
    percent_interval,
    probability,
    quantity,
    rough,
    signed,
    stage_words,
    times,
    with_unit,
)
from waxstudy.report.formats import console
from waxstudy.report.words import counted

VERDICTS = {
    "effect": "effect found",
    "group": "effects found that this record cannot tell apart",
    "unknown": "gap without a known cause",
    "untestable": "not testable with this record",
    "none": "no effect found",
    "room": "a room departs from its neighbours",
}
QUICK = (
    "not all alternatives were compared: another effect, or none, may explain as much; the full run takes longer and "
    "tells"
)
Line = tuple[str, str]  # label, text
OFF_MEASURED = ("heat_percent", "air_mae_K", "setpoint_shift_K")  # figures over those that were measured
MOST_NAMES = 3
MOST_LINES = 3  # of one label
MOST_EVENTS = 12  # of rooms
MOST_BUILT = 5  # things that were so from the start
MOST_LIKELY, LEAST_LIKELY = 4, 0.01  # hypotheses that are told, and how likely they are at least


def lines(diagnosis: Diagnosis) -> list[Line]:
    """Return the summary, line by line; a label is blank where it is that of the line above."""
    found: list[Line] = []
    for label, texts in _parts(diagnosis):
        found += [(label if i == 0 else "", text) for i, text in enumerate(texts)]
    return found


def headline(diagnosis: Diagnosis) -> str:
    """The verdict in words; nothing found is not nothing there, where a part of the loop could not be judged."""
    is_partial = diagnosis.verdict == "none" and diagnosis.not_judged
    return VERDICTS[diagnosis.verdict] + (" in what could be judged" if is_partial else "")


def _parts(diagnosis: Diagnosis) -> Iterator[tuple[str, list[str]]]:
    yield "quick look", [looked] if (looked := quick_look(diagnosis)) else []
    yield "compared with", [_compared(diagnosis)] if diagnosis.compared_with else []
    yield "as calibrated", _few(clear_words(diagnosis.as_built), MOST_BUILT)
    yield "where", [*(_where(diagnosis, stage) for stage in main_stages(diagnosis)), *_others(diagnosis)]
    yield "heat", [diagnosis.missing_heat.sentence] if diagnosis.missing_heat.is_resolved else []
    yield "rooms", _few([event_words(each) for each in diagnosis.neighbours.events], MOST_EVENTS)
    yield "cause", [_cause(effect) for effect in diagnosis.effects]
    yield "days", [told] if (told := first_day(diagnosis)) else []
    yield "likely", [_likely(diagnosis)] if diagnosis.compared_with and diagnosis.posterior else []
    yield "how far", [*(_how_far(diagnosis, effect) for effect in diagnosis.effects), *_loop(diagnosis)]
    nothing_left = ["nothing that stands out of the noise"] if diagnosis.stages else []
    yield "unexplained", _few(_left(diagnosis)) or nothing_left
    yield "not tested", _not_tested(diagnosis)
    yield "measure next", _few([_next(each) for each in measurements(diagnosis)])
    yield "warnings", _few(list(diagnosis.warnings))


def quick_look(diagnosis: Diagnosis) -> str:
    """What a quick look leaves open, empty where nothing was judged."""
    return QUICK if diagnosis.is_quick and diagnosis.tried and diagnosis.verdict != "untestable" else ""


def first_day(diagnosis: Diagnosis) -> str:
    """Which day is the first, where days are told by their number."""
    every = [*(each.when for each in diagnosis.effects), *(each.when for each in diagnosis.unexplained)]
    is_numbered = any(re.search(r"\bday \d", when.pattern) for when in every if when)
    # what a first sample at midnight ends belongs to the day behind it
    return f"day 1 is {diagnosis.traces.index[0]:%Y-%m-%d}" if is_numbered and len(diagnosis.traces) else ""


def event_words(event: NeighbourEvent) -> str:
    """What departs in a room, when, by how much, and what it may be."""
    way = "colder" if event.size_K.value < 0.0 else "warmer"
    heat = f", {interval(event.heat_W, 'W')} {event.heat_from}" if event.heat_W else ""
    size = Interval(*sorted_size(event))
    departs = f"{event.room}, {event.when}: {way} than its neighbours say by {interval(size, 'K')}{heat}"
    return f"{departs}; {event.reading} ({chance(event.probability)})"


def sorted_size(event: NeighbourEvent) -> tuple[float, float, float]:
    """The size of a departure, whichever way it goes, with its bounds."""
    size = event.size_K
    return (size.value, size.low, size.high) if size.value >= 0.0 else (-size.value, -size.high, -size.low)


def _few(texts: Sequence[str], most: int = MOST_LINES) -> list[str]:
    if len(texts) <= most:
        return list(texts)
    return [*texts[: most - 1], f"and {len(texts) - most + 1} more"]


def _compared(diagnosis: Diagnosis) -> str:
    """Which healthy record it was compared with, and how well the air of a room is followed there."""
    air = next((each for each in diagnosis.baseline if each.channel == "air_temperature_C"), None)
    followed = f"; its air is followed to {quantity(air.rmse, air.unit)}" if air else ""
    return f"{diagnosis.compared_with}, taken as healthy{followed}"


def _likely(diagnosis: Diagnosis) -> str:
    """The likeliest hypotheses of the whole loop, the likeliest first."""
    told = sorted(diagnosis.posterior.items(), key=lambda each: -each[1])
    shown = [each for each in told[:MOST_LIKELY] if each[1] >= LEAST_LIKELY] or told[:1]
    likely = ", ".join(f"{chance(probability)} {hypothesis(names)}" for names, probability in shown)
    hidden = f"{in_words(diagnosis.not_judged)} could not be judged" if diagnosis.not_judged else ""
    return "; ".join(filter(None, (likely, hidden)))


def _where(diagnosis: Diagnosis, stage: StageGap) -> str:
    words = f"{stage_words(stage.stage)}: {channel_words(stage.channel)} is off by "
    words += with_unit(number(stage.gap), stage.unit) or "nothing"
    if stage.noise_floor > 0.0:
        words += f", {times(stage.over_floor)} times its noise floor"
    left = left_at(diagnosis, stage)
    is_explained = any(effect.channel == stage.channel for effect in diagnosis.effects)
    if left and not left.is_finding and not is_explained:
        words += " (no finding: see unexplained)"
    impact = impact_words(stage)
    return f"{words}; {impact}" if impact else words


def impact_words(stage: StageGap) -> str:
    """What a stage's gap does to heat and air, as far as it was computed."""
    heat, air = stage.impact.get("heat_percent", math.nan), stage.impact.get("air_K", math.nan)
    off_K = f"by {rough(air)} K" if math.isfinite(air) else ""
    if math.isfinite(heat):
        return f"by itself this puts heat off by {signed(heat)} %" + (f", air {off_K}" if off_K else "")
    return f"air is off {off_K}" if off_K and stage.channel != "air_temperature_C" else ""


def _others(diagnosis: Diagnosis) -> list[str]:
    others = other_stages(diagnosis)
    if not others:
        return []
    most = f"{channel_words(others[0].channel)}, by {times(others[0].over_floor)} times its noise floor"
    return [f"{counted(len(others), 'other channel')} judged; off by most is {most}"]


def _cause(effect: FoundEffect) -> str:
    values = "; ".join(filter(None, (parameter_words(effect.parameters), at_end_words(effect))))
    words = f"{effect.name}: {values}." if values else f"{effect.name}: {effect.sentence}"
    if others := alternatives(effect):
        words += f" This record cannot tell it from {' or '.join(others)}."
    return f"{words} {how_sure(effect)}"


def parameter_words(parameters: Mapping[str, Interval]) -> str:
    return ", ".join(f"{named(name)[0]} {interval(value, named(name)[1])}" for name, value in parameters.items())


def at_end_words(effect: FoundEffect) -> str:
    """What is to be said of a value beyond which nothing is tried."""
    names = " and ".join(named(name)[0] for name in effect.at_end)
    return f"{names} may be further off: nothing beyond is tried" if names else ""


def alternatives(effect: FoundEffect) -> list[str]:
    """The other members of an effect's group, with fitted values as far as they are told."""
    fitted = {each.name: parameter_words(each.parameters) for each in effect.alternatives[:MOST_NAMES]}
    names = [name for name in effect.group if name != effect.name]
    return [f"{name} (fitted: {fitted[name]})" if fitted.get(name) else name for name in names]


def how_sure(effect: FoundEffect) -> str:
    if math.isfinite(effect.probability):
        sure = chance(effect.probability)
        told = f"Together {sure} probable" if len(effect.group) > 1 else f"Probability {sure}"
        return f"{told}; {effect.when.told}." if effect.when else f"{told}."
    found = f"{percent(effect.inclusion)} of resampled records" if math.isfinite(effect.inclusion) else ""
    return f"Found again in {found}; p = {probability(effect.p)}." if found else f"p = {probability(effect.p)}."


def _how_far(diagnosis: Diagnosis, effect: FoundEffect) -> str:
    before, after, floor = (number(v) for v in (effect.gap_before, effect.gap_after, effect.noise_floor))
    gap = f"the gap of {channel_words(effect.channel)} {held_out([effect])}"
    share = percent_interval(effect.shrink)
    told = f"{effect.name} takes away {share} of {gap}"
    if not share:
        told = f"{gap} may be noise: how much {effect.name} takes away of it cannot be told"
    return f"{told}; in all {before} → {with_unit(after, unit_of(diagnosis, effect))}, floor {floor}"


def held_out(effects: Sequence[FoundEffect]) -> str:
    """Where shrinkage was judged."""
    return "on held-out days" if all(effect.is_held_out for effect in effects) else "where its fit has not seen"


def _loop(diagnosis: Diagnosis) -> list[str]:
    """The closed loop in one line, where something was found that changes it."""
    if not diagnosis.effects or not diagnosis.closed_loop:
        return []
    told = []
    for key, figure in in_order(diagnosis.closed_loop)[:MOST_LINES]:
        words, unit = loop_words(key)
        values = (figure.before, figure.after, figure.measured)
        before, after, seen = (number(v, 2) if unit == "°C" else rough(v) for v in values)  # of 21 °C tenths matter
        measured = "" if key in OFF_MEASURED else f" (measured {seen})"
        told.append(f"{words} {before} → {with_unit(after, unit)}{measured}")
    turns = " (its controller reacts, so that signs may turn)" if "heat_percent" in diagnosis.closed_loop else ""
    return [f"closed loop{turns}: {', '.join(told)}"]


def in_order(loop: Mapping[str, BeforeAfter]) -> list[tuple[str, BeforeAfter]]:
    """Figures of the closed loop, those that an engineer asks for first."""
    order = list(OF_LOOP)
    return sorted(loop.items(), key=lambda item: order.index(item[0]) if item[0] in order else len(order))


def _left(diagnosis: Diagnosis) -> list[str]:
    """Unexplained gaps, findings first; of what is no finding, one channel of each stage."""
    rest: dict[tuple[str, str], list[Unexplained]] = {}
    for left in diagnosis.unexplained:
        if not left.is_finding:
            rest.setdefault((left.stage, "; ".join(remarks(left))), []).append(left)
    told = [_gap_left(diagnosis, left) for left in diagnosis.unexplained if left.is_finding]
    for (_, remark), alike in rest.items():
        more = f" and {counted(len(alike) - 1, 'more channel')}" if len(alike) > 1 else ""
        told.append(f"{_gap_left(diagnosis, alike[0])}{more}; {remark}")
    return told


def _gap_left(diagnosis: Diagnosis, left: Unexplained) -> str:
    gap = with_unit(number(left.gap), unit_of(diagnosis, left))
    channel = f" {channel_words(left.channel)}" if left.channel else ""
    when = f", mostly {left.when.pattern}" if left.when else ""
    like = f", as if {left.like}" if left.like else ""
    return (
        f"{stage_words(left.stage)}:{channel} {gap}{when}{like}, floor {number(left.noise_floor)}, {_how_sure_of(left)}"
    )


def _how_sure_of(left: Unexplained) -> str:
    if math.isfinite(left.probability):
        what = "something amiss" if left.is_nameless else "something unknown"
        return f"{what} {chance(left.probability)} probable"
    return f"p = {probability(left.p)}"


def remarks(left: Unexplained) -> list[str]:
    """When an unexplained gap shows, and what keeps it from being a finding."""
    form = "a model of this form misses as much where nothing is wrong"
    covered = "it is within the believed model's published uncertainty"
    drives = "sun or gains that nobody recorded may leave as much"
    told = ((form, left.is_room_form), (covered, left.is_covered), (drives, left.is_of_drives))
    why = ", and ".join(words for words, holds in told if holds)
    when = [f"mostly {left.when.pattern}"] if left.when else []
    return [*when, *([f"as if {left.like}"] if left.like else []), *([f"no finding: {why}"] if why else [])]


def _not_tested(diagnosis: Diagnosis) -> list[str]:
    if not diagnosis.untestable:
        return []
    reason, names = by_reason(diagnosis.untestable)[0]
    others = len(diagnosis.untestable) - len(names)
    more = f"; {others} more for other reasons" if others else ""
    return [f"{_some(names)}: {reason}{more}"]


def _some(names: Sequence[str]) -> str:
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more


def _next(measurement: Measurement) -> str:
    names = [stage_words(name) for name in measurement.splits]
    return f"{measurement.what}; it would settle {_some(names)}" if names else measurement.what


def as_terminal(diagnosis: Diagnosis, width: int, colour: bool) -> str:
    """The summary for a terminal of a given width."""
    out = io.StringIO()
    printer = console(out, width, colour)
    printer.print(f"{diagnosis.dataset}: {headline(diagnosis)}", style="bold")
    printer.print(diagnosis.summary)
    grid = Grid.grid(padding=(0, 2, 0, 0))
    grid.add_column(no_wrap=True, style="dim")
    grid.add_column()
    for label, text in lines(diagnosis):
        grid.add_row(label, text)
    printer.print(grid)
    return "".join(f"{line.rstrip()}\n" for line in out.getvalue().splitlines())
