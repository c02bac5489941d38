"""Tables as parquet files that say the unit of each of their columns."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

TIME = "local standard time"  # what a column of time stamps has for its unit


def write_parquet(table: pd.DataFrame, path: Path, units: Mapping[str, str]) -> None:
    """Write a table and its index, if that has a name, with `units` (column -> unit) in the metadata of its fields.

    Raises `KeyError` for a column without a unit, and `OSError`.
    """
    plain = pa.Table.from_pandas(table)
    fields = [field.with_metadata({"unit": units[field.name]}) for field in plain.schema]
    pq.write_table(plain.cast(pa.schema(fields, plain.schema.metadata)), path, compression="zstd")
