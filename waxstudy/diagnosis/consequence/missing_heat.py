"""Missing heat: which heat into the room's air would explain what its model misses, when, and against what."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import compress, pairwise
from math import nan

import numpy as np
import pandas as pd

from waxstudy.diagnosis.calibration.calibrate import Calibration
from waxstudy.diagnosis.consequence.heat_estimate import HeatData, HeatEstimate, Pieces, Unknowns, estimated
from waxstudy.diagnosis.consequence.heat_words import is_resolved, sentence
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.nuisance import habits, of_record
from waxstudy.diagnosis.model.room_response import built
from waxstudy.diagnosis.observations.record import settling_s
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import HeatBy, HeatPer, HeatPiece, MissingHeat
from waxstudy.diagnosis.select.search import Selection
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray

PIECES_H = (3.0, 6.0, 12.0, 24.0)
MOST_PIECES = 120  # chosen: a longer record has longer pieces
ASKED_W_M2 = 2.0  # of floor, chosen: what people differ by; pieces are as short as the data tell it in
BINS = 3
DARK = 0.02  # of the strongest sun in a piece
FLOWS = 0.1  # least spread of the share of the time in which water flows, to tell one from the other
LONGEST_OF_DAY_H = 12.0  # the longest piece that tells hours of the day apart


def missing_heat(selection: Selection, calibration: Calibration | None, time: pd.DatetimeIndex) -> MissingHeat:
    """Return the heat that would explain a room's record, as believed and with the effects found.

    `time` are the ends of the record's intervals.
    """
    problem = selection.problem
    assert problem.belief.room
    floor_m2 = built(problem.belief.room).floor_area_m2
    usual_W = _usual_W(calibration, problem.segment.name, floor_m2)
    believed = _as_known(problem, selection.before)
    unknowns = _unknowns(problem, Estimator(problem).slopes_at(believed))
    pieces, data = _resolving(problem, believed, unknowns, floor_m2)
    before = after = estimated(data, pieces, floor_m2, usual_W)
    if selection.found:
        data = _data(problem, _as_known(problem, selection.after), pieces, unknowns)
        after = estimated(data, pieces, floor_m2, usual_W)
    drivers = Drivers.of(problem, pieces, time)
    told = MissingHeat(
        before=_pieces(problem, pieces, before),
        after=_pieces(problem, pieces, after),
        mean_before=before.of(drivers.mean),
        mean_after=after.of(drivers.mean),
        usual_W=usual_W if calibration and problem.segment.name in calibration.healthy else nan,
        by=list(drivers.by(before, after)),
        per=list(drivers.per(before, after)),
    )
    told = replace(told, is_resolved=is_resolved(told))
    return replace(told, sentence=sentence(told, [found.effect.name for found in selection.found]))


def _as_known(problem: SegmentProblem, fitted: Hypothesis) -> Hypothesis:
    """Return a hypothesis with nothing departing: what heat explains need not bend the room."""
    return problem.at(fitted.effects, np.zeros(len(problem.sd)), fitted.convention) or fitted


def _unknowns(problem: SegmentProblem, slopes: FloatArray) -> tuple[Unknowns, Unknowns]:
    """Return what is unknown of the record itself, and what of the room and its drives, by slopes (m, nuisances)."""
    if not problem.nuisances:
        return (Unknowns.none(len(slopes)),) * 2
    root = problem.prior / problem.sd
    covariance = np.linalg.inv(root.T @ root)
    of_the_record = {each.name for each in of_record(problem.belief, problem.record, problem.segment.driven_by)}
    known = {knob.name for knob in problem.as_built.knobs} if problem.as_built else set()
    of_the_record |= {each.name for each in habits(problem.record)} - known
    is_lost = np.array([each.name in of_the_record for each in problem.nuisances])
    lost, doubted = (Unknowns(slopes[:, each], covariance[np.ix_(each, each)]) for each in (is_lost, ~is_lost))
    return lost, doubted


def _usual_W(calibration: Calibration | None, name: str, floor_m2: float) -> float:
    """Return how large heat may be where nothing is wrong, by what a healthy record leaves; a standard deviation."""
    healthy = calibration.healthy.get(name) if calibration else None
    if healthy is None:
        return 0.0
    # what calibration took is how the room was built, and no heat
    nothing = Unknowns.none(len(healthy.fitted.whitened))
    pieces, data = _resolving(healthy.problem, healthy.fitted, (nothing, nothing), floor_m2)
    return WEIGHTS.usual_heat * estimated(data, pieces, floor_m2).size_W


def _resolving(
    problem: SegmentProblem, fitted: Hypothesis, unknowns: tuple[Unknowns, Unknowns], floor_m2: float
) -> tuple[Pieces, HeatData]:
    """Return the shortest pieces that a record resolves, and what it tells of them."""
    record = problem.record
    hours = len(record) * record.interval_s / 3600.0
    lengths = [each for each in PIECES_H if hours / each <= MOST_PIECES] or [PIECES_H[-1]]
    finest = Pieces.of(len(record), record.interval_s, record.start_s, lengths[0])
    whole = _data(problem, fitted, finest, unknowns)
    for length_h in lengths:
        pieces = Pieces.of(len(record), record.interval_s, record.start_s, length_h)
        data = whole.merged(finest.within(pieces))
        if data.resolved(ASKED_W_M2 * floor_m2) >= WEIGHTS.resolved:
            break
    return pieces, data


def _data(problem: SegmentProblem, fitted: Hypothesis, pieces: Pieces, unknowns: tuple[Unknowns, Unknowns]) -> HeatData:
    heats_W = [{"extra_W": each} for each in pieces.courses()]
    return HeatData(fitted.whitened, problem.warmed(fitted, heats_W), *unknowns)


def _pieces(problem: SegmentProblem, pieces: Pieces, heat: HeatEstimate) -> list[HeatPiece]:
    record = problem.record
    first_h, end_h = record.start_s / 3600.0, len(record) * record.interval_s / 3600.0
    found, judged = [], _judged(problem, pieces).tolist()
    for middle_h, each in compress(zip(pieces.middle_h.tolist(), heat.pieces(), strict=True), judged):
        from_h = middle_h - 0.5 * pieces.length_h - first_h
        ends = max(0.0, from_h), min(end_h, from_h + pieces.length_h)
        found.append(HeatPiece(*ends, each.value, each.low, each.high))
    return found


def _judged(problem: SegmentProblem, pieces: Pieces) -> np.ndarray:
    """Return which pieces (P,) are judged: at the start heat stands in for how warm the room's mass was."""
    record = problem.record
    since_s = 3600.0 * pieces.middle_h - record.start_s
    return np.asarray(since_s >= settling_s(len(record) * record.interval_s))


