"""A diagnosis: what is found, in numbers, as its JSON says it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from math import inf, nan
from typing import Any, Literal

import pandas as pd

IMPACTS = ("heat_percent", "air_K")
Part = Literal["room", "drives", "chain"]  # of a loop: drives are sun, gains and supply
Verdict = Literal["effect", "group", "unknown", "untestable", "none", "room"]
NORMAL = 1.96  # standard deviations to either side that hold 95 % of a normal distribution


@dataclass(frozen=True)
class Interval:
    """A figure with its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Regime:
    """A part of a stage's gap: its root mean square there, and its share of the whole gap's square."""

    name: str
    gap: float
    share: float


@dataclass(frozen=True)
class StageGap:
    """The gap of one judged channel; `stage` names the merged stages that lie behind it, joined by '+'."""

    stage: str
    channel: str
    unit: str
    gap: float  # with what is believed
    gap_after: float  # with the effects found
    noise_floor: float
    impact: Mapping[str, float]  # of IMPACTS: the modelled output in place of the measured one
    regimes: Sequence[Regime]
    autocorrelation: float  # of the error, from one sample to the next
    separate_by: str = ""  # the channel that would tell merged stages apart
    posterior: Mapping[str, float] = field(default_factory=dict)  # of hypotheses

    @property
    def over_floor(self) -> float:
        """The gap in units of its noise floor; infinite above a floor of nothing."""
        return in_floors(self.gap, self.noise_floor)

    def regime_over_floor(self, regime: Regime) -> float:
        return in_floors(regime.gap, self.noise_floor)

    def described(self) -> dict[str, Any]:
        regimes = [{**asdict(each), "over_floor": self.regime_over_floor(each)} for each in self.regimes]
        impact = {name: self.impact.get(name, nan) for name in IMPACTS}
        return {**as_data(self), "over_floor": self.over_floor, "impact": impact, "regimes": regimes}


def in_floors(gap: float, floor: float) -> float:
    """Return a gap in units of its noise floor; without noise any gap is without bounds."""
    return gap / floor if floor > 0.0 else (inf if gap > 0.0 else 0.0)


@dataclass(frozen=True)
class Alternative:
    """Another member of a group, at the values that it was chosen with; nobody looked for their intervals."""

    name: str
    stage: str
    sentence: str
    parameters: Mapping[str, Interval]  # without bounds


GROWING = "growing"  # from nothing at the start of a record


@dataclass(frozen=True)
class When:
    """When an effect acts: in words, and the hours since the record began, from and to."""

    pattern: str
    spans_h: Sequence[tuple[float, float]]

    @property
    def told(self) -> str:
        return f"{GROWING} from nothing (the value is its mean)" if self.pattern == GROWING else self.pattern


@dataclass(frozen=True)
class Calibrated:
    """What differs from the documents always, by a healthy record: a value with its 95 % interval.

    Of an effect's parameter, as factor or in its unit; of what the room itself says is uncertain, a departure, or the
    factor whose logarithm that is.
    """

    name: str
    value: Interval
    documented: float
    sentence: str
    part: Part
    is_clear: bool = False  # it differs by more than is noticeable, and by its interval, if it has one, not by chance
    description: str = ""  # what a value of the room is, as a factor on something


@dataclass(frozen=True)
class BaselineFit:
    """How well what is believed, as calibrated, follows a channel of the healthy record.

    CV(RMSE) and NMBE are over the mean of what was measured (ASHRAE Guideline 14), of temperatures in degrees Celsius.
    """

    channel: str
    unit: str
    rmse: float
    cv_rmse_percent: float
    nmbe_percent: float


