"""Which way each channel of a segment is judged in."""

from __future__ import annotations

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.model.as_built import AsBuilt
from waxstudy.diagnosis.model.perturbation import STILL, Perturbation
from waxstudy.diagnosis.model.room_response import OF_ROOM, Predicted, error_of
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.partition import parts_of
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.continuous import Continuous
from waxstudy.diagnosis.residuals.room_means import RoomMeans
from waxstudy.diagnosis.residuals.switching import Switching
from waxstudy.plugin import Belief, SimulationError

PERTURBATIONS = 4  # of a drive, to see what its noise does to the timing of switches
ONLY_OF_ROOM = ("floor_surface_temperature_C", "return_temperature_C")


class Judge:
    """Compares predictions of one segment with the record, always in the same way, so that losses can be compared."""

    def __init__(
        self,
        segment: Segment,
        record: Record,
        belief: Belief,
        holds_out: bool = True,
        is_exact_room: bool = False,
        as_built: AsBuilt | None = None,
        parts: np.ndarray | None = None,
    ) -> None:
        self.segment, self.record, self.is_exact_room = segment, record, is_exact_room
        self.parts = parts_of(record, days_in_turn=segment.with_room, holds_out=holds_out) if parts is None else parts
        self._as_built = as_built
        self._belief, self._perturbed = belief, self._perturb(belief)
        self.ways = {channel: self._way(channel) for channel in segment.judged}

    def residuals(self, predicted: Predicted) -> list[Residual]:
        """Return what a prediction misses of each judged channel."""
        return [way.residual(predicted) for way in self.ways.values()]

    def _way(self, channel: str) -> Switching | Continuous | RoomMeans:
        common = channel, self.segment, self.record, self.parts, self._perturbed
        left = self._as_built.left.get(channel) if self._as_built else None
        more = max(1.0, left.whitened) if left else 1.0
        if channel in self.record.binary:
            return Switching(*common, more)
        if channel in ONLY_OF_ROOM or (self.segment.with_room and channel in OF_ROOM):
            error = error_of(self._belief, channel)
            known = self._as_built.discrepancies.get(channel) if self._as_built else None
            return RoomMeans(channel, self.record, self.parts, error, self.is_exact_room, known)
        return Continuous(*common, more)

    def _perturb(self, belief: Belief) -> list[Predicted]:
        """Return what a belief predicts, then that with its drive perturbed; nothing where it cannot run."""
        if self.segment.with_room:
            return []
        known = self._as_built.conventions.get(self.segment.name) if self._as_built else None
        plain = known or [each for each in self.segment.conventions if not (each.is_raw or each.is_late)][-1]
        tried = [STILL, *(Perturbation(np.random.default_rng(seed)) for seed in range(PERTURBATIONS))]
        try:
            return [self.segment.predict(self.record, belief, plain, each) for each in tried]
        except (SimulationError, ValueError):
            return []
