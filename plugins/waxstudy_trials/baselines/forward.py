"""Forward selection by likelihood ratio: at each segment, effect after effect, as long as chi-square says so.

It takes a diagnosis' segments and fits, and believes that whitened residual are white and the model is right.
"""

from __future__ import annotations

from collections.abc import Sequence

from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import installed_effects
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import FIT, SELECT, SHRINK
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy_trials.baselines import Json, answer, taken

LEVEL = 0.01  # over the effects of a segment (Bonferroni)
MOST = 2
THOROUGH = 0.25
WHOLE = (FIT, SELECT, SHRINK)


def diagnose(dataset: Dataset) -> Json:
    """Return the effects of all segments that a likelihood ratio adds."""
    record, belief = taken(dataset)
    cut = segments(record, belief)
    found: dict[str, tuple[EffectType, dict[str, float]]] = {}
    for segment in (each for each in cut if not each.is_supply):
        estimator = Estimator(SegmentProblem(segment, record, belief, dataset.room_tolerance), THOROUGH)
        for effect, values in _added(estimator, [e for e in installed_effects() if e.stage in segment.stages]):
            found.setdefault(effect.name, (effect, values))
    return answer(dataset, list(found.values()), "" if cut else "nothing to judge")


def _added(
    estimator: Estimator[SegmentProblem], effects: Sequence[EffectType]
) -> list[tuple[EffectType, dict[str, float]]]:
    current = estimator.base
    for _ in range(MOST):
        tried = [one for e in effects if e.name not in current.names and (one := estimator.fit(e, current, WHOLE))]
        accepted = [one for one in tried if _gain(current, one) > _threshold(one, len(effects))]
        if not accepted:
            break
        current = min(accepted, key=_loss)
    return [(effect, dict(values)) for effect, values in current.effects]


def _loss(fitted: Hypothesis) -> float:
    """Minus twice the logarithm of the likelihood."""
    return sum(fitted.loss(part) for part in WHOLE)


def _gain(current: Hypothesis, one: Hypothesis) -> float:
    return _loss(current) - _loss(one)


def _threshold(one: Hypothesis, tried: int) -> float:
    from scipy.stats import chi2

    return float(chi2.isf(LEVEL / tried, max(1, len(one.effects[-1][0].priors))))
