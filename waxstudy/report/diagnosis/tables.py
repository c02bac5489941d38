"""The tables of a diagnosis, as text."""

from __future__ import annotations

from waxstudy.diagnosis.result import Diagnosis, FoundEffect, StageGap
from waxstudy.report.diagnosis.figures.ranking import ranked, role
from waxstudy.report.diagnosis.focus import by_reason, measurements, unit_left
from waxstudy.report.diagnosis.summary import held_out, in_order, remarks
from waxstudy.report.diagnosis.words import (
    channel_words,
    decimals,
    interval,
    loop_words,
    named,
    number,
    percent,
    percent_interval,
    probability,
    rough,
    signed,
    stage_words,
    times,
    unit_words,
    with_unit,
)
from waxstudy.report.words import Table

PARTS = {"fit": "fit", "select": "choice", "shrinkage": "shrinkage"}


def stages(diagnosis: Diagnosis) -> Table:
    """The gap of each judged channel."""
    headings = ["stage", "channel", "gap", "noise floor", "times", "with the effects", "heat", "air", "memory"]
    title = "gap of each judged channel: root mean square, and what it does to heat and air temperature"
    return title, headings, [_stage(stage) for stage in diagnosis.stages]


def _stage(stage: StageGap) -> list[str]:
    heat, air = stage.impact.get("heat_percent"), stage.impact.get("air_K")
    return [
        stage_words(stage.stage),
        channel_words(stage.channel),
        *(with_unit(number(value), stage.unit) for value in (stage.gap, stage.noise_floor)),
        times(stage.over_floor),
        with_unit(number(stage.gap_after), stage.unit),
        "" if heat is None else with_unit(signed(heat), "%"),
        "" if air is None else with_unit(rough(air), "K"),
        number(stage.autocorrelation, 2),
    ]


def regimes(diagnosis: Diagnosis) -> Table:
    """The same by regime."""
    rows = [
        [
            stage_words(stage.stage),
            channel_words(stage.channel),
            regime.name,
            with_unit(number(regime.gap), stage.unit),
            times(stage.regime_over_floor(regime)),
            percent(regime.share),
        ]
        for stage in diagnosis.stages
        for regime in stage.regimes
    ]
    return "the gap by regime", ["stage", "channel", "regime", "gap", "times the floor", "share of the square"], rows


def parameters(effect: FoundEffect) -> Table:
    """Fitted parameters of a found effect with their 95 % intervals, and those of its group without."""
    members = {effect.name: effect.parameters, **{each.name: each.parameters for each in effect.alternatives}}
    several = len(members) > 1
    rows = [
        [*([member] if several else []), named(name)[0], interval(value, named(name)[1])]
        for member, parameters in members.items()
        for name, value in parameters.items()
    ]
    of_first = f"; only of {effect.name} intervals were looked for" if several else ""
    headings = [*(["effect"] if several else []), "parameter", "value"]
    return f"fitted parameters, with 95 % intervals{of_first}", headings, rows


def found(diagnosis: Diagnosis) -> Table:
    """How sure each found effect is, and how far its gap shrinks."""
    units = {stage.channel: stage.unit for stage in diagnosis.stages}
    rows = [
        [
            effect.name,
            channel_words(effect.channel),
            *(with_unit(number(v), units.get(effect.channel, "")) for v in (effect.gap_before, effect.gap_after)),
            with_unit(number(effect.noise_floor), units.get(effect.channel, "")),
            percent_interval(effect.shrink),
            percent(effect.inclusion),
            probability(effect.p),
        ]
        for effect in diagnosis.effects
    ]
    headings = ["effect", "judged by", "gap before", "gap after", "noise floor", "shrinks by", "found again", "p"]
    return f"found effects: gaps over the whole record, shrinkage {held_out(diagnosis.effects)}", headings, rows


def closed_loop(diagnosis: Diagnosis) -> Table:
    """Figures of the closed loop, which runs free."""
    rows = []
    for key, figure in in_order(diagnosis.closed_loop):
        words, unit = loop_words(key)
        values = (figure.measured, figure.before, figure.after)
        places = min((decimals(value) for value in values if value != round(value)), default=0)
        places = 2 if unit == "°C" else places  # as in the summary: of 21 °C hundredths matter
        rows.append([words, *(number(value, places) for value in values), unit_words(unit)])
    headings = ["figure", "measured", "as believed", "with the effects", "unit"]
    return "the closed loop, running free", headings, rows


def tried(diagnosis: Diagnosis) -> Table:
    """Every effect that was fitted, in the order of the figure."""
    rows = [
        [
            each.name,
            stage_words(each.stage),
            channel_words(each.channel),
            percent(each.share),
            number(each.gain),
            probability(each.p),
            f"{role(diagnosis, each)}{f': {each.why}' if each.why else ''}",
        ]
        for each in ranked(diagnosis)
    ]
    headings = ["effect", "stage", "judged by", "explains", "gain", "p", "verdict"]
    return "every effect that was tried, on days that its fit has not seen", headings, rows


def unexplained(diagnosis: Diagnosis) -> Table:
    """Gaps that no effect of the library explains."""
    rows = [
        [
            stage_words(each.stage),
            channel_words(each.channel),
            *(with_unit(number(value), unit_left(diagnosis, each)) for value in (each.gap, each.noise_floor)),
            probability(each.p),
            "; ".join(remarks(each)),
        ]
        for each in diagnosis.unexplained
    ]
    return "gaps without a known cause", ["stage", "channel", "gap", "noise floor", "p", "remark"], rows


def untestable(diagnosis: Diagnosis) -> Table:
    """Effects that this record could not show, by reason."""
    rows = [[reason, ", ".join(names)] for reason, names in by_reason(diagnosis.untestable)]
    return "effects that this record could not show", ["why", "effects"], rows


def next_measurements(diagnosis: Diagnosis) -> Table:
    """What to measure next."""
    rows = [[each.what, ", ".join(map(stage_words, each.splits))] for each in measurements(diagnosis)]
    return "measurements that would tell more", ["measurement", "what it would settle"], rows


def departures(diagnosis: Diagnosis) -> Table:
    """Departures of the room in standard deviations of their priors."""
    rows = [[name, signed(value)] for name, value in diagnosis.departures.items()]
    return "departures of the room", ["of", "standard deviations"], rows


def parts(diagnosis: Diagnosis) -> Table:
    """Which days served for what."""
    rows = [[PARTS.get(name, name), *days[:1], *days[-1:]] for name, days in diagnosis.parts.items() if days]
    return "parts of the record", ["part", "first day", "last day"], rows
