"""What speaks for a hypothesis of one link: what it gains, what it leaves, and whether it is worth a name."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from waxstudy.diagnosis.calibration.healthy import Healthy, blocks_of_room
from waxstudy.diagnosis.criteria import limits
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.model.as_built import Knob
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.edits import Edits, EffectType, Values
from waxstudy.diagnosis.model.travel import travel
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.day import SPANS
from waxstudy.diagnosis.select.days import days_of
from waxstudy.diagnosis.select.evidence import departure, travel_left
from waxstudy.diagnosis.select.filtered import Filtered
from waxstudy.diagnosis.select.gain_spread import along_change, gain_spread, strength
from waxstudy.diagnosis.select.meter import coarser_steps
from waxstudy.diagnosis.select.patterns import Pattern, day_of
from waxstudy.diagnosis.select.posterior import Weighed
from waxstudy.diagnosis.select.thermostat import past_switch
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import HOURS, Belief, FloatArray


class Appraisal:
    """Holds hypotheses of a link against nothing, and against what a link leaves where nothing is amiss."""

    def __init__(self, problem: SegmentProblem, healthy: Healthy, estimator: Estimator[SegmentProblem]) -> None:
        self.problem, self.healthy, self.estimator = problem, healthy, estimator
        self.share = self._shares()
        self.none = estimator.settled(estimator.base)
        self.read: dict[Convention, Hypothesis] = {}  # nothing, where the record is read in another way
        self.filtered = Filtered(problem, healthy)

    def _shares(self) -> dict[str, float]:
        """Return how many samples of each channel, or motion of it, count as one."""
        return {each.channel: self.healthy.together(each.channel) for each in self.healthy.fitted.by_motion}

    def beside(self, given: Weighed, fitted: Hypothesis) -> Weighed:
        """Return a hypothesis with one more effect: it gains what days and cycles say that it adds, each by itself."""
        weighed = self.of(fitted, given.fitted)
        more = weighed.gain - given.gain - self._form_may_tell(given, fitted)
        spread, most = self._spread(fitted, given.fitted)
        return replace(weighed, gain=given.gain + min(more / spread, most), spread=given.spread, most=given.most)

    def _form_may_tell(self, given: Weighed, fitted: Hypothesis) -> float:
        """Return how much of what a second effect gains the form of the first one may leave.

        Of a room that is a share of what the first one told. Of a chain the first one's residuals along its own change
        count, as far as the second one takes them away; in each channel no more than is gained there.
        """
        if self.problem.segment.with_room:
            return WEIGHTS.form_of_room**2 * (max(0.0, given.gain) + max(0.0, given.ease))
        may, losses = 0.0, (self._losses(given.fitted), self._losses(fitted))
        none = self._none_read(given.fitted.convention)
        for old, first, both in zip(none.by_motion, given.fitted.by_motion, fitted.by_motion, strict=True):
            change = old.whitened - first.whitened
            of_form = float(np.sum(_of_form(first, change) - _of_form(both, change))) / self.share.get(old.channel, 1.0)
            gained = max(0.0, losses[0][old.channel] - losses[1][old.channel])
            may += 0.5 * min(max(0.0, of_form), gained)
        return may

    def of(self, fitted: Hypothesis, given: Hypothesis | None = None, pattern: Pattern | None = None) -> Weighed:
        """Return a hypothesis, added to nothing or to a given one, with what speaks for it."""
        ease = 0.5 * (self.estimator.strain(self.none) - self.estimator.strain(fitted))
        nothing = self._nothing(fitted)
        gain = 0.5 * (self._loss(nothing) - self._loss(fitted)) - ease - self._once(fitted)
        always, moved = self._always(fitted)
        spread, most = self._spread(fitted)
        price = sum(_price(effect, values) for effect, values in fitted.effects)
        names = tuple(sorted(self._notable(fitted, pattern)))
        stands = self._stands(fitted, given or nothing, pattern)
        if not pattern and set(fitted.names[-1:]) & set(names):
            stands = max(stands, self._along(fitted, given or nothing))
        return Weighed(
            fitted=fitted,
            names=names,
            gain=gain,
            ease=ease,
            always=always / spread if always > 0.0 else always,
            misfit=self.misfit(fitted),
            price=price,
            spread=spread,
            most=most,
            by_cycle=self._by_cycle(fitted),
            unlike=self._unlike(fitted, moved) if always > 0.0 else 0.0,
            left=self._left(fitted),
            is_of_room=self.problem.segment.with_room,
            is_by_noise=self.healthy.is_noise,
            stands=stands,
            pattern=pattern,
        )

    def _once(self, fitted: Hypothesis) -> float:
        """Return what a hypothesis with days gains on the day of most: what happened once may be chance."""
        if not any(days_of(effect) for effect, _ in fitted.effects):
            return 0.0
        day = np.concatenate([day_of(self.problem.record)[each.sample] for each in fitted.residuals])
        gains = np.bincount(day, 0.5 * (self._missed(self._nothing(fitted)) ** 2 - self._missed(fitted) ** 2))
        return max(0.0, float(gains.max()))

    def _always(self, fitted: Hypothesis) -> tuple[float, FloatArray]:
        """Return how much likelier the healthy record were, had effects been there then, and what else would differ.

        Of what was calibrated on it is known how much of it was there: more of it is a change. So is an effect in whose
        place calibration had something else. What acts on some days only is not looked for there.
        """
        known = self.problem.as_built.knobs if self.problem.as_built else ()
        calibrated, names = {each.effect for each in known if isinstance(each, Knob)}, {each.name for each in known}

        def is_open(effect: EffectType) -> bool:
            return effect not in calibrated and names.isdisjoint(effect.absorbs) and days_of(effect) is None

        open_ = [(effect, values) for effect, values in fitted.effects if is_open(effect)]
        return self.healthy.had_it(open_) if open_ else (0.0, np.zeros(len(self.problem.sd)))

    def _unlike(self, fitted: Hypothesis, moved: FloatArray) -> float:
        """Return how much less likely a room's record is if what was calibrated lies elsewhere, all else fitted again.

        What a healthy record cannot tell from an effect would have taken its place there, and did not change since.
        """
        sd = self.problem.sd
        if not len(sd) or self.problem.as_built is None:
            return 0.0
        weight = np.concatenate([each.weights(self.share) for each in fitted.residuals])
        root = self.problem.prior / sd
        ways = np.vstack((self.estimator.slopes_at(fitted) * weight[:, None], root))

        def loss(mean: FloatArray) -> float:
            both = np.concatenate((fitted.whitened * weight, root @ (fitted.departures - mean)))
            left = both + ways @ np.linalg.lstsq(ways, -both, rcond=None)[0]
            return float(left @ left)

        calibrated = {knob.name for knob in self.problem.as_built.knobs}
        there = zip(self.healthy.problem.nuisances, moved.tolist(), strict=True)
        means = {knob.name: step for knob, step in there if knob.name in calibrated}
        # steps: what was not calibrated did not move
        elsewhere = np.array([means.get(knob.name, 0.0) for knob in self.problem.nuisances])
        return 0.5 * max(0.0, loss(elsewhere) - loss(np.zeros(len(sd))))

    def _stands(self, fitted: Hypothesis, given: Hypothesis, pattern: Pattern | None = None) -> float:
        """Return how far what another hypothesis leaves of a chain stands out where this one changes it.

        The cycle that stands out most is left out: what happened once may be chance.
        """
        if self.problem.segment.with_room:
            return np.inf
        weights, missed, luck = list[FloatArray](), list[FloatArray](), 0.0
        for old, new in zip(given.by_motion, fitted.by_motion, strict=True):
            weights.append(self.healthy.acts(old, new))
            # the healthy record has no such times as a pattern has
            where = self.healthy.usual_where(old, () if pattern else fitted.effects, given.effects)
            missed.append(weights[-1] * (old.whitened / where.whitened) ** 2)
            luck += float(weights[-1].sum()) / where.cycles
        block = np.concatenate([self._block(each) for each in given.by_motion])
        over = _lasting(np.concatenate(missed), np.concatenate(weights), block)
        acts = sum(float(each.sum()) for each in weights)
        scatter = float(np.hypot(self.healthy.stands_scatter, (0.5 * luck / acts) ** 0.5 if acts else 0.0))
        return 0.5 * float(np.log(max(1.0, over))) / scatter

    def _along(self, fitted: Hypothesis, given: Hypothesis) -> float:
        """Return how far what another hypothesis leaves of a chain stands out along what this one changes.

        A healthy record whose errors do not lie along it tells that this is no error of the form, however large others
        are. An effect too small for a name is not told so: form errs by as much.
        """
        # read in another way, a link changes by more than the effect does
        if self.problem.segment.with_room or given.convention != fitted.convention:
            return 0.0
        healthy = self.healthy.pair(given.effects, fitted.effects, fitted.convention)
        there = strength(*self._signed(*healthy)) if healthy else None
        here = strength(*self._signed(given, fitted), is_lasting=True)
        if there is None or here is None:
            return 0.0
        usual, luck = max(there.square, WEIGHTS.form**2), 0.5 / there.cycles + 0.5 / here.cycles
        scatter = float(np.hypot(self.healthy.stands_scatter, luck**0.5))
        return 0.5 * float(np.log(max(1.0, here.square / usual))) / scatter

    def _signed(self, given: Hypothesis, fitted: Hypothesis) -> tuple[FloatArray, FloatArray, np.ndarray]:
        """Return what two hypotheses leave of judged samples over the usual, each (m,), and the block of each sample.

        Errors of switches have no sign, and are left out.
        """
        pairs = zip(given.by_motion, fitted.by_motion, strict=True)
        rows = [(np.zeros(0), np.zeros(0), np.zeros(0, dtype=int))]
        for old, new in (each for each in pairs if each[0].unit != "s"):
            usual, judged = self.healthy.usual(old), old.judged
            rows.append((old.whitened[judged] / usual, new.whitened[judged] / usual, self._block(old)[judged]))
        before, after, block = (np.concatenate(each) for each in zip(*rows, strict=True))
        return before, after, block

    def _left(self, fitted: Hypothesis) -> float:
        """Return the share that a hypothesis leaves of what a chain misses beyond the usual, at least `_kept` of it."""
        if self.problem.segment.with_room:
            return WEIGHTS.least_share  # what a room leaves is judged by its healthy record alone
        before, after, nothing = 0.0, 0.0, self._nothing(fitted)
        for old, new in zip(nothing.by_motion, fitted.by_motion, strict=True):
            missed = self._beyond(nothing, old)
            before, after = before + missed, after + max(self._beyond(fitted, new), self._kept(old, new) * missed)
        return float(max(WEIGHTS.least_share, min(1.0, (after / before) ** 0.5))) if before > 0.0 else 1.0

    def _beyond(self, fitted: Hypothesis, residual: Residual) -> float:
        return max(0.0, float(self._squares(fitted, residual).sum()) - self.healthy.usual_loss(residual))

    def _squares(self, fitted: Hypothesis, residual: Residual) -> FloatArray:
        """Return the squares that a hypothesis misses of a channel (m,), with the noise that it smooths away."""
        spared = self.filtered.squares(fitted, self._none_read(fitted.convention))
        return np.asarray(residual.whitened**2 + residual.judged * spared.get(residual.channel, 0.0))

    def _kept(self, none: Residual, residual: Residual) -> float:
        """Return which share of the squares of a channel's gap a hypothesis keeps, beyond what may be usual.

        Some samples weigh far more than others: a fit may lower the weighed squares while the gap grows. Switches do
        not. The cycle of most is left out.
        """
        healthy, before = self.healthy.left(residual.channel), _gap_square(none)
        if healthy is None or residual.unit == "s" or before == 0.0:
            return 0.0
        beyond = _gap_square(residual) - (limits()["gap"].value * healthy.gap) ** 2
        return float(np.clip(beyond / before, 0.0, 1.0))

    def _nothing(self, fitted: Hypothesis) -> Hypothesis:
        """Return the link without effects, read in the best way or in a hypothesis's, whichever misses less."""
        other = self._none_read(fitted.convention)
        return self.none if other is self.none else min(self.none, other, key=self._loss)

    def _none_read(self, convention: Convention) -> Hypothesis:
        if convention == self.none.convention:
            return self.none
        if convention not in self.read:
            self.read[convention] = self.estimator.refined((), self.none.departures, convention, ALL) or self.none
        return self.read[convention]

    def _loss(self, fitted: Hypothesis) -> float:
        """Return what a hypothesis misses; of a chain at least what a healthy record does."""
        strain = self.estimator.strain(fitted)
        if self.problem.segment.with_room:
            return self.healthy.room_loss(fitted) + strain
        return strain + sum(self._losses(fitted).values())

    def _losses(self, fitted: Hypothesis) -> dict[str, float]:
        """Return the same of each channel of a chain."""
        missed = ((each, float(self._squares(fitted, each).sum())) for each in fitted.by_motion)
        pairs = {each.channel: max(loss, self.healthy.usual_loss(each)) for each, loss in missed}
        return {channel: loss / self.share.get(channel, 1.0) for channel, loss in pairs.items()}

    def most_told(self, given: Hypothesis) -> float:
        """Return what would speak for one more effect of a chain, but for its price, if it explained all that is amiss.

        It would gain all that is missed beyond the usual, and leave no misfit; without it something unknown, for its
        price, may excuse that misfit.
        """
        gains = (0.5 * self._beyond(given, each) / self.share.get(each.channel, 1.0) for each in given.by_motion)
        return sum(gains) + min(0.5 * self.misfit(given) ** 2, WEIGHTS.unknown_price)

    def may_show(self, effect: EffectType, told: float) -> bool:
        """Whether an effect for which so much speaks would show beside what is given, as cheap as it can be."""
        softness = WEIGHTS.softness(self.healthy.is_noise)
        return told - _least_price(effect) >= softness * float(np.log(WEIGHTS.least_seen))

    def _missed(self, fitted: Hypothesis) -> FloatArray:
        """Return whitened residuals (m,), weighed by how many of them count as one."""
        return np.concatenate([each.whitened * each.weights(self.share) for each in fitted.residuals])

    def _spread(self, fitted: Hypothesis, given: Hypothesis | None = None) -> tuple[float, float]:
        missed = self._missed(given or self._nothing(fitted))
        block = np.concatenate([self._block(each) for each in fitted.residuals])
        return gain_spread(missed, self._missed(fitted), block)

    def _by_cycle(self, fitted: Hypothesis) -> FloatArray:
        """Return the squares that a hypothesis leaves of each judged cycle of a chain (cycles,); none of a room."""
        if self.problem.segment.with_room:
            return np.zeros(0)
        judged = np.concatenate([each.judged for each in fitted.residuals])
        _, member = np.unique(np.concatenate([each.block for each in fitted.residuals])[judged], return_inverse=True)
        squares = [self._squares(fitted, each) * each.weights(self.share) ** 2 for each in fitted.residuals]
        return np.asarray(np.bincount(member, np.concatenate(squares)[judged]))

    def _block(self, residual: Residual) -> np.ndarray:
        """Return the number of the cycle, of a room of the quarter of a day, of each residual."""
        if not self.problem.segment.with_room:
            return residual.block
        return blocks_of_room(residual, self.problem.record.interval_s)

    def _notable(self, fitted: Hypothesis, pattern: Pattern | None) -> Iterator[str]:
        """Yield the names of effects that depart by more than is worth a name, and than real motors stray."""
        for effect, values in fitted.effects:
            rest = [each for each in fitted.effects if each[0] is not effect]
            without = self.problem.edited(rest, fitted.departures)
            if departure(effect, values, without) <= WEIGHTS.notable:
                continue
            if effect.stage != "actuator" or not self._may_stray(pattern) or not self._strays(without, rest, fitted):
                yield effect.name

    def _may_stray(self, pattern: Pattern | None) -> bool:
        """Whether motors stray: from what is believed, else in strokes that are told apart and always differ alike."""
        is_told = any(each.is_at_rest for each in self.none.by_motion)
        return self.healthy.tolerated_travel > 0.0 or (is_told and pattern is None)

    def _strays(self, without: Belief, rest: Edits, fitted: Hypothesis) -> bool:
        """Whether a motor differs from that without an effect by no more than real ones stray; `rest`: the others.

        From itself it strays less, and in its strokes only: a healthy record has no pauses and pulses of all lengths.
        """
        most = limits()["tolerated"].value if self.healthy.tolerated_travel else WEIGHTS.strays
        strays = travel(self.problem.record, without, self.problem.belief_of(fitted)) <= most
        return strays and not self._shows_at_rest(fitted, self.problem.at(rest, fitted.departures, fitted.convention))

    def _shows_at_rest(self, fitted: Hypothesis, without: Hypothesis | None) -> bool:
        """Whether a hypothesis changes a motor or valve at rest, beside another one, by more than is usual there."""
        pairs = zip(fitted.by_motion, without.by_motion if without else (), strict=False)
        resting = [(new, old) for new, old in pairs if old.is_at_rest and old.judged.any()]
        return any(
            float(self.healthy.acts(old, new)[old.judged].mean()) > self.healthy.usual(old) ** 2 for new, old in resting
        )

    def misfit(self, fitted: Hypothesis) -> float:
        """Return by how much the channel that is missed most is missed by more than in the healthy record."""
        pairs = zip(self._none_read(fitted.convention).by_motion, fitted.by_motion, strict=True)
        counted = [self._misfit(fitted, old, new) for old, new in pairs if not self._is_covered(fitted, new)]
        whole = self._nothing(fitted) if fitted.is_at_times else fitted
        coarser = coarser_steps(self.problem.segment, self.problem.record, self.healthy)
        return max([*counted, past_switch(self.problem, self.healthy, whole), coarser])

    def _is_covered(self, fitted: Hypothesis, residual: Residual) -> bool:
        """Whether a motor is missed by no more than real ones stray."""
        most = self.healthy.tolerated_travel
        return most > 0.0 and travel_left(self.problem, fitted, residual) <= most

    def _misfit(self, fitted: Hypothesis, none: Residual, residual: Residual) -> float:
        count = int(residual.judged.sum())
        healthy = self.healthy.left(residual.channel)
        if not count or healthy is None:
            return 0.0
        # a valve that moves more often is missed more often; moves and rest that are weighed apart are not
        cycles, segment = len(np.unique(residual.block[residual.judged])), self.problem.segment
        is_whole = residual.channel in segment.judged and not segment.with_room
        more = max(1.0, cycles / count * healthy.samples / healthy.cycles) if is_whole else 1.0
        kept = 0.0 if segment.with_room else self._kept(none, residual)
        explained = max(0.0, min(none.loss() - residual.loss(), (1.0 - kept) * none.loss())) / count
        usual = float(np.sqrt(more * self.healthy.usual(residual) ** 2 + WEIGHTS.form**2 * explained))
        squares = self._squares(fitted, residual)[residual.judged]
        left = max(0.0, _lasting(squares, np.ones(count), residual.block[residual.judged])) ** 0.5
        # errors of different cycles do not hang together, however alike something that is always amiss makes them
        share = min(self.share.get(residual.channel, 1.0), count / cycles)
        scatter = np.sqrt(self.healthy.scatter(residual) ** 2 + 0.5 * share / count + 0.5 * share / healthy.samples)
        return max(0.0, float(np.log(max(left / usual, 1.0)) / scatter))


