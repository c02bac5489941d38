"""What changed since a healthy record: every hypothesis fitted to the whole record, and how probable it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from waxstudy.diagnosis.calibration.calibrate import Healthy
from waxstudy.diagnosis.calibration.presumed import Presumed
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.estimate.start_points import Screen
from waxstudy.diagnosis.model.as_built import Knob
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.evidence import departure
from waxstudy.diagnosis.select.patterns import Pattern, patterns
from waxstudy.diagnosis.select.superposed import Superposed
from waxstudy.diagnosis.select.timed import can_be_timed, timed
from waxstudy.plugin import FloatArray

# constants of the posterior
PRIOR = 0.02  # of each effect that it came: that of a whole library something did is as likely as not
PRICE = 2.0  # of a free parameter, in units of log likelihood
UNKNOWN_PRICE = 5.0  # of leaving something to what is unknown
SCATTER, COARSE = 0.25, 0.5  # of the logarithm of what healthy records leave; of switches and the return, a few tell
LEAST_LEFT, LEAST_OFF = 0.3, 1.0  # of what noise leaves, of a channel that runs on and of one that switches
FORM = 0.1  # of what an effect explains, that its form may leave
SURE = 1.25  # of the square of a misfit: the log likelihood by which a chain's more can outdo less
ALIKE = 2.0  # power of the share that an effect leaves: the probability that something unknown looks like it so far
LEAST_SHARE = 0.03  # of what an effect leaves
BLOCK_S = 21_600.0  # of a room, whose errors hang together for hours and are whitened
SCREENED = 1.0  # of log likelihood that an effect of a chain must promise for a closer look
DEEPER = 3  # hypotheses that others are tried beside
LEAST_SEEN = 0.01  # probability of an effect that shows
LIKELIER = 0.5
OPEN = 1.0  # standard deviations of misfit, from which on a chain's hypothesis leaves something to tell
NOTABLE = 0.3  # noticeable steps: how much it matters is another question than whether it is there
SOFT = 1.5  # of what speaks for a hypothesis, as a power: how much surer it looks than it is
UNSEEN = {False: 0.01, True: 0.1}  # where nothing shows, that there is an effect which does not: of a chain, of a room
STRONGEST = 4.0  # times what an effect does always, that it may do at times
UNKNOWN = "unknown"
NONE = "none"
Tick = Callable[[str], None]


@dataclass(frozen=True)
class Weighed:
    """A hypothesis of one link: its effects as fitted, and what speaks for it, as logarithms."""

    fitted: Hypothesis
    names: tuple[str, ...]  # of its effects that are large enough to be worth a name, in alphabetical order
    gain: float  # of likelihood over that of nothing, by what is missed
    ease: float  # the same by how far the room need not depart
    always: float  # how much likelier the healthy record would be, had it been so from the start
    misfit: float  # what it leaves beyond what healthy records do, in standard deviations
    price: float  # of its parameters, and that anything of the kind happens
    spread: float  # variance of the gain from day to day or cycle to cycle, over that which independent errors have
    most: float  # gain that so many days or cycles can tell at all
    unlike: float = 0.0  # how much less likely the later record is then: the healthy one would have taught otherwise
    left: float = 1.0  # share of what is missed beyond what nothing amiss leaves
    is_of_room: bool = False
    stands: float = np.inf  # how far what is missed without it stands out where it acts, in standard deviations
    pattern: Pattern | None = None  # where it does not act always


class Weighing:
    """Weighs what may have changed at one link."""

    def __init__(
        self,
        problem: SegmentProblem,
        effects: Sequence[EffectType],
        healthy: Healthy | Presumed,
        thorough: float,
        tick: Tick,
    ) -> None:
        self.problem, self.tick, self.healthy = problem, tick, healthy
        self.estimator = Estimator(problem, thorough, keeps=True)
        self.effects = [effect for effect in effects if not effect.hindrance(problem.belief)]
        self.share = self._shares()
        if problem.segment.with_room:
            make: Callable[..., EffectType] = timed  # a cached function takes hashable arguments, which classes are
            self.effects += [make(effect) for effect in self.effects if can_be_timed(effect, problem.belief)]
        self.none = self.estimator.settled(self.estimator.base)

    def weighed(self) -> list[Weighed]:
        """Return the hypotheses: none, each effect, and the best few with every other."""
        singles = self._singles()
        if isinstance(self.healthy, Presumed):
            self.healthy = self.healthy.knowing(min((self.none, *singles), key=self._loss))
            self.share = self._shares()
        found = [self.of(each) for each in (self.none, *singles)]
        # an effect that comes and goes gains much, but not on all days
        told = [each for each in found[1:] if each.gain + each.ease > each.price]
        found += list(self._patterned(sorted(told, key=lambda each: -each.gain)[:DEEPER]))
        best = sorted(found[1:], key=lambda each: -score(each))[:DEEPER]
        if best and score(best[0]) > score(found[0]) and not self.estimator.is_quick:
            for each in self._open(best):
                others = [effect for effect in self.effects if effect.name not in each.fitted.names]
                found += [self._beside(each, pair) for pair in self._one_more(others, each.fitted, self.tick)]
        return found

    def _open(self, best: Sequence[Weighed]) -> list[Weighed]:
        """Return hypotheses that leave something for more to tell; of a room its unknowns may hide that."""
        return [each for each in best if self.problem.segment.with_room or each.misfit > OPEN]

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
        for each in self._open(best):
            made = [(self._with_pattern(each.fitted, pattern), pattern) for pattern in tried]
            fitted, pattern = min(made, key=lambda pair: self._loss(pair[0]))
            weighed = self.of(fitted)
            price = weighed.price + PRICE + float(np.log(len(tried)))
            yield replace(weighed, price=price, pattern=pattern)

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
        weighed = self.of(fitted, given.fitted)
        # what the form of the first effect may leave is no second one
        more = weighed.gain - given.gain - FORM**2 * max(0.0, given.gain)
        spread, most = self._spread(fitted, given.fitted)
        return replace(weighed, gain=given.gain + min(more / spread, most), spread=given.spread, most=given.most)

    def of(self, fitted: Hypothesis, given: Hypothesis | None = None) -> Weighed:
        """Return a hypothesis, added to nothing or to a given one, with what speaks for it."""
        parameters = sum(len(effect.priors) for effect, _ in fitted.effects)
        ease = 0.5 * (self.estimator.strain(self.none) - self.estimator.strain(fitted))
        gain = 0.5 * (self._loss(self.none) - self._loss(fitted)) - ease
        always, moved = self._always(fitted)
        spread, most = self._spread(fitted)
        price = PRICE * parameters - float(np.log(PRIOR)) * len(fitted.effects)
        names = tuple(sorted(self._notable(fitted)))
        return Weighed(
            fitted,
            names,
            gain,
            ease,
            always / spread if always > 0.0 else always,
            self.misfit(fitted),
            price,
            spread,
            most,
            unlike=self._unlike(fitted, moved) if always > 0.0 else 0.0,
            left=self._left(fitted),
            is_of_room=self.problem.segment.with_room,
            stands=self._stands(fitted, given or self.none),
        )

    def _always(self, fitted: Hypothesis) -> tuple[float, FloatArray]:
        """Return how much likelier the healthy record were, had effects been there then, and what else would differ.

        Of what was calibrated on it is known how much of it was there: more of it is a change.
        """
        known = self.problem.as_built.knobs if self.problem.as_built else ()
        calibrated = {each.effect for each in known if isinstance(each, Knob)}
        open_ = [(effect, values) for effect, values in fitted.effects if effect not in calibrated]
        return self.healthy.had_it(open_) if open_ else (0.0, np.zeros(len(self.problem.sd)))

    def _unlike(self, fitted: Hypothesis, moved: FloatArray) -> float:
        """Return how much less likely a room's record is if what was calibrated lies elsewhere, all else fitted again.

        What a healthy record cannot tell from an effect would have taken its place there, and did not change since.
        """
        sd = self.problem.sd
        if not len(sd) or self.problem.as_built is None:
            return 0.0
        count = len(self.problem.as_built.knobs)
        weight = np.concatenate(
            [np.full(len(e.whitened), self.share.get(e.channel, 1.0) ** -0.5) for e in fitted.residuals]
        )
        root = self.problem.prior / sd
        ways = np.vstack((self.estimator.slopes_at(fitted) * weight[:, None], root))

        def loss(mean: FloatArray) -> float:
            both = np.concatenate((fitted.whitened * weight, root @ (fitted.departures - mean)))
            left = both + ways @ np.linalg.lstsq(ways, -both, rcond=None)[0]
            return float(left @ left)

        elsewhere = np.concatenate((moved[:count], np.zeros(len(sd) - count)))
        return 0.5 * max(0.0, loss(elsewhere) - loss(np.zeros(len(sd))))

    def _stands(self, fitted: Hypothesis, given: Hypothesis) -> float:
        """Return how far what another hypothesis leaves of a chain stands out where this one changes it."""
        if self.problem.segment.with_room:
            return np.inf
        power = missed = 0.0
        for old, new in zip(given.residuals, fitted.residuals, strict=True):
            change = (old.whitened - new.whitened) ** 2
            # noise of its drive moves what runs on at its edges most, where any other model changes it too
            weight = change if old.unit == "s" else np.full(len(change), change.mean())
            power += float(change.sum())
            missed += float(weight @ old.whitened**2) / self._usual(old) ** 2
        return max(0.0, 0.5 * float(np.log(missed / power)) / SCATTER) if power and missed else 0.0

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
        for effect, values in fitted.effects:
            rest = [each for each in fitted.effects if each[0] is not effect]
            if departure(effect, values, self.problem.edited(rest, fitted.departures)) > NOTABLE:
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
        usual = float(np.sqrt(more * usual**2 + FORM**2 * explained))
        left, before = float(np.sqrt(residual.loss() / count)), healthy.samples
        # errors of different cycles do not hang together, however alike something that is always amiss makes them
        share = min(self.share.get(residual.channel, 1.0), count / cycles)
        own = COARSE if residual.unit == "s" or residual.channel == "return_temperature_C" else SCATTER
        scatter = np.sqrt(own**2 + 0.5 * share / count + 0.5 * share / before)
        return max(0.0, float(np.log(max(left / usual, 1.0)) / scatter))


def score(weighed: Weighed) -> float:
    """Return the logarithm of what speaks for a hypothesis by itself, with nothing unknown beside it."""
    return (
        weighed.gain / weighed.spread
        + weighed.ease
        - max(0.0, weighed.always)
        - 0.5 * weighed.misfit**2
        - weighed.price
    )


def posterior(found: Sequence[Weighed], soft: float = SOFT, unseen: float | None = None) -> dict[str, float]:
    """Return the probability of each hypothesis of a link, with something unknown beside it or not; they sum to 1.

    The first is that nothing changed. What was so from the start is no change. `python -m benchmarks.posterior` asks
    for other values of what is learned.
    """
    best = max(found, key=score)
    gains = _gains(found, best)
    logs: dict[str, float] = {}
    for each, gain in zip(found, gains, strict=True):
        _add(logs, each.names, gain - max(0.0, each.always) - each.price, each.misfit)
        if len(each.fitted.effects) == 1:
            _raise(logs, (UNKNOWN,), _mimicked(each, gain))
        if each.always > 0.0:
            _add(logs, (), gain - each.unlike - each.price, each.misfit)
    most = max(logs.values())
    weights = {name: float(np.exp((value - most) / soft)) for name, value in logs.items()}
    whole = sum(weights.values())
    share = UNSEEN[found[0].is_of_room] if unseen is None else unseen
    return _with_unseen({name: weight / whole for name, weight in weights.items()}, found, share)


def _with_unseen(beliefs: Mapping[str, float], found: Sequence[Weighed], share: float) -> dict[str, float]:
    """Return probabilities that leave a share of nothing to effects which may be there and would not show."""
    told = dict(beliefs)
    singles = {each.fitted.names[0] for each in found if len(each.fitted.effects) == 1}
    hidden = sorted(name for name in singles if told.get(name, 0.0) < LEAST_SEEN)
    if not hidden or NONE not in told:
        return told
    unseen = told[NONE] * share
    told[NONE] -= unseen
    for name in hidden:
        told[name] = told.get(name, 0.0) + unseen / len(hidden)
    return told


def _mimicked(each: Weighed, gain: float) -> float:
    """Return what speaks for something unknown that looks like an effect: the less likely the more alike."""
    freedom = each.price + float(np.log(PRIOR))  # of its parameters, and of when it acts
    return gain - max(0.0, each.always) - freedom + ALIKE * float(np.log(each.left)) - UNKNOWN_PRICE


def _gains(found: Sequence[Weighed], best: Weighed) -> list[float]:
    """Return what speaks for each hypothesis; more cannot outdo less by more than what stands out without it."""
    gains = [each.gain / (best.spread if best.names else each.spread) + each.ease for each in found]
    order = sorted(range(len(found)), key=lambda place: -len(found[place].fitted.effects))
    for place in order:
        each = found[place]
        if best.names and not each.names:
            # days and cycles can speak against it only so much
            gains[place] = max(gains[place], best.gain / best.spread - best.most)
        more = [
            gains[n] - SURE * other.stands**2 for n, other in enumerate(found) if _is_within(each.fitted, other.fitted)
        ]
        gains[place] = max([gains[place], *more])
    return _with_peers(found, gains)


def _with_peers(found: Sequence[Weighed], gains: Sequence[float]) -> list[float]:
    """Return what speaks for each: of single effects of a chain one that leaves nothing amiss is outdone by little.

    A finer name must be earned: real motors have no form of the library exactly.
    """
    singles = [place for place, each in enumerate(found) if len(each.fitted.effects) == 1 and each.stands < np.inf]
    most = max((gains[place] for place in singles), default=0.0)
    least = {place: most - UNKNOWN_PRICE - SURE * found[place].misfit ** 2 for place in singles}
    return [max(gain, least.get(place, gain)) for place, gain in enumerate(gains)]


def _is_within(one: Hypothesis, other: Hypothesis) -> bool:
    """Whether another hypothesis is one effect on top of this."""
    return bool(other.names) and other.names[:-1] == one.names


def _add(logs: dict[str, float], names: Sequence[str], value: float, misfit: float) -> None:
    """Take a hypothesis in, with something unknown beside it and without; of several the best counts."""
    pairs = (("+".join(names) or NONE, 0.5 * misfit**2), ("+".join((*names, UNKNOWN)), UNKNOWN_PRICE))
    for key, price in pairs:
        _raise(logs, key.split("+"), value - price)


def _raise(logs: dict[str, float], names: Sequence[str], value: float) -> None:
    key = "+".join(names)
    logs[key] = max(logs.get(key, -np.inf), value)
