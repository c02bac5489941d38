"""Tables as parquet files that say the unit of each of their columns."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

TIME = "local standard time"  # what a column of time stamps has for its unit


def write_parquet(table: pd.DataFrame, path: Path, units: Mapping[str, str]) -> None:
    """Write a table and its index, if that has a name, with `units` (column -> unit) in the metadata of its fields.

    Raises `KeyError` for a column without a unit, and `OSError`.
    """
    with parquet_parts(path, units) as add:
        add(table)


@contextmanager
def parquet_parts(path: Path, units: Mapping[str, str]) -> Iterator[Callable[[pd.DataFrame], None]]:
    """Give a function that writes tables of the same columns below each other, as `write_parquet` does."""
    writer: list[pq.ParquetWriter] = []

    def add(table: pd.DataFrame) -> None:
        plain = pa.Table.from_pandas(table, preserve_index=table.index.name is not None)
        fields = [field.with_metadata({"unit": units[field.name]}) for field in plain.schema]
        told = plain.cast(pa.schema(fields, plain.schema.metadata))
        if not writer:
            writer.append(pq.ParquetWriter(path, told.schema, compression="zstd"))
        writer[0].write_table(told)

    try:
        yield add
    finally:
        for each in writer:
            each.close()
