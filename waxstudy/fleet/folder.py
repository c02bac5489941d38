"""The folder of a finished activation, format 1.

activation.json    what was called, the table with bands, warnings, versions; written last
response.parquet   the whole fleet over time after each call, with the band of other fleets
loops.parquet      a row for each loop, week, state and call: what was drawn, and its figures
batches/           what an activation that was interrupted goes on from
"""

from __future__ import annotations

from pathlib import Path

MANIFEST, RESPONSE, LOOPS, BATCHES = "activation.json", "response.parquet", "loops.parquet", "batches"


def holds_activation(folder: Path) -> bool:
    """Whether a folder holds what an activation leaves, finished or not."""
    return (folder / MANIFEST).exists() or (folder / BATCHES).is_dir()