@dataclass(frozen=True)
class Drivers:
    """What a record had in each piece (P,), and for how many hours each is judged."""

    hours: FloatArray
    of_day: Sequence[str]  # "" where pieces do not tell hours apart
    is_weekend: np.ndarray
    colder_K: FloatArray  # outside than in the room
    sun_W: FloatArray
    flows: FloatArray | None  # share of the time in which water flows

    @classmethod
    def of(cls, problem: SegmentProblem, pieces: Pieces, time: pd.DatetimeIndex) -> Drivers:
        record, inputs = problem.record, problem.belief.inputs
        assert inputs
        flow = record.filled_or_zero("flow_L_h") if record.has("flow_L_h") else None
        middle = time - pd.Timedelta(0.5 * record.interval_s, "s")
        return cls(
            hours=np.where(_judged(problem, pieces), pieces.hours(record.interval_s), 0.0),
            of_day=[_hours(each, pieces.length_h) for each in pieces.middle_h.tolist()],
            is_weekend=pieces.means(np.asarray(middle.day_of_week >= 5, dtype=float)) > 0.5,
            colder_K=pieces.means(inputs.air_C - inputs.outdoor_C),
            sun_W=pieces.means(inputs.solar_W),
            flows=None if flow is None else pieces.means((flow > 0.5 * flow.max()).astype(float)),
        )

    @property
    def mean(self) -> FloatArray:
        return np.asarray(self.hours / self.hours.sum())

    @property
    def _judged(self) -> np.ndarray:
        return np.asarray(self.hours > 0.0)

    def by(self, before: HeatEstimate, after: HeatEstimate) -> Iterator[HeatBy]:
        """Yield means by each driver."""
        for driver, name, chosen in self._chosen():
            hours = float(self.hours[chosen].sum())
            if not hours:
                continue
            weights = np.where(chosen, self.hours, 0.0) / hours
            yield self._mean(driver, name, hours, weights, before, after)
        if self.flows is not None and np.std(self.flows[self._judged]) > FLOWS:
            design = np.column_stack((self.flows, 1.0 - self.flows))
            for name, weights, share in zip(("on", "off"), self._fitted(design), design.T, strict=True):
                yield self._mean("flow", name, float(self.hours @ share), weights, before, after)

    def _mean(
        self, driver: str, name: str, hours: float, weights: FloatArray, before: HeatEstimate, after: HeatEstimate
    ) -> HeatBy:
        return HeatBy(driver, name, hours, before.of(weights), after.of(weights), before.of(weights - self.mean))

    def per(self, before: HeatEstimate, after: HeatEstimate) -> Iterator[HeatPer]:
        """Yield slopes over the drivers that run on, each by itself."""
        drivers = (("outdoor difference", "W/K", self.colder_K), ("sun", "W/W", self.sun_W))
        for driver, unit, values in drivers:
            if np.ptp(values[self._judged]) > 0.0:
                weights = self._fitted(np.column_stack((values, np.ones(len(values)))))[0]
                yield HeatPer(driver, unit, before.of(weights), after.of(weights), self._share(values, before.mean_W))

    def _chosen(self) -> Iterator[tuple[str, str, np.ndarray]]:
        names = list(dict.fromkeys(sorted(self.of_day)))
        for name in names if len(names) > 1 else []:
            yield "hour", name, np.array(self.of_day) == name
        if self.is_weekend.any() and not self.is_weekend.all():
            yield "day", "weekdays", ~self.is_weekend
            yield "day", "weekends", self.is_weekend
        for name, chosen in _bins(self.colder_K, "K"):
            yield "outdoor difference", name, chosen
        dark = self.sun_W <= DARK * self.sun_W.max()
        if dark.any() and not dark.all():
            yield "sun", "none", dark
            for name, chosen in _bins(self.sun_W, "W", ~dark):
                yield "sun", name, chosen

    def _fitted(self, design: FloatArray) -> FloatArray:
        """Return what takes a course in pieces to its least squares over a design (P, k), by hours (k, P)."""
        weighted = design * self.hours[:, None]
        return np.asarray(np.linalg.solve(weighted.T @ design, weighted.T))

    def _share(self, values: FloatArray, heat_W: FloatArray) -> float:
        """Return the share of the variance of heat that goes with a driver."""
        left = [each - self.mean @ each for each in (values, heat_W)]
        one, both, other = (float(self.mean @ (a * b)) for a, b in ((left[0],) * 2, left, (left[1],) * 2))
        return both**2 / (one * other) if one * other > 0.0 else 0.0


def _hours(middle_h: float, length_h: float) -> str:
    if length_h > LONGEST_OF_DAY_H:
        return ""
    from_h = (middle_h - 0.5 * length_h) % 24.0
    return f"{from_h:02.0f} to {from_h + length_h:02.0f} h"


def _bins(values: FloatArray, unit: str, among: np.ndarray | None = None) -> Iterator[tuple[str, np.ndarray]]:
    """Yield parts of the pieces with as many each, by a driver, the lowest first, with its range in words."""
    among = np.ones(len(values), dtype=bool) if among is None else among
    edges = np.quantile(values[among], np.linspace(0.0, 1.0, BINS + 1))
    for low, high in pairwise(edges.tolist()):
        chosen = among & (values >= low) & ((values < high) | (high == edges[-1]))
        if chosen.any() and high > low:
            yield f"{low:.0f} to {high:.0f} {unit}", chosen
