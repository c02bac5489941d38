"""Segments: stretches of the loop between recorded channels, each driven by the one and judged on the next."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from waxstudy.diagnosis.criteria import ROOM_STAGES
from waxstudy.diagnosis.model.beginning import begun
from waxstudy.diagnosis.model.conventions import AFTER, BEFORE, LATE, LONG_S, MEAN_WORDS, PLAIN, RAW, Convention
from waxstudy.diagnosis.model.modulator_clock import late_s
from waxstudy.diagnosis.model.opening_path import cells, path
from waxstudy.diagnosis.model.perturbation import STILL, Perturbation
from waxstudy.diagnosis.model.room_response import (
    OF_AIR_AND_FLOOR,
    OF_ROOM,
    Predicted,
    built,
    full_flow_L_h,
    means,
    response_to_heat,
    room_response,
    samples_of_mean,
)
from waxstudy.diagnosis.model.shares import SETTLED_S, by_shares, hidden_pulses
from waxstudy.diagnosis.observations.record import CONTINUOUS, FLOW, SUPPLY, Record
from waxstudy.plugin import CHAIN, Belief, FloatArray, Room, SimulationError
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.recorded import believed_supply_C
from waxstudy.simulation.replay import replay
from waxstudy.study.model import Choice

# what a block of each kind shows to a logger
SHOWN = {
    "sensor": "sensor_temperature_C",
    "controller": "control_output",
    "modulator": "heating_signal",
    "actuator": "displacement",
    "valve": FLOW,
}
STEP_S = 5.0
ROUGH_STEP_S = 30.0  # chosen: of searches, which end with a look in short steps; it changes no name of 99 records
# by kind: at the ends of the intervals (n,), their means (n,), and what depends on when a switch was thrown (shifts, n)
Replayed = tuple[Mapping[str, FloatArray], Mapping[str, FloatArray], Mapping[str, FloatArray]]


@dataclass(frozen=True)
class Segment:
    """A stretch of stages. `driven_by` is a channel, `judged` are channels; `conventions`: ways to read the record."""

    stages: tuple[str, ...]
    driven_by: str
    judged: tuple[str, ...]
    conventions: tuple[Convention, ...] = (PLAIN,)
    by_shares: bool = False  # its drive is a share of time, as long samples hide pulses

    @property
    def name(self) -> str:
        return "+".join(self.stages)

    @property
    def is_supply(self) -> bool:
        """Whether it is the heating curve, beside the recorded supply temperature."""
        return self.judged == (SUPPLY,)

    @property
    def with_room(self) -> bool:
        return "room" in self.stages

    def predict(
        self,
        record: Record,
        belief: Belief,
        convention: Convention = PLAIN,
        perturbation: Perturbation = STILL,
        is_fine: bool = False,  # of a room: in short steps, with valves that move within intervals
    ) -> Predicted:
        """Return what the belief makes of the measured drive, each judged channel (n,) or (quarters,) for a room's.

        Raises `SimulationError`, and `ValueError` from an impossible room.
        """
        if self.is_supply:
            return Predicted({SUPPLY: _curve_C(record, belief)})
        shown, flow = self._flow(record, belief, convention, perturbation)
        if self.with_room:
            shown.update(room_response(record, belief, flow, convention, is_fine))
        shifted = {channel: shown.shifted[channel] for channel in self.judged if channel in shown.shifted}
        return Predicted({channel: shown[channel] for channel in self.judged}, shifted)

    def warmed(
        self,
        record: Record,
        belief: Belief,
        convention: Convention,
        heats_W: Iterable[Mapping[str, FloatArray]],
        repeats_first_day: bool = False,
    ) -> Iterator[Predicted]:
        """Yield by how much each course of heat [W], by field of the inputs (n,), changes what is predicted of a room.

        With `repeats_first_day` a course was in the week before as it is on the first day.
        """
        _, flow = self._flow(record, belief, convention, STILL)
        return response_to_heat(record, belief, flow, convention, heats_W, repeats_first_day)

    def _flow(
        self, record: Record, belief: Belief, convention: Convention, perturbation: Perturbation
    ) -> tuple[Predicted, FloatArray]:
        """Return what the chain shows, and what flows through the room: as predicted, or as recorded."""
        chain = [stage for stage in self.stages if stage in CHAIN]
        shown = self._chain(record, belief, convention, perturbation, chain) if chain else Predicted()
        return shown, shown.get(FLOW, record.filled_or_zero(FLOW))

    def _chain(
        self, record: Record, belief: Belief, convention: Convention, perturbation: Perturbation, chain: list[str]
    ) -> Predicted:
        blocks, first = {kind: belief.blocks[kind] for kind in chain if kind in belief.blocks}, chain[0]
        shown = Predicted()
        signal, jump = self._drive(record, convention, perturbation), None
        if first == "sensor":
            if SHOWN["sensor"] in self.judged:
                shown[SHOWN["sensor"]] = self._sensor(record, belief, convention, perturbation)
            if not convention.is_before and self.driven_by == SHOWN["sensor"]:
                first = "controller"
                blocks.pop("sensor", None)
        elif self.driven_by in record.binary:
            jump = perturbation.jump(record)
        start_s = record.start_s - late_s(record, blocks.get("modulator"))
        step_s = ROUGH_STEP_S if convention.is_rough else STEP_S
        has_cells = jump is not None and not perturbation.random

        def made() -> Replayed:
            if hides := self._hidden(blocks, first, signal, record, step_s):
                return hides
            drive = blocks, first, signal, record.filled_or_zero("setpoint_C"), record.interval_s, start_s
            # a switch may have been thrown anywhere in its interval, else the signal runs from sample to sample
            output = self._output(record, chain)
            return _thrown(*drive, step_s) if has_cells else (*replayed(*drive, jump, "valve", step_s, output), {})

        ways = convention.is_raw, convention.is_late, step_s
        slot, key = ("chain", first, self.driven_by), (*ways, start_s, *blocks.items())
        # ends and means; a link may have no block, and passes on what it gets
        arrays = 2 * (max(2, cells(record.interval_s)) if jump is not None else max(1, len(blocks)))
        ends, averages, shifted = made() if perturbation.random else record.remembered(slot, key, made, arrays)
        shown.update({SHOWN[kind]: ends[kind] for kind in chain if kind in ends and kind != "sensor"})
        shown.update(self._logged_as_means(record, ends, averages))
        if "valve" in chain:
            full_L_h = full_flow_L_h(record, belief)
            shown[FLOW] = record.metered(FLOW, averages["valve"] * full_L_h)
            if "valve" in shifted:
                shifted = {**shifted, "valve": record.metered(FLOW, shifted["valve"] * full_L_h)}
        if convention.is_raw and "controller" in chain and SHOWN["controller"] not in record.binary:
            shown[SHOWN["controller"]] = record.smooth(shown[SHOWN["controller"]])
        shown.shifted = {SHOWN[kind]: each for kind, each in shifted.items()}
        return shown

    def _output(self, record: Record, chain: list[str]) -> FloatArray | None:
        """Return a recorded output that runs on, which tells the state in which its controller begins."""
        channel = SHOWN["controller"]
        is_told = "controller" in chain and channel in self.judged and channel not in record.binary
        return record.values[channel] if is_told else None

    def _hidden(
        self, blocks: Mapping[str, Choice], first: str, signal: FloatArray, record: Record, step_s: float
    ) -> Replayed | None:
        """Return what blocks make of a drive whose course within a sample nobody logged; None where that is known."""
        if self.by_shares:
            return *by_shares(signal, lambda on: _settled(blocks, first, on, step_s)), {}
        return _along_its_path(blocks, signal, record, step_s) if self.driven_by == "displacement" else None

    def _logged_as_means(
        self, record: Record, ends: Mapping[str, FloatArray], averages: Mapping[str, FloatArray]
    ) -> Iterator[tuple[str, FloatArray]]:
        """Yield the means of what only switches, by channel, where a record has it between off and on."""
        for kind in averages.keys() & {"controller", "modulator"}:
            channel = SHOWN[kind]
            if channel in self.judged and channel not in record.binary and np.isin(ends[kind], (0.0, 1.0)).all():
                yield channel, averages[kind]

    def _drive(self, record: Record, convention: Convention, perturbation: Perturbation) -> FloatArray:
        if convention.is_raw:
            return perturbation.raw(record, self.driven_by)
        if convention.is_late:
            values = perturbation.temperature(record, self.driven_by)
            return np.concatenate((values[:1], values[:-1]))
        if self.driven_by in CONTINUOUS:
            return perturbation.temperature(record, self.driven_by)
        if self.driven_by == "control_output" and self.driven_by not in record.binary:
            return perturbation.output(record)
        return perturbation.opening(record) if self.driven_by == "displacement" else record.drive(self.driven_by)

    @staticmethod
    def _sensor(record: Record, belief: Belief, convention: Convention, perturbation: Perturbation) -> FloatArray:
        """Return the reading that the sensor makes of the air, or the air where it was logged before the sensor."""
        air = perturbation.temperature(record, record.air_channel)
        if convention.is_before or "sensor" not in belief.blocks:
            return air
        sensor = belief.blocks["sensor"]

        def made() -> FloatArray:
            timing = record.interval_s, record.start_s
            return replayed({"sensor": sensor}, "sensor", air, air, *timing, last="sensor")[0]["sensor"]

        return made() if perturbation.random else record.remembered("sensor", sensor, made)


def _along_its_path(blocks: Mapping[str, Choice], opening: FloatArray, record: Record, step_s: float) -> Replayed:
    """Return what a valve makes of an opening that was sampled, at the ends of the intervals and their means."""
    fine, parts = path(opening, record.interval_s), cells(record.interval_s)
    ends, mean = replayed(blocks, "valve", fine, fine, record.interval_s / parts, record.start_s, step_s=step_s)
    return {"valve": ends["valve"][parts - 1 :: parts]}, {"valve": means(mean["valve"], parts)}, {}


def _thrown(
    blocks: Mapping[str, Choice],
    first: str,
    signal: FloatArray,
    setpoint_C: FloatArray,
    interval_s: float,
    start_s: float,
    step_s: float,
) -> Replayed:
    """Return what a switch drives, thrown in the middle of its interval, and in each of its cells."""
    count, parts = len(signal), max(2, cells(interval_s))
    signal, setpoint_C = np.repeat(signal, parts), np.repeat(setpoint_C, parts)
    halfway = np.full(len(signal), 0.5)
    ends, averages = replayed(blocks, first, signal, setpoint_C, interval_s / parts, start_s, halfway, step_s=step_s)

    def by_shift(each: FloatArray) -> FloatArray:
        """Return what lies a number of cells before the end of each interval (shifts, n)."""
        return each.reshape(count, parts)[:, ::-1].T

    shifted = {kind: by_shift(ends[kind]) for kind in blocks if kind == "actuator"}
    shifted["valve"] = np.diff(by_shift(np.cumsum(averages["valve"])), prepend=0.0) / parts
    middle = parts // 2
    shown = {kind: by_shift(each)[middle].copy() for kind, each in ends.items()}  # not all of what it is cut from
    return shown, {"valve": shifted["valve"][middle]}, shifted


def _settled(blocks: Mapping[str, Choice], first: str, drive: float, step_s: float) -> Mapping[str, FloatArray]:
    """Return what blocks give that have had the same drive for long."""
    drives = np.full(2, drive)
    return replayed(blocks, first, drives, np.zeros(2), SETTLED_S, 0.0, step_s=step_s)[0]


def segments(record: Record, belief: Belief) -> list[Segment]:
    """Return the segments that a record can be cut into; a missing channel merges its neighbours into one.

    Where no controller is believed, or not known what it reads or its setpoint, the first recorded channel behind it
    drives what follows.
    """
    found: list[Segment] = []
    since: str | None = "sensor"
    driven_by, is_driven = record.sensed_channel, _is_driven(record, belief)
    for kind in CHAIN[1:]:
        if since is not None and record.has(SHOWN[kind]):
            stages = CHAIN[CHAIN.index(since) : CHAIN.index(kind) + 1]
            if belief.blocks and (since != "sensor" or is_driven):
                found.append(_segment(record, stages, driven_by, SHOWN[kind]))
            since, driven_by = _after(kind), SHOWN[kind]
    # a return says nothing without knowing when water flowed
    shown = [channel for channel in OF_ROOM if channel != "return_temperature_C" or record.has_return]
    room = tuple(channel for channel in shown if record.has(channel))
    if room and belief.room and belief.inputs and (since != "sensor" or is_driven):
        rest = CHAIN[CHAIN.index(since) :] if since is not None else ()
        segment = _segment(record, (*rest, *ROOM_STAGES), driven_by, *room)
        found.append(replace(segment, conventions=tuple(_of_room(segment.conventions, belief.room, record))))
        if SUPPLY not in record.assumed and _states_curve(belief.room):
            found.append(Segment(("emitter",), "outdoor_temperature_C", (SUPPLY,)))
    hidden = hidden_pulses(record, belief)
    return [replace(each, by_shares=each.driven_by in hidden) for each in found]


def _states_curve(room: Choice) -> bool:
    assert issubclass(room.component, Room)
    return room.component.states_curve(room.parameters)


def _curve_C(record: Record, belief: Belief) -> FloatArray:
    """Return the believed heating curve's supply temperature, and what an effect adds to the recorded one."""
    assert belief.room
    assert belief.inputs
    added_K = belief.inputs.supply_C - record.inputs.supply_C
    return believed_supply_C(built(belief.room), belief.inputs) + added_K


