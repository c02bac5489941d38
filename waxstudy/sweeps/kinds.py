"""Names of where a sweep can be computed; the command line knows them without importing the executors."""

from __future__ import annotations

from typing import Literal

Kind = Literal["threads", "processes", "dask"]
KINDS: tuple[Kind, ...] = ("threads", "processes", "dask")
