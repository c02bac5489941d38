"""Calibration on a healthy record: what differs from the documents, how well that is known, and what is left."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import log

import numpy as np

from waxstudy.diagnosis.calibration.healthy import Healthy, blocks_of_room, least_usual, scatter_of_weeks, together
from waxstudy.diagnosis.estimate.estimator import Estimator, Followed
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.estimate.solver import MOST_SD
from waxstudy.diagnosis.estimate.start_points import Screen
from waxstudy.diagnosis.model.as_built import AsBuilt, Left, knobs
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.discrepancy import Discrepancy
from waxstudy.diagnosis.model.edits import Edits
from waxstudy.diagnosis.model.nuisance import Nuisance, nuisances, of_record
from waxstudy.diagnosis.model.room_response import OF_ROOM, samples_of_mean
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import ALL, FIT, SELECT
from waxstudy.diagnosis.observations.record import OUTPUT, Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import Belief, Effect, FloatArray

ROUNDS = 2  # of fitting and weighing what is left in turn
# of the search for a healthy chain's fit, chosen: it begins with steps of half a standard deviation and ends
# where neither the unknowns nor the loss change enough to matter, or after so many simulations for each unknown
SIMPLEX_SD, CLOSE_SD, CLOSE_LOSS, POLISHED = 0.5, 0.02, 1.0, 25
Effects = Sequence[type[Effect]]


@dataclass(frozen=True)
class Calibration:
    """What a healthy record says of a loop."""

    as_built: AsBuilt
    healthy: Mapping[str, Healthy]  # by segment

    def without(self, links: Collection[str]) -> Calibration:
        """Return the same without some links, in which too little happened: there the documents hold."""
        lost = [each.problem.segment for name, each in self.healthy.items() if name in links]
        stages = {stage for segment in lost if not segment.with_room for stage in segment.stages}
        known = self.as_built.as_documented() if any(segment.with_room for segment in lost) else self.as_built
        found = replace(
            known,
            chain=tuple((knob, departure) for knob, departure in known.chain if knob.effect.stage not in stages),
            always=[(effect, values) for effect, values in known.always if effect.stage not in stages],
            conventions={name: way for name, way in known.conventions.items() if name not in links},
        )
        return Calibration(found, {name: each for name, each in self.healthy.items() if name not in links})

    def seen_in(self, record: Record) -> Calibration:
        """Return the same for another record of the loop."""
        return replace(self, as_built=self.as_built.seen_in(record))


def calibrate(
    record: Record, belief: Belief, effects: Effects, thorough: float = 1.0, room_tolerance: float = 1.0
) -> Calibration:
    """Return what a healthy record says of a loop; `thorough` below 1 looks at less of its chain.

    `room_tolerance` is how many times as far as a room as drawn this one may differ from what is believed.
    """
    found = AsBuilt((), np.zeros(0), np.zeros((0, 0)))
    healthy: dict[str, Healthy] = {}
    for segment in segments(record, belief):
        if segment.is_supply:
            continue
        about = segment, record, belief, effects, found
        found, problem, fitted = _of_room(*about, room_tolerance) if segment.with_room else _of_chain(*about, thorough)
        healthy[segment.name] = Healthy(problem, fitted)
    return Calibration(found, healthy)


def _of_chain(
    segment: Segment, record: Record, belief: Belief, effects: Effects, known: AsBuilt, thorough: float
) -> tuple[AsBuilt, SegmentProblem, Hypothesis]:
    unknowns = list(knobs(effects, segment.stages, belief))
    problem = SegmentProblem(segment, record, belief, holds_out=False, unknowns=unknowns)
    fitted = _fitted(problem)
    chain = tuple(zip(unknowns, fitted.departures.tolist(), strict=True))
    conventions = {**known.conventions, segment.name: fitted.convention}
    ways = {**known.ways, segment.name: segment.conventions}
    there = replace(known, chain=(*known.chain, *chain), conventions=conventions, ways=ways)
    problem, fitted, always = _with_always(segment, record, belief, effects, there, thorough)
    there = replace(there, as_good={**there.as_good, segment.name: tuple(_as_good(problem, fitted))})
    return weighed_by_left(replace(there, always=(*there.always, *always)), problem, fitted)


def weighed_by_left(
    there: AsBuilt, problem: SegmentProblem, fitted: Hypothesis
) -> tuple[AsBuilt, SegmentProblem, Hypothesis]:
    """Return what is left of a link of the healthy record, and the link weighed by it, as a later record's is."""
    found = replace(there, left={**there.left, **_left_of(fitted)})
    parts = np.full(len(problem.record), FIT)
    about = problem.segment, problem.record, problem.belief
    again = SegmentProblem(*about, as_built=found, unknowns=(), parts=parts, alike=problem)
    return found, again, again.at((), fitted.departures, fitted.convention) or fitted


