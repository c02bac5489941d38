"""What a prediction misses: errors of each judged channel, whitened, by block and by part of the record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.gap.links import Link
from waxstudy.gap.reading import LONG_S, STILL, Drift
from waxstudy.gap.record import DAY_S, Record
from waxstudy.gap.room import OF_AIR_AND_FLOOR, Predicted, merging, room_error, weighted
from waxstudy.plugin import Belief, FloatArray, SimulationError

FIT, SELECT, SHRINK = 0, 1, 2
BOTH = (FIT, SELECT)  # the days on which a cause is looked for
ALL = (*BOTH, SHRINK)
SOFT = 3.0  # standard deviations beyond which an error of a switch counts straight
SHAKES = 4  # how often a drive is shaken to see what its noise does to the timing of switches
SHORT_DAYS = 6
LEAST_SHRINK_DAYS = 3
FIT_SHARE = 0.57  # of the cycles of a chain that are not kept back
FEWEST_CYCLES = 3
STEPPED_K = 0.005  # chosen: what stays of a room that is as believed, in samples of some minutes
CLIPPED = 0.5**0.5  # what is left of noise that is cut off on one side
PIECE = 8  # quarters of an hour over which such errors hang together
STANDS = 1e-4  # of full flow, below which a meter stands still
JUMP = 0.4
RESTS, LONE = 0.05, 0.1  # of full scale: a drive that does not move, a sample that stands alone
SMOOTHED = ("sensor_temperature_C", "control_output")
RIDGE = 0.05  # share of full scale by which a moving valve may be missed, beside the noise
STEEP = 0.18  # share of a step between samples, likewise: nobody knows how it went on between them


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

    def __init__(
        self, link: Link, record: Record, belief: Belief, holds_out: bool = True, is_to_the_letter: bool = False
    ) -> None:
        self.link, self.record, self.belief, self.is_to_the_letter = link, record, belief, is_to_the_letter
        self.parts = parts_of(record, days_in_turn=link.with_room, holds_out=holds_out)
        shaken = self._shaken(belief)
        switches = [channel for channel in link.judged if self._is_switch(channel)]
        self._still = shaken[0] if shaken else Predicted()
        self._timing = {channel: self._switching(channel, shaken) for channel in switches}
        self._drives = {c: self._driven(c, shaken) for c in link.judged if c in ("control_output", "flow_L_h")}
        self._measured = {channel: self._quarters(channel) for channel in link.judged if self._is_quarterly(channel)}
        rest = [c for c in link.judged if c not in self._timing and c not in self._measured]
        self._runs = {channel: self._run_of(channel) for channel in rest}

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
                found.append(self._running(channel, predicted))
        return found

    def measured(self, channel: str) -> FloatArray:
        """Return the record as it is judged: of a room means over quarters, else its samples, gaps filled."""
        if channel in self._measured:
            return self._measured[channel]
        filled = self.record.filled(channel)
        return self.record.smooth(filled) if channel in SMOOTHED and not self._is_switch(channel) else filled

    def noise(self, channel: str) -> FloatArray:
        """Return the standard deviation of the noise of what is judged, 0 where a meter stands still or rests."""
        record = self.record
        noise = record.noise[channel]
        if channel in self._measured:
            parts, merged = merging(self.record.interval_s)
            return np.full(len(self._measured[channel]), noise / np.sqrt(parts * merged))
        values = record.filled(channel)
        if channel in SMOOTHED:
            return np.full(len(values), noise * record.smoothed_noise)
        if channel == "flow_L_h":
            return np.where(stands(values, float(np.nanmax(values))), 0.0, noise)
        return np.full(len(values), noise * (CLIPPED if channel == "displacement" else 1.0))

    def timing_s(self, channel: str) -> float:
        """Return how far noise alone moves the switches of a channel, typically."""
        return float(np.sqrt(np.median(self._timing[channel].scale_s ** 2)))

    def moved(self, channel: str) -> float:
        """Return how far the noise of the drive moves a controller's running output, or a flow, typically."""
        return float(np.sqrt(np.mean(self._drives[channel] ** 2)))

    # --- what switches ---

    def _shaken(self, belief: Belief) -> list[Predicted]:
        """Return what a belief predicts, and then what it does with its drive shaken; nothing where it cannot run."""
        if self.link.with_room:
            return []
        reading = next(each for each in reversed(self.link.readings) if not (each.is_raw or each.is_late))
        drifts = [STILL, *(Drift(np.random.default_rng(seed)) for seed in range(SHAKES))]
        try:
            return [self.link.predict(self.record, belief, reading, drift) for drift in drifts]
        except (SimulationError, ValueError):
            return []

    def _switching(self, channel: str, shaken: Sequence[Predicted]) -> _Switches:
        """Return the windows around each measured switch, and how far noise alone moves it."""
        windows = _windows(self.record, channel)
        least_s = self.record.interval_s * 12.0**-0.5
        if not shaken:
            return _Switches(windows, np.full(windows.max() + 1, least_s))
        still = shaken[0][channel]
        off = [self._off_s(np.abs(each[channel] - still), windows) for each in shaken[1:]]
        own_s = np.sqrt(np.mean(np.square(off), axis=0))
        typical_s = float(np.sqrt(np.mean(np.minimum(own_s, np.quantile(own_s, 0.9)) ** 2)))
        return _Switches(windows, np.maximum(own_s, max(least_s, typical_s)))

    def _off_s(self, differs: FloatArray, windows: np.ndarray) -> FloatArray:
        return np.asarray(np.bincount(windows, weights=differs, minlength=windows.max() + 1) * self.record.interval_s)

    def _driven(self, channel: str, shaken: Sequence[Predicted]) -> FloatArray:
        """Return how far the noise of a drive moves a channel (n,), smoothed over time where the loop is slow."""
        if not shaken or self.link.driven_by in self.record.binary:
            return np.zeros(len(self.record))
        moved = np.mean([(each[channel] - shaken[0][channel]) ** 2 for each in shaken[1:]], axis=0)
        if channel == "flow_L_h":
            return np.asarray(np.sqrt(moved))
        width = max(1, round(3600.0 / self.record.interval_s))
        nearby = np.convolve(moved, np.full(width, 1.0 / width), mode="same")
        return np.sqrt(np.maximum(nearby, np.mean(moved)))

    def _switched(self, channel: str, predicted: FloatArray) -> Errors:
        """Return how long, around each measured switch, the prediction differs from the record [s]."""
        switches, record = self._timing[channel], self.record
        windows = switches.windows
        known = ~record.is_gap(channel) & ~record.is_gap(self.link.driven_by) & record.settled
        differs = np.abs(predicted - record.filled(channel)) * known
        count = windows.max() + 1
        off_s = self._off_s(differs, windows)
        judged = np.bincount(windows, weights=known, minlength=count) > 0.5 * np.bincount(windows, minlength=count)
        ends = np.searchsorted(windows, np.arange(count + 1))
        middle = (ends[:-1] + ends[1:] - 1) // 2
        off_s = np.where(judged, off_s, 0.0)
        whitened = softened(off_s / switches.scale_s)
        return Errors(channel, "s", off_s, whitened, judged, record.cycle[middle], self.parts[middle], middle)

    # --- what runs on ---

    def _run_of(self, channel: str) -> _Run:
        """Return what a channel that runs on is held against."""
        record = self.record
        measured = record.values[channel]
        known = np.isfinite(measured) & record.settled
        for drive in {self.link.driven_by} & set(record.values):
            known &= ~record.is_gap(drive)
        if self.link.driven_by == "displacement":
            # it jumped within a sample: nobody knows when, nor what flowed meanwhile
            known &= np.abs(np.diff(record.filled("displacement"), prepend=0.0)) < JUMP
        if record.interval_s >= LONG_S and self.link.driven_by in (*record.binary, "displacement"):
            known &= ~is_lone(record.filled(channel), record.filled(self.link.driven_by))
        if channel in SMOOTHED:
            # as the link's drive was: what is linear then misses nothing by it
            measured = record.smooth(record.filled(channel))
        return _Run(np.nan_to_num(measured), known, self._scale(channel))

    def _running(self, channel: str, predicted: Predicted) -> Errors:
        record, run = self.record, self._runs[channel]
        error = np.where(run.known, predicted[channel] - run.measured, 0.0)
        if channel in predicted.shifted:
            error = self._best_shift(predicted.shifted[channel], run)
        unit = {"flow_L_h": "L/h", "displacement": "1", "control_output": "1"}.get(channel, "K")
        sample = np.arange(len(record))
        return Errors(channel, unit, error, error / run.scale, run.known, record.cycle, self.parts, sample)

    def _scale(self, channel: str) -> FloatArray:
        """Return the standard deviation to weigh errors by: the noise, and more while the link's drive moves."""
        record, noise = self.record, self.record.noise[channel]
        full = float(np.nanmax(record.values[channel])) or self._believed_full(channel)
        least = 0.1 * noise if channel == "flow_L_h" else noise
        resting = np.where(stands(record.filled(channel), full), max(least, 1e-3 * full), noise)
        if self.link.driven_by == "displacement":
            drive = record.drive("displacement")
            steps = np.maximum(np.abs(np.gradient(drive)), np.abs(np.diff(drive, prepend=drive[:1])))
            moves = steps > 3.0 * record.noise["displacement"]
            within = np.where(moves, np.hypot(RIDGE, STEEP * steps) * full, 0.0)
            return np.hypot(np.hypot(resting, within), self._drives[channel])
        return np.hypot(np.maximum(resting, 1e-3), self._drives.get(channel, 0.0))

    def _believed_full(self, channel: str) -> float:
        """Return what a channel should reach that never leaves zero."""
        return float(np.max(self._still[channel])) if channel in self._still else 1.0

    def _best_shift(self, shifted: FloatArray, run: _Run) -> FloatArray:
        """Return the errors after each switch of the drive is put where in its interval it fits best."""
        drive = self.record.filled(self.link.driven_by)
        segment = np.concatenate(([0], np.cumsum(np.diff(drive) != 0)))
        tried = np.where(run.known, shifted - run.measured, 0.0)
        losses = [np.bincount(segment, weights=(error / run.scale) ** 2, minlength=segment[-1] + 1) for error in tried]
        best = np.argmin(losses, axis=0)[segment]
        return np.asarray(tried[best, np.arange(len(segment))])

    # --- what the room shows ---

    def _quarters(self, channel: str) -> FloatArray:
        """Return a measured channel as means over quarters of an hour, the return only where water flows."""
        record = self.record
        parts, merged = merging(self.record.interval_s)
        values = record.values[channel]
        weight = np.isfinite(values).astype(float)
        if channel == "return_temperature_C" and record.has("flow_L_h"):
            flow = record.filled("flow_L_h")
            weight *= np.where(flow > 0.2 * np.nanmax(flow), flow, 0.0)
        return weighted(np.nan_to_num(values), weight, parts * merged)

    def _room(self, channel: str, predicted: FloatArray) -> Errors:
        measured = self._measured[channel]
        parts, merged = merging(self.record.interval_s)
        sample = np.minimum(np.arange(len(measured)) * parts * merged, len(self.record) - 1)
        count = min(len(measured), len(predicted))
        error = np.full(len(measured), np.nan)
        error[:count] = predicted[:count] - measured[:count]
        known = np.isfinite(error) & self.record.settled[sample]
        error = np.where(known, error, 0.0)
        scale_K = self._room_scale_K(channel) * PIECE**0.5
        return Errors(channel, "K", error, error / scale_K, known, self.record.day[sample], self.parts[sample], sample)

    def _room_scale_K(self, channel: str) -> FloatArray | float:
        """Return by what the errors of a room are weighed: what a form leaves, or where it leaves nothing, noise.

        Not so the return: its first minutes of each pulse are blurred whatever the form.
        """
        if self.is_to_the_letter and channel in OF_AIR_AND_FLOOR:
            return np.hypot(STEPPED_K, self.noise(channel))
        return float(np.hypot(room_error(self.belief, channel).typical_K, self.record.noise[channel]))