def _is_driven(record: Record, belief: Belief) -> bool:
    """Whether a controller is believed, and known what it reads and its setpoint."""
    return "controller" in belief.blocks and record.has("setpoint_C") and bool(record.sensed_channel)


def _segment(record: Record, stages: tuple[str, ...], driven_by: str, *judged: str) -> Segment:
    if stages[0] != "sensor":
        return Segment(stages, driven_by, judged)
    is_logged = driven_by == SHOWN["sensor"]
    if is_logged and record.has("air_temperature_C"):
        # an output that never changes shows nothing of its controller, and hides nothing of the sensor
        is_alone = len(judged) == 1 and record.is_still(judged[0]) and _moves(record)
        judged = (SHOWN["sensor"],) if is_alone else (SHOWN["sensor"], *judged)
    late = (LATE,) if judged[-1] in record.binary else ()  # what runs on moves too little in a sample to tell
    ways = (AFTER, BEFORE, RAW) if is_logged else (PLAIN,)
    return Segment(stages, driven_by, judged, conventions=(*ways, *late))


def _moves(record: Record) -> bool:
    """Whether anything of the chain ever moves: a record in which nothing does shows no loop."""
    return any(record.has(SHOWN[kind]) and not record.is_still(SHOWN[kind]) for kind in CHAIN[1:])


