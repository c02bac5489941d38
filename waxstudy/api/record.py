"""A record of a loop, from a folder or from a frame."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd
import tomli_w

from waxstudy.dataset import read
from waxstudy.dataset.channels import CHANNELS
from waxstudy.importing.units import conversion
from waxstudy.importing.zone import standard_time
from waxstudy.plugin.files import read_file
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
        or a dataset.toml to take it and the room from; `room` is [room], or [building] if it has an `area_m2`.
        Other tables go by their name, such as `dataset={"room_tolerance": 2.0}`.
        """
        named = {column: channel for channel, column in (columns or {}).items()}
        values = _in_channel_units(frame.rename(columns=named), {named.get(k, k): u for k, u in (units or {}).items()})
        values.index = standard_time(_times(frame), timezone).rename("time")
        described = _described(believed, room, tables)
        described["dataset"] = {"name": "frame", **described.get("dataset", {})}
        with tempfile.TemporaryDirectory(prefix="waxstudy-record-") as place:
            folder = Path(place)
            values.to_csv(folder / "data.csv", date_format="%Y-%m-%dT%H:%M:%S")
            (folder / "dataset.toml").write_bytes(tomli_w.dumps(described).encode())
            return cls.read(folder)


def _times(frame: pd.DataFrame) -> pd.DatetimeIndex:
    if not isinstance(frame.index, pd.DatetimeIndex):
        raise _refusal("index", "the time of each row is expected there", "set_index() with a column of times")
    return frame.index


def _in_channel_units(frame: pd.DataFrame, units: Mapping[str, str]) -> pd.DataFrame:
    frame = frame.copy()
    for name, unit in units.items():
        if name not in frame:
            raise _refusal(
                name, "has a unit, but the frame has no such column", f"its columns: {', '.join(map(str, frame))}"
            )
        if name not in CHANNELS:
            raise _refusal(name, "is no channel", "columns={CHANNEL: COLUMN} says which it is")
        try:
            found = conversion(unit, CHANNELS[name].quantity)
        except ValueError as error:
            raise _refusal(name, str(error)) from error
        if found is None or found.is_counter:
            raise _refusal(name, f"'{unit}' is no unit of it", f"as {CHANNELS[name].unit}")
        frame[name] = frame[name] * found.scale + found.offset
    return frame


def _described(
    believed: Mapping[str, Any] | str | Path, room: Mapping[str, Any] | None, tables: Mapping[str, Mapping[str, Any]]
) -> dict[str, Any]:
    described: dict[str, Any] = {name: dict(table) for name, table in tables.items()}
    if isinstance(believed, Mapping):
        described["nominal"] = dict(believed)
    else:
        described |= _stated(Path(believed))
    if room is not None:
        for name in ("room", "building"):
            described.pop(name, None)
        described["building" if "area_m2" in room else "room"] = dict(room)
    return described


def _stated(path: Path) -> dict[str, Any]:
    """Return what another dataset believes of its loop."""
    import tomllib

    try:
        known = tomllib.loads(read_file(path).decode())
    except (OSError, ValueError) as error:
        raise _refusal("believed", f"{path} cannot be read: {error}") from error
    return {name: known[name] for name in ("nominal", "room", "building", "site") if name in known}


def _refusal(key: str, wrong: str, allowed: str = "") -> StudyError:
    return StudyError([Problem("frame", 0, "", key, "", wrong, allowed=allowed)])
