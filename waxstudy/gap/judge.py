"""What a prediction misses: errors of each judged channel, whitened, by block and by part of the record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.gap.links import JUDGED_S, ROOM_STEP_S, Drift, Link, Predicted, Reading, weighted
from waxstudy.gap.record import DAY_S, Record
from waxstudy.plugin import Belief, FloatArray

FIT, SELECT, SHRINK, LEFT_OUT = 0, 1, 2, -1
SHAKES = 4  # how often a drive is shaken to see what its noise does to the timing of switches
SHIFTS = (-0.5, -0.25, 0.0, 0.25, 0.5)  # of an interval: nobody knows when in it a switch was thrown
SHORT_DAYS = 6
LEAST_SHRINK_DAYS = 3
# what the form of a room's model leaves of each channel, as seen against another engine's rooms [K]
FORM_K = {
    "air_temperature_C": 0.07,
    "operative_temperature_C": 0.07,
    "floor_surface_temperature_C": 0.08,
    "return_temperature_C": 0.15,
}
CLIPPED = 0.5**0.5  # what is left of noise that is cut off on one side
PIECE = 8  # quarters of an hour over which such errors hang together
JUMP = 0.4
RIDGE = 0.15  # share of full scale by which a moving valve may be missed, beside the noise


@dataclass(frozen=True)
class Errors:
    """What a prediction misses of one channel: `error` in `unit`, `scale` of its whitened form, both (m,)."""

    channel: str
    unit: str
    error: FloatArray  # 0 where nothing is judged
    whitened: FloatArray  # 0 where nothing is judged
    judged: np.ndarray  # (m,) bool
    block: np.ndarray  # (m,) cycle or day
    part: np.ndarray  # (m,) FIT, SELECT, SHRINK
    sample: np.ndarray  # (m,) index of the record's sample

    def loss(self, part: int | None = None) -> float:
        chosen = self.whitened if part is None else self.whitened[self.part == part]
        return float(chosen @ chosen)

    def gap(self, part: int | None = None) -> float:
        """Root mean square error in the channel's unit, over what is judged."""
        chosen = self.judged if part is None else self.judged & (self.part == part)
        return float(np.sqrt(np.mean(self.error[chosen] ** 2))) if chosen.any() else 0.0


