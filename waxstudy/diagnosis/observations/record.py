"""A record made ready: noise of each channel, smoothed drives, what may be judged, and its parts and blocks."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from waxstudy.dataset.limits import FEW_SAMPLES
from waxstudy.dataset.pulses import Pulses
from waxstudy.dataset.resolution import step
from waxstudy.dataset.stand_ins import FIELDS, GAINS, SUN, StandIn
from waxstudy.diagnosis.observations.noise import ON, estimated, left_out, measured, snapped
from waxstudy.plugin import FloatArray, Inputs

T = TypeVar("T")
SMOOTH_S = 1500.0  # window of the local parabola through a noisy temperature
SETTLING_S, SETTLING_SHARE = 6 * 3600.0, 0.1  # at the start, where nobody knows the state of the blocks
AFTER_GAP_S = 1800.0  # what was missed in a gap is not judged for so long
LOST_S = 6 * 3600.0  # chosen: of a drive of the room, from which a straight line through a gap hides a day's course
FLOW = "flow_L_h"
OUTPUT = "control_output"
SUPPLY = "supply_temperature_C"
DAILY = (SUN, GAINS)  # drives whose course is much the same every day
ROOM_DRIVES = ("outdoor_temperature_C", SUPPLY, FLOW, *DAILY)
LONG_GAP_S, FEW_LOST = 600.0, 3  # up to which a channel that runs on is known between its samples
SPARSE_S = 900.0  # interval from which on a pulse may lie within a sample
FLOWS, FLOWS_ON = 0.2, 0.9  # chosen: of the largest flow, for a return to count; of the usual one, for it to flow on
DAY_S = 86_400.0
REMEMBERED = 2_000_000  # samples that a slot holds of what was made before
CONTINUOUS = ("sensor_temperature_C", "air_temperature_C", "operative_temperature_C")
AIR = ("air_temperature_C", "sensor_temperature_C", "operative_temperature_C")  # that best tells it, first


def settling_s(lasts_s: float) -> float:
    """Return how long a record that lasts so long is not judged at its start [s]."""
    return min(SETTLING_S, SETTLING_SHARE * lasts_s)


class Memory:
    """What was made before, by a key each; of more than `most` what was not asked for longest is forgotten."""

    def __init__(self, most: int) -> None:
        self.most, self.held = most, dict[Hashable, Any]()

    def get(self, key: Hashable, make: Callable[[], T]) -> T:
        found: T = self.held.pop(key) if key in self.held else make()
        self.held[key] = found
        if len(self.held) > self.most:
            del self.held[next(iter(self.held))]
        return found


@dataclass(frozen=True)
class Record:
    """Channels of a dataset on a regular grid; all arrays are (n,), NaN where a sample is missing."""

    interval_s: float
    start_s: float  # start of the first interval, seconds after midnight
    values: Mapping[str, FloatArray]
    stated_noise: Mapping[str, float] = field(default_factory=dict)
    assumed: tuple[str, ...] = ()
    stand_ins: Mapping[str, StandIn] = field(default_factory=dict)  # for what drove the room and was not recorded
    first_weekday: int | None = None  # of day 0, Monday is 0; None where nobody knows
    spreads: Mapping[str, float] = field(default_factory=dict)  # of heat that is assumed, where somebody stated it
    pulses: Pulses | None = None  # in which its flow was counted

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    def has(self, channel: str) -> bool:
        """Whether a channel is there and holds at least a few samples."""
        return channel in self.values and bool(np.isfinite(self.values[channel]).sum() > FEW_SAMPLES)

    def is_still(self, channel: str) -> bool:
        """Whether a channel never changes."""
        return bool(np.nanmax(self.values[channel]) - np.nanmin(self.values[channel]) <= 1e-9)

    @cached_property
    def binary(self) -> frozenset[str]:
        """Channels that are only ever 0 or 1."""
        return frozenset(
            name
            for name in ("control_output", "heating_signal")
            if self.has(name) and np.isin(measured(self.values[name]), (0.0, 1.0)).all()
        )

    @cached_property
    def noise(self) -> Mapping[str, float]:
        """Standard deviation of each channel's noise, at least its rounding; stated, else from second differences.

        That of a flow that was counted in pulses is of its means between them, whatever was stated.
        """
        return {name: self._noise_of(name, values) for name, values in self.values.items()}

    def _noise_of(self, name: str, values: FloatArray) -> float:
        if self.pulses and name == FLOW:
            return float(np.sqrt(np.mean(self.pulses.noise[self.pulses.ends] ** 2)))
        stated = self.stated_noise.get(name)
        return max(stated, left_out(name, measured(values))) if stated else estimated(name, values)

    @cached_property
    def flow_step_L_h(self) -> float:
        """The step in which flow is told: what one pulse in a sample is written as, else rounding; 0 without one."""
        if self.pulses:
            return self.pulses.pulse_L_h
        return step(measured(self.values[FLOW])) if FLOW in self.values else 0.0

    @property
    def pulse_L(self) -> float:
        """The volume of a pulse in which flow was counted, 0 where it was not."""
        return self.pulses.pulse_L_h * self.interval_s / 3600.0 if self.pulses else 0.0

    def between(self, channel: str) -> float:
        """Return what a straight line from sample to sample misses of a channel (root mean square).

        Of a signal that bends evenly it is a quarter of what a line over two intervals misses of the sample between.
        """
        bend = np.diff(self.filled(channel), 2) / 2.0
        return 0.25 * float(np.sqrt(max(0.0, float(np.mean(bend**2)) - 1.5 * self.noise[channel] ** 2)))

    @cached_property
    def _memories(self) -> dict[Hashable, Memory]:
        return {}

    def memory(self, arrays: int, every: int = 1) -> Memory:
        """Return an empty memory for what holds so many arrays as long as the record, or of means over `every` ones."""
        return Memory(max(1, REMEMBERED * every // (arrays * len(self))))

    def remembered(self, slot: Hashable, key: Hashable, make: Callable[[], T], arrays: int = 1) -> T:
        """Return what a slot has for a key, made where it has nothing: most hypotheses change one block alone."""
        return self._memories.setdefault(slot, self.memory(arrays)).get(key, make)

    def filled(self, channel: str) -> FloatArray:
        """Return a channel with its gaps filled: straight for what runs on, held for what switches; read-only.

        Sun and gains have in long gaps what they have at that time of other days.
        """
        return self.remembered(("filled", channel), "", lambda: _read_only(self._filled(channel)))

    def metered(self, channel: str, values: FloatArray) -> FloatArray:
        """Return values of a channel (..., n) as its meter tells them: of a counted flow its means between pulses."""
        return self.pulses.means(values) if self.pulses and channel == FLOW else values

    def filled_or_zero(self, channel: str) -> FloatArray:
        """Return a filled channel, zeros where there is none: for what then has no part in the result."""
        return self.filled(channel) if self.has(channel) else np.zeros(len(self))

    def drive(self, channel: str) -> FloatArray:
        """Return what drives the next segment: smoothed where noisy, snapped where it rests at an end; read-only."""
        return self.remembered(("drive", channel), "", lambda: _read_only(self._drive(channel)))

    def _usual(self, channel: str) -> FloatArray:
        """Return a drive's mean at the same time of all days (n,); NaN where it is known on none."""
        slot = (self.clock_h * 3600.0 // self.interval_s).astype(int)
        known = np.isfinite(self.values[channel])
        count = np.bincount(slot[known], minlength=slot.max() + 1)
        total = np.bincount(slot[known], self.values[channel][known], minlength=len(count))
        return np.asarray(np.divide(total, count, out=np.full(len(count), np.nan), where=count > 0)[slot])

    def _lost(self, channel: str) -> Iterator[slice]:
        """Yield the long gaps of what drives a room. What is blank at night on all days is none of the sun's."""
        missing = ~np.isfinite(self.values[channel])
        if channel == SUPPLY and self.has(FLOW):
            missing &= ~(self.values[FLOW] <= 0.0)  # how warm water is that stands is of no account
        if channel in DAILY:
            missing &= np.isfinite(self._usual(channel))
        lost = np.diff(np.concatenate(([False], missing, [False])).astype(int))
        for start, end in zip(np.flatnonzero(lost > 0).tolist(), np.flatnonzero(lost < 0).tolist(), strict=True):
            if (end - start) * self.interval_s > LOST_S:
                yield slice(start, end)

    def _filled(self, channel: str) -> FloatArray:
        values = self.values[channel]
        if channel in DAILY and (gaps := list(self._lost(channel))):
            values, usual = values.copy(), self._usual(channel)
            for gap in gaps:
                values[gap] = usual[gap]
        known = np.flatnonzero(np.isfinite(values))
        if channel in self.binary:
            last = np.searchsorted(known, np.arange(len(values)), side="right") - 1
            held: FloatArray = np.take(values, known[np.clip(last, 0, None)])
            return held
        return np.interp(np.arange(len(values)), known, values[known])

    def smooth(self, values: FloatArray) -> FloatArray:
        """Return a local parabola through a signal (Savitzky and Golay); where the samples are dense enough to help."""
        width = self._width
        if not width:
            return values
        from scipy.signal import savgol_filter

        return np.asarray(savgol_filter(values, width, polyorder=2))

    @property
    def _width(self) -> int:
        """Samples of a parabola, 0 where they are too far apart."""
        width = round(SMOOTH_S / self.interval_s) // 2 * 2 + 1
        return 0 if width < 5 or len(self) <= width else width

    @property
    def smoothed_noise(self) -> float:
        """Return the share of white noise that smoothing leaves: that of a parabola's middle."""
        w = self._width
        return float(np.sqrt(0.75 * (3.0 * w**2 - 7.0) / (w * (w**2 - 4.0)))) if w else 1.0

    def _drive(self, channel: str) -> FloatArray:
        values = self.filled(channel)
        if channel in CONTINUOUS:
            return self.smooth(values)
        if channel == "displacement":
            return snapped(values, self.noise[channel])
        return values

    def is_gap(self, channel: str) -> np.ndarray:
        """Return where a channel was lost, and for a while after what may have hidden something.

        Of a channel that switches a gap with a switch, of one that runs on a long one.
        """
        missing = ~np.isfinite(self.values[channel])
        changed = np.zeros(len(self), dtype=bool)
        filled, after = self.filled(channel), max(1, round(AFTER_GAP_S / self.interval_s))
        is_binary, long = channel in self.binary, max(FEW_LOST, round(LONG_GAP_S / self.interval_s))
        ends: list[int] = np.flatnonzero(missing[:-1] & ~missing[1:]).tolist()
        for end in ends:
            start = end
            while start >= 0 and missing[start]:
                start -= 1
            has_switched, is_long = filled[max(start, 0)] != filled[end + 1], end - start > long
            if has_switched if is_binary else is_long:
                changed[max(start, 0) : end + 1 + after] = True
        return missing | changed

    @cached_property
    def settled(self) -> np.ndarray:
        """Return which samples lie after the start, where nobody knows the blocks' state."""
        return np.arange(len(self)) >= round(settling_s(len(self) * self.interval_s) / self.interval_s)

    @cached_property
    def driven(self) -> np.ndarray:
        """Samples (n,) in which what drives every room is known."""
        return self.driven_by(*ROOM_DRIVES)

    def driven_by(self, *channels: str) -> np.ndarray:
        """Return samples (n,) in which what drives a room is known: not in a long gap of it, nor so soon after one."""
        known = np.ones(len(self), dtype=bool)
        after = round(SETTLING_S / self.interval_s)
        for channel in filter(self.has, channels):
            for gap in self._lost(channel):
                known[gap.start : gap.stop + after] = False
        return known

    @cached_property
    def usual_flow_L_h(self) -> float:
        """The usual one of the largest flows, with the valve open; 0 where nothing flows."""
        if self.pulses:
            return self.pulses.usual_L_h
        flow = self.values[FLOW]
        large = flow[flow > 0.8 * np.nanquantile(flow, 0.99)]
        return float(np.median(large)) if len(large) else 0.0

    @cached_property
    def flowing(self) -> np.ndarray:
        """Samples (n,) in which a return temperature is of water that flows.

        Where samples are far apart it must flow throughout: otherwise they hold water that stood and cooled.
        """
        flow = self.filled(FLOW)
        if self.interval_s < SPARSE_S:
            return np.asarray(flow > FLOWS * np.nanmax(flow))
        signal = self.values.get("heating_signal", np.ones(len(self)))  # lower, it was off for a part of the sample
        return np.asarray((flow > FLOWS_ON * self.usual_flow_L_h) & ~(signal < FLOWS_ON))

    @property
    def has_return(self) -> bool:
        """Whether a return temperature is there and of flowing water in at least a few samples."""
        both = self.has("return_temperature_C") and self.has(FLOW)
        return both and bool(
            (self.flowing & np.isfinite(self.values["return_temperature_C"]) & self.settled).sum() > FEW_SAMPLES
        )

    @cached_property
    def day(self) -> np.ndarray:
        """Number of the day of each sample, from 0."""
        return ((self.start_s + (np.arange(len(self)) + 0.5) * self.interval_s) // DAY_S).astype(int)

    @cached_property
    def clock_h(self) -> FloatArray:
        """Hour of the day of the middle of each sample's interval (n,)."""
        return np.asarray((self.start_s + (np.arange(len(self)) + 0.5) * self.interval_s) % DAY_S / 3600.0)

    @cached_property
    def rises_s(self) -> FloatArray:
        """Times after midnight [s] at which the heating signal switches on, in the middle of an interval."""
        rises = np.flatnonzero(np.diff(self.filled("heating_signal")) > 0.5) + 1
        return np.asarray(self.start_s + (rises + 0.5) * self.interval_s)

    @cached_property
    def cycle(self) -> np.ndarray:
        """Number of the heating cycle of each sample, from the middle of a pause; the day where nothing switches."""
        for channel in ("heating_signal", "control_output", FLOW, "displacement"):
            if self.has(channel):
                values = self.filled(channel)
                on: np.ndarray = values > ON * max(float(values.max()), 0.0)
                starts = np.flatnonzero(on[1:] & ~on[:-1]) + 1
                if len(starts) >= 6:
                    return np.searchsorted(_before(on, starts), np.arange(len(self)), side="right")
        return self.day

    @property
    def sensed_channel(self) -> str:
        """The channel that tells best what the controller reads, "" where no room temperature is recorded."""
        return next(filter(self.has, ("sensor_temperature_C", *AIR)), "")

    @property
    def has_inputs(self) -> bool:
        """Whether what drives a room is recorded."""
        return bool(self.sensed_channel) and self.has("outdoor_temperature_C") and self.has("supply_temperature_C")

    @cached_property
    def inputs(self) -> Inputs:
        """What drove the room, or stands in for it; raise `KeyError` naming a channel that is missing."""
        air = self.drive(self.air_channel)
        return Inputs(
            interval_s=self.interval_s,
            start_s=self.start_s,
            outdoor_C=self.smooth(self.filled("outdoor_temperature_C")),
            supply_C=self.smooth(self.filled("supply_temperature_C")),
            solar_W=self._heat(SUN),
            gains_W=self._heat(GAINS),
            ventilation_C=self._optional("ventilation_supply_temperature_C"),
            air_C=air,
            flow_L_h=self._optional(FLOW),
            signal=self._optional("heating_signal"),
            neighbour_C=self._optional("neighbour_temperature_C"),
            stand_ins=frozenset(FIELDS[channel] for channel in self.stand_ins),
        )

    def _heat(self, channel: str) -> FloatArray:
        """Return a drive, or what stands in for it; none of what the room does not take."""
        return self.stand_ins[channel].values if channel in self.stand_ins else self.filled_or_zero(channel)

    def _optional(self, channel: str) -> FloatArray | None:
        return self.filled(channel) if self.has(channel) else None

    @property
    def air_channel(self) -> str:
        """The channel that tells the room's air best."""
        if found := next(filter(self.has, AIR), ""):
            return found
        raise KeyError(AIR[0])


def _read_only(values: FloatArray) -> FloatArray:
    values.flags.writeable = False
    return values


def _before(on: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return the sample halfway through the pause before each start."""
    stops = np.flatnonzero(~on[1:] & on[:-1]) + 1
    places = np.searchsorted(stops, starts) - 1
    last = np.where(places >= 0, stops[np.clip(places, 0, None)], 0) if len(stops) else np.zeros_like(starts)
    return np.asarray((last + starts) // 2)
