"""The tables of a diagnosis."""

from __future__ import annotations

from math import isfinite, nan
from typing import Any

from waxstudy.diagnosis.result import (
    BaselineFit,
    BeforeAfter,
    Calibrated,
    Diagnosis,
    FoundEffect,
    HeatBy,
    HeatPer,
    Measurement,
    NeighbourEvent,
    NeighbourRoom,
    StageGap,
    Tried,
    Unexplained,
)
from waxstudy.report.diagnosis import words
from waxstudy.report.diagnosis.calibration import as_built, fit
from waxstudy.report.diagnosis.figures.ranking import ranked, role
from waxstudy.report.diagnosis.focus import by_reason, measurements, unit_of
from waxstudy.report.diagnosis.summary import held_out, in_order, remarks
from waxstudy.report.diagnosis.words import quantity, with_unit
from waxstudy.report.table import Column, Table, text

PARTS = {"fit": "fit", "select": "choice", "shrinkage": "shrinkage"}
EFFECT: Column[Any] = text("name", heading="effect")
STAGE: Column[Any] = text("stage", lambda each: words.stage_words(each.stage))
CHANNEL: Column[Any] = text("channel", lambda each: words.channel_words(each.channel))
JUDGED_BY: Column[Any] = text("judged by", CHANNEL.value)
PROBABILITY: Column[Any] = Column("probability or p", lambda each: words.chance(each.probability) or _p(each))


def _p(each: Any) -> str:
    """Of a room without a healthy record there is no probability."""
    return f"p = {words.probability(each.p)}"


def _found_again(effect: FoundEffect) -> str:
    """How often resampled records show an effect that rules named; what was weighed has a probability instead."""
    return "" if isfinite(effect.probability) else words.percent(effect.inclusion)


def _of_group(effect: FoundEffect) -> str:
    """How probable it is that an effect, or one that cannot be told from it, is there."""
    told = PROBABILITY.text(effect)
    return f"{told} together" if len(effect.group) > 1 and isfinite(effect.probability) else told


def stages(diagnosis: Diagnosis) -> Table[StageGap]:
    """The gap of each judged channel."""
    columns: list[Column[StageGap]] = [
        STAGE,
        CHANNEL,
        Column("gap", lambda stage: quantity(stage.gap, stage.unit)),
        Column("noise floor", lambda stage: quantity(stage.noise_floor, stage.unit)),
        Column("times", lambda stage: words.times(stage.over_floor)),
        Column("with the effects", lambda stage: quantity(stage.gap_after, stage.unit)),
        Column("heat", lambda stage: with_unit(words.signed(stage.impact.get("heat_percent", nan)), "%")),
        Column("air", lambda stage: with_unit(words.rough(stage.impact.get("air_K", nan)), "K")),
        Column("memory", lambda stage: words.number(stage.autocorrelation, 2)),
    ]
    title = "gap of each judged channel: root mean square, and what it does to heat and air temperature"
    return Table(title, columns, diagnosis.stages)


def regimes(diagnosis: Diagnosis) -> Table[Any]:
    """The same by regime; a row is a stage and its regime."""
    columns: list[Column[Any]] = [
        text("stage", lambda row: STAGE.text(row[0])),
        text("channel", lambda row: CHANNEL.text(row[0])),
        text("regime", lambda row: row[1].name),
        Column("gap", lambda row: quantity(row[1].gap, row[0].unit)),
        Column("times the floor", lambda row: words.times(row[0].regime_over_floor(row[1]))),
        Column("share of the square", lambda row: words.percent(row[1].share)),
    ]
    return Table("the gap by regime", columns, [(stage, each) for stage in diagnosis.stages for each in stage.regimes])


def parameters(effect: FoundEffect) -> Table[Any]:
    """Fitted parameters of a found effect with their 95 % intervals, and those of its group without."""
    members = {effect.name: effect.parameters, **{each.name: each.parameters for each in effect.alternatives}}
    rows = [(member, *words.named(key), value) for member, fitted in members.items() for key, value in fitted.items()]
    of_first = f"; only of {effect.name} intervals were looked for" if len(members) > 1 else ""
    columns: list[Column[Any]] = [
        text("effect", lambda row: row[0]),
        text("parameter", lambda row: row[1]),
        Column("value", lambda row: words.interval(row[3], row[2])),
    ]
    title = f"fitted parameters, with 95 % intervals{of_first}"
    return Table(title, columns if len(members) > 1 else columns[1:], rows)


