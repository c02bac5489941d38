"""What differs at a link from what is known of it: by its healthy record, or without one by what is believed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from waxstudy.diagnosis.calibration.calibrate import Healthy
from waxstudy.diagnosis.calibration.presumed import Presumed
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.model.travel import is_within_stray
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.choice import Choice, without
from waxstudy.diagnosis.select.departure import distinct
from waxstudy.diagnosis.select.evidence import posterior
from waxstudy.diagnosis.select.selection import Candidate, Found, Selection, strongest
from waxstudy.diagnosis.select.weigh import NOTABLE, Tick, Weighed, Weighing


def differing(
    problem: SegmentProblem,
    healthy: Healthy | Presumed,
    whole: SegmentProblem,
    effects: Sequence[EffectType],
    thorough: float,
    tick: Tick,
) -> Selection:
    """Return what differs at a link; `whole` is its problem with nothing held out."""
    weighing = Weighing(whole, effects, healthy, thorough, tick)
    weighed = weighing.weighed()
    is_followed = isinstance(healthy, Healthy) and weighing.estimator.has_nuisances
    estimator = Estimator(problem, thorough, before=weighing.estimator.followed if is_followed else None)
    beliefs, tried = posterior([each.evidence for each in weighed]), _tried(weighed)
    while True:
        selection = _selection(estimator, weighed, tried, beliefs)
        if not (blurred := _blurred(selection)):
            return selection
        beliefs = without(beliefs, blurred)


def _selection(
    estimator: Estimator[SegmentProblem],
    weighed: Sequence[Weighed],
    tried: Mapping[str, Candidate],
    beliefs: Mapping[str, float],
) -> Selection:
    groups, evidence = Choice.of(beliefs).groups, [each.evidence for each in weighed]
    if not groups:
        return Selection.of(estimator, (), estimator.base.convention, tuple(tried.values()), beliefs, evidence)
    best = best_of(weighed, [group[0] for group in groups])
    values = {effect.name: (effect, each) for effect, each in best.fitted.effects}
    found = [
        Found(
            *values[group[0]],
            group,
            sum(p for name, p in beliefs.items() if set(group) & set(name.split("+"))),
            tuple(tried[name] for name in group[1:] if name in tried),
            best.pattern if len(groups) == 1 else None,
        )
        for group in groups
    ]
    return Selection.of(estimator, found, best.fitted.convention, tuple(tried.values()), beliefs, evidence)


def best_of(weighed: Sequence[Weighed], names: Sequence[str]) -> Weighed:
    """Return the best hypothesis with at least these effects, and as few others as there are."""
    return max((e for e in weighed if set(names) <= set(e.evidence.names)), key=_fewest_and_best)


def _fewest_and_best(weighed: Weighed) -> tuple[int, float]:
    return -len(weighed.evidence.names), weighed.evidence.score


def _tried(weighed: Sequence[Weighed]) -> dict[str, Candidate]:
    """Return each effect as it fits best by itself, by name."""
    none, found = weighed[0].fitted, {}
    singles = (each for each in weighed if len(each.fitted.effects) == 1)
    for each in sorted(singles, key=lambda each: each.evidence.score):
        ((effect, values),) = each.fitted.effects
        gain = each.evidence.gain + each.evidence.ease
        found[effect.name] = Candidate(effect, values, gain, *strongest(none, each.fitted))
    return found


def _blurred(selection: Selection) -> set[str]:
    """Return the groups of effects of a chain that, by their intervals, may as well be what is believed.

    A controller of another form looks as if it were tuned otherwise each time; a room has no settings. Without a
    healthy record a motor may differ as far as real ones stray.
    """
    last, problem = selection.after, selection.problem
    found: set[str] = set()
    # of what comes and goes the days without it blur what is fitted as if it acted always
    always = [each for each in selection.found if each.pattern is None]
    for each in () if selection.segment.with_room else always:
        rest = [(effect, values) for effect, values in last.effects if effect is not each.effect]
        believed = problem.edited(rest, last.departures)
        is_blurred = distinct(each.effect, selection.intervals[each.effect], believed) <= NOTABLE
        strays = each.effect.stage == "actuator" and not selection.is_compared
        if is_blurred or (strays and is_within_stray(problem.record, believed, problem.belief_of(last))):
            found |= set(each.group)
    return found
