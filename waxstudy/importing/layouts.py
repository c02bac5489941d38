"""Layouts: a table with a column for each entity, or with a row for each reading; columns in any order."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.dataset.columns import named
from waxstudy.importing.begin import UNITS as UNITS_OF_TIME
from waxstudy.importing.headers import is_value, parted, units_row
from waxstudy.importing.limits import AGAIN, AUTUMNS_D, LOOKED_AT, MIXED, MOST_ENTITIES, REPEATED, TWICE
from waxstudy.importing.reading import Readings, Table, refusal
from waxstudy.importing.row_numbers import without_row_numbers
from waxstudy.importing.stamps import is_stamps, stamps_of, zone_told
from waxstudy.importing.status import without_bad, without_status
from waxstudy.importing.summaries import without_summaries
from waxstudy.importing.time_columns import EXPECTED, dated, may_be_stamps, time_column
from waxstudy.importing.units import plain_unit
from waxstudy.importing.words import SIGN, numbers_of
from waxstudy.study.problems import listed

# names of columns, in lower case; what is not named so is told by what it holds
ENTITY = ("entity_id", "entity", "sensor", "sensor_id", "name", "tag", "variable", "channel", "point", "series",
          "metric", "device", "id", "friendly_name", "topic", "messstelle", "statistic_id", "item", "destination name",
          "destination address")  # fmt: skip
VALUE = ("state", "value", "_value", "reading", "mean", "wert", "val", "messwert", "measurement", "info")
UNIT = ("unit", "unit_of_measurement", "units", "einheit", "_unit")
NO_ROWS = "holds less than two rows of readings"
FIELD = "_field"  # of InfluxDB
START, MEAN = ("start", "start_ts"), "mean"  # of Home Assistant's statistics
PLACED = re.compile(r"column \d+")  # of a table without names
# behind a file's name, as of each month or day
DATED = re.compile(r"[._ -](?:19|20)\d\d[._ -]?(?:0[1-9]|1[0-2])(?:[._ -]?(?:0[1-9]|[12]\d|3[01]))?$")


def readings_of(
    table: Table, file: Path, time_format: str | None, begin: pd.Timestamp | None = None
) -> Iterator[Readings]:
    """Yield what a table says of each entity, in the order of its columns; raise `StudyError` for another layout.

    `begin` is that of times that tell no date.
    """
    for part in _side_by_side(table):
        yield from _readings_of(part, file, time_format, begin)


def _side_by_side(table: Table) -> Iterator[Table]:
    """Yield tables that stand beside each other in one, each with stamps of its own in its first column."""
    frame = table.frame.dropna(axis="columns", how="all")
    columns = [frame.iloc[:, place] for place in range(len(frame.columns))]
    places = [place for place, each in enumerate(columns) if may_be_stamps(each) and is_stamps(each)]
    # some tables tell two times of each row, as when it began and ended: these lie beside each other
    is_several = len(places) > 1 and places[0] == 0 and min(np.diff([*places, len(frame.columns)])) > 1
    if not is_several or all(columns[places[0]].equals(columns[place]) for place in places[1:]):
        yield table
        return
    for begin, end in pairwise([*places, len(frame.columns)]):
        part = frame.iloc[:, begin:end]
        yield table._replace(frame=part[part.iloc[:, 0].notna()])


def _readings_of(
    table: Table, file: Path, time_format: str | None, begin: pd.Timestamp | None = None
) -> Iterator[Readings]:
    frame = table.frame.dropna(axis="columns", how="all")
    if not len(frame):
        raise refusal(table.where, NO_ROWS, EXPECTED)
    _refuse_turned(table)
    frame, summed = without_summaries(Table(table.where, frame))
    units, frame = units_row(frame) if len(frame) > 1 else ({}, frame)
    frame, counting = dated(Table(table.where, frame), units, time_format, begin)
    time_format = None if time_format in UNITS_OF_TIME else time_format
    time, frame = time_column(Table(table.where, _fields_with_tags(frame)))
    frame, numbered = without_row_numbers(frame, (time.strip().lower(), *VALUE))
    frame, bad, judged = without_status(Table(table.where, frame), time)
    entity = _entity_column(frame, time)
    if entity:
        frame = _told_apart(frame, time, entity)
    frame, lost = without_bad(Table(table.where, frame), bad, (time, entity or "", *_units(frame)))
    split = _long if entity else _wide
    zone = zone_told(frame[time], time_format, table.where)
    said = tuple(filter(None, (zone, counting, numbered, *judged, lost, summed, *table.notes)))
    for each in split(Table(table.where, frame), file, time, units, time_format, entity or ""):
        yield replace(each, notes=(*each.notes, *said)) if said else each


def _units(frame: pd.DataFrame) -> list[str]:
    """Return the columns that hold units."""
    return [str(name) for name in frame.columns if str(name).strip().lower() in UNIT]


def _refuse_turned(table: Table) -> None:
    """Refuse a table with a row for each sensor: its columns are stamps."""
    names = pd.Series([str(name) for name in table.frame.columns[1:]], dtype=object)
    if len(names) > 3 and is_stamps(names):
        wrong = "names its columns after stamps: it has a row for each sensor and a column for each time"
        raise refusal(table.where, wrong, "turn it round, so that each time is a row")


def _fields_with_tags(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table of InfluxDB with each field's name behind that of the sensor, where it has several of both."""
    fields = frame[FIELD].dropna().nunique() if FIELD in frame else 0
    if fields < 2:
        return frame
    lower = {str(name).strip().lower(): str(name) for name in frame.columns}
    tags = [lower[name] for name in ENTITY if name in lower and frame[lower[name]].dropna().nunique() > 1]
    names = frame[tags[0]].astype(str) + " " + frame[FIELD].astype(str) if tags else frame[FIELD]
    return frame.assign(**{FIELD: names.where(frame[FIELD].notna())}).drop(columns=tags)


