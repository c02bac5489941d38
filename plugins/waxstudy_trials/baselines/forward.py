"""Forward selection by likelihood ratio: at each link, effect after effect, as long as chi-square says so.

It takes a diagnosis' links and fits, and believes that whitened errors are white and the model is right.
"""

from __future__ import annotations

from collections.abc import Sequence

from waxstudy.dataset.read import Dataset
from waxstudy.gap.diagnose import installed_effects
from waxstudy.gap.fit import Fitter
from waxstudy.gap.fitted import Fitted
from waxstudy.gap.judge import FIT, SELECT, SHRINK
from waxstudy.gap.links import links
from waxstudy.gap.space import EffectType
from waxstudy_trials.baselines import Json, answer, taken

LEVEL = 0.01  # over the effects of a link (Bonferroni)
MOST = 2
THOROUGH = 0.25
WHOLE = (FIT, SELECT, SHRINK)


def diagnose(dataset: Dataset) -> Json:
    """Return the effects of all links that a likelihood ratio adds."""
    record, belief = taken(dataset)
    cut = links(record, belief)
    found: dict[str, tuple[EffectType, dict[str, float]]] = {}
    for link in (each for each in cut if not each.is_supply):
        fitter = Fitter(link, record, belief, THOROUGH, dataset.room_tolerance)
        for effect, values in _added(fitter, [e for e in installed_effects() if e.stage in link.stages]):
            found.setdefault(effect.name, (effect, values))
    return answer(dataset, list(found.values()), "" if cut else "nothing to judge")


def _added(fitter: Fitter, effects: Sequence[EffectType]) -> list[tuple[EffectType, dict[str, float]]]:
    current = fitter.base
    for _ in range(MOST):
        tried = [one for e in effects if e.name not in current.names and (one := fitter.fit(e, current, WHOLE))]
        accepted = [one for one in tried if _gain(current, one) > _threshold(one, len(effects))]
        if not accepted:
            break
        current = min(accepted, key=_loss)
    return [(effect, dict(values)) for effect, values in current.effects]


def _loss(fitted: Fitted) -> float:
    """Minus twice the logarithm of the likelihood."""
    return sum(fitted.loss(part) for part in WHOLE)


def _gain(current: Fitted, one: Fitted) -> float:
    return _loss(current) - _loss(one)


def _threshold(one: Fitted, tried: int) -> float:
    from scipy.stats import chi2

    return float(chi2.isf(LEVEL / tried, max(1, len(one.effects[-1][0].priors))))
