"""An effect tried at a segment, with the evidence for it, and which of several is the best."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace

from waxstudy.diagnosis.criteria import Question, failed, meets
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.select.evidence import Evidence

SAME = 1e-6  # share of a gain that is but rounding


@dataclass(frozen=True)
class Candidate:
    """An effect tried on top of a model."""

    effect: EffectType
    fitted: Hypothesis
    evidence: Evidence

    def meets(self, question: Question) -> bool:
        return meets(question, self.evidence)

    @property
    def why_not(self) -> str:
        """Why it may not be claimed, by the first criterion that it does not meet; empty where it may."""
        criterion = failed(Question.CLAIM, self.evidence)
        return criterion.name if criterion else ""


def best_of(candidates: Sequence[Candidate]) -> Candidate:
    """Return the candidate that gains most; of those that gain the same but for rounding, the first by name.

    One with fewer parameters that cannot be told from it is better: more of them follow what sampling blurs.
    """
    most = max(c.evidence.gain for c in candidates)
    alike = [c for c in candidates if c.evidence.gain >= most * (1.0 - SAME)]
    best = min(alike, key=lambda c: c.effect.name)
    simpler = [c for c in candidates if c.evidence.parameters < best.evidence.parameters]
    even = [c for c in simpler if meets(Question.SIMPLER, SimpleNamespace(apart=_apart(best.evidence, c.evidence)))]
    return min(even, key=lambda c: (c.evidence.parameters, -c.evidence.gain, c.effect.name), default=best)


def alike(best: Candidate, candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Return the effects that cannot be told from the best one on what it was chosen by, the best first."""

    def is_alike(other: Evidence) -> bool:
        apart = _apart(best.evidence, other)
        return meets(Question.ALIKE, SimpleNamespace(p=other.p, gain_per_form=other.gain_per_form, apart=apart))

    others = [c for c in candidates if c.effect is not best.effect and is_alike(c.evidence)]
    nearest = sorted(others, key=lambda c: _apart(best.evidence, c.evidence))
    return (best.effect.name, *(c.effect.name for c in nearest))


def _apart(best: Evidence, other: Evidence) -> float:
    """Return how much more another one leaves, in units of what the best one leaves."""
    left = max(1.0, best.missed) ** 2 * best.form_share
    worse = other.loss + other.strain - best.loss - best.strain
    return worse / left if left else float("inf") if worse > 0.0 else -float("inf")