def _price(effect: EffectType, values: Values) -> float:
    """Return what an effect costs: that it came, its parameters, its days, and its hours, unless it acts always."""
    least = _least_price(effect)
    if not effect.has_hours() or effect.hours(effect.Parameters(**values)) is None:
        return least
    return least + float(np.log(SPANS))


def _least_price(effect: EffectType) -> float:
    """Return what an effect costs that acts always."""
    came, days = -float(np.log(WEIGHTS.prior)), days_of(effect)
    if days is not None:
        came += WEIGHTS.price + float(np.log(days.tried))
    return came + WEIGHTS.price * (len(effect.priors) - (len(HOURS) if effect.has_hours() else 0))


def _of_form(left: Residual, change: FloatArray) -> FloatArray:
    """Return the squares that would go of each judged cycle if an effect were stronger or weaker there (cycles,).

    Its strength may differ by the share of an effect that its form may leave. `change` (m,) is what the effect does to
    the residuals. What is left across it has another cause; errors of switches have no sign and always lie along it.
    """
    along, power = along_change(left.whitened[left.judged], change[left.judged], left.block[left.judged])
    best = np.divide(along, power, out=np.zeros(len(along)), where=power > 0.0)
    more = np.clip(best, -WEIGHTS.form, WEIGHTS.form)
    return np.asarray(more * (2.0 * along - more * power))


def _gap_square(residual: Residual) -> float:
    """Return the mean square error in the channel's unit, without the cycle of most."""
    judged = residual.judged
    return _lasting(residual.error[judged] ** 2, np.ones(int(judged.sum())), residual.block[judged])


def _lasting(missed: FloatArray, power: FloatArray, block: np.ndarray) -> float:
    """Return what is missed over a power without the day or cycle of most: what happened once may be chance."""
    _, member = np.unique(block, return_inverse=True)
    sums = np.array([np.bincount(member, missed), np.bincount(member, power)])
    if sums.shape[1] > 1:
        sums = np.delete(sums, np.argmax(sums[0]), axis=1)
    over, whole = sums.sum(axis=1)
    return float(over / whole) if whole else 0.0
