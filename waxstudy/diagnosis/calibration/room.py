"""The room of a healthy record as it was built, for studies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from waxstudy.diagnosis.calibration.calibrate import Calibration
from waxstudy.diagnosis.calibration.told import calibrated, doubts, fits
from waxstudy.diagnosis.result import BaselineFit, Calibrated, as_data
from waxstudy.plugin import Belief, Choice


@dataclass(frozen=True)
class CalibratedRoom:
    """A room as a healthy record has it, and what the record says besides."""

    dataset: str
    origin: str
    days: tuple[str, str]  # first and last
    room: Choice
    as_built: Sequence[Calibrated]  # of room, drives and chain
    baseline: Sequence[BaselineFit]
    warnings: Sequence[str]

    @classmethod
    def of(
        cls, calibration: Calibration, documented: Belief, dataset: str, origin: str, days: tuple[str, str]
    ) -> CalibratedRoom:
        """Return the room at the posterior mean of what was calibrated."""
        room = calibration.as_built.believed(documented).room
        assert room
        told = list(calibrated(calibration, documented))
        return cls(dataset, origin, days, room, told, list(fits(calibration)), list(doubts(calibration, documented)))

    def about(self) -> dict[str, Any]:
        """Return what a fragment tells of its calibration, in TOML's words, which have no NaN for what is not known."""
        intervals = {
            each.name: [each.value.low, each.value.high]
            for each in self.as_built
            if each.part == "room" and each.value.low == each.value.low
        }
        return {
            "dataset": self.dataset,
            "origin": self.origin,
            "days": list(self.days),
            # what drives the room, and the chain: no part of a room
            "beside": list(dict.fromkeys(e.sentence for e in self.as_built if e.part != "room" and e.is_clear)),
            "warnings": list(self.warnings),
            "values": {each.name: each.value.value for each in self.as_built if each.part == "room"},
            "intervals": intervals,
            "channels": {
                each.channel: {k: v for k, v in vars(each).items() if k != "channel"} for each in self.baseline
            },
        }

    def described(self) -> dict[str, Any]:
        """The calibration as JSON has it."""
        return {name: as_data(value) for name, value in vars(self).items() if name != "room"} | {
            "room": self.room.described()
        }