def _with_always(
    segment: Segment, record: Record, belief: Belief, effects: Effects, there: AsBuilt, thorough: float
) -> tuple[SegmentProblem, Hypothesis, Edits]:
    """Return a link with the effects that a healthy record shows as well: they were there from the start."""
    belief = there.believed(belief)
    found: list[tuple[type[Effect], Mapping[str, float]]] = []
    named = [effect for effect in effects if effect.stage in segment.stages]
    fits: dict[type[Effect], tuple[Hypothesis, Hypothesis]] = {}  # by effect: the last fits without it and with it
    while True:
        problem = SegmentProblem(segment, record, belief, as_built=there, unknowns=(), parts=np.full(len(record), FIT))
        fitted = _fitted(problem)
        if len(found) == WEIGHTS.most_always:
            return problem, fitted, found
        possible = [effect for effect in named if effect not in dict(found) and not effect.hindrance(belief)]
        best = 0.0, fitted
        for effect, gain, one in _paying(Estimator(problem, thorough), fitted, possible, fits):
            fits[effect] = fitted, one
            if gain > best[0] and not _hinders(named, belief, problem.belief_of(one)):
                best = gain, one
        if best[1] is fitted:
            return problem, fitted, found
        found += best[1].effects
        belief = problem.belief_of(best[1])


def _paying(
    estimator: Estimator[SegmentProblem],
    fitted: Hypothesis,
    effects: Effects,
    fits: Mapping[type[Effect], tuple[Hypothesis, Hypothesis]],
) -> Iterator[tuple[type[Effect], float, Hypothesis]]:
    """Yield each effect that may pay, what it gains beyond its price, and its fit; `fits` are those from before."""
    share = {each.channel: together(each) for each in fitted.by_motion}
    most = _most_gained(fitted, share)
    for effect in effects:
        price = WEIGHTS.always * len(effect.priors)
        if most > price:
            one = _still_best(estimator.problem, effect, fitted, *fits[effect]) if effect in fits else None
            one = one or estimator.fit(effect, fitted, screen=Screen(WEIGHTS.promised * price, share))
            if one:
                yield effect, _gain(fitted, one, share) - price, one


def _still_best(
    problem: SegmentProblem, effect: type[Effect], fitted: Hypothesis, without: Hypothesis, one: Hypothesis
) -> Hypothesis | None:
    """Return a fit of an effect from before another was found, where that changed nothing that the effect moves.

    A new fit would end where it began: as of a controller whose reading was logged, after an effect of its sensor; or
    of an effect that takes the place of the block in which the other one acts.
    """
    again = problem.at(one.effects, one.departures, one.convention)
    if again is None:
        return None
    four = zip(without.residuals, fitted.residuals, one.residuals, again.residuals, strict=True)
    moved = [each for each in four if not _is_same(each[0], each[2])]
    stands = (_is_same(with_it, now) and (effect.replaces or _is_same(old, new)) for old, new, with_it, now in moved)
    return again if moved and all(stands) else None


def _is_same(one: Residual, other: Residual) -> bool:
    return np.array_equal(one.whitened, other.whitened)