def found(diagnosis: Diagnosis) -> Table[FoundEffect]:
    """How sure each found effect is, and how far its gap shrinks."""
    columns: list[Column[FoundEffect]] = [
        EFFECT,
        JUDGED_BY,
        Column("gap before", lambda effect: quantity(effect.gap_before, unit_of(diagnosis, effect))),
        Column("gap after", lambda effect: quantity(effect.gap_after, unit_of(diagnosis, effect))),
        Column("noise floor", lambda effect: quantity(effect.noise_floor, unit_of(diagnosis, effect))),
        Column("shrinks by", lambda effect: words.percent_interval(effect.shrink)),
        *([Column("found again", _found_again)] if any(map(_found_again, diagnosis.effects)) else []),
        Column("probability", _of_group),
    ]
    title = f"found effects: gaps over the whole record, shrinkage {held_out(diagnosis.effects)}"
    return Table(title, columns, diagnosis.effects)


def closed_loop(diagnosis: Diagnosis) -> Table[tuple[str, BeforeAfter]]:
    """Figures of the closed loop, which runs free."""

    def shown(row: tuple[str, BeforeAfter], value: float) -> str:
        every = (row[1].measured, row[1].before, row[1].after)
        places = min((words.decimals(each) for each in every if each != round(each)), default=0)
        is_air = words.loop_words(row[0])[1] == "°C"  # as in the summary: of 21 °C hundredths matter
        return words.number(value, 2 if is_air else places)

    columns: list[Column[tuple[str, BeforeAfter]]] = [
        text("figure", lambda row: words.loop_words(row[0])[0]),
        Column("measured", lambda row: shown(row, row[1].measured)),
        Column("as believed", lambda row: shown(row, row[1].before)),
        Column("with the effects", lambda row: shown(row, row[1].after)),
        text("unit", lambda row: words.unit_words(words.loop_words(row[0])[1])),
    ]
    return Table("the closed loop, running free", columns, in_order(diagnosis.closed_loop))


def heat(diagnosis: Diagnosis) -> Table[HeatBy]:
    """Means of missing heat by what may drive it."""
    columns: list[Column[HeatBy]] = [
        text("driver", heading="by"),
        text("name", heading="where"),
        Column("hours", lambda each: words.number(each.hours, 0)),
        Column("as believed", lambda each: words.interval(each.before, "W")),
        Column("with the effects", lambda each: words.interval(each.after, "W")),
    ]
    return Table("missing heat: means, with 95 % intervals", columns, diagnosis.missing_heat.by)


def heat_slopes(diagnosis: Diagnosis) -> Table[HeatPer]:
    """By how much missing heat changes with what may drive it, each by itself."""
    columns: list[Column[HeatPer]] = [
        text("driver", heading="with"),
        Column("as believed", lambda each: words.interval(each.before, each.unit)),
        Column("with the effects", lambda each: words.interval(each.after, each.unit)),
        Column("share of its variance", lambda each: words.percent(each.share)),
    ]
    return Table("how missing heat goes with a driver, each by itself", columns, diagnosis.missing_heat.per)


def events(diagnosis: Diagnosis) -> Table[NeighbourEvent]:
    """What departs in which room, and when."""
    columns: list[Column[NeighbourEvent]] = [
        text("room"),
        text("when", heading="when (local standard time)"),
        Column("departure", lambda each: words.interval(each.size_K, "K")),
        Column("heat", lambda each: words.interval(each.heat_W, "W") if each.heat_W else "not known"),
        text("reading", heading="what it may be", kind="prose"),
        Column("probability", lambda each: words.chance(each.probability)),
    ]
    return Table("what departs from its neighbours", columns, diagnosis.neighbours.events)


