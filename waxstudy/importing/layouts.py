"""Layouts: a table with a column for each entity, or with a row for each reading; columns in any order."""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pandas as pd

from waxstudy.dataset.columns import named
from waxstudy.importing.limits import LOOKED_AT, MOST_ENTITIES, REPEATED, SPREADSHEET_DAYS
from waxstudy.importing.reading import Readings, Table, refusal
from waxstudy.importing.stamps import is_stamps, stamps_of, zone_told
from waxstudy.importing.units import WRITTEN
from waxstudy.importing.words import is_told_in_words

# names of columns, in lower case; what is not named so is told by what it holds
TIME = ("time", "timestamp", "datetime", "last_changed", "last_updated", "date_time", "zeit", "zeitstempel", "_time",
        "date", "datum", "ts", "epoch", "when", "last_changed_ts", "last_updated_ts")  # fmt: skip
ENTITY = ("entity_id", "entity", "sensor", "sensor_id", "name", "tag", "variable", "channel", "point", "series",
          "metric", "device", "id", "friendly_name", "topic", "messstelle", "statistic_id", "item")  # fmt: skip
VALUE = ("state", "value", "_value", "reading", "mean", "wert", "val", "messwert", "measurement")
UNIT = ("unit", "unit_of_measurement", "units", "einheit", "_unit")
FIELD = "_field"  # of InfluxDB
START, MEAN = ("start", "start_ts"), "mean"  # of Home Assistant's statistics
DAY = ("date", "datum", "day", "tag")
CLOCK = re.compile(r"\s*\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?\s*([AaPp][Mm])?\s*")
BRACKETED = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\])]*)[\])]\s*$")
SLASHED = re.compile(r"^(?P<name>.+?)\s+/\s+(?P<unit>\S+)$")
NO_CLOCK = r"[ T]00:00(:00(\.0+)?)?$"  # as a workbook's days have
NO_TABLES = {
    re.compile(r"^\s*[{\[]"): "JSON",
    re.compile(r"^\S+[, ]\S.*=\S+ \d{10,19}$"): "InfluxDB's line protocol",
}
EXPECTED = (
    "expected is a column of stamps, and either a column for each sensor, or one of names, one of values; "
    "units may stand in the row below the names"
)


def readings_of(table: Table, file: Path, time_format: str | None) -> Iterator[Readings]:
    """Yield what a table says of each entity, in the order of its columns; raise `StudyError` for another layout."""
    frame = table.frame.dropna(axis="columns", how="all")
    if len(frame) < 2:
        raise refusal(table.where, "holds less than two rows of readings", EXPECTED)
    _refuse_turned(table)
    units, frame = _units_row(frame)
    time, frame = _time_column(Table(table.where, _fields_with_tags(frame)))
    entity = _entity_column(frame, time)
    split = _long if entity else _wide
    told = zone_told(frame[time], time_format, table.where)
    for each in split(Table(table.where, frame), file, time, units, time_format, entity or ""):
        yield replace(each, notes=(*each.notes, told)) if told else each


def _refuse_turned(table: Table) -> None:
    """Refuse a table with a row for each sensor: its columns are stamps."""
    names = pd.Series([str(name) for name in table.frame.columns[1:]], dtype=object)
    if len(names) > 3 and is_stamps(names):
        wrong = "names its columns after stamps: it has a row for each sensor and a column for each time"
        raise refusal(table.where, wrong, "turn it round, so that each time is a row")


def _units_row(frame: pd.DataFrame) -> tuple[dict[str, str], pd.DataFrame]:
    """Return the units of a row below the names, if there is one, and the table without it."""
    first = frame.iloc[0]
    told = {name: str(cell).strip() for name, cell in first.items() if isinstance(cell, str) and str(cell).strip()}
    others = [name for name in frame.columns if name not in told and pd.notna(first[name])]
    is_row = told and not others and not any(_is_value(cell) for cell in told.values())
    is_row = is_row and not is_stamps(first.astype(object).dropna().astype(str)) and _is_unlike(frame, told)
    if not is_row:
        return {}, frame
    rest = frame.iloc[1:]
    return {str(name): unit.strip("[]()") for name, unit in told.items()}, rest.infer_objects()


def _is_value(cell: str) -> bool:
    if cell.lower() in WRITTEN and not cell.isdigit():
        return False
    begins_as_number = re.fullmatch(r"[-+]?[.,]?\d[\d.,:eE \-/TZ+]*", cell)  # T1 and E2 are names
    return begins_as_number is not None or is_told_in_words(cell)


def _is_unlike(frame: pd.DataFrame, told: dict[Hashable, str]) -> bool:
    """Whether the cells are of another kind than those below them."""
    second = dict(frame.iloc[1])
    return any(not isinstance(second[name], str) or _is_value(str(second[name])) for name in told)


