"""A record of a loop, from a folder or from a frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import tomli_w

from waxstudy.dataset import read
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.tables import TRUSTED
from waxstudy.dataset.zones import is_zone
from waxstudy.importing.units import conversion
from waxstudy.importing.zone import standard_time
from waxstudy.plugin.files import read_file
from waxstudy.plugin.registry import hint
from waxstudy.results.atomic import scratch_folder
from waxstudy.study.problems import Problem, StudyError


@dataclass(frozen=True, repr=False)
class Dataset(read.Dataset):
    """A checked record on a regular grid, and what is believed of its loop (docs/datasets.md)."""

    @classmethod
    def read(cls, folder: str | Path) -> Dataset:
        """Read a folder with dataset.toml and data.csv; raises `StudyError` with every problem."""
        return cls(**vars(read.read_dataset(Path(folder))))

    @classmethod
    def from_frame(
        cls,
        frame: pd.DataFrame,
        *,
        believed: Mapping[str, Any] | str | Path,
        room: Mapping[str, Any] | None = None,
        units: Mapping[str, str] | None = None,
        timezone: str | None = None,
        columns: Mapping[str, str] | None = None,
        **tables: Mapping[str, Any],
    ) -> Dataset:
        """Return a frame's record, checked as a folder's is; raises `StudyError` with every problem.

        The index is the time at the end of each interval, in local standard time, or in any zone if it says which;
        `timezone` takes summer time out. Columns are named as channels, or `columns` says which channel is which
        column. `units` are those of the frame's columns, by default those of the channels. `believed` is [nominal],
        or a dataset.toml to take it, the room, and how far it is trusted from; `room` is [room], or [building] if it
        has a `floor_area_m2`. Other tables go by their name, such as `dataset={"room_tolerance": 2.0}`: what they say
        counts before what the file does.
        """
        values, times = _named(_in_channel_units(frame, units or {}, columns or {}), columns or {}), _times(frame)
        described = _described(believed, room, tables)
        if timezone is None and times.tz is not None:
            timezone = described.get("site", {}).get("timezone")
        values.index = standard_time(times, timezone).rename("time")
        zone = timezone or str(times.tz)
        if "site" in described and is_zone(zone):
            described["site"] = {"timezone": zone, **described["site"]}
        described["dataset"] = {"name": "frame", **described.get("dataset", {})}
        with scratch_folder("waxstudy-frame-") as folder:
            values.to_csv(folder / "data.csv", date_format="%Y-%m-%dT%H:%M:%S")
            (folder / "dataset.toml").write_bytes(tomli_w.dumps(described).encode())
            return cls.read(folder)


def _times(frame: pd.DataFrame) -> pd.DatetimeIndex:
    if not isinstance(frame.index, pd.DatetimeIndex):
        raise _refusal("index", "the time of each row is expected there", "set_index() with a column of times")
    return frame.index


def _named(frame: pd.DataFrame, columns: Mapping[str, str]) -> pd.DataFrame:
    """Return a frame whose columns are named as the channels that they are; two channels may be one column."""
    rest = [name for name in frame if name not in {*columns, *columns.values()}]
    return frame[[*columns.values(), *rest]].set_axis([*columns, *rest], axis="columns")


def _in_channel_units(frame: pd.DataFrame, units: Mapping[str, str], columns: Mapping[str, str]) -> pd.DataFrame:
    frame = frame.copy()
    channels = {column: channel for channel, column in columns.items()}
    for channel, name in columns.items():
        if channel not in CHANNELS:
            raise _refusal(channel, f"is no channel{hint(channel, CHANNELS)}", "columns={CHANNEL: COLUMN}")
        if name not in frame:
            raise _refusal(channel, f"is to be column '{name}', but the frame has no such column", _there(frame))
    for name, unit in _by_column(frame, units, columns).items():
        channel = channels.get(name, name)
        if channel not in CHANNELS:
            raise _refusal(name, "is no channel", "columns={CHANNEL: COLUMN} says which it is")
        try:
            found = conversion(unit, CHANNELS[channel].quantity)
        except ValueError as error:
            raise _refusal(name, str(error)) from error
        if found is None or found.is_counter:
            raise _refusal(name, f"'{unit}' is no unit of it", f"as {CHANNELS[channel].unit}")
        frame[name] = frame[name] * found.scale + found.offset
    return frame


def _by_column(frame: pd.DataFrame, units: Mapping[str, str], columns: Mapping[str, str]) -> dict[str, str]:
    """Return the unit of each column, which may be told by its own name or by that of a channel."""
    told: dict[str, str] = {}
    for key, unit in units.items():
        name = key if key in frame else columns.get(key, key)
        if name not in frame:
            raise _refusal(name, "has a unit, but the frame has no such column", _there(frame))
        if told.setdefault(name, unit) != unit:
            raise _refusal(name, f"is said to be in '{told[name]}' and in '{unit}'")
    return told


def _there(frame: pd.DataFrame) -> str:
    return f"its columns: {', '.join(map(str, frame))}"


def _described(
    believed: Mapping[str, Any] | str | Path, room: Mapping[str, Any] | None, tables: Mapping[str, Mapping[str, Any]]
) -> dict[str, Any]:
    described = {"nominal": dict(believed)} if isinstance(believed, Mapping) else _stated(Path(believed))
    if room is not None:
        for name in ("room", "building"):
            described.pop(name, None)
        described["building" if "floor_area_m2" in room else "room"] = dict(room)
    return described | {name: {**described.get(name, {}), **table} for name, table in tables.items()}


def _stated(path: Path) -> dict[str, Any]:
    """Return what another dataset believes of its loop, and how far."""
    import tomllib

    try:
        known = tomllib.loads(read_file(path).decode("utf-8-sig"))
    except (OSError, ValueError) as error:
        raise _refusal("believed", f"{path} cannot be read: {error}") from error
    about = known.get("dataset", {})
    found = {name: known[name] for name in ("nominal", "room", "building", "site") if name in known}
    return found | {"dataset": {name: about[name] for name in TRUSTED if name in about}}


def _refusal(key: str, wrong: str, allowed: str = "") -> StudyError:
    return StudyError([Problem("frame", 0, "", key, "", wrong, allowed=allowed)])