def _after(kind: str) -> str | None:
    """Return the kind of block that gets what one of a kind gives, None behind the valve."""
    place = CHAIN.index(kind) + 1
    return CHAIN[place] if place < len(CHAIN) else None


def _of_room(conventions: Iterable[Convention], room: Choice, record: Record) -> Iterator[Convention]:
    """Yield each convention with each way to mean the sun's heat, and with means where samples are far apart."""
    assert issubclass(room.component, Room)
    factors = room.component.solar_readings(room.parameters) if record.has("solar_gain_W") else {}
    for convention, (words, factor) in product(conventions, (factors or {"": 1.0}).items()):
        for is_mean in (False, True) if record.interval_s >= LONG_S else (False,):
            told = " ".join(filter(None, (convention.words, words, MEAN_WORDS if is_mean else "")))
            yield replace(convention, words=told, solar_factor=factor, is_mean=is_mean)


def replayed(
    blocks: Mapping[str, Choice],
    first: str,
    signal: FloatArray,
    setpoint_C: FloatArray,
    interval_s: float,
    start_s: float,
    jump: FloatArray | None = None,
    last: str = CHAIN[-1],
    step_s: float = STEP_S,
    output: FloatArray | None = None,
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Return what `replay` makes of blocks at a step that divides the interval, `step_s` or somewhat less.

    A controller begins in the state that its recorded output (n,) tells, where that is given.
    """
    step_s = interval_s / max(1, int(np.ceil(interval_s / step_s)))
    drive = first, signal, setpoint_C
    begins = {} if output is None else begun(blocks, *drive, output, interval_s, start_s, step_s)
    chain = Chain(blocks, step_s, begins)
    return replay(chain, first, signal, setpoint_C, interval_s=interval_s, start_s=start_s, jump=jump, last=last)


class Prediction:
    """Predicts one segment; what shorter steps change of the room as believed is added to every belief.

    With the same flow they change as much of any other. Not of the return, whose first minutes of each pulse are a
    matter of form, unless that is as believed (`is_exact_room`).
    """

    def __init__(self, segment: Segment, record: Record, belief: Belief, is_exact_room: bool) -> None:
        self.segment, self.record, self.belief, self.is_exact_room = segment, record, belief, is_exact_room
        self._refinements: dict[Convention, Mapping[str, FloatArray]] = {}
        # a room's are means, so that many can be kept
        self._made = record.memory(arrays=4, every=samples_of_mean(record.interval_s))

    def remembered(self, key: Hashable, belief: Callable[[], Belief], convention: Convention) -> Predicted | None:
        """Return what a belief predicts of a room, by its key, or None where it cannot; problems share it."""

        def made() -> Predicted | None:
            try:
                return self(belief(), convention)
            except (SimulationError, ValueError, ArithmeticError):
                return None

        return self._made.get((key, convention), made) if self.segment.with_room else made()

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
        if not self.segment.with_room or self.segment.driven_by != FLOW:
            return {}
        if convention not in self._refinements:
            coarse, fine = (
                self.segment.predict(self.record, self.belief, convention, is_fine=way) for way in (False, True)
            )
            refined = [channel for channel in fine if channel in OF_AIR_AND_FLOOR or self.is_exact_room]
            changes = {channel: fine[channel] - coarse[channel] for channel in refined}
            self._refinements[convention] = {channel: np.nan_to_num(change) for channel, change in changes.items()}
        return self._refinements[convention]
