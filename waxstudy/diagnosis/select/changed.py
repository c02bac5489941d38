"""What changed at a link since its healthy record, and how sure that is: a selection by probability."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.model.edits import EffectType, Values
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import Interval
from waxstudy.diagnosis.select.candidate import Candidate
from waxstudy.diagnosis.select.intervals import Intervals, parameter_intervals
from waxstudy.diagnosis.select.posterior import NONE, UNKNOWN, Weighed, posterior, score
from waxstudy.diagnosis.select.search import Found, Search, Selection, distinct_in
from waxstudy.diagnosis.select.weigh import Tick, Weighing
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import Belief

LEAST_TOLD = 1e-4  # of a joint hypothesis


def changed(search: Search, healthy: Healthy, whole: SegmentProblem, tick: Tick) -> Selection:
    """Return what changed at a link; `whole` is its problem with all days to fit."""
    weighing = Weighing(whole, search.effects, healthy, search.estimator.thorough, tick)
    search.estimator.before = weighing.estimator.followed
    weighed = weighing.weighed()
    beliefs, tried = posterior(weighed), _tried(search, weighed)
    while True:
        choice = Choice.of(beliefs)
        found = _found(search, weighed, choice, beliefs)
        names = [each.effect.name for each in found]
        best = best_with(weighed, names)
        last, intervals = _of_all_days(weighing, best) if found else (best.fitted, {})
        rests = [likeliest_with(weighed, [other for other in names if other != name]) for name in names]
        unsure = [each for each, rest in zip(found, rests, strict=True) if _may_be_blurred(best, rest, each)]
        blurred = [each for each in unsure if distinct_in(whole, last, each.effect, intervals) <= WEIGHTS.notable]
        if not blurred:
            return replace(search.selection(found, tried, intervals, last), posterior=beliefs, off_by=best.off_by)
        kept = WEIGHTS.blurred if search.problem.segment.with_room else 0.0
        beliefs = _without(beliefs, {each.effect.name for each in blurred}, kept)


def _of_all_days(weighing: Weighing, best: Weighed) -> tuple[Hypothesis, Intervals]:
    """Return a hypothesis fitted to all days, with the intervals of its parameters.

    What acts at times is fitted as if it acted always, and then made as strong as it is when it acts.
    """
    fitted, estimator = best.fitted, weighing.estimator
    last = estimator.refined(fitted.effects, fitted.departures, fitted.convention, ALL) or fitted
    intervals = parameter_intervals(estimator, last)
    if best.pattern is None:
        return last, intervals
    return last, {effect: _scaled(effect, each, weighing.problem.belief, best) for effect, each in intervals.items()}


def _scaled(effect: EffectType, found: Mapping[str, Interval], belief: Belief, best: Weighed) -> Mapping[str, Interval]:
    """Return intervals so many times as far from what is neutral as an effect is stronger while it acts."""
    neutral = effect.neutral(belief)
    if neutral is None:
        return found

    def ends(end: str) -> Values:
        return Space(effect).scaled({name: getattr(each, end) for name, each in found.items()}, neutral, best.strength)

    values, low, high = ends("value"), ends("low"), ends("high")
    return {name: Interval(values[name], low[name], high[name]) for name in found}


def _may_be_blurred(best: Weighed, without: Weighed, found: Found) -> bool:
    """Return whether an effect may be nothing where its interval holds what is believed.

    `best` is the hypothesis with it, `without` the likeliest with all others that are named. What takes away more of
    a misfit than is open is something, unless it is a motor's: no model follows a motor in every pause. What comes and
    goes is blurred by the days without it.
    """
    takes_little = without.misfit - best.misfit <= WEIGHTS.open
    return best.pattern is None and (takes_little or found.effect.stage == "actuator")


def _without(beliefs: Mapping[str, float], blurred: set[str], kept: float) -> dict[str, float]:
    """Return probabilities where effects that may as well be what is believed are none, but for a share."""
    found: dict[str, float] = {}
    for name, probability in beliefs.items():
        rest = [each for each in name.split("+") if each not in blurred]
        for key, share in ((name, kept), ("+".join(rest) or NONE, 1.0 - kept)):
            found[key] = found.get(key, 0.0) + share * probability
    return {key: probability for key, probability in found.items() if probability > 0.0}


@dataclass(frozen=True)
class Choice:
    """The effects that are named, each with those that may stand in its place, itself first."""

    groups: tuple[tuple[str, ...], ...]

    @classmethod
    def of(cls, beliefs: Mapping[str, float]) -> Choice:
        """Return the answer of least expected cost: nothing, names, or the smallest groups.

        A wrong name costs so many times what saying nothing does where something is there.
        """
        sets: dict[frozenset[str], float] = {}
        for name, probability in beliefs.items():
            effects = frozenset(name.split("+")) - {NONE, UNKNOWN}
            sets[effects] = sets.get(effects, 0.0) + probability
        wrong, there = sets.get(frozenset(), 0.0), 1.0 - beliefs.get(NONE, 0.0)
        if WEIGHTS.named / (1.0 - WEIGHTS.named) * wrong > there:
            return cls(())
        best = max((each for each in sets if each), key=lambda each: sets[each])
        groups = [_group(name, best, sets) for name in sorted(best)]
        return cls(tuple(group for group in groups if group))


def _group(name: str, best: frozenset[str], sets: Mapping[frozenset[str], float]) -> tuple[str, ...]:
    """Return an effect and what may stand in its place, the likeliest first; nothing where it may as well not be."""
    rest = best - {name}
    held = sum(probability for effects, probability in sets.items() if name in effects)
    if held >= WEIGHTS.named:
        return (name,)
    instead: dict[str, float] = {}
    for effects, probability in sets.items():
        others = effects - rest
        if rest <= effects and len(others) == 1:
            (other,) = others
            instead[other] = instead.get(other, 0.0) + probability
    chosen, sum_, all_ = [name], instead.pop(name, 0.0), sum(instead.values())
    whole = sum_ + all_
    if rest and whole < WEIGHTS.likelier:
        return ()
    for other in sorted(instead, key=lambda each: -instead[each]):
        if sum_ >= WEIGHTS.credible * whole:
            break
        chosen.append(other)
        sum_ += instead[other]
    return tuple(chosen)


def _found(search: Search, weighed: Sequence[Weighed], choice: Choice, beliefs: Mapping[str, float]) -> list[Found]:
    """Return what is named as findings, each judged beside those before it."""
    first = [group[0] for group in choice.groups]
    if not first:
        return []
    best = best_with(weighed, first)
    values = {effect.name: (effect, each) for effect, each in best.fitted.effects}
    # what fits best without an effect may read the record in another way than with it
    current, found = search.under_convention(search.estimator.base, best.fitted.convention), []
    for group in choice.groups:
        edits = (*current.effects, values[group[0]])
        # a fit may end at another optimum: it begins where less is missed, as without the effect or as weighed
        start = search.estimator.nearest(edits, (current.departures, best.fitted.departures), current.convention)
        fitted = search.estimator.refined(edits, start, current.convention) or current
        candidate = search.judged(current, [(values[group[0]][0], fitted)])[0]
        beside = [name for name in first if name != group[0]]
        others = [_alternative(search, weighed, name, beside) for name in group[1:]]
        often = sum(p for name, p in beliefs.items() if set(group) & set(name.split("+")))
        pattern = best.pattern if len(choice.groups) == 1 else None
        found.append(Found(candidate, group, often, tuple(each for each in others if each), pattern))
        current = fitted
    return found


def best_with(weighed: Sequence[Weighed], names: Sequence[str]) -> Weighed:
    """Return the best hypothesis with at least these effects, and as few others as there are, small ones as well."""
    return max(_with(weighed, names), key=lambda each: (-len(each.names), -len(each.fitted.effects), score(each)))


def likeliest_with(weighed: Sequence[Weighed], names: Sequence[str]) -> Weighed:
    """Return the likeliest hypothesis with at least these effects and as few other names as there are.

    Effects too small for a name may stand beside them: they count as nothing.
    """
    return max(_with(weighed, names), key=lambda each: (-len(each.names), score(each)))


def _with(weighed: Sequence[Weighed], names: Sequence[str]) -> list[Weighed]:
    return [each for each in weighed if set(names) <= set(each.names)]


def _alternative(search: Search, weighed: Sequence[Weighed], name: str, beside: Sequence[str]) -> Candidate | None:
    """Return an effect that may stand in another's place, as it is fitted beside the others that are named."""
    if not (fitted := in_place(weighed, name, beside)):
        return None
    last = sorted(fitted.effects, key=lambda each: each[0].name == name)  # what it was added to goes before it
    return search.judged(search.estimator.base, [(last[-1][0], search.here(replace(fitted, effects=tuple(last))))])[0]