# --- time ---------------------------------------------------------------------------------------------


def _time_column(table: Table) -> tuple[str, pd.DataFrame]:
    """Return the name of the column of stamps, and the table with a day and a time of day put together."""
    frame = table.frame
    lower = {str(name).strip().lower(): str(name) for name in frame.columns}
    by_name = [lower[name] for name in TIME if name in lower]
    for name in [*by_name, *(str(name) for name in frame.columns if name not in by_name)]:
        if not is_stamps(frame[name], name if name in by_name else ""):
            continue
        clock = next((each for each in frame.columns if each != name and _is_clock(frame[each])), None)
        if clock is None or not _is_day(frame[name]):
            return name, frame
        return name, _day_and_clock(frame, name, clock)
    clock = next((str(name) for name in frame.columns if _is_clock(frame[name])), None)
    day = next((lower[name] for name in DAY if name in lower and lower[name] != clock), None)
    if clock and day:  # nobody can tell days from months, or the format must be said
        return day, _day_and_clock(frame, day, clock)
    if by_name and not pd.api.types.is_numeric_dtype(frame[by_name[0]]):
        return by_name[0], frame  # whose first bad cell is told where stamps are read
    if by_name and (days := frame[by_name[0]].dropna()).between(*SPREADSHEET_DAYS).all() and len(days):
        wrong = f"no column holds stamps: '{by_name[0]}' has numbers, such as {days.iloc[0]}"
        raise refusal(table.where, wrong, "if they count days, as a spreadsheet does, write them as 2024-01-31 12:00")
    first = ",".join(map(str, frame.columns))
    for form, what in NO_TABLES.items():
        if form.search(first):
            raise refusal(table.where, f"is no table: it holds {what}", "export a table, with a row for each time")
    raise refusal(table.where, f"no column holds stamps (columns: {named(frame)})", EXPECTED)


def _day_and_clock(frame: pd.DataFrame, day: str, clock: Hashable) -> pd.DataFrame:
    """Return a table whose column of days has the time of day behind them."""
    days = frame[day].astype(str).str.strip().str.replace(NO_CLOCK, "", regex=True)
    both = days + " " + frame[clock].astype(str).str.strip()
    return frame.assign(**{day: both}).drop(columns=[clock])


def _is_clock(written: pd.Series) -> bool:
    first = written.dropna().iloc[:LOOKED_AT].astype(str)
    return len(first) > 0 and bool(first.str.fullmatch(CLOCK).all())


def _is_day(written: pd.Series) -> bool:
    first = written.dropna().iloc[:LOOKED_AT].astype(str)
    return not first.str.contains(":").any() or bool(first.str.contains(" 00:00:00").all())


# --- layouts ------------------------------------------------------------------------------------------