def _told_apart(frame: pd.DataFrame, time: str, entity: str) -> pd.DataFrame:
    """Return a table whose names have those of another column beside them, where alone they name several sensors."""
    value = _named(VALUE, [name for name in frame.columns if name not in (time, entity)])
    rest = [name for name in frame.columns if name not in (time, entity, value, *_units(frame))]
    whole = [name for name in rest if frame[name].notna().all() and _holds_names(frame[name])]
    if not whole or frame.duplicated([time, entity]).mean() <= TWICE:
        return frame
    tell = [name for name in whole if frame.duplicated([time, entity, name]).mean() <= TWICE]
    if not tell:
        return frame
    other = min(tell, key=lambda name: frame[name].nunique())
    first, second = (name for name in frame.columns if name in (entity, other))
    names = frame[first].astype(str).str.strip() + " " + frame[second].astype(str).str.strip()
    return frame.assign(**{entity: names}).drop(columns=other)


def _read_again(table: Table, time: str, times: pd.DatetimeIndex, is_again: np.ndarray) -> tuple[str, ...]:
    """Return what is said of rows (n,) that have the stamp of another one, of which the last counts; nothing of few.

    Raises `StudyError` where stamps are days, as the time of day must stand elsewhere then.
    """
    share = float(is_again.mean())
    if share <= AGAIN:
        return ()
    days = times[is_again].tz_localize(None)
    if (days == days.normalize()).all():
        wrong = f"many rows have the stamp {table.frame[time].iloc[int(is_again.argmax())]}, which tells no time of day"
        raise refusal(table.where, wrong, "name its column 'hour' or 'time', or write it behind the day")
    return (f"{Path(table.where).name}: {share:.0%} of the rows have the stamp of another one: the last counts.",)


def _contradicting(table: Table, time: str, times: pd.DatetimeIndex) -> tuple[str, ...]:
    """Return what is said of a few rows whose stamp another one has with other readings.

    Nothing of hours that the end of summer time may repeat: one for each autumn.
    """
    again = times.duplicated(keep=False)
    hours = times[again].tz_localize(None).floor("h").unique()
    if (
        len(hours) <= 1 + (times.max() - times.min()) / pd.Timedelta(AUTUMNS_D, "D")
        or times.duplicated().mean() > AGAIN
    ):
        return ()
    rows = table.frame.drop(columns=time)[again].apply(_as_numbers)
    count = int((rows.groupby(times[again]).nunique() > 1).any(axis=1).sum())
    stamps = f"{count} stamps have" if count > 1 else "1 stamp has"
    return (f"{Path(table.where).name}: {stamps} rows that contradict each other: the last counts.",) if count else ()


