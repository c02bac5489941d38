"""A calibration in figures: what differs from the documents, and how well the healthy record is followed."""

from __future__ import annotations

from collections.abc import Iterator
from math import nan

import numpy as np

from waxstudy.diagnosis.calibration.calibrate import Calibration
from waxstudy.diagnosis.estimate.parameter_space import EffectType, Values
from waxstudy.diagnosis.model.as_built import Knob
from waxstudy.diagnosis.model.nuisance import Nuisance
from waxstudy.diagnosis.result import BaselineFit, Calibrated, Interval

NORMAL = 1.96
FAR = 3.0  # standard deviations of what is usual, from which on a healthy loop is doubted


def calibrated(calibration: Calibration) -> Iterator[Calibrated]:
    """Yield what differs from the documents, of the whole loop."""
    known = calibration.as_built
    sd = np.sqrt(np.diag(known.covariance)).tolist()
    for knob, departure, each in zip(known.knobs, known.departures.tolist(), sd, strict=True):
        yield _of(knob, departure, each)
    for knob, departure in known.chain:
        yield _of(knob, departure, nan)
    for effect, values in known.always:
        yield from _always(effect, values)


def _of(knob: Nuisance, departure: float, sd: float) -> Calibrated:
    ends = [departure + way * NORMAL * sd for way in (-1.0, 1.0)]
    if not isinstance(knob, Knob):
        sentence = f"{knob.name} departs by {departure:.2g} from what the room says ({_deviations(knob, departure)})."
        return Calibrated(knob.name, Interval(departure, *ends), 0.0, sentence)
    value, low, high = (knob.values(each)[knob.parameter] for each in (departure, *(ends if sd == sd else (0.0, 0.0))))
    interval = Interval(value, low, high) if sd == sd else Interval(value, nan, nan)
    sentence = knob.effect.sentence(knob.effect.Parameters(**knob.values(departure)))
    return Calibrated(knob.name, interval, knob.neutral[knob.parameter], sentence)


def _deviations(knob: Nuisance, departure: float) -> str:
    return f"{abs(departure) / knob.sd:.1f} standard deviations"


def _always(effect: EffectType, values: Values) -> Iterator[Calibrated]:
    sentence = effect.sentence(effect.Parameters(**values))
    for name, value in values.items():
        yield Calibrated(f"{effect.name} {name}", Interval(value, nan, nan), nan, sentence)


def fits(calibration: Calibration) -> Iterator[BaselineFit]:
    """Yield how well each channel of the healthy record that runs on is followed."""
    for healthy in calibration.healthy.values():
        for residual in healthy.fitted.residuals:
            measured = healthy.problem.record.values[residual.channel]
            mean = float(np.nanmean(measured))
            if residual.unit == "s" or not residual.judged.any() or mean == 0.0:
                continue
            off = 100.0 * float(residual.error[residual.judged].mean()) / mean
            yield BaselineFit(residual.channel, residual.unit, residual.gap(), 100.0 * residual.gap() / mean, off)


def doubts(calibration: Calibration) -> Iterator[str]:
    """Yield what of the healthy record makes one doubt that it is healthy."""
    known = calibration.as_built
    for knob, departure in (*zip(known.knobs, known.departures.tolist(), strict=True), *known.chain):
        if abs(departure) > FAR * knob.sd:
            usual = _deviations(knob, departure)
            yield f"the baseline itself: {knob.name} lies {usual} from the documents; is it healthy?"
    for effect, values in known.always:
        sentence = effect.sentence(effect.Parameters(**values))
        yield f"the baseline shows {effect.name} as well, so it counts as there from the start: {sentence}"
