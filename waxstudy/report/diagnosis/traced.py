"""The traces of a judged channel, as figures and pages have them."""

from __future__ import annotations

import pandas as pd

TRACED = {"measured": "measured", "before": "as believed", "after": "with the effects found"}


def traced(frame: pd.DataFrame, channel: str) -> dict[str, pd.Series[float]]:
    """Return the traces of a channel by the keys of `TRACED`, "after" only if effects change the channel."""
    found = {what: frame[f"{channel}_{what}"] for what in TRACED if f"{channel}_{what}" in frame}
    if "after" in found and found["after"].equals(found["before"]):
        del found["after"]
    return found
