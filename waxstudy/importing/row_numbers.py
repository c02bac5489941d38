"""Columns that number the rows of a table: they rise by one from row to row as no meter does, and are left out."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS
from waxstudy.importing.limits import FEWEST_NUMBERED
from waxstudy.importing.names import CHANNEL_NAMES, plain, says
from waxstudy.study.problems import listed

# of a meter each pulse of which is a row
COUNTED = (
    "|".join(
        f"{words.clear}|{words.weak}"
        for name, words in CHANNEL_NAMES.items()
        if CHANNELS[name].quantity in ("flow", "gain")
    )
    + "|impulse?|pulses?"
)


def without_row_numbers(frame: pd.DataFrame, kept: Collection[str]) -> tuple[pd.DataFrame, str]:
    """Return a table without columns that number its rows, and a sentence on them; as it is if nothing else is left.

    `kept` are names, in lower case, of columns that hold stamps or readings.
    """
    others = [name for name in frame.columns if str(name).strip().lower() not in kept]
    numbered = [name for name in others if _numbers_rows(frame[name]) and not says(plain(str(name)), COUNTED)]
    if not numbered or len(frame.columns) - len(numbered) < 2:
        return frame, ""
    return frame.drop(columns=numbered), f"Left out, as it numbers the rows: {listed(numbered)}."


def _numbers_rows(column: pd.Series) -> bool:
    if not pd.api.types.is_numeric_dtype(column) or len(column) < FEWEST_NUMBERED:
        return False
    steps = np.diff(column.to_numpy(dtype=float, na_value=np.nan))
    return bool((steps == 1.0).all() or (steps == -1.0).all())  # a table may begin with the last
