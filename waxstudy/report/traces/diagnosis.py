"""Traces of a diagnosis, from the folder that it was written to: measured, as believed, and with what was found."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from waxstudy.report.diagnosis.traced import TRACED, traced
from waxstudy.report.diagnosis.words import named, unit_words
from waxstudy.report.traces.lines import Line, Panel, Traces
from waxstudy.results.folder import RunError

TRACES = "traces.parquet"


def of_diagnosis(folder: Path, dataset: str) -> Traces:
    """Return every judged channel of a diagnosis; raise `RunError` for traces that cannot be read or hold nothing."""
    path = folder / TRACES
    try:
        frame = pd.read_parquet(path)
    except (OSError, ValueError) as error:
        raise RunError(f"{path}: missing, cut off or damaged; diagnose the record again") from error
    channels = dict.fromkeys(str(name).rpartition("_")[0] for name in frame if str(name).endswith("_before"))
    panels = [panel for channel in channels if (panel := _panel(frame, channel)).lines]
    if not panels or not isinstance(frame.index, pd.DatetimeIndex):
        raise RunError(f"{path}: no channel was judged, so that there is nothing to look at")
    summary = "Every judged channel, driven by what was measured before it in the loop."
    return Traces(f"Traces of the diagnosis of “{dataset}”", summary, panels)


def _panel(frame: pd.DataFrame, channel: str) -> Panel:
    words, unit = named(channel)
    known = {what: trace.dropna() for what, trace in traced(frame, channel).items()}
    lines = [Line(TRACED[what], list(TRACED).index(what), values) for what, values in known.items() if len(values)]
    return Panel(words, unit_words(unit) or "0 to 1", lines)
