"""What was found at one link, how probable it is, and the models that show how far its gap shrinks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.estimate.parameter_space import EffectType, Values
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import Interval
from waxstudy.diagnosis.select.evidence import UNKNOWN, Evidence
from waxstudy.diagnosis.select.intervals import parameter_intervals
from waxstudy.diagnosis.select.patterns import Pattern

Models = Sequence[Hypothesis]


@dataclass(frozen=True)
class Candidate:
    """An effect that was fitted by itself to the whole record, and what it does to the channel that it moves most."""

    effect: EffectType
    values: Values
    gain: float  # of log likelihood
    before: Residual
    after: Residual

    @property
    def channel(self) -> str:
        return self.before.channel

    def share(self, floor: NoiseFloor) -> float:
        """Return the share of the channel's squared gap above its floor that it explains; nothing of what is within."""
        before, after, least = (each**2 for each in (self.before.gap(), self.after.gap(), floor.plain[self.channel]))
        return (before - after) / (before - min(least, after)) if before > least else 0.0


@dataclass(frozen=True)
class Found:
    """A named effect, the names that may stand in its place (its own first), and how probable they are together."""

    effect: EffectType
    values: Values  # as fitted to the whole record
    group: tuple[str, ...]
    probability: float
    others: tuple[Candidate, ...] = ()  # of its group
    pattern: Pattern | None = None  # where it does not act always
    channel: str = ""  # that it moves most


@dataclass(frozen=True)
class Selection:
    """What was found at one link; `models`: the believed one and each with one more effect, on days not held out."""

    estimator: Estimator[SegmentProblem]
    models: Models
    without: Models  # the last model without each effect found
    found: tuple[Found, ...]
    tried: tuple[Candidate, ...]
    floor: NoiseFloor
    intervals: Mapping[EffectType, Mapping[str, Interval]]  # of what was found
    posterior: Mapping[str, float]  # of hypotheses
    evidence: Sequence[Evidence]  # that it follows from

    @classmethod
    def of(
        cls,
        estimator: Estimator[SegmentProblem],
        named: Sequence[Found],
        convention: Convention,
        tried: Sequence[Candidate],
        posterior: Mapping[str, float],
        evidence: Sequence[Evidence],
    ) -> Selection:
        """Return a selection of what is named, all of it fitted under one convention of the record."""
        models, found = [estimator.base_as(convention)], []
        for each in named:
            last = models[-1]
            edits = (*last.effects, (each.effect, each.values))
            if fitted := estimator.refined(edits, last.departures, last.convention):
                models.append(fitted)
                found.append(each)
        without = models[:-1] if len(found) < 2 else [_without(estimator, each.effect, models) for each in found]
        shown = [
            replace(each, channel=strongest(before, models[-1])[0].channel)
            for each, before in zip(found, without, strict=True)
        ]
        floor, intervals = NoiseFloor.of(estimator.problem, models[-1]), parameter_intervals(estimator, models[-1])
        return cls(estimator, models, without, tuple(shown), tuple(tried), floor, intervals, posterior, evidence)

    @property
    def problem(self) -> SegmentProblem:
        return self.estimator.problem

    @property
    def segment(self) -> Segment:
        return self.problem.segment

    @property
    def is_compared(self) -> bool:
        """Whether a healthy record of the link is known."""
        return self.problem.as_built is not None

    @property
    def before(self) -> Hypothesis:
        return self.models[0]

    @property
    def after(self) -> Hypothesis:
        return self.models[-1]

    def probability(self, name: str) -> float:
        """Return how probable an effect, or something unknown, is, alone or beside others."""
        return sum(probability for names, probability in self.posterior.items() if name in names.split("+"))

    @property
    def unknown(self) -> float:
        return self.probability(UNKNOWN)


def strongest(before: Hypothesis, after: Hypothesis) -> tuple[Residual, Residual]:
    """Return what is missed of the channel that gains most."""
    pairs = zip(before.residuals, after.residuals, strict=True)
    return max(pairs, key=lambda pair: pair[0].loss() - pair[1].loss())


def _without(estimator: Estimator[SegmentProblem], effect: EffectType, models: Models) -> Hypothesis:
    """Return the last model without one of its effects, the rest fitted again."""
    last = models[-1]
    rest = [(other, values) for other, values in last.effects if other is not effect]
    return estimator.refined(rest, last.departures, last.convention) or models[0]
