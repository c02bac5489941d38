"""The noise floor of a segment: what would be missed by a model that is right, driven and judged by noisy channels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.model.perturbation import Perturbation
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.residuals.switching import Switching
from waxstudy.plugin import SimulationError

PERTURBATIONS = 3


@dataclass(frozen=True)
class NoiseFloor:
    """Root mean square of what noise alone makes of each channel's residual, in its unit and whitened."""

    plain: Mapping[str, float]
    white: Mapping[str, float]

    @classmethod
    def of(cls, problem: SegmentProblem, fitted: Hypothesis) -> NoiseFloor:
        """Return the floor of a model: its own predictions, perturbed and seen by the instruments, judged by it."""
        plain: dict[str, list[float]] = {channel: [] for channel in problem.segment.judged}
        white: dict[str, list[float]] = {channel: [] for channel in problem.segment.judged}
        for residuals in of_noise(problem, fitted, PERTURBATIONS):
            for each in residuals:
                plain[each.channel].append(each.gap())
                white[each.channel].append(each.whitened_rms)
        ways = problem.judge.ways.items()
        switched = {channel: way.typical_s for channel, way in ways if isinstance(way, Switching)}
        return _at_least(cls(_typical(plain) | switched, _typical(white) | dict.fromkeys(switched, 1.0)), problem)


def of_noise(problem: SegmentProblem, fitted: Hypothesis, times: int) -> Iterator[Sequence[Residual]]:
    """Yield what noise alone makes of a right model's residuals, up to so many times."""
    belief, way = problem.belief_of(fitted), fitted.convention.drawn
    still = problem.predicted(belief, way)
    for seed in range(times):
        random = np.random.default_rng([7, seed])
        try:
            moved = problem.predicted(belief, way, Perturbation(random))
        except (SimulationError, ValueError, ArithmeticError):
            continue
        yield problem.judge.residuals(_seen(problem, still, moved, random))


def _seen(problem: SegmentProblem, still: Predicted, moved: Predicted, random: np.random.Generator) -> Predicted:
    """Return a prediction that misses the record by what noise makes of a right one: the record plus the difference."""
    seen = Predicted()
    for channel, value in still.items():
        way = problem.judge.ways[channel]
        if isinstance(way, Switching):
            seen[channel] = np.abs(way.measured - np.abs(moved[channel] - value))
            continue
        difference = moved[channel] - value
        noise = np.nan_to_num(way.noise) * random.normal(size=len(value))
        count = min(len(way.measured), len(difference))
        seen[channel] = way.measured[:count] + difference[:count] + noise[:count]
        if channel in still.shifted:
            # the moved one is what was measured, which the right model misses but for when its switches were thrown
            shown = way.measured[:count] - moved[channel][:count] + noise[:count]
            seen.shifted = {**seen.shifted, channel: still.shifted[channel] + shown}
    return seen


def _typical(values: Mapping[str, list[float]]) -> dict[str, float]:
    return {name: float(np.mean(many)) if many else 0.0 for name, many in values.items()}


def _at_least(floor: NoiseFloor, problem: SegmentProblem) -> NoiseFloor:
    """Return a floor that holds what a healthy record leaves as well."""
    known = problem.as_built
    if known is None:
        return floor
    plain, white = dict(floor.plain), dict(floor.white)
    lefts = known.left_of(problem.segment.name)
    for channel in problem.segment.judged:
        if left := lefts.get(channel):
            plain[channel] = max(plain[channel], left.gap)
            white[channel] = 1.0 if left.whitened > 1.0 else white[channel]
        elif channel in known.discrepancies:
            plain[channel] = max(plain[channel], known.discrepancies[channel].rms_K)  # which has its noise
            white[channel] = known.discrepancies[channel].shared ** -0.5
    return NoiseFloor(plain, white)
