"""What a healthy record said of a loop: how it was built, and how well that is followed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import isfinite
from typing import Any

from waxstudy.diagnosis.calibration.room import CalibratedRoom
from waxstudy.diagnosis.result import BaselineFit, Calibrated
from waxstudy.report.diagnosis import words
from waxstudy.report.table import Column, Table, text


def tables(found: CalibratedRoom) -> list[Table[Any]]:
    return [as_built(found.as_built), fit(found.baseline)]


def notes(found: CalibratedRoom) -> list[str]:
    first, last = found.days
    beside = clear_words(each for each in found.as_built if each.part != "room")
    return [
        f"{found.dataset}, {first} to {last}: 95 % intervals; values of the control chain have none.",
        *(f"no part of a room, and not in the file: {sentence}" for sentence in beside),
        *(f"warning: {warning}" for warning in found.warnings),
        *([f"Origin of the record: {found.origin}"] if found.origin else []),
    ]


def as_built(each: Sequence[Calibrated]) -> Table[Calibrated]:
    """What was calibrated, beside what the documents say."""
    columns: list[Column[Calibrated]] = [
        text("of", lambda one: words.named(one.name)[0]),
        text("part"),
        Column("documents", lambda one: words.quantity(one.documented, words.named(one.name)[1])),
        Column("as calibrated", lambda one: words.interval(one.value, words.named(one.name)[1])),
        text("in words", lambda one: one.sentence if one.is_clear else one.description, kind="prose"),
    ]
    return Table(
        "as calibrated, with 95 % intervals; a whole sentence where it differs clearly from the documents",
        columns,
        each,
    )


def fit(each: Sequence[BaselineFit]) -> Table[BaselineFit]:
    """How well each channel of the healthy record is followed."""
    columns: list[Column[BaselineFit]] = [
        text("channel", lambda one: words.channel_words(one.channel)),
        Column("RMSE", lambda one: words.quantity(one.rmse, one.unit)),
        Column("CV(RMSE)", lambda one: words.with_unit(words.number(one.cv_rmse_percent, 2), "%")),
        Column("NMBE", lambda one: words.with_unit(words.number(one.nmbe_percent, 2), "%")),
    ]
    return Table("fit to the healthy record", columns, each)


def clear_words(told: Iterable[Calibrated]) -> list[str]:
    """What differs clearly from the documents, each effect once, with what was calibrated of it."""
    found: dict[str, list[str]] = {}
    for each in told:
        if each.is_clear:
            values = found.setdefault(each.sentence, [])
            if isfinite(each.value.low + each.value.high):
                values.append(_range(each))
    return [_with(sentence, values) for sentence, values in found.items()]


def _range(each: Calibrated) -> str:
    """Return an interval with the parameter's name, without the effect's."""
    name, unit = words.named(each.name.partition(" ")[2])
    return words.with_unit(f"{name} {' to '.join(words.ends(each.value))}".strip(), unit)


def _with(sentence: str, values: Sequence[str]) -> str:
    return f"{sentence.rstrip('.')} ({', '.join(values)})." if values else sentence
