"""SQLite databases: the history of Home Assistant, or tables that are read as those of text are."""

from __future__ import annotations

import json
import shutil
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pandas as pd

from waxstudy.importing.reading import Readings, Table, refusal
from waxstudy.plugin.files import check_file
from waxstudy.results.atomic import scratch_folder

LOCK_S = 2.0  # that is waited for another program's lock
JOURNAL = slice(18, 20)  # of the file: 2 where what was written last lies in a file beside it
SHORT_S, LONG_S = 300.0, 3600.0  # intervals of the two tables of statistics
CLIMATE = "climate."
# of a thermostat: attributes that are readings of their own, with a name that says what they are
ATTRIBUTES = {
    "current_temperature": "current_temperature",
    "temperature": "setpoint",
    "hvac_action": "hvac_action",
}


def read_history(path: Path, where: str) -> Iterator[Table | Readings]:
    """Yield the readings of a database, or its tables; raise `StudyError` where it is locked or damaged.

    The database is opened for reading only. One whose last readings lie beside it is read from a copy, as a reader of
    it would write files there.
    """
    try:
        with path.open("rb") as file:
            is_beside = file.read(JOURNAL.stop)[JOURNAL] == b"\x02\x02"
        if not is_beside:
            yield from _read(path, where)
            return
        with scratch_folder("waxstudy-import-") as folder:
            for each in (path, path.with_name(f"{path.name}-wal")):
                if each.is_file():
                    check_file(each)
                    shutil.copyfile(each, folder / each.name)
            yield from _read(folder / path.name, where)
    except (sqlite3.Error, pd.errors.DatabaseError) as error:
        if "locked" in str(error) or "busy" in str(error):
            mend = "close the program that writes it, or copy it: sqlite3 FILE '.backup copy.db'"
            raise refusal(where, "the database is locked by another program", mend) from error
        raise refusal(where, f"is no whole database: {error}", "copy it again while nothing writes it") from error


def _read(path: Path, where: str) -> Iterator[Table | Readings]:
    with closing(sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True, timeout=LOCK_S)) as base:
        base.execute("pragma trusted_schema = off")  # the file may be anybody's
        names = {name for (name,) in base.execute("select name from sqlite_master where type = 'table'")}
        if "states_meta" in names or "statistics_meta" in names:
            yield from _home_assistant(base, names, where)
            return
        tables = [table for name in sorted(names) if (table := _plain(base, name, where)) is not None]
        if not tables:
            raise refusal(where, "no table of this database holds a history", "tables: " + ", ".join(sorted(names)))
        yield from tables


def _plain(base: sqlite3.Connection, name: str, where: str) -> Table | None:
    quoted = '"' + name.replace('"', '""') + '"'
    frame = pd.read_sql_query(f"select * from {quoted}", base)
    frame.index = frame.index + 1
    return Table(f"{where}, table '{name}'", frame) if len(frame) > 1 and len(frame.columns) > 1 else None


def _home_assistant(base: sqlite3.Connection, names: set[str], where: str) -> Iterator[Readings]:
    found: set[str] = set()
    if {"states", "states_meta"} <= names:
        for readings in _states(base, names, f"{where}, table 'states'"):
            found.add(readings.entity)
            yield readings
    if {"statistics", "statistics_meta"} <= names:
        for readings in _statistics(base, names, where):
            if readings.entity not in found:  # means of hours say less than the states
                yield readings
                found.add(readings.entity)
    if not found:
        raise refusal(where, "the history is empty: no state and no statistics in it")


def _states(base: sqlite3.Connection, names: set[str], where: str) -> Iterator[Readings]:
    has_attributes = "state_attributes" in names
    attributes = "shared_attrs" if has_attributes else "null"
    join = "left join state_attributes using (attributes_id)" if has_attributes else ""
    last = (
        f"(select {attributes} from states s {join} where s.metadata_id = m.metadata_id order by state_id desc limit 1)"
    )
    entities = base.execute(f"select metadata_id, entity_id, {last} from states_meta m order by entity_id").fetchall()
    for key, entity, attrs in entities:
        query = "select state_id, last_updated_ts, state from states where metadata_id = ? order by last_updated_ts"
        frame = pd.read_sql_query(query, base, params=(key,), index_col="state_id").dropna(subset="last_updated_ts")
        if len(frame):
            unit = _attributes(attrs).get("unit_of_measurement", "")
            yield Readings(entity, where, _utc(frame["last_updated_ts"]), frame["state"], str(unit or ""))
        if has_attributes and entity.startswith(CLIMATE):
            yield from _thermostat(base, key, entity, where)


def _thermostat(base: sqlite3.Connection, key: int, entity: str, where: str) -> Iterator[Readings]:
    query = (
        "select state_id, last_updated_ts, shared_attrs from states join state_attributes using (attributes_id) "
        "where metadata_id = ? order by last_updated_ts"
    )
    frame = pd.read_sql_query(query, base, params=(key,), index_col="state_id")
    told = pd.DataFrame([_attributes(each) for each in frame["shared_attrs"]], index=frame.index)
    for attribute, name in ATTRIBUTES.items():
        if attribute in told and (values := told[attribute].dropna()).size:
            times = _utc(frame["last_updated_ts"][values.index])
            yield Readings(f"{entity}:{name}", where, times, values.astype(str))


def _statistics(base: sqlite3.Connection, names: set[str], where: str) -> Iterator[Readings]:
    tables = [("statistics_short_term", SHORT_S)] * ("statistics_short_term" in names) + [("statistics", LONG_S)]
    meta = base.execute(
        "select id, statistic_id, unit_of_measurement, has_sum from statistics_meta order by 2"
    ).fetchall()
    for key, entity, unit, is_counter in meta:
        for table, interval_s in tables:
            column = "sum" if is_counter else "mean"
            query = f"select id, start_ts, {column} as value from {table} where metadata_id = ? order by start_ts"
            frame = pd.read_sql_query(query, base, params=(key,), index_col="id").dropna()
            if len(frame):
                ends = _utc(frame["start_ts"] + interval_s)
                said = f"{entity}: means of {interval_s:g} s, of the table '{table}'"
                place = f"{where}, table '{table}'"
                yield Readings(entity, place, ends, frame["value"], str(unit or ""), not is_counter, (said,))
                break


def _utc(seconds: pd.Series) -> pd.DatetimeIndex:
    ns = (seconds.to_numpy(dtype=float) * 1e6).round().astype("int64") * 1000
    return pd.DatetimeIndex(ns).tz_localize("UTC")


def _attributes(text: object) -> dict[str, object]:
    try:
        found = json.loads(str(text))
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}
