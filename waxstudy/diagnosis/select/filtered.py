"""What a hypothesis misses less because it lets less of the drive's noise through: that speaks for no effect."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.observations.record import CONTINUOUS
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.plugin import FloatArray


class Filtered:
    """Squares that hypotheses of a link driven by a thermometer are spared: a lag smooths what a delay only shifts."""

    def __init__(self, problem: SegmentProblem, healthy: Healthy) -> None:
        self.problem, self.healthy = problem, healthy
        self._seen = problem.record.memory(arrays=len(problem.segment.judged))
        self._of_nothing: dict[Convention, list[FloatArray | None]] = {}  # how noise moves what nothing misses

    def squares(self, fitted: Hypothesis, nothing: Hypothesis) -> Mapping[str, FloatArray]:
        """Return by channel the whitened squares (m,) that noise adds to nothing and not to a hypothesis.

        Both are read in the same way. Where an effect acts at some times only, it is spared nothing.
        """
        if self.problem.segment.driven_by not in CONTINUOUS or not fitted.effects or fitted.is_at_times:
            return {}
        key = *((effect, *values.items()) for effect, values in fitted.effects), fitted.departures.tobytes()
        return self._seen.get((*key, fitted.convention), lambda: self._squares(fitted, nothing))

    def _squares(self, fitted: Hypothesis, nothing: Hypothesis) -> Mapping[str, FloatArray]:
        if nothing.convention not in self._of_nothing:
            self._of_nothing[nothing.convention] = self.problem.moved_by_noise(nothing)
        both = self._of_nothing[nothing.convention], self.problem.moved_by_noise(fitted)
        found = zip(nothing.residuals, *both, strict=True)
        return {
            residual.channel: self._share(residual, before) * (before**2 - after**2)
            for residual, before, after in found
            if before is not None and after is not None
        }

    def _share(self, nothing: Residual, moved: FloatArray) -> float:
        """Return which share of the noise is there: where less is usual than noise makes, less was stated too much."""
        if not nothing.judged.any():
            return 0.0
        expected = nothing.noise_square + float(np.mean(moved[nothing.judged] ** 2))
        return min(1.0, self.healthy.usual(nothing) ** 2 / expected) if expected else 0.0
