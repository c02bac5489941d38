"""The folder of a finished sweep, format 1.

sweep.json       study, method, keys and ranges, and which points failed and why; written last
sweep.parquet    a row for each point, case, week and member: the point's parameters, then its key figures
points/          what a sweep that was interrupted goes on from
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from waxstudy.plugin.files import check_file, read_file, why
from waxstudy.results.folder import RunError
from waxstudy.sweeps.axes import Range

TABLE, MANIFEST, POINTS = "sweep.parquet", "sweep.json", "points"
FORMAT = 1


@dataclass(frozen=True)
class Swept:
    """A finished sweep; `failed` tells of points that are not in the table."""

    folder: Path
    study: str
    method: str
    keys: tuple[str, ...]
    ranges: dict[str, Range]
    points: int
    failed: dict[int, str]

    @property
    def file(self) -> Path:
        """Where the table is."""
        return self.folder / TABLE

    @property
    def frame(self) -> pd.DataFrame:
        """A row for each point, case, week and member; raises `RunError`."""
        try:
            check_file(self.file)
            return pd.read_parquet(self.file)
        except (OSError, ValueError) as error:
            raise RunError(f"{self.file}: cannot be read: {why(error)}; run the sweep again") from error


def read_swept(folder: Path) -> Swept:
    """Read what a sweep left in a folder; raise `RunError` if it is not one, or not finished."""
    try:
        said = json.loads(read_file(folder / MANIFEST))
        if said["format"] > FORMAT:
            raise RunError(f"{folder}: format {said['format']}; this version reads up to {FORMAT}")
        ranges = {key: Range(*bounds) for key, bounds in said["ranges"].items()}
        failed = {int(number): str(reason) for number, reason in said["failed"].items()}
        return Swept(folder, said["study"], said["method"], tuple(said["keys"]), ranges, int(said["points"]), failed)
    except FileNotFoundError:
        held = "a sweep that has not finished: run it again, it goes on" if (folder / POINTS).is_dir() else "no sweep"
        raise RunError(f"{folder}: holds {held}") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise RunError(f"{folder / MANIFEST}: cannot be read: {why(error)}") from error