def _as_numbers(column: pd.Series) -> pd.Series:
    """Return numbers, where a column's words are some: 20.10 and 20,1 are the same."""
    numbers = pd.to_numeric(column.astype(str).str.strip().str.replace(",", "."), errors="coerce")
    return numbers.astype(object).where(numbers.notna(), column)


def _entity_column(frame: pd.DataFrame, time: str) -> str | None:
    """Return the column of entities' names; None in a table with a column for each entity."""
    rest = [name for name in frame.columns if name != time]
    if FIELD in rest and frame[FIELD].nunique() > 1:
        return FIELD
    texts = [name for name in rest if _holds_names(frame[name])]
    by_name = _named(ENTITY, texts)
    if not by_name and _named(VALUE, rest):  # names may look like numbers, as 1/2/3, or be some
        by_name = _named(ENTITY, [name for name in rest if _may_be_numbered(frame, time, name)])
    if by_name:
        return by_name
    texts = [name for name in texts if str(name).strip().lower() not in UNIT]
    others = [name for name in rest if name not in (*texts, *_units(frame))]
    if len(texts) == 1 and len(others) <= 2 and frame[texts[0]].notna().all():
        is_number = any(pd.api.types.is_numeric_dtype(frame[name]) for name in others)
        if frame[texts[0]].nunique() == 1 or not is_number:
            return str(texts[0])
    return _telling(frame, time, texts)


def _may_be_numbered(frame: pd.DataFrame, time: str, name: Hashable) -> bool:
    """Whether a column may hold names: of numbers, that tells apart the rows of one stamp."""
    if not pd.api.types.is_numeric_dtype(frame[name]):
        return True
    are_several = frame.duplicated([time]).mean() > AGAIN
    return are_several and bool(frame.duplicated([time, name]).mean() <= TWICE)


def _named(words: Sequence[str], columns: Sequence[Hashable]) -> str | None:
    """Return the column that is called by the first of some words, in lower case, that one is called by."""
    lower = {str(name).strip().lower(): str(name) for name in columns}
    return next((lower[word] for word in words if word in lower), None)


def _telling(frame: pd.DataFrame, time: str, texts: Sequence[Hashable]) -> str | None:
    """Return the column of texts that tells whose readings a row has, that with the fewest names; None without one.

    By it rows of one stamp differ; or readings go in small steps, and from row to row in large ones.
    """
    whole = [name for name in texts if frame[name].notna().all()]
    if frame.duplicated([time]).mean() > AGAIN:
        tell = [name for name in whole if frame.duplicated([time, name]).mean() <= TWICE]
    else:
        tell = [name for name in whole if _are_mixed(frame, name)]
    return str(min(tell, key=lambda name: frame[name].nunique())) if tell else None


def _are_mixed(frame: pd.DataFrame, name: Hashable) -> bool:
    """Whether a column has readings of several sensors in turn, each of which goes in far smaller steps by itself."""
    for column in frame.columns[[pd.api.types.is_numeric_dtype(kind) for kind in frame.dtypes]]:
        known = frame[column].dropna()
        across = float(known.diff().abs().median())
        within = float(known.groupby(frame[name]).diff().abs().median())
        if within < MIXED * across:
            return True
    return False


def _holds_names(written: pd.Series) -> bool:
    """Whether cells are texts that are neither numbers nor states."""
    first = written.dropna().iloc[:LOOKED_AT]
    if not pd.api.types.is_string_dtype(first) and not pd.api.types.is_object_dtype(first):
        return False
    return len(first) > 0 and not any(is_value(str(cell).strip()) or _starts_as_number(str(cell)) for cell in first)


def _starts_as_number(cell: str) -> bool:
    return bool(re.match(rf"\s*{SIGN}\d+([.,]\d+)?\s*\S{{0,6}}$", cell))