@dataclass(frozen=True)
class _Switches:
    windows: np.ndarray  # (n,) number of the measured switch that is nearest
    scale_s: FloatArray  # of each of them


@dataclass(frozen=True)
class _Run:
    measured: FloatArray  # (n,)
    known: np.ndarray  # (n,) where it is judged
    scale: FloatArray  # (n,) standard deviation to weigh errors by


def stands(values: FloatArray, full: float) -> np.ndarray:
    """Return where a meter stands still: a zero among others, not noise that is cut off at zero."""
    from scipy.ndimage import uniform_filter1d

    zero = np.abs(values) <= STANDS * full
    return np.asarray(zero & (uniform_filter1d(zero.astype(float), 31) > 0.3))


def is_lone(values: FloatArray, drive: FloatArray) -> np.ndarray:
    """Return samples that stand alone while the drive rests: a pulse or pause came and went between its samples."""
    rests, moved = np.abs(np.diff(drive)) <= RESTS, np.diff(values) / max(float(np.max(values)), 1e-9)
    lone = np.zeros(len(values), dtype=bool)
    still = rests[:-2] & rests[1:-1] & rests[2:]
    there, back = moved[1:-1], moved[2:]
    lone[2:-1] = still & (np.minimum(np.abs(there), np.abs(back)) > LONE) & (np.abs(there + back) < LONE)
    return lone