def _hinders(effects: Effects, before: Belief, after: Belief) -> bool:
    """Whether an effect cannot apply any more, and could be no change then."""
    return any(effect.hindrance(after) and not effect.hindrance(before) for effect in effects)


def _gain(fitted: Hypothesis, other: Hypothesis, share: Mapping[str, float]) -> float:
    """Return the log likelihood that another hypothesis gains, of samples of which so many count as one.

    Errors are weighed by what the other one leaves, but at least by noise; those of a motor or valve that moves, by the
    chosen scale. To leave less than noise is no gain: a smoothed reading of a controller does that as well. The share
    of the cycle of most is left out: what happened once may be chance.
    """
    gain, by_cycle = 0.0, np.zeros(1 + max(int(each.block.max(initial=0)) for each in other.by_motion))
    for old, new in zip(fitted.by_motion, other.by_motion, strict=True):
        noise, scale = float(new.judged.sum()), share[old.channel] * max(1.0, _left(new).whitened ** 2)
        gain += 0.5 * (max(noise, old.loss()) - max(noise, new.loss())) / scale
        for residual, sign in ((old, 0.5), (new, -0.5)):
            by_cycle += sign * _squares(residual, len(by_cycle)) / scale
    most, whole = float(by_cycle.max()), float(by_cycle.sum())
    return gain * (1.0 - most / whole) if gain > 0.0 and whole > 0.0 else gain


def _most_gained(fitted: Hypothesis, share: Mapping[str, float]) -> float:
    """Return the log likelihood that a hypothesis would gain which leaves nothing but noise."""
    beyond = ((each.loss() - float(each.judged.sum())) / share[each.channel] for each in fitted.by_motion)
    return sum(0.5 * max(0.0, each) for each in beyond)


def _squares(residual: Residual, cycles: int) -> FloatArray:
    """Return the squares that are missed of each cycle (cycles,)."""
    judged = residual.judged
    return np.asarray(np.bincount(residual.block[judged], residual.whitened[judged] ** 2, minlength=cycles))


def _left_of(fitted: Hypothesis) -> dict[str, Left]:
    """Return what is left of each channel, and of its rest and moves where these are weighed apart."""
    whole = {each.channel: _left(each) for each in fitted.residuals}
    return whole | {each.channel: _of_motion(each) for each in fitted.by_motion if each.channel not in whole}


def _left(residual: Residual) -> Left:
    return Left(residual.gap(), residual.whitened_rms)


def _of_motion(motion: Residual) -> Left:
    """Return what is left of a motion, the chosen scale counted as one cycle more: few cycles tell little."""
    left, cycles = _left(motion), len(np.unique(motion.block[motion.judged]))
    return replace(left, whitened=float(np.sqrt((cycles * left.whitened**2 + 1.0) / (cycles + 1.0))))


def _of_room(
    segment: Segment, record: Record, belief: Belief, effects: Effects, known: AsBuilt, room_tolerance: float
) -> tuple[AsBuilt, SegmentProblem, Hypothesis]:
    lasting = lasting_unknowns(segment, record, belief, effects, room_tolerance)
    unknowns = [*lasting, *of_record(belief, record, segment.driven_by)]
    early = early_part(record)
    found, problem, last = known, None, None
    for turn in range(ROUNDS + 1):
        problem = SegmentProblem(segment, record, belief, as_built=found, unknowns=unknowns, parts=early, alike=problem)
        last = _followed(problem, last)
        if turn < ROUNDS:
            ahead = Estimator(problem, keeps=True).nuisance_fit(
                (), last.fitted.departures, last.fitted.convention, (FIT,), last.slopes
            )
            found = replace(found, discrepancies=_discrepancies(problem, last.fitted, ahead or last.fitted))
    assert problem
    assert last
    fitted = _settled(problem, last.fitted)
    count = len(lasting)
    found = replace(
        found,
        knobs=tuple(lasting),
        departures=fitted.departures[:count],
        covariance=_covariance(problem, fitted)[:count, :count] + np.diag([each.varies**2 for each in lasting]),
        conventions={**found.conventions, segment.name: fitted.convention},
        ways={**found.ways, segment.name: segment.conventions},
    )
    return found, problem, fitted