def _long(
    table: Table, file: Path, time: str, units: dict[str, str], time_format: str | None, entity: str
) -> Iterator[Readings]:
    frame = table.frame
    written_as = {name: str(name).strip() for name in frame[entity].dropna().unique()}
    is_plain = all(name == plain for name, plain in written_as.items())
    names = frame[entity] if is_plain else frame[entity].map(written_as)  # a long table is mapped only if it must be
    count = len(set(written_as.values()))
    if count > MOST_ENTITIES or (count > 1 and count * REPEATED > len(frame)):
        wrong = f"column '{entity}' has {count} names in {len(frame)} rows: it names no sensors"
        raise refusal(table.where, wrong, EXPECTED)
    values = _value_columns(table, time, entity)
    unit = next(iter(_units(frame)), None)
    times = _at_ends(stamps_of(frame[time], time_format, table.where), frame, time)
    groups = frame.groupby(names, sort=True, observed=True).indices
    is_again = np.zeros(len(frame), dtype=bool)
    for places in groups.values():
        is_again[places] = times[places].duplicated()
    notes = _read_again(table, time, times, is_again)
    frame = frame.drop(columns=time)
    for name, places in groups.items():
        rows = frame.iloc[places]
        told = _unit_told(Table(table.where, rows), unit, str(name))
        if len(values) == 1:
            yield Readings(str(name), table.where, times[places], rows[values[0]], told, notes=notes)
            continue
        for value in values:
            what, own_unit = parted(value)
            is_there = rows[value].notna().to_numpy()
            own_unit = units.get(value, own_unit or told)
            at = times[places][is_there]
            yield Readings(f"{name} {what}", table.where, at, rows.loc[is_there, value], own_unit, notes=notes)


def _unit_told(table: Table, column: str | None, entity: str) -> str:
    """Return the unit that a column tells of an entity, "" for none; raise `StudyError` for several."""
    written = [str(unit).strip() for unit in table.frame[column].dropna().unique()] if column else []
    told = {plain_unit(unit): unit for unit in written if unit}
    if len(told) > 1:
        wrong = f"{entity} has readings in {listed(sorted(told.values()))}"
        raise refusal(table.where, wrong, "import what has one unit")
    return next(iter(told.values()), "")


def _value_columns(table: Table, time: str, entity: str) -> list[str]:
    """Return the column of readings, or several of which each names what it holds."""
    rest = [str(name) for name in table.frame.columns if name not in (time, entity)]
    by_name = _named(VALUE, rest)
    others = [name for name in rest if name not in _units(table.frame)]
    if by_name or len(others) == 1:
        return [by_name or others[0]]
    found = [name for name in others if numbers_of(table.frame[name].dropna()).is_readable]
    if not found:
        wrong = f"has a row for each reading, and no column of values (columns: {named(table.frame)})"
        raise refusal(table.where, wrong, f"name it one of {', '.join(VALUE)}")
    return found


def _wide(
    table: Table, file: Path, time: str, units: dict[str, str], time_format: str | None, entity: str
) -> Iterator[Readings]:
    frame = table.frame
    rest = [str(name) for name in frame.columns if name != time]
    if len(rest) > MOST_ENTITIES:
        raise refusal(table.where, f"has {len(rest)} columns beside the stamps", EXPECTED)
    if not rest:
        raise refusal(table.where, "has stamps and no readings", EXPECTED)
    times = _at_ends(stamps_of(frame[time], time_format, table.where), frame, time)
    notes = (*_read_again(table, time, times, times.duplicated()), *_contradicting(table, time, times))
    of_units = _units(frame)
    unit_of_all = _unit_told(table, next(iter(of_units), None), " ".join(each for each in rest if each not in of_units))
    parts = {column: parted(column) for column in rest if column not in of_units}
    count = Counter(name for name, _ in parts.values())
    for column, (name, unit) in parts.items():
        name = name if count[name] == 1 else column
        if name.lower() in VALUE or (len(rest) == 1 and (not name or PLACED.fullmatch(name))):
            name = _named_after(file)
        is_there = frame[column].notna().to_numpy()
        unit = units.get(column, unit or unit_of_all)
        yield Readings(name, table.where, times[is_there], frame.loc[is_there, column], unit, notes=notes)


def _at_ends(times: pd.DatetimeIndex, frame: pd.DataFrame, time: str) -> pd.DatetimeIndex:
    """Return the ends of means that are stamped at their starts, as those of Home Assistant's statistics."""
    if time.strip().lower() not in START or MEAN not in (str(name).strip().lower() for name in frame.columns):
        return times
    steps = times.unique().sort_values().diff().dropna()
    return times + steps.value_counts().index[0] if len(steps) else times


def _named_after(file: Path) -> str:
    """Return what a file is named after, without its ending and the days that stand behind it."""
    name = without_ending(file)
    return DATED.sub("", name).strip() or name


def without_ending(file: Path) -> str:
    name = file.name.removesuffix(".gz")
    return name.rpartition(".")[0] or name
