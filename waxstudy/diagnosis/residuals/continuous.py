"""A channel that runs on: judged sample by sample, over its noise and what its drive's noise makes of it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import MOTIONS, Residual
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.record import AFTER_GAP_S, FLOW, OUTPUT, SUPPLY, Record
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray

CLIPPED = 0.5**0.5  # what is left of noise that is cut off on one side
STANDS = 1e-4  # of full flow, below which a meter stands still
JUMP = 0.4  # of an opening within a sample: nobody knows when, nor what flowed meanwhile
RESTS, LONE = 0.05, 0.1  # of full scale: a drive that does not move, a sample that stands alone
MOVED = (OUTPUT, FLOW)  # which noise of the drive moves
SMOOTHED = ("sensor_temperature_C", OUTPUT)  # as the segment's drive: what is linear misses nothing by it
RIDGE = 0.05  # share of full scale by which a moving valve may be missed, beside the noise
STEEP = 0.18  # share of a step between samples, likewise: nobody knows how it went on between them
MOVES_SD = 3.0  # standard deviations of noise within which a sample rests where the last one was
MOVES_S = 60.0  # within which it does: a stroke takes minutes
MOST_LOST = 0.1  # chosen: share of a span between pulses in which its drive may be lost
UNITS = {FLOW: "L/h", "displacement": "1", OUTPUT: "1", "heating_signal": "1"}


class Continuous:
    """Errors of each sample, weighed by noise, and by more while the segment's drive moves."""

    def __init__(
        self,
        channel: str,
        segment: Segment,
        record: Record,
        parts: np.ndarray,
        still: Predicted | None,
        more: float = 1.0,
        left: Sequence[float] | None = None,  # by motion, over what is chosen; None: these are not told apart
    ) -> None:
        self.channel, self.segment, self.record, self.parts = channel, segment, record, parts
        self.still, self.more, self.left = still, more, left
        filled = record.filled(channel)
        self.sample = np.arange(len(record))
        self.measured = record.smooth(filled) if channel in SMOOTHED else record.metered(channel, filled)
        self.pulses = record.pulses if channel == FLOW else None
        self.known = self._known()
        self._squares, self.draws = np.zeros(len(record)), 0

    @property
    def is_moved(self) -> bool:
        """Whether noise of the drive counts: of what a switch drives it does not."""
        return self.channel in MOVED and self.segment.driven_by not in self.record.binary

    def see(self, moved: Predicted) -> None:
        """Take one draw more of what noise of the drive does."""
        assert self.still
        self._squares += (moved[self.channel] - self.still[self.channel]) ** 2
        self.draws += 1

    def see_at_least(self, other: Continuous) -> None:
        """Count noise of the drive at least as much as another does: a controller fitted to noise looks too weak."""
        if self.draws and other.draws:
            self._squares = np.maximum(self._squares, other._squares * self.draws / other.draws)

    def likelihood(self, error: FloatArray) -> float:
        """Return the logarithm of how likely errors are (n,), each sample by itself."""
        scale, missed = self.scale[self.known], error[self.known]
        return -float(0.5 * np.sum((missed / scale) ** 2) + np.sum(np.log(scale)))

    @cached_property
    def scale(self) -> FloatArray:
        """Standard deviation to weigh errors by (n,)."""
        believed = float(np.max(self.still[self.channel])) if self.still else 1.0
        resting, within = self._scale(float(np.nanmax(self.record.values[self.channel])) or believed)
        whole = np.hypot(resting, within)
        if self.left is None or self.motion is None:
            return self.more * whole
        return np.asarray(np.maximum(resting, np.array(self.left)[self.motion] * whole))

    @cached_property
    def motion(self) -> np.ndarray | None:
        """Place in `MOTIONS` of each sample (n,), if each is weighed by itself."""
        if self.left is None:
            return None
        if self.segment.driven_by == "displacement":
            moves = self._moves("displacement", self.record.drive("displacement"))
        else:
            moves = self._moves(self.channel, self.measured)
            if self.still:
                moves |= self._moves(self.channel, self.still[self.channel])
        if self.pulses:
            moves = self.pulses.sums(moves) > 0.0
        return np.where(moves, MOTIONS.index("moving"), MOTIONS.index("resting"))

    def _moves(self, channel: str, values: FloatArray) -> np.ndarray:
        """Return where a channel moves within a minute (n,), however often it is sampled."""
        apart = max(1, round(MOVES_S / self.record.interval_s))
        far = np.abs(values[apart:] - values[:-apart]) > 2.0**0.5 * MOVES_SD * self.record.noise[channel]
        moves = np.zeros(len(values), dtype=bool)
        moves[apart:] |= far
        moves[:-apart] |= far
        return moves

    @cached_property
    def noise(self) -> FloatArray:
        """Standard deviation of the noise of what is judged (n,), 0 where a meter stands still."""
        record, noise = self.record, self.record.noise[self.channel]
        if self.channel in SMOOTHED:
            return np.full(len(record), noise * record.smoothed_noise)
        if self.pulses:
            return self.pulses.noise
        if self.channel == FLOW:
            return np.where(stands(self.measured, float(np.nanmax(self.measured))), 0.0, noise)
        return np.full(len(record), noise * (CLIPPED if self.channel == "displacement" else 1.0))

    def residual(self, predicted: Predicted) -> Residual:
        record, channel = self.record, self.channel
        error = np.where(self.known, predicted[channel] - self.measured, 0.0)
        if channel in predicted.shifted:
            error = self._best_shift(predicted.shifted[channel])
        unit = UNITS.get(channel, "K")
        where = record.cycle, self.parts, self.sample
        about = channel, unit, error, error / self.scale, self.known, *where
        return Residual(*about, motion=self.motion, noise=self.noise / self.scale)

    def _known(self) -> np.ndarray:
        """Return where it is judged (n,)."""
        record, driven_by = self.record, self.segment.driven_by
        known: np.ndarray = np.isfinite(record.values[self.channel]) & record.settled
        if self.pulses:
            lost = self.pulses.sums(record.is_gap(driven_by)) if driven_by in record.values else 0.0
            is_settled = self.pulses.sums(~record.settled) == 0.0
            return np.asarray(known & self.pulses.ends & is_settled & (lost <= MOST_LOST * self.pulses.samples))
        # the air drives the sensor, which drives the controller of the same segment
        for drive in (driven_by, record.air_channel) if self.channel == "sensor_temperature_C" else (driven_by,):
            if drive in record.values:
                known &= ~record.is_gap(drive)
        if self.channel == SUPPLY and record.has(FLOW):  # how warm water is that stands is of no account
            known &= ~record.is_gap(FLOW) & (record.filled(FLOW) > 0.0)
        if driven_by == "displacement":
            known &= np.abs(np.diff(record.filled("displacement"), prepend=0.0)) < JUMP
        is_coarse = driven_by in record.binary and record.interval_s >= WEIGHTS.far_apart_s
        if is_coarse or (driven_by == "displacement" and record.interval_s > WEIGHTS.pulse_s):
            known &= ~is_lone(record.filled(self.channel), record.filled(driven_by))
        if is_coarse:
            known &= ~of_unknown_length(record.filled(driven_by), round(AFTER_GAP_S / record.interval_s))
        return known

    @property
    def driven(self) -> FloatArray:
        """Return how far noise of the drive moves an output or a flow (n,), smoothed where the loop is slow."""
        if not self.draws:
            return np.zeros(len(self.record))
        moved = self._squares / self.draws
        if self.channel == FLOW:
            return np.asarray(np.sqrt(moved))
        width = max(1, round(3600.0 / self.record.interval_s))
        nearby = np.convolve(moved, np.full(width, 1.0 / width), mode="same")
        return np.sqrt(np.maximum(nearby, np.mean(moved)))

    def _scale(self, full: float) -> tuple[FloatArray, FloatArray]:
        """Return standard deviations to weigh errors by: of the noise, and of what a moving valve adds; both (n,)."""
        if self.pulses:
            within = self._within(full) if self.segment.driven_by == "displacement" else np.zeros(len(self.record))
            return np.hypot(self.noise, self.driven), self.pulses.means(within)
        record, noise = self.record, self.record.noise[self.channel]
        least = 0.1 * noise if self.channel == FLOW else noise
        resting = np.where(stands(record.filled(self.channel), full), max(least, 1e-3 * full), noise)
        resting[resting == 0.0] = 1e-3 * (full or 1.0)  # nobody knows a channel without noise better
        if self.segment.driven_by == "displacement":
            return np.hypot(resting, self.driven), self._within(full)
        return np.hypot(np.maximum(resting, 1e-3), self.driven), np.zeros(len(record))

    def _within(self, full: float) -> FloatArray:
        """Return by how much a valve may be missed while it moves (n,)."""
        drive = self.record.drive("displacement")
        steps = _steps(drive)
        moves = steps > MOVES_SD * self.record.noise["displacement"]
        if self.still and (most := float(np.max(self.still[self.channel]))) > 0.0:
            steps = np.maximum(steps, _steps(self.still[self.channel]) / most)
        return np.where(moves, np.hypot(RIDGE, STEEP * steps) * full, 0.0)

    def _best_shift(self, shifted: FloatArray) -> FloatArray:
        """Return the errors after each switch of the drive is put where in its interval it fits best."""
        drive = self.record.filled(self.segment.driven_by)
        stretch = np.concatenate(([0], np.cumsum(np.diff(drive) != 0)))
        tried = np.where(self.known, shifted - self.measured, 0.0)
        losses = [np.bincount(stretch, weights=(error / self.scale) ** 2) for error in tried]
        best = np.argmin(losses, axis=0)[stretch]
        return np.asarray(tried[best, np.arange(len(stretch))])