class Judge:
    """Compares predictions of one link with the record, always in the same way, so that losses can be compared."""

    def __init__(self, link: Link, record: Record, belief: Belief) -> None:
        self.link, self.record = link, record
        self.parts = parts_of(record, days_in_turn=link.with_room)
        self._timing = {
            channel: self._switching(channel, belief) for channel in link.judged if self._is_switch(channel)
        }
        self._measured = {channel: self._quarters(channel) for channel in link.judged if self._is_quarterly(channel)}

    def _is_switch(self, channel: str) -> bool:
        return channel in self.record.binary

    def _is_quarterly(self, channel: str) -> bool:
        return (self.link.with_room and channel in ("air_temperature_C", "operative_temperature_C")) or channel in (
            "floor_surface_temperature_C",
            "return_temperature_C",
        )

    def errors(self, predicted: Predicted) -> list[Errors]:
        """Return the errors of each judged channel."""
        found = []
        for channel in self.link.judged:
            if channel in self._timing:
                found.append(self._switched(channel, predicted[channel]))
            elif channel in self._measured:
                found.append(self._room(channel, predicted[channel]))
            else:
                found.append(self._running(channel, predicted[channel]))
        return found

    def measured(self, channel: str) -> FloatArray:
        """Return the record as it is judged: of a room means over quarters, else its samples, gaps filled."""
        return self._measured[channel] if channel in self._measured else self.record.filled(channel)

    def noise(self, channel: str) -> FloatArray:
        """Return the standard deviation of the noise of what is judged, 0 where a meter stands still or rests."""
        record = self.record
        noise = record.noise[channel]
        if channel in self._measured:
            parts, merged = self._merging()
            return np.full(len(self._measured[channel]), noise / np.sqrt(parts * merged))
        values = record.filled(channel)
        if channel == "flow_L_h":
            return np.where(values > 0.02 * np.nanmax(values), noise, 0.0)
        return np.full(len(values), noise * (CLIPPED if channel == "displacement" else 1.0))

    def timing_s(self, channel: str) -> float:
        """Return how far noise alone moves the switches of a channel, typically."""
        return self._timing[channel].scale_s

    # --- what switches ---

    def _switching(self, channel: str, belief: Belief) -> _Switches:
        """Return the windows around each measured switch, and how far noise alone moves it."""
        windows = _windows(self.record, channel)
        reading = self.link.readings[-1]
        try:
            still = self.link.predict(self.record, belief, reading)[channel]
            moved = [self._moved(channel, belief, reading, still, windows, seed) for seed in range(SHAKES)]
        except Exception:  # a belief that cannot run is told elsewhere
            moved = []
        least_s = self.record.interval_s * 12.0**-0.5
        typical = float(np.sqrt(np.mean(np.square(moved)))) if moved else 0.0
        return _Switches(windows, max(least_s, typical))

    def _moved(
        self, channel: str, belief: Belief, reading: Reading, still: FloatArray, windows: np.ndarray, seed: int
    ) -> FloatArray:
        shaken = self.link.predict(self.record, belief, reading, Drift(np.random.default_rng(seed)))[channel]
        off_s = (
            np.bincount(windows, weights=np.abs(shaken - still), minlength=windows.max() + 1) * self.record.interval_s
        )
        return np.minimum(off_s, np.quantile(off_s, 0.9))

    def _switched(self, channel: str, predicted: FloatArray) -> Errors:
        """Return how long, around each measured switch, the prediction differs from the record [s]."""
        switches, record = self._timing[channel], self.record
        windows = switches.windows
        known = ~record.is_gap(channel) & ~record.is_gap(self.link.driven_by) & record.settled
        differs = np.abs(predicted - record.filled(channel)) * known
        count = windows.max() + 1
        off_s = np.bincount(windows, weights=differs, minlength=count) * record.interval_s
        judged = np.bincount(windows, weights=known, minlength=count) > 0.5 * np.bincount(windows, minlength=count)
        middle = np.searchsorted(windows, np.arange(count))
        off_s = np.where(judged, off_s, 0.0)
        return Errors(
            channel, "s", off_s, off_s / switches.scale_s, judged, record.cycle[middle], self.parts[middle], middle
        )

    # --- what runs on ---

    def _running(self, channel: str, predicted: FloatArray) -> Errors:
        record = self.record
        measured = record.values[channel]
        known = np.isfinite(measured) & record.settled
        for drive in {self.link.driven_by} & set(record.values):
            known &= ~record.is_gap(drive)
        if self.link.driven_by == "displacement":
            # it jumped within a sample: nobody knows when, nor what flowed meanwhile
            known &= np.abs(np.diff(record.filled("displacement"), prepend=0.0)) < JUMP
        error = np.where(known, predicted - np.nan_to_num(measured), 0.0)
        scale = self._scale(channel)
        if self.link.driven_by in record.binary:
            error = self._best_shift(predicted, np.nan_to_num(measured), known, scale)
        unit = {"flow_L_h": "L/h", "displacement": "1", "control_output": "1"}.get(channel, "K")
        sample = np.arange(len(record))
        return Errors(channel, unit, error, error / scale, known, record.cycle, self.parts, sample)

    def _scale(self, channel: str) -> FloatArray:
        """Return the standard deviation to weigh errors by: the noise, and more while the link's drive moves."""
        record, noise = self.record, self.record.noise[channel]
        full = float(np.nanmax(record.values[channel]))
        least = 0.1 * noise if channel == "flow_L_h" else noise
        resting = np.where(record.filled(channel) > 0.02 * full, noise, max(least, 1e-3 * full))
        if self.link.driven_by == "displacement":
            drive = record.drive("displacement")
            moves = np.abs(np.gradient(drive)) > 3.0 * record.noise["displacement"]
            return np.hypot(resting, np.where(moves, RIDGE * full, 0.0))
        return np.maximum(resting, 1e-3)

    def _best_shift(
        self, predicted: FloatArray, measured: FloatArray, known: np.ndarray, scale: FloatArray
    ) -> FloatArray:
        """Return the errors after each switch of the drive is put where in its interval it fits best."""
        record = self.record
        drive = record.filled(self.link.driven_by)
        segment = np.concatenate(([0], np.cumsum(np.diff(drive) != 0)))
        at, count = np.arange(len(predicted)), segment[-1] + 1
        tried = [np.where(known, np.interp(at - shift, at, predicted) - measured, 0.0) for shift in SHIFTS]
        losses = [np.bincount(segment, weights=(error / scale) ** 2, minlength=count) for error in tried]
        best = np.argmin(losses, axis=0)[segment]
        return np.asarray(np.choose(best, tried))

    # --- what the room shows ---

    def _quarters(self, channel: str) -> FloatArray:
        """Return a measured channel as means over quarters of an hour, the return only where water flows."""
        record = self.record
        parts, merged = self._merging()
        values = record.values[channel]
        weight = np.isfinite(values).astype(float)
        if channel == "return_temperature_C" and record.has("flow_L_h"):
            flow = record.filled("flow_L_h")
            weight *= np.where(flow > 0.2 * np.nanmax(flow), flow, 0.0)
        return weighted(np.nan_to_num(values), weight, parts * merged)

    def _merging(self) -> tuple[int, int]:
        parts = max(1, round(ROOM_STEP_S / self.record.interval_s))
        return parts, max(1, round(JUDGED_S / (parts * self.record.interval_s)))

    def _room(self, channel: str, predicted: FloatArray) -> Errors:
        measured = self._measured[channel]
        parts, merged = self._merging()
        sample = np.minimum(np.arange(len(measured)) * parts * merged, len(self.record) - 1)
        count = min(len(measured), len(predicted))
        error = np.full(len(measured), np.nan)
        error[:count] = predicted[:count] - measured[:count]
        known = np.isfinite(error) & self.record.settled[sample]
        error = np.where(known, error, 0.0)
        scale_K = np.hypot(FORM_K[channel], self.record.noise[channel]) * PIECE**0.5
        return Errors(channel, "K", error, error / scale_K, known, self.record.day[sample], self.parts[sample], sample)


