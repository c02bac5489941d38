"""What was measured and what the models predict, on the record's samples."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from waxstudy.diagnosis.model.room_response import samples_of_mean
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.select.search import Selection
from waxstudy.plugin import FloatArray


def traces(record: Record, time: pd.DatetimeIndex, selections: Sequence[Selection]) -> pd.DataFrame:
    """Return measured, before and after of each judged channel at the record's times (n,)."""
    columns: dict[str, FloatArray] = {}
    for selection in selections:
        problem = selection.problem
        for name, model in (("before", selection.before), ("after", selection.after)):
            belief = problem.edited(model.effects, model.departures)
            predicted = problem.predicted(belief, model.convention)
            for channel, values in predicted.items():
                columns[f"{channel}_measured"] = record.metered(channel, record.values[channel])
                columns[f"{channel}_{name}"] = held(values, len(record), record.interval_s)
        if selection.course is not None:
            for channel in predicted:
                before, after = (columns[f"{channel}_{name}"] for name in ("before", "after"))
                columns[f"{channel}_after"] = before + selection.course * (after - before)
    return pd.DataFrame(columns, index=time)


def held(values: FloatArray, count: int, interval_s: float) -> FloatArray:
    """Return a prediction at each of so many samples: means over quarters of an hour, as of a room, are held."""
    if len(values) == count:
        return values
    return np.asarray(values[np.minimum(np.arange(count) // samples_of_mean(interval_s), len(values) - 1)])