def rooms(diagnosis: Diagnosis) -> Table[NeighbourRoom]:
    """How each room follows the others, and what its own recorded heat does."""
    columns: list[Column[NeighbourRoom]] = [
        text("name", heading="room"),
        Column("neighbours and weather miss", lambda each: quantity(each.rms_K, "K")),
        Column(
            "mean warming in 3 h of a kilowatt of its own",
            lambda each: words.interval(each.own_heat_K_kW, "K") if each.own_heat_K_kW else "not known",
        ),
        Column("departures", lambda each: str(sum(event.room == each.name for event in diagnosis.neighbours.events))),
    ]
    return Table("how each room follows the others", columns, diagnosis.neighbours.rooms)


def tried(diagnosis: Diagnosis) -> Table[Tried]:
    """Every effect that was fitted, in the order of the figure."""
    columns: list[Column[Tried]] = [
        EFFECT,
        STAGE,
        JUDGED_BY,
        Column("explains", lambda each: words.percent(each.share)),
        Column("gain", lambda each: words.number(each.gain)),
        PROBABILITY,
        text("verdict", lambda each: f"{role(diagnosis, each)}{f': {each.why}' if each.why else ''}"),
    ]
    title = "every effect that was tried; what only rules judged, on days that its fit has not seen"
    return Table(title, columns, ranked(diagnosis))


def unexplained(diagnosis: Diagnosis) -> Table[Unexplained]:
    """Gaps that no effect of the library explains."""
    columns: list[Column[Unexplained]] = [
        STAGE,
        CHANNEL,
        Column("gap", lambda left: quantity(left.gap, unit_of(diagnosis, left))),
        Column("noise floor", lambda left: quantity(left.noise_floor, unit_of(diagnosis, left))),
        PROBABILITY,
        text("remark", lambda left: "; ".join(remarks(left))),
    ]
    return Table("gaps without a known cause", columns, diagnosis.unexplained)


def untestable(diagnosis: Diagnosis) -> Table[tuple[str, list[str]]]:
    """Effects that this record could not show, by reason."""
    return Table(
        "effects that this record could not show",
        [text("why", lambda row: row[0]), text("effects", lambda row: ", ".join(row[1]))],
        by_reason(diagnosis.untestable),
    )


def next_measurements(diagnosis: Diagnosis) -> Table[Measurement]:
    """What to measure next."""
    columns: list[Column[Measurement]] = [
        text("what", heading="measurement"),
        text("what it would settle", lambda each: ", ".join(map(words.stage_words, each.splits))),
    ]
    return Table("measurements that would tell more", columns, measurements(diagnosis))


def departures(diagnosis: Diagnosis) -> Table[tuple[str, float]]:
    """Departures of the room in standard deviations of their priors."""
    return Table(
        "departures of the room",
        [text("of", lambda row: row[0]), Column("standard deviations", lambda row: words.departure(row[1]))],
        list(diagnosis.departures.items()),
    )


def posterior(diagnosis: Diagnosis) -> Table[tuple[str, float]]:
    """Hypotheses of the whole loop that are not below 1 %, the likeliest first."""
    told = [each for each in diagnosis.posterior.items() if each[1] >= words.LEAST_CHANCE]
    return Table(
        "how likely each hypothesis is" + (" (others are below 1 %)" if len(told) < len(diagnosis.posterior) else ""),
        [
            text("hypothesis", lambda row: words.hypothesis(row[0])),
            Column("probability", lambda row: words.chance(row[1])),
        ],
        sorted(told, key=lambda each: -each[1]),
    )


def calibrated(diagnosis: Diagnosis) -> Table[Calibrated]:
    return as_built(diagnosis.as_built)


def fitted(diagnosis: Diagnosis) -> Table[BaselineFit]:
    return fit(diagnosis.baseline)


def parts(diagnosis: Diagnosis) -> Table[tuple[str, str, str]]:
    """Which days served for what."""
    rows = [(PARTS.get(name, name), days[0], days[-1]) for name, days in diagnosis.parts.items() if days]
    columns: list[Column[tuple[str, str, str]]] = [
        text("part", lambda row: row[0]),
        Column("first day", lambda row: row[1]),
        Column("last day", lambda row: row[2]),
    ]
    return Table("parts of the record", columns, rows)


TABLES = (
    stages,
    regimes,
    found,
    closed_loop,
    heat,
    heat_slopes,
    events,
    rooms,
    tried,
    unexplained,
    untestable,
    next_measurements,
    departures,
    parts,
    posterior,
    calibrated,
    fitted,
)
