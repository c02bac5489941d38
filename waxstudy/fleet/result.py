"""What an activation left in its folder."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from waxstudy.fleet.folder import BATCHES, LOOPS, MANIFEST, RESPONSE
from waxstudy.fleet.response import Band
from waxstudy.fleet.summary import Row
from waxstudy.plugin.files import check_file, read_file, why
from waxstudy.results.folder import RunError

FORMAT = 1


@dataclass(frozen=True)
class Activated:
    """A finished activation; raises `RunError` where a table of it cannot be read."""

    folder: Path
    study: str
    said: dict[str, Any]  # as `[activation]` does, defaults filled in
    rows: list[Row]
    warnings: list[str]
    provenance: dict[str, Any]
    comfort_limit_C: float
    rooms: int  # that the loops share

    @property
    def table(self) -> pd.DataFrame:
        """A row for each week, state and call, bands as columns NAME_low and NAME_high."""
        return pd.DataFrame([dict(_flat(row)) for row in self.rows])

    @property
    def response(self) -> pd.DataFrame:
        """The whole fleet over time after each call, with bands."""
        return self._read(RESPONSE)

    @property
    def loops(self) -> pd.DataFrame:
        """A row for each loop, week, state and call."""
        return self._read(LOOPS)

    def _read(self, name: str) -> pd.DataFrame:
        path = self.folder / name
        try:
            check_file(path)
            return pd.read_parquet(path)
        except (OSError, ValueError) as error:
            raise RunError(f"{path}: cannot be read: {why(error)}; run the study again") from error

    def _repr_html_(self) -> str:
        return str(self.table.to_html())


def _flat(row: Row) -> Any:
    for name, value in vars(row).items():
        if isinstance(value, Band):
            yield from ((name, value.value), (f"{name}_low", value.low), (f"{name}_high", value.high))
        else:
            yield name, value


def read_activated(folder: Path) -> Activated:
    """Read what an activation left in a folder; raise `RunError` if it is not one, or not finished."""
    try:
        said = json.loads(read_file(folder / MANIFEST))
        if said["format"] > FORMAT:
            raise RunError(f"{folder}: format {said['format']}; this version reads up to {FORMAT}")
        return Activated(
            folder,
            said["study"],
            said["activation"],
            [_row(row) for row in said["table"]],
            said["warnings"],
            said["provenance"],
            said["comfort_limit_C"],
            said["rooms"],
        )
    except FileNotFoundError:
        held = "one that has not finished: run it again, it goes on" if (folder / BATCHES).is_dir() else "none"
        raise RunError(f"{folder}: an activation is asked for; it holds {held}") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise RunError(f"{folder / MANIFEST}: cannot be read: {why(error)}") from error


def _row(stated: dict[str, Any]) -> Row:
    made: dict[str, Any] = {
        name: Band(**_read(value)) if isinstance(value, dict) else value for name, value in stated.items()
    }
    return Row(**_read(made))


def _read(stated: dict[str, Any]) -> dict[str, Any]:
    """Return values with NaN where the file has null."""
    return {name: math.nan if value is None else value for name, value in stated.items()}
