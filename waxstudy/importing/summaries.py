"""Rows that sum up those above or below them, as protocols of a month have: they are none of readings."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from waxstudy.importing.limits import NAMED
from waxstudy.importing.reading import Table
from waxstudy.importing.stamps import is_stamps
from waxstudy.study.problems import listed

# what stands in place of a stamp, in lower case
SUMMARIES = (
    "mittelwert", "mittel", "durchschnitt", "ø", "minimum", "maximum", "minimalwert", "maximalwert", "summe", "gesamt",
    "standardabweichung", "mean", "average", "avg", "min", "max", "sum", "total", "std", "count", "anzahl", "moyenne",
    "somme", "media", "gemiddelde", "totaal", "totale", "suma", "średnia", "medel", "gennemsnit", "keskiarvo",
)  # fmt: skip


def without_summaries(table: Table) -> tuple[pd.DataFrame, str]:
    """Return a table without rows that have such a word in place of a stamp, its first cell, and a sentence on them."""
    frame = table.frame
    if frame.empty:
        return frame, ""
    cells = frame.iloc[:, 0]
    if pd.api.types.is_numeric_dtype(cells) or pd.api.types.is_datetime64_any_dtype(cells):
        return frame, ""
    words = [each for each in cells.dropna().unique() if str(each).strip().rstrip(".:").lower() in SUMMARIES]
    is_summed = cells.isin(words)
    if not words or is_summed.all() or not is_stamps(cells[~is_summed]):
        return frame, ""
    told = listed([f"'{each}'" for each in words], NAMED)
    said = f"{Path(table.where).name}: {int(is_summed.sum())} rows are left out, as they sum up others: {told}."
    return frame[~is_summed].infer_objects(), said
