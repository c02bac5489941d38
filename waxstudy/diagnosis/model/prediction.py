"""What one segment makes of a belief, a room's as if its steps were short."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.perturbation import STILL, Perturbation
from waxstudy.diagnosis.model.predicted import Predicted
from waxstudy.diagnosis.model.room_response import OF_AIR_AND_FLOOR
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import Belief, FloatArray


class Prediction:
    """Predicts one segment; what shorter steps change of the room as believed is added to every belief.

    With the same flow they change as much of any other. Not of the return, whose first minutes of each pulse are a
    matter of form, unless that is as believed (`is_exact_room`).
    """

    def __init__(self, segment: Segment, record: Record, belief: Belief, is_exact_room: bool) -> None:
        self.segment, self.record, self.belief, self.is_exact_room = segment, record, belief, is_exact_room
        self._refinements: dict[Convention, Mapping[str, FloatArray]] = {}

    def __call__(self, belief: Belief, convention: Convention, perturbation: Perturbation = STILL) -> Predicted:
        found = self.segment.predict(self.record, belief, convention, perturbation)
        for channel, change in self._refinement(convention).items():
            found[channel] = found[channel] + change
        return found

    def fine(self, belief: Belief, convention: Convention) -> Predicted:
        """Return the same with what short steps change of this very belief, not of the one that is believed."""
        found = self(belief, convention)
        if refined := self._refinement(convention):
            fine = self.segment.predict(self.record, belief, convention, is_fine=True)
            found.update({channel: fine[channel] for channel in refined})
        return found

    def _refinement(self, convention: Convention) -> Mapping[str, FloatArray]:
        if not self.segment.with_room or self.segment.driven_by != "flow_L_h":
            return {}
        if convention not in self._refinements:
            coarse, fine = (
                self.segment.predict(self.record, self.belief, convention, is_fine=way) for way in (False, True)
            )
            refined = [channel for channel in fine if channel in OF_AIR_AND_FLOOR or self.is_exact_room]
            changes = {channel: fine[channel] - coarse[channel] for channel in refined}
            self._refinements[convention] = {channel: np.nan_to_num(change) for channel, change in changes.items()}
        return self._refinements[convention]