@dataclass(frozen=True)
class FoundEffect:
    """An effect that the record shows, or the best of a group that it cannot tell apart."""

    name: str
    stage: str
    sentence: str
    group: Sequence[str]
    parameters: Mapping[str, Interval]
    inclusion: float
    p: float
    channel: str
    gap_before: float
    gap_after: float
    noise_floor: float
    shrink: Interval  # on days that its fit has not seen
    is_held_out: bool = True  # whether these took no part in choosing it either; they do where it was weighed
    alternatives: Sequence[Alternative] = ()  # the rest of its group
    probability: float = nan  # that it, or one of its group, is there; where hypotheses were weighed
    slight: str = ""  # why it hardly matters, where it is there and hardly does
    when: When | None = None
    at_end: Sequence[str] = ()  # parameters whose value is the least or the most that is tried


@dataclass(frozen=True)
class Unexplained:
    """A gap that no effect of the library explains."""

    stage: str
    gap: float
    noise_floor: float
    p: float
    is_room_form: bool = False  # the form of the room's model, which alone is no finding
    is_covered: bool = False  # within what the believed model's published uncertainty covers
    is_of_drives: bool = False  # as little as what drives the room and was not recorded could make
    channel: str = ""  # that it is judged by
    probability: float = nan  # that something unknown is there, or where it `is_nameless` anything
    when: When | None = None  # where it is missed by more at certain times
    like: str = ""  # what it looks as if, where an instrument explains it
    is_nameless: bool = False  # something is surely amiss, which may be of the library: no effect is sure enough

    @property
    def is_finding(self) -> bool:
        return not (self.is_room_form or self.is_covered or self.is_of_drives)


class Lack(StrEnum):
    """Why an effect could not be shown."""

    NOT_RECORDED = "not recorded"  # no channel shows its stage
    TOO_LITTLE = "too little"  # of what was recorded, or nothing happened in it
    NOT_EXCITED = "not excited"  # what happened would look the same with it
    NOT_UNDERSTOOD = "not understood"  # too much stays of the room


@dataclass(frozen=True)
class Untestable:
    """An effect that this record could not show."""

    name: str
    reason: str
    lack: Lack


@dataclass(frozen=True)
class Tried:
    """An effect that was fitted: what it gains on days that took no part in the fit."""

    name: str
    stage: str
    gain: float
    p: float
    share: float  # of the gap above the noise floor
    channel: str = ""  # of which
    why: str = ""  # it is not named; empty of what was found and of its group
    probability: float = nan  # that it is there, alone or beside others; not told of a room without a healthy record


@dataclass(frozen=True)
class BeforeAfter:
    """A figure of the closed loop: as measured, as believed, and with the effects found."""

    measured: float
    before: float
    after: float


@dataclass(frozen=True)
class Measurement:
    """What to measure next, and which effects it would tell apart or make testable."""

    what: str
    splits: Sequence[str]


@dataclass(frozen=True)
class Step:
    """The gap of a channel with one more effect, for the waterfall."""

    channel: str
    unit: str
    effect: str  # empty for what is believed alone
    gap: float


@dataclass(frozen=True)
class HeatPiece:
    """Heat into the room that would explain what was measured in some hours of the record, with its 95 % interval."""

    from_h: float  # since the record began
    to_h: float
    heat_W: float
    low_W: float
    high_W: float


@dataclass(frozen=True)
class HeatBy:
    """The mean of that heat where a driver is between bounds, or as it is named: as believed, and with the effects."""

    driver: str
    name: str
    hours: float
    before: Interval
    after: Interval
    beside: Interval  # by how much the first differs from the mean over the whole record


@dataclass(frozen=True)
class HeatPer:
    """By how much that heat changes with a driver, in watts per its unit; `share` is that of its variance."""

    driver: str
    unit: str
    before: Interval
    after: Interval
    share: float


@dataclass(frozen=True)
class MissingHeat:
    """Which heat into the room would explain what was measured: positive where the room has more than is believed."""

    before: Sequence[HeatPiece] = ()  # as believed
    after: Sequence[HeatPiece] = ()  # with the effects found
    mean_before: Interval | None = None
    mean_after: Interval | None = None
    usual_W: float = nan  # standard deviation of what may be of it where nothing is wrong; by a healthy record
    by: Sequence[HeatBy] = ()
    per: Sequence[HeatPer] = ()
    sentence: str = ""
    is_resolved: bool = False  # whether the data tell that there is any