@dataclass(frozen=True)
class _Switches:
    windows: np.ndarray  # (n,) number of the measured switch that is nearest
    scale_s: float


def _windows(record: Record, channel: str) -> np.ndarray:
    values = record.filled(channel)
    edges = np.flatnonzero(np.diff(values) != 0) + 1
    if len(edges) < 2:
        return record.day - record.day[0]
    middles = (edges[1:] + edges[:-1]) // 2
    return np.searchsorted(middles, np.arange(len(record)), side="right")


def parts_of(record: Record, days_in_turn: bool = False) -> np.ndarray:
    """Return the part of each sample: fit, then select, then shrinkage of at least three days.

    A room is fitted and judged on days in turn: what a few days tell of it would not hold in other weather. A short
    record has cycles, or days, in turn for fit and for the rest, which then serves twice.
    """
    days = len(record) * record.interval_s / DAY_S
    at = (np.arange(len(record)) + 0.5) * record.interval_s / DAY_S
    in_turn = np.where((record.day if days_in_turn else record.cycle) % 2 == 0, FIT, SELECT)
    if days < SHORT_DAYS:
        return in_turn
    kept = max(LEAST_SHRINK_DAYS, 0.3 * days)
    first = in_turn if days_in_turn else np.where(at < 0.57 * (days - kept), FIT, SELECT)
    return np.where(at >= days - kept, SHRINK, first)


def losses(errors: Sequence[Errors], part: int) -> Mapping[int, float]:
    """Return the loss of each block of a part."""
    found: dict[int, float] = {}
    for each in errors:
        chosen = each.part == part
        for block, value in zip(each.block[chosen], each.whitened[chosen] ** 2, strict=True):
            found[int(block)] = found.get(int(block), 0.0) + float(value)
    return found