def softened(whitened: FloatArray) -> FloatArray:
    """Return errors whose square grows straight beyond a few standard deviations (pseudo-Huber)."""
    return np.asarray(SOFT * np.sqrt(2.0 * (np.sqrt(1.0 + (whitened / SOFT) ** 2) - 1.0)))


def _windows(record: Record, channel: str) -> np.ndarray:
    values = record.filled(channel)
    edges = np.flatnonzero(np.diff(values) != 0) + 1
    if len(edges) < 2:
        return np.asarray(record.day - record.day[0])
    middles = (edges[1:] + edges[:-1]) // 2
    return np.searchsorted(middles, np.arange(len(record)), side="right")


def parts_of(record: Record, days_in_turn: bool = False, holds_out: bool = True) -> np.ndarray:
    """Return the part of each sample: fit, then select, then shrinkage of at least three days.

    A chain is fitted to its first heating cycles: of days without heating it could learn nothing. A room is fitted and
    judged on days in turn: what a few days tell of it would not hold in other weather. A short record has cycles, or
    days, in turn for fit and for the rest, which then serves twice.
    """
    days = len(record) * record.interval_s / DAY_S
    in_turn = np.where((record.day if days_in_turn else record.cycle) % 2 == 0, FIT, SELECT)
    if days < SHORT_DAYS or not holds_out:
        return in_turn
    at = (np.arange(len(record)) + 0.5) * record.interval_s / DAY_S
    kept = at >= days - max(LEAST_SHRINK_DAYS, 0.3 * days)
    return np.where(kept, SHRINK, in_turn if days_in_turn else _first(record, kept))


def _first(record: Record, kept: np.ndarray) -> np.ndarray:
    """Return fit for the first cycles of what is not kept back, or where there are too few, of its samples."""
    cycles = np.unique(record.cycle[~kept])
    if len(cycles) < FEWEST_CYCLES:
        return np.where(np.arange(len(record)) < FIT_SHARE * np.count_nonzero(~kept), FIT, SELECT)
    return np.where(record.cycle < cycles[round(FIT_SHARE * len(cycles))], FIT, SELECT)


def losses(errors: Sequence[Errors], part: int) -> Mapping[int, float]:
    """Return the loss of each block of a part."""
    found: dict[int, float] = {}
    for each in errors:
        chosen = each.part == part
        for block, value in zip(each.block[chosen], each.whitened[chosen] ** 2, strict=True):
            found[int(block)] = found.get(int(block), 0.0) + float(value)
    return found