@dataclass(frozen=True)
class NeighbourRoom:
    """A room beside others: what they and the weather miss of its air, and what its own recorded heat does."""

    name: str
    rms_K: float
    own_heat_K_kW: Interval | None = None  # mean warming in three hours of a kilowatt; none if it is not known


@dataclass(frozen=True)
class NeighbourEvent:
    """Times at which a room departs from its neighbours: the mean departure in its hours, with 95 % intervals."""

    room: str
    when: str  # in the record's clock, local standard time
    spans_h: Sequence[tuple[float, float]]  # from and to, since `RoomsBeside.begins`
    size_K: Interval
    heat_W: Interval | None  # that would do the same; none where no heat or capacity is known or assumed
    heat_from: str  # how it is known
    reading: str
    together_with: Sequence[str]  # rooms that depart alike at the same time
    probability: float


@dataclass(frozen=True)
class RoomCourse:
    """A room's air as measured, and as its neighbours and what drives it have it: means around `hours`."""

    hours: Sequence[float]  # since `RoomsBeside.begins`
    measured_C: Sequence[float]
    expected_C: Sequence[float]


@dataclass(frozen=True)
class RoomsBeside:
    """Rooms as each other's control."""

    rooms: Sequence[NeighbourRoom] = ()
    events: Sequence[NeighbourEvent] = ()
    sentence: str = ""
    courses: Mapping[str, RoomCourse] = field(default_factory=dict)  # of rooms with events
    begins: str = ""  # first moment of the whole record, in its own clock; a loop may be judged on some days only


@dataclass(frozen=True)
class Diagnosis:
    """Where the gap lies, which effect causes it, how far it shrinks."""

    dataset: str
    verdict: Verdict
    summary: str  # a sentence or two
    stages: Sequence[StageGap]
    effects: Sequence[FoundEffect]
    unexplained: Sequence[Unexplained]
    untestable: Sequence[Untestable]
    tried: Sequence[Tried]
    closed_loop: Mapping[str, BeforeAfter]  # heat_kWh_m2, air_mae_K, cycles, open_h, setpoint_shift_K, ...
    waterfall: Sequence[Step]
    next_measurements: Sequence[Measurement]
    warnings: Sequence[str]
    assumptions: Sequence[str]
    departures: Mapping[str, float]  # of the room, in standard deviations of their priors
    parts: Mapping[str, Sequence[str]]  # "fit", "select", "shrinkage" -> first and last day
    seed: int
    is_quick: bool
    begins: str = ""  # when the judged days begin, from which hours and days count
    # probability of each hypothesis: names joined by "+", "none", "unknown"; empty where nothing can be judged
    posterior: Mapping[str, float] = field(default_factory=dict)
    not_judged: Sequence[str] = ()  # stages of which no effect could be
    compared_with: str = ""  # the healthy record, with its days; empty without one
    as_built: Sequence[Calibrated] = ()
    baseline: Sequence[BaselineFit] = ()
    missing_heat: MissingHeat = field(default_factory=MissingHeat)
    neighbours: RoomsBeside = field(default_factory=RoomsBeside)
    # measured, before and after of each judged channel (columns channel + "_measured", "_before", "_after"), by time
    traces: pd.DataFrame = field(repr=False, default_factory=pd.DataFrame)

    def described(self) -> dict[str, Any]:
        """The diagnosis as JSON has it, without its traces; figures may be no number or infinite."""
        values = {name: as_data(value) for name, value in vars(self).items() if name != "traces"}
        return {**values, "stages": [stage.described() for stage in self.stages]}


def as_data(value: Any) -> Any:
    """Return dataclasses as mappings, and tuples as lists."""
    if hasattr(value, "__dataclass_fields__"):
        return {name: as_data(each) for name, each in vars(value).items()}
    if isinstance(value, Mapping):
        return {key: as_data(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [as_data(each) for each in value]
    return value
