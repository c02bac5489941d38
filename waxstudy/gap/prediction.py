"""What one link makes of a belief, a room's as if its steps were short."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from waxstudy.gap.links import Link
from waxstudy.gap.reading import STILL, Drift, Reading
from waxstudy.gap.record import Record
from waxstudy.gap.room import OF_AIR_AND_FLOOR, Predicted
from waxstudy.plugin import Belief, FloatArray


class Prediction:
    """Predicts one link; what shorter steps change of the room as believed is added to every belief.

    With the same flow they change as much of any other. Not of the return, whose first minutes of each pulse are a
    matter of form, unless that is as believed (`is_to_the_letter`).
    """

    def __init__(self, link: Link, record: Record, belief: Belief, is_to_the_letter: bool) -> None:
        self.link, self.record, self.belief, self.is_to_the_letter = link, record, belief, is_to_the_letter
        self._refinements: dict[Reading, Mapping[str, FloatArray]] = {}

    def __call__(self, belief: Belief, reading: Reading, drift: Drift = STILL) -> Predicted:
        found = self.link.predict(self.record, belief, reading, drift)
        for channel, change in self._refinement(reading).items():
            found[channel] = found[channel] + change
        return found

    def fine(self, belief: Belief, reading: Reading) -> Predicted:
        """Return the same with what short steps change of this very belief, not of the one that is believed."""
        found = self(belief, reading)
        if refined := self._refinement(reading):
            fine = self.link.predict(self.record, belief, reading, is_fine=True)
            found.update({channel: fine[channel] for channel in refined})
        return found

    def _refinement(self, reading: Reading) -> Mapping[str, FloatArray]:
        if not self.link.with_room or self.link.driven_by != "flow_L_h":
            return {}
        if reading not in self._refinements:
            coarse, fine = (self.link.predict(self.record, self.belief, reading, is_fine=way) for way in (False, True))
            refined = [channel for channel in fine if channel in OF_AIR_AND_FLOOR or self.is_to_the_letter]
            changes = {channel: fine[channel] - coarse[channel] for channel in refined}
            self._refinements[reading] = {channel: np.nan_to_num(change) for channel, change in changes.items()}
        return self._refinements[reading]
