"""The noise floor of a segment: what would be missed by a model that is right, driven and judged by noisy channels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.estimate.fitter import Fitter
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.conventions import Perturbation
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.plugin import SimulationError

SHAKES = 3


@dataclass(frozen=True)
class NoiseFloor:
    """Root mean square of what noise alone makes of each channel's residual, in its unit and whitened."""

    plain: Mapping[str, float]
    white: Mapping[str, float]

    @classmethod
    def of(cls, fitter: Fitter, fitted: Hypothesis) -> NoiseFloor:
        """Return the floor of a fitted model: its own predictions, shaken and seen by the instruments, judged by it."""
        segment, record = fitter.segment, fitter.record
        belief = fitter.edited(fitted.effects, fitted.departures)
        still = fitter.predicted(belief, fitted.convention)
        plain: dict[str, list[float]] = {channel: [] for channel in segment.judged}
        white: dict[str, list[float]] = {channel: [] for channel in segment.judged}
        for seed in range(SHAKES):
            perturbation = Perturbation(np.random.default_rng([7, seed]))
            try:
                shaken = fitter.predicted(belief, fitted.convention, perturbation)
            except (SimulationError, ValueError):
                continue
            for each in fitter.judge.residuals(_seen(fitter, still, shaken, perturbation)):
                plain[each.channel].append(each.gap())
                count = max(1, int(each.judged.sum()))
                white[each.channel].append(float(np.sqrt(each.loss() / count)))
        switched = {channel: fitter.judge.timing_s(channel) for channel in segment.judged if channel in record.binary}
        return cls(_typical(plain) | switched, _typical(white) | dict.fromkeys(switched, 1.0))


def _seen(fitter: Fitter, still: Predicted, shaken: Predicted, perturbation: Perturbation) -> Predicted:
    """Return a prediction that misses the record by what noise makes of a right one: the record plus the difference."""
    record, seen = fitter.record, Predicted()
    assert perturbation.random
    for channel, value in still.items():
        difference = shaken[channel] - value
        measured = fitter.judge.measured(channel)
        if channel in record.binary:
            seen[channel] = record.filled(channel)
            continue
        noise = np.nan_to_num(fitter.judge.noise(channel)) * perturbation.random.normal(size=len(value))
        count = min(len(measured), len(difference))
        seen[channel] = measured[:count] + difference[:count] + noise[:count]
        if channel in still.shifted:
            # the shaken one is what was measured, which the right model misses but for when its switches were thrown
            shown = measured[:count] - shaken[channel][:count] + noise[:count]
            seen.shifted = {**seen.shifted, channel: still.shifted[channel] + shown}
    return seen


def _typical(values: Mapping[str, list[float]]) -> dict[str, float]:
    return {name: float(np.mean(many)) if many else 0.0 for name, many in values.items()}
