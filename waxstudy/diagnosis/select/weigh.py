"""What may differ at a link: every hypothesis fitted to the whole record, and how probable it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from waxstudy.diagnosis.calibration.calibrate import Healthy
from waxstudy.diagnosis.calibration.presumed import Presumed
from waxstudy.diagnosis.criteria import LIMITS
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.estimate.start_points import Screen
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.departure import departure
from waxstudy.diagnosis.select.evidence import Evidence
from waxstudy.diagnosis.select.patterns import Pattern, patterns
from waxstudy.diagnosis.select.superposed import Superposed
from waxstudy.diagnosis.select.timed import can_be_timed, timed
from waxstudy.plugin import FloatArray

COARSER = 2.0  # times as much healthy records vary of switches and of the return, of which a few tell
LEAST_LEFT, LEAST_OFF = 0.3, 1.0  # of what noise leaves, of a channel that runs on and of one that switches
LEAST_SHARE = 0.03  # of what an effect leaves
BLOCK_S = 21_600.0  # of a room, whose errors hang together for hours and are whitened
SCREENED = 1.0  # of log likelihood that an effect of a chain must promise for a closer look
DEEPER = 3  # hypotheses that others are tried beside
NOTABLE = 1.0  # noticeable steps of a chain's effect
STRONGEST = 4.0  # times what an effect does always, that it may do at times
Tick = Callable[[str], None]


@dataclass(frozen=True)
class Weighed:
    """A hypothesis of one link: its effects as fitted, and what speaks for it."""

    fitted: Hypothesis
    evidence: Evidence
    pattern: Pattern | None = None  # where it does not act always


class Weighing:
    """Weighs what may differ at one link from its healthy record, or from what is presumed of one."""

    def __init__(
        self,
        problem: SegmentProblem,
        effects: Sequence[EffectType],
        healthy: Healthy | Presumed,
        thorough: float,
        tick: Tick,
    ) -> None:
        self.problem, self.tick, self.healthy = problem, tick, healthy
        self.estimator = Estimator(problem, thorough)
        self.effects = [effect for effect in effects if not effect.hindrance(problem.belief)]
        self.share = self._shares()
        if problem.segment.with_room:
            make: Callable[..., EffectType] = timed  # a cached function takes hashable arguments, which classes are
            self.effects += [make(effect) for effect in self.effects if can_be_timed(effect, problem.belief)]
        self.none = self.estimator.base

    def weighed(self) -> list[Weighed]:
        """Return the hypotheses: none, each effect, and the best few with every other."""
        singles = self._singles()
        if isinstance(self.healthy, Presumed):
            self.healthy = self.healthy.knowing(min((self.none, *singles), key=self._loss))
            self.share = self._shares()
        found = [self.of(each) for each in (self.none, *singles)]
        best = sorted(found[1:], key=lambda each: -each.evidence.score)[:DEEPER]
        tells = bool(best) and best[0].evidence.score > found[0].evidence.score
        if tells:
            found += list(self._patterned(best))
        if tells and not self.estimator.is_quick:
            for each in best:
                others = [effect for effect in self.effects if effect.name not in each.fitted.names]
                found += [self._beside(each, pair) for pair in self._one_more(others, each.fitted, self.tick)]
        return found

    def _singles(self) -> list[Hypothesis]:
        """Return each effect by itself, fitted to the whole record."""
        self._one_more = Superposed(self.estimator, self.none).fits if len(self.problem.sd) else self._fits
        singles = list(self._one_more(self.effects, self.none, self.tick))
        self._settle(singles)
        return singles

    def _shares(self) -> dict[str, float]:
        """Return how many samples of each channel count as one."""
        return {each.channel: self.healthy.together(each.channel) for each in self.healthy.fitted.residuals}

    def _settle(self, singles: Sequence[Hypothesis]) -> None:
        """Look for a better fit of nothing where the best effects led the room: else they gain what it had left."""
        if len(self.problem.sd):
            near = sorted(singles, key=self._loss)[:DEEPER]
            again = [self.estimator.nuisance_fit((), each.departures, each.convention, ALL) for each in near]
            self.none = min([self.none, *(each for each in again if each)], key=self._loss)

    def _fits(self, effects: Sequence[EffectType], given: Hypothesis, tick: Tick) -> Iterator[Hypothesis]:
        for effect in effects:
            tick(effect.name)
            fitted = self.estimator.fit(effect, given, ALL, Screen(SCREENED, self.share))
            if fitted is not None:
                yield fitted

    def _patterned(self, best: Sequence[Weighed]) -> Iterator[Weighed]:
        """Yield effects of the chain that act at certain times, where that tells much more than that they act always.

        What an effect does to each sample is taken times its strength there: what it does later is left out.
        """
        if self.problem.segment.with_room:
            return
        tried = list(patterns(self.problem.record))
        for each in best:
            if each.evidence.misfit <= 1.0:
                continue  # nothing is left for a pattern to tell
            made = [(self._with_pattern(each.fitted, pattern), pattern) for pattern in tried]
            fitted, pattern = min(made, key=lambda pair: self._loss(pair[0]))
            weighed = self.of(fitted)
            more = LIMITS.price + float(np.log(len(tried)))
            evidence = replace(weighed.evidence, price=weighed.evidence.price + more)
            yield replace(weighed, evidence=evidence, pattern=pattern)

    def _with_pattern(self, fitted: Hypothesis, pattern: Pattern) -> Hypothesis:
        """Return a hypothesis whose effect has a course, at the strength that suits the record best."""
        pairs = list(zip(self.none.residuals, fitted.residuals, strict=True))
        courses = [pattern.strength[new.sample] for _, new in pairs]
        before = np.concatenate([old.whitened / self.share.get(old.channel, 1.0) ** 0.5 for old, _ in pairs])
        parts = zip(pairs, courses, strict=True)
        change = np.concatenate(
            [g * (new.whitened - old.whitened) / self.share.get(old.channel, 1.0) ** 0.5 for (old, new), g in parts]
        )
        strength = float(np.clip(-(before @ change) / max(float(change @ change), 1e-12), 0.0, STRONGEST))
        return replace(
            fitted,
            residuals=[
                replace(
                    new,
                    error=old.error + strength * g * (new.error - old.error),
                    whitened=old.whitened + strength * g * (new.whitened - old.whitened),
                )
                for (old, new), g in zip(pairs, courses, strict=True)
            ],
        )

    def _beside(self, given: Weighed, fitted: Hypothesis) -> Weighed:
        """Return a hypothesis with one more effect: it gains what days and cycles say that it adds, each by itself."""
        weighed, first = self.of(fitted, given.fitted), given.evidence
        # what the form of the first effect may leave is no second one
        more = weighed.evidence.gain - first.gain - LIMITS.form**2 * max(0.0, first.gain)
        spread, most = self._spread(fitted, given.fitted)
        gain = first.gain + min(more / spread, most)
        return replace(weighed, evidence=replace(weighed.evidence, gain=gain, spread=first.spread, most=first.most))

    def of(self, fitted: Hypothesis, given: Hypothesis | None = None) -> Weighed:
        """Return a hypothesis, added to nothing or to a given one, with what speaks for it."""
        ease = 0.5 * (self.estimator.strain(self.none) - self.estimator.strain(fitted))
        gain = 0.5 * (self._loss(self.none) - self._loss(fitted)) - ease
        spread, most = self._spread(fitted)
        evidence = Evidence(
            effects=fitted.names,
            names=tuple(sorted(self._notable(fitted))),
            gain=gain,
            ease=ease,
            always=self.healthy.gain(fitted.effects) if fitted.effects else 0.0,
            misfit=self.misfit(fitted),
            price=price([effect for effect, _ in fitted.effects]),
            spread=spread,
            most=most,
            left=self._left(fitted),
            stands=self._stands(fitted, given or self.none),
            of_room=self.problem.segment.with_room,
        )
        return Weighed(fitted, evidence)

    def _stands(self, fitted: Hypothesis, given: Hypothesis) -> float:
        """Return how far what another hypothesis leaves stands out; of a chain where this one changes it.

        What the form of a room may leave is no finding. A healthy record tells that by what it leaves of a room.
        """
        if self.problem.segment.with_room:
            return np.inf if isinstance(self.healthy, Healthy) else self.misfit(given)
        power = missed = 0.0
        for old, new in zip(given.residuals, fitted.residuals, strict=True):
            change = (old.whitened - new.whitened) ** 2
            # noise of its drive moves what runs on at its edges most, where any other model changes it too
            weight = change if old.unit == "s" else np.full(len(change), change.mean())
            power += float(change.sum())
            missed += float(weight @ old.whitened**2) / self._usual(old) ** 2
        return max(0.0, 0.5 * float(np.log(missed / power)) / LIMITS.scatter) if power and missed else 0.0

    def _usual(self, residual: Residual) -> float:
        """Return what nothing amiss leaves of a sample, over what it is weighed by."""
        healthy = self.healthy.left(residual.channel)
        least = LEAST_OFF if residual.unit == "s" else LEAST_LEFT
        return max(healthy.whitened, least) if healthy else least

    def _left(self, fitted: Hypothesis) -> float:
        """Return which share of what is missed beyond what nothing amiss leaves a hypothesis leaves.

        A room's innovations hardly tell what lasts: there it is that of its gaps, of which small ones tell nothing.
        With a healthy record what a room leaves is judged by that alone.
        """
        if self.problem.segment.with_room and isinstance(self.healthy, Healthy):
            return LEAST_SHARE
        before, after = self._beyond(self.none), self._beyond(fitted)
        if before <= 0.0:
            return LEAST_SHARE if self.problem.segment.with_room else 1.0
        return float(max(LEAST_SHARE, min(1.0, (after / before) ** 0.5)))

    def _beyond(self, fitted: Hypothesis) -> float:
        if self.problem.segment.with_room:
            assert isinstance(self.healthy, Presumed)
            over = [each.gap() / self.healthy.usual_K(each.channel) for each in fitted.residuals]
            return sum(max(0.0, each**2 - 1.0) for each in over)
        return sum(max(0.0, each.loss() - self.healthy.usual_loss(each)) for each in fitted.residuals)

    def _loss(self, fitted: Hypothesis) -> float:
        """Return what a hypothesis misses; of a chain at least what a healthy record does."""
        strain = self.estimator.strain(fitted)
        if self.problem.segment.with_room:
            return self.healthy.room_loss(fitted) + strain
        pairs = ((each.loss(), self.healthy.usual_loss(each)) for each in fitted.residuals)
        shares = (self.share.get(each.channel, 1.0) for each in fitted.residuals)
        return strain + sum(max(pair) / share for pair, share in zip(pairs, shares, strict=True))

    def _missed(self, fitted: Hypothesis) -> FloatArray:
        """Return whitened residuals (m,), weighed by how many of them count as one."""
        return np.concatenate([each.whitened / self.share.get(each.channel, 1.0) ** 0.5 for each in fitted.residuals])

    def _spread(self, fitted: Hypothesis, given: Hypothesis | None = None) -> tuple[float, float]:
        """Return how much more than independent errors a gain varies over days or cycles, and the most they can tell.

        A gain that only few of them give is no effect's: the sandwich variance of its size (White 1980,
        doi:10.2307/1912934), and the logarithm of Student's t that so many give.
        """
        missed = self._missed(given or self.none)
        change = missed - self._missed(fitted)
        _, block = np.unique(np.concatenate([self._block(each) for each in fitted.residuals]), return_inverse=True)
        along, power = np.bincount(block, missed * change), np.bincount(block, change * change)
        count, whole = int(np.count_nonzero(power)), float(power.sum())
        if count < 2 or whole <= 0.0:
            return 1.0, 0.0
        off = along - along.sum() / whole * power
        variance = max(float(off @ off), 1e-12)
        t_2 = float(along.sum()) ** 2 / variance * (count - 1) / count
        return max(1.0, variance / whole), 0.5 * count * float(np.log1p(t_2 / (count - 1)))

    def _block(self, residual: Residual) -> np.ndarray:
        """Return the number of the cycle, of a room of the quarter of a day, of each residual."""
        if not self.problem.segment.with_room:
            return residual.block
        return (residual.sample * self.problem.record.interval_s // BLOCK_S).astype(int)

    def _notable(self, fitted: Hypothesis) -> Iterator[str]:
        """Yield the names of effects that depart by more than is worth a name."""
        least = LIMITS.notable_of_room if self.problem.segment.with_room else NOTABLE
        for effect, values in fitted.effects:
            rest = [each for each in fitted.effects if each[0] is not effect]
            if departure(effect, values, self.problem.edited(rest, fitted.departures)) > least:
                yield effect.name

    def misfit(self, fitted: Hypothesis) -> float:
        """Return by how much the channel that is missed most is missed by more than in the healthy record."""
        pairs = zip(self.none.residuals, fitted.residuals, strict=True)
        return max((self._misfit(before, after) for before, after in pairs), default=0.0)

    def _misfit(self, none: Residual, residual: Residual) -> float:
        count = int(residual.judged.sum())
        healthy = self.healthy.left(residual.channel)
        if not count or healthy is None:
            return 0.0
        if isinstance(self.healthy, Presumed) and self.problem.segment.with_room:
            return self.healthy.misfit(residual)
        usual = max(healthy.whitened, LEAST_OFF if residual.unit == "s" else LEAST_LEFT)
        # a valve that moves more often is missed more often: of samples and cycles the ones that tell less
        cycles = len(np.unique(residual.block[residual.judged]))
        is_room = self.problem.segment.with_room
        more = 1.0 if is_room else max(1.0, cycles / count * healthy.samples / healthy.cycles)
        explained = max(0.0, none.loss() - residual.loss()) / count
        usual = float(np.sqrt(more * usual**2 + LIMITS.form**2 * explained))
        left, before = float(np.sqrt(residual.loss() / count)), healthy.samples
        share = self.share.get(residual.channel, 1.0)
        is_coarse = residual.unit == "s" or residual.channel == "return_temperature_C"
        own = (COARSER if is_coarse else 1.0) * LIMITS.scatter
        scatter = np.sqrt(own**2 + 0.5 * share / count + 0.5 * share / before)
        return max(0.0, float(np.log(max(left / usual, 1.0)) / scatter))


def price(effects: Sequence[EffectType]) -> float:
    """Return the log likelihood that effects cost: their parameters, and that each of them came."""
    return LIMITS.price * sum(len(each.priors) for each in effects) - float(np.log(LIMITS.prior)) * len(effects)