def _fields_with_tags(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table of InfluxDB with each field's name behind that of the sensor, where it has several of both."""
    fields = frame[FIELD].dropna().nunique() if FIELD in frame else 0
    if fields < 2:
        return frame
    lower = {str(name).strip().lower(): str(name) for name in frame.columns}
    tags = [lower[name] for name in ENTITY if name in lower and frame[lower[name]].dropna().nunique() > 1]
    names = frame[tags[0]].astype(str) + " " + frame[FIELD].astype(str) if tags else frame[FIELD]
    return frame.assign(**{FIELD: names.where(frame[FIELD].notna())}).drop(columns=tags)


def _entity_column(frame: pd.DataFrame, time: str) -> str | None:
    """Return the column of entities' names; None in a table with a column for each entity."""
    rest = [name for name in frame.columns if name != time]
    if FIELD in rest and frame[FIELD].nunique() > 1:
        return FIELD
    texts = [name for name in rest if _holds_names(frame[name])]
    lower = {str(name).strip().lower(): str(name) for name in texts}
    by_name = next((lower[name] for name in ENTITY if name in lower), None)
    if by_name:
        return by_name
    texts = [name for name in texts if str(name).strip().lower() not in UNIT]
    return str(texts[0]) if len(texts) == 1 and len(rest) - len(texts) <= 2 else None


def _holds_names(written: pd.Series) -> bool:
    """Whether cells are texts that are neither numbers nor states."""
    first = written.dropna().iloc[:LOOKED_AT]
    if not pd.api.types.is_string_dtype(first) and not pd.api.types.is_object_dtype(first):
        return False
    return len(first) > 0 and not any(_is_value(str(cell).strip()) or _starts_as_number(str(cell)) for cell in first)


def _starts_as_number(cell: str) -> bool:
    return bool(re.match(r"\s*[-+]?\d+([.,]\d+)?\s*\S{0,6}$", cell))


def _long(
    table: Table, file: Path, time: str, units: dict[str, str], time_format: str | None, entity: str
) -> Iterator[Readings]:
    frame = table.frame
    written_as = {name: str(name).strip() for name in frame[entity].dropna().unique()}
    is_plain = all(name == plain for name, plain in written_as.items())
    names = frame[entity] if is_plain else frame[entity].map(written_as)  # a long table is mapped only if it must be
    count = len(set(written_as.values()))
    if count > MOST_ENTITIES or count * REPEATED > len(frame):
        wrong = f"column '{entity}' has {count} names in {len(frame)} rows: it names no sensors"
        raise refusal(table.where, wrong, EXPECTED)
    value = _value_column(table, time, entity)
    unit = next((str(name) for name in frame.columns if str(name).strip().lower() in UNIT), None)
    times = _at_ends(stamps_of(frame[time], time_format, table.where), frame, time)
    frame = frame.drop(columns=time)
    for name, places in frame.groupby(names, sort=True, observed=True).indices.items():
        rows = frame.iloc[places]
        written = rows[unit].dropna() if unit else pd.Series(dtype=object)
        told = str(written.iloc[0]).strip() if len(written) else ""
        yield Readings(str(name), table.where, times[places], rows[value], told)


def _value_column(table: Table, time: str, entity: str) -> str:
    rest = [str(name) for name in table.frame.columns if name not in (time, entity)]
    lower = {name.strip().lower(): name for name in rest}
    by_name = next((lower[name] for name in VALUE if name in lower), None)
    others = [name for name in rest if name.strip().lower() not in UNIT]
    if by_name is None and len(others) != 1:
        wrong = f"has a row for each reading, and no column of values (columns: {named(table.frame)})"
        raise refusal(table.where, wrong, f"name it one of {', '.join(VALUE)}")
    return by_name or others[0]


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
    unit_of_all = next((str(frame[name].dropna().iloc[0]) for name in rest if name.strip().lower() in UNIT), "")
    for column in rest:
        if column.strip().lower() in UNIT:
            continue
        name, unit = parted(column)
        if name.lower() in VALUE or (len(rest) == 1 and not name):
            name = file.name.partition(".")[0].strip()  # a file of one sensor is named after it
        is_there = frame[column].notna().to_numpy()
        yield Readings(
            name, table.where, times[is_there], frame.loc[is_there, column], units.get(column, unit or unit_of_all)
        )


def _at_ends(times: pd.DatetimeIndex, frame: pd.DataFrame, time: str) -> pd.DatetimeIndex:
    """Return the ends of means that are stamped at their starts, as those of Home Assistant's statistics."""
    if time.strip().lower() not in START or MEAN not in (str(name).strip().lower() for name in frame.columns):
        return times
    steps = times.unique().sort_values().diff().dropna()
    return times + steps.value_counts().index[0] if len(steps) else times


def parted(column: str) -> tuple[str, str]:
    """Return a column's name without the unit that stands behind it, and the unit.

    >>> parted("T_room [degF]"), parted("Flow / L/min"), parted("Valve")
    (('T_room', 'degF'), ('Flow', 'L/min'), ('Valve', ''))
    """
    found = BRACKETED.match(column) or SLASHED.match(column)
    return (found["name"].strip(), found["unit"].strip()) if found else (column.strip(), "")


def joined(found: Sequence[Readings]) -> list[Readings]:
    """Return readings of one entity in several files as one; what overlaps in time is told apart by the file's name."""
    by_entity: dict[str, list[Readings]] = {}
    for each in found:
        by_entity.setdefault(each.entity, []).append(each)
    whole: list[Readings] = []
    for entity, parts in by_entity.items():
        parts = [each for each in parts if len(each.times)]
        whole += _in_turn(entity, parts) if len(parts) > 1 else parts
    return whole


def _in_turn(entity: str, parts: list[Readings]) -> list[Readings]:
    parts = sorted(parts, key=lambda each: each.times.min())
    if any(later.times.min() < former.times.max() for former, later in pairwise(parts)):
        return [replace(each, entity=f"{_stem(each.where)}/{entity}") for each in parts]
    if len(names := {each.unit for each in parts}) > 1:
        units = ", ".join(f"'{each.unit}' in {each.where}" for each in parts)
        raise refusal(parts[0].where, f"{entity} has {len(names)} units: {units}", "import what has one unit")
    times = pd.DatetimeIndex(parts[0].times.append([each.times for each in parts[1:]]))
    written = pd.concat([each.written.astype(object) for each in parts])
    once = ~times.duplicated(keep="last")  # a file may begin with the last row of the one before
    return [replace(parts[0], times=times[once], written=written[once])]


def _stem(where: str) -> str:
    """Return a file's name without its ending, and its sheet or table."""
    path, _, part = where.partition(", ")
    return Path(path).name.partition(".")[0] + (f" ({part})" if part else "")