def _steps(values: FloatArray) -> FloatArray:
    """Return how far a channel goes within a sample (n,), from the one before it or to the one behind it."""
    return np.asarray(np.maximum(np.abs(np.gradient(values)), np.abs(np.diff(values, prepend=values[:1]))))


def stands(values: FloatArray, full: float) -> np.ndarray:
    """Return where a meter stands still: a zero among others, not noise that is cut off at zero."""
    from scipy.ndimage import uniform_filter1d

    zero = np.abs(values) <= STANDS * full
    return np.asarray(zero & (uniform_filter1d(zero.astype(float), 31) > 0.3))


def of_unknown_length(drive: FloatArray, after: int) -> np.ndarray:
    """Return samples (n,) of a pulse or pause that a single one shows, and some after it, up to the next switch.

    It lasted anything up to two intervals: nobody knows how far a motor came meanwhile.
    """
    stretch = np.concatenate(([0], np.cumsum(np.diff(drive) != 0.0)))
    lone = np.bincount(stretch) == 1
    since = np.arange(len(drive)) - np.searchsorted(stretch, stretch)
    follows = np.concatenate(([False], lone[:-1]))[stretch] & (since < after)
    return np.asarray(lone[stretch] | follows)


def is_lone(values: FloatArray, drive: FloatArray) -> np.ndarray:
    """Return samples that stand alone while the drive rests: a pulse or pause came and went between its samples."""
    rests, moved = np.abs(np.diff(drive)) <= RESTS, np.diff(values) / max(float(np.max(values)), 1e-9)
    lone = np.zeros(len(values), dtype=bool)
    still = rests[:-2] & rests[1:-1] & rests[2:]
    there, back = moved[1:-1], moved[2:]
    lone[2:-1] = still & (np.minimum(np.abs(there), np.abs(back)) > LONE) & (np.abs(there + back) < LONE)
    return lone