def in_place(weighed: Sequence[Weighed], name: str, beside: Sequence[str]) -> Hypothesis | None:
    """Return the best fit of an effect with some others and no more; by itself where nobody tried these together."""
    for names in ({name, *beside}, {name}):
        if possible := [each for each in weighed if set(each.fitted.names) == names]:
            return max(possible, key=score).fitted
    return None


def _tried(search: Search, weighed: Sequence[Weighed]) -> list[Candidate]:
    singles: list[tuple[EffectType, Hypothesis]] = [
        (each.fitted.effects[0][0], search.here(each.fitted)) for each in weighed if len(each.fitted.effects) == 1
    ]
    return search.judged(search.estimator.base, singles)


def joint(links: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the probability of each hypothesis of the whole loop, whose links are independent; they sum to 1."""
    found: dict[frozenset[str], float] = {frozenset(): 1.0}
    for link in links:
        more: dict[frozenset[str], float] = {}
        for names, probability in found.items():
            for name, own in link.items():
                both = names | (frozenset(name.split("+")) - {NONE})
                more[both] = more.get(both, 0.0) + probability * own
        found = {names: probability for names, probability in more.items() if probability >= LEAST_TOLD}
    whole = sum(found.values())
    told = {joined(names): probability / whole for names, probability in found.items()} if links else {}
    return dict(sorted(told.items(), key=lambda each: -each[1]))


def joined(names: frozenset[str]) -> str:
    """Return what a hypothesis is called: its effects in alphabetical order, something unknown behind them."""
    known = sorted(names - {UNKNOWN})
    return "+".join([*known, UNKNOWN] if UNKNOWN in names else known) or NONE