def early_part(record: Record) -> np.ndarray:
    """Return the part of each sample (n,): the rest of a healthy record is predicted from its first days."""
    return np.where(np.arange(len(record)) < WEIGHTS.early * len(record), FIT, SELECT)


def lasting_unknowns(
    segment: Segment, record: Record, belief: Belief, effects: Effects, room_tolerance: float
) -> list[Nuisance]:
    """Return what may differ of room and drives; what effects say of it goes before what the room says."""
    own = list(knobs(effects, segment.stages, belief))
    taken = {name for effect in effects for name in effect.absorbs if any(each.effect is effect for each in own)}
    once = {each.name for each in of_record(belief, record, segment.driven_by)}
    rest = [each for each in nuisances(belief, record, segment.driven_by) if each.name not in taken | once]
    wider = max(WEIGHTS.wider, room_tolerance)
    return [*own, *(each if each.is_habit else replace(each, sd=wider * each.sd) for each in rest)]


def _fitted(problem: SegmentProblem) -> Hypothesis:
    """Return the best fit of a chain to the whole record; noise of its drive counts against no way to read it."""
    estimator, start = Estimator(problem), np.zeros(len(problem.sd))
    tried = [estimator.nuisance_fit((), start, way, ALL) for way in problem.conventions]
    best = estimator.best(tried, ALL)
    return _polished(estimator, best) if len(start) else best


def _as_good(problem: SegmentProblem, fitted: Hypothesis) -> Iterator[Convention]:
    """Yield the other ways to read a record that leave no channel clearly more: it cannot tell them from the first.

    A reading with more freedom would have to leave less, and is not one of them.
    """
    for way in problem.segment.conventions:
        if way != fitted.convention and not way.is_handicapped:
            other = problem.at((), fitted.departures, way)
            if other and _more_left(problem, fitted, other) <= WEIGHTS.open:
                yield way


def _more_left(problem: SegmentProblem, one: Hypothesis, other: Hypothesis) -> float:
    """Return by how much more another hypothesis leaves of a channel, at most, in standard deviations of what weeks do.

    Noise that the drive brings into a controller's output is taken off. Leaving less than usual is luck.
    """
    noise, found = 0.0, 0.0
    if problem.discounts_noise:
        of_noise = [sum(problem.drive_noise(each, OUTPUT).values()) for each in (other, one)]
        noise = max(0.0, of_noise[0] - of_noise[1])
    for old, new in zip(one.residuals, other.residuals, strict=True):
        least = least_usual(old) ** 2 * max(1, int(old.judged.sum()))
        left = new.loss() - (noise if old.channel == OUTPUT else 0.0)
        found = max(found, log(max(left, least) / max(old.loss(), least)) / (2.0 * scatter_of_weeks(old)))
    return found


def _polished(estimator: Estimator[SegmentProblem], fitted: Hypothesis) -> Hypothesis:
    """Return a fit improved by a simplex search (Nelder and Mead 1965).

    What switches answers in jumps: slopes mislead Gauss-Newton steps, which then end early.
    """
    from scipy.optimize import minimize

    sd = estimator.problem.sd

    def at(x: FloatArray) -> Hypothesis | None:
        return estimator.problem.at((), x * sd, fitted.convention)

    def score(x: FloatArray) -> float:
        return estimator.score(at(x), ALL)

    start = fitted.departures / sd
    inwards = np.where(start > 0.0, -SIMPLEX_SD, SIMPLEX_SD)
    corners = np.vstack([start, start + np.diag(inwards)])
    found = minimize(
        score,
        start,
        method="Nelder-Mead",
        bounds=[(-MOST_SD, MOST_SD)] * len(sd),
        options={"initial_simplex": corners, "maxfev": POLISHED * len(sd), "xatol": CLOSE_SD, "fatol": CLOSE_LOSS},
    )
    return estimator.best([fitted, at(found.x)], ALL, is_fair=False)


