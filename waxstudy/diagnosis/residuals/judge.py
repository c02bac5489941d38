"""Which way each channel of a segment is judged in."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Residual, motions_of
from waxstudy.diagnosis.model.as_built import AsBuilt
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.perturbation import STILL, Perturbation
from waxstudy.diagnosis.model.room_response import OF_ROOM, Predicted, error_of
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.noise import STROKES
from waxstudy.diagnosis.observations.partition import parts_of
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.continuous import Continuous
from waxstudy.diagnosis.residuals.room_means import RoomMeans
from waxstudy.diagnosis.residuals.switching import Switching
from waxstudy.plugin import Belief, SimulationError

# draws of noise of a drive: how closely is looked at what it does to switches; more samples have fewer, to save time.
# Twice as many moved no probability of nine links by more than 0.01
FEWEST, MOST = 8, 16
DRAWN = MOST * 14 * 1440  # samples of all draws: two weeks of minutes have the most
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
        perturbed: Iterator[Predicted] | None = None,  # what noise of the drive does; None: to what is believed
    ) -> None:
        self.segment, self.record, self.is_exact_room = segment, record, is_exact_room
        self.parts = parts_of(record, days_in_turn=segment.with_room, holds_out=holds_out) if parts is None else parts
        self._as_built, self._belief = as_built, belief
        drawn = perturbed_by_noise(segment, record, belief, self._known) if perturbed is None else perturbed
        self._still = next(drawn, None)
        self.ways = {channel: self._way(channel) for channel in segment.judged}
        driven = [way for way in self.ways.values() if not isinstance(way, RoomMeans) and way.is_moved]
        for moved in drawn if driven else ():
            for way in driven:
                way.see(moved)

    @property
    def _known(self) -> Convention | None:
        """In which way the healthy record was read."""
        return self._as_built.conventions.get(self.segment.name) if self._as_built else None

    def residuals(self, predicted: Predicted) -> list[Residual]:
        """Return what a prediction misses of each judged channel."""
        return [way.residual(predicted) for way in self.ways.values()]

    def _way(self, channel: str) -> Switching | Continuous | RoomMeans:
        common = channel, self.segment, self.record, self.parts, self._still
        left = self._as_built.left_of(self.segment.name).get(channel) if self._as_built else None
        more = max(1.0, left.whitened) if left else 1.0
        if channel in self.record.binary:
            return Switching(*common, more)
        if channel in ONLY_OF_ROOM or (self.segment.with_room and channel in OF_ROOM):
            error = error_of(self._belief, channel)
            known = self._as_built.discrepancies.get(channel) if self._as_built else None
            about = channel, self.record, self.segment.driven_by, self.parts
            return RoomMeans(*about, error, self.is_exact_room, known)
        return Continuous(*common, more, self._by_motion(channel))

    def _by_motion(self, channel: str) -> list[float] | None:
        """Return what the healthy record leaves of each motion of a channel, None where it has no such link."""
        if self._as_built is None or self.segment.name not in self._as_built.conventions or channel not in STROKES:
            return None
        found = [self._as_built.left.get(name) for name in motions_of(channel)]
        return [each.whitened if each else 1.0 for each in found]


def perturbed_by_noise(
    segment: Segment, record: Record, belief: Belief, convention: Convention | None = None
) -> Iterator[Predicted]:
    """Yield what a belief predicts, then that with its drive perturbed; nothing of a room, or where it cannot run.

    The record is read in the way of a convention; without one, as instruments are believed to log.
    """
    if segment.with_room:
        return
    way = convention or [each for each in segment.conventions if not each.is_handicapped][-1]
    draws = max(FEWEST, min(MOST, DRAWN // len(record)))
    for each in (STILL, *(Perturbation(np.random.default_rng(seed)) for seed in range(draws))):
        try:
            yield segment.predict(record, belief, way.drawn, each)
        except (SimulationError, ValueError, ArithmeticError):
            if each is STILL:
                return
