"""How often a member's signal switches its motor on, and how far its valve travels."""

from __future__ import annotations

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy.results.kpis import MemberWeek

DAY_S = 86400.0


class Wear:
    """Switches and travel of one member, from the parts of its record as they follow each other."""

    def __init__(self) -> None:
        self.duration_s, self.travel, self.switches = 0.0, 0.0, 0
        self.is_binary = True
        self.last: tuple[FloatArray, FloatArray] | None = None

    def add(self, part: MemberWeek) -> None:
        """Take in the next part."""
        signal, opening = part.channels["signal"], part.channels["opening"]
        before, at = self.last or (signal[:1], opening[:1])
        self.travel += float(np.sum(np.abs(np.diff(opening, prepend=at))))
        self.switches += int(np.sum(np.diff(signal, prepend=before) > 0.5))
        self.is_binary &= bool(np.all((signal == 0.0) | (signal == 1.0)))
        self.last = (signal[-1:].copy(), opening[-1:].copy())
        self.duration_s += len(signal) * part.step_s

    def per_day(self) -> dict[str, float]:
        """Return how often a day the signal switches on (NaN if it is not binary), and full strokes of the valve."""
        days = self.duration_s / DAY_S
        return {
            "switches_per_day": self.switches / days if self.is_binary else np.nan,
            "strokes_per_day": self.travel / days,
        }