def _settled(problem: SegmentProblem, fitted: Hypothesis) -> Hypothesis:
    """Return a fit gone on with by slopes as they are: kept ones may end it early, and its intervals would be wrong."""
    return Estimator(problem).nuisance_fit((), fitted.departures, fitted.convention, ALL) or fitted


def _followed(problem: SegmentProblem, last: Followed | None) -> Followed:
    """Return the best fit of a room to the whole record, going on from the last one, which weighed errors otherwise."""
    estimator = Estimator(problem, keeps=True)
    if last:
        return estimator.follow(last.fitted.departures, last.fitted.convention, ALL, last.place)
    first, *others = problem.conventions
    found = estimator.follow(np.zeros(len(problem.sd)), first, ALL)
    start, slopes = found.fitted.departures, found.slopes
    tried = [estimator.nuisance_fit((), start, way, ALL, slopes) for way in others]
    return replace(found, fitted=estimator.best([found.fitted, *tried], ALL, is_fair=False))


def _discrepancies(problem: SegmentProblem, fitted: Hypothesis, ahead: Hypothesis) -> dict[str, Discrepancy]:
    """Return what is left of each channel of the room, by days that a fit has not seen where these are missed by more.

    A channel that is known nowhere leaves nothing.
    """
    found, interval_s = {}, problem.record.interval_s
    step_s = interval_s * samples_of_mean(interval_s)
    pairs = zip(fitted.residuals, ahead.residuals, strict=True)
    for within, beyond in ((one, other) for one, other in pairs if one.channel in OF_ROOM and one.judged.any()):
        least_K = problem.record.noise[within.channel] * float(len(within.error) / len(problem.record)) ** 0.5
        discrepancy = Discrepancy.of(within.error, within.judged, step_s, least_K)
        wider = beyond.gap(SELECT) / within.gap() if within.gap() else 1.0
        found[within.channel] = replace(
            discrepancy, sd_K=discrepancy.sd_K * float(np.clip(wider, 1.0, WEIGHTS.most_wider))
        )
    known = [each for each in fitted.residuals if each.channel in found]
    shared = _shared([found[each.channel].whitened(each.error, each.judged, step_s) for each in known])
    return {channel: replace(each, shared=shared) for channel, each in found.items()}


def _shared(whitened: Sequence[FloatArray]) -> float:
    """Return how many channels tell the same: their number over the effective one, by how they are correlated."""
    values = np.linalg.eigvalsh(np.corrcoef(np.array(whitened))) if len(whitened) > 1 else np.ones(1)
    return float(len(whitened) * np.sum(values**2) / np.sum(values) ** 2)


def _covariance(problem: SegmentProblem, fitted: Hypothesis) -> FloatArray:
    """Return the posterior covariance of the departures (k, k), by slopes at the best fit (Laplace).

    It is wider along what errors of six hours move together by more than independent ones do (White 1980,
    doi:10.2307/1912934). Up to the most that chance makes of so few such hours (Marchenko and Pastur 1967) is luck.
    """
    slopes, root = Estimator(problem).slopes_at(fitted), problem.prior / problem.sd
    values, ways = np.linalg.eigh(slopes.T @ slopes + root.T @ root)
    half = ways * values**-0.5  # columns
    block = np.concatenate([blocks_of_room(each, problem.record.interval_s) for each in fitted.residuals])
    pull = np.array([np.bincount(block, column) for column in (slopes * fitted.whitened[:, None]).T]).T
    pull -= pull.mean(axis=0)
    moved = half.T @ (pull.T @ pull + root.T @ root) @ half
    more, turned = np.linalg.eigh(moved)
    luck = (1.0 + (len(more) / len(pull)) ** 0.5) ** 2
    wide = half @ turned * np.maximum(1.0, more / luck) ** 0.5
    return np.asarray(wide @ wide.T)
