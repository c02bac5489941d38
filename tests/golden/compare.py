"""Compare two tables of results, columns and rows both ways."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd


def differences(
    golden: pd.DataFrame, fresh: pd.DataFrame, keys: Sequence[str], tolerance: Mapping[str, float | pd.Series]
) -> list[str]:
    """Return every difference in words; an empty list means that the tables agree.

    `tolerance` gives each figure column's allowed absolute difference, one number or one per row.
    """
    missing, added = sorted(set(golden) - set(fresh)), sorted(set(fresh) - set(golden))
    found = [f"column {name} is missing" for name in missing] + [f"column {name} is new" for name in added]
    golden, fresh = golden.set_index(list(keys)), fresh.set_index(list(keys))
    found += [f"row {row} is missing" for row in golden.index.difference(fresh.index)]
    found += [f"row {row} is new" for row in fresh.index.difference(golden.index)]
    if found:
        return found
    fresh = fresh.loc[golden.index]
    for column in golden.columns:
        found += _column(column, golden[column], fresh[column], tolerance.get(column))
    return found


def _column(name: str, golden: pd.Series, fresh: pd.Series, allowed: float | pd.Series | None) -> list[str]:
    if allowed is None:
        unlike = golden.fillna("") != fresh.fillna("")
        return [f"{name} {row}: {fresh[row]} instead of {golden[row]}" for row in golden.index[unlike]]
    limit = allowed.to_numpy() if isinstance(allowed, pd.Series) else allowed
    off = np.abs(fresh.to_numpy(dtype=float) - golden.to_numpy(dtype=float))
    one_sided = golden.isna().to_numpy() != fresh.isna().to_numpy()
    bad = (off > limit) | one_sided
    return [f"{name} {row}: {fresh[row]} instead of {golden[row]}" for row in golden.index[bad]]
