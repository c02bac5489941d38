"""A calibration in figures: what differs from the documents, and how well the healthy record is followed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import exp, isfinite, log, nan

import numpy as np

from waxstudy.diagnosis.calibration.calibrate import Calibration
from waxstudy.diagnosis.criteria import ROOM_STAGES, limits
from waxstudy.diagnosis.model.as_built import Knob
from waxstudy.diagnosis.model.edits import EffectType, Values
from waxstudy.diagnosis.model.nuisance import Nuisance
from waxstudy.diagnosis.result import NORMAL, BaselineFit, Calibrated, Interval, Part
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import HOURS, Belief, Prior, Room, Uncertainty


def calibrated(calibration: Calibration, documented: Belief) -> Iterator[Calibrated]:
    """Yield what differs from the documents, of the whole loop."""
    known = calibration.as_built
    sd = np.sqrt(np.diag(known.covariance)).tolist()
    of_loop = [*zip(known.knobs, known.departures.tolist(), sd, strict=True), *((*each, nan) for each in known.chain)]
    chain, always, said = (
        {knob.name for knob, _ in known.chain},
        _always(calibration, documented),
        _unknown(documented),
    )
    for knob, departure, each in of_loop:
        if knob.is_habit:
            continue  # no document tells at which hours people heat a room
        is_of_room = knob.apply(documented, knob.sd).room != documented.room
        is_of_chain = knob.name in chain or (isinstance(knob, Knob) and knob.effect.stage not in ROOM_STAGES)
        part: Part = "room" if is_of_room else "chain" if is_of_chain else "drives"
        if not isinstance(knob, Knob):
            yield _of_room(knob, departure, each, part, said.get(knob.name))
        elif knob.effect not in always or _has_hours(knob.effect, always[knob.effect]):
            values = {
                other.parameter: other.values(at)[other.parameter]
                for other, at, _ in of_loop
                if isinstance(other, Knob) and other.effect is knob.effect
            }
            yield _of_effect(knob, departure, each, part, {**knob.neutral, **values})
    for effect, found in always.items():
        sentence, still = effect.sentence(effect.Parameters(**found)), effect.neutral(documented) or {}
        is_of_room = effect.apply(documented, effect.Parameters(**found)).room != documented.room
        for name, value in found.items():
            before = still.get(name, nan)
            yield Calibrated(
                f"{effect.name} {name}",
                Interval(value, nan, nan),
                before,
                sentence,
                "room" if is_of_room else "chain",
                _is_clear(effect, name, value, before) and _is_there(effect, found, still),
            )


def _has_hours(effect: EffectType, values: Values) -> bool:
    return effect.hours(effect.Parameters(**values)) is not None


def _is_there(effect: EffectType, values: Values, still: Values) -> bool:
    """Whether an effect is worth a word by anything but its hours, which nothing has as well."""
    names = [name for name in values if name not in HOURS]
    return any(_is_clear(effect, name, values[name], still.get(name, nan)) for name in names)


def _is_clear(effect: EffectType, name: str, value: float, still: float) -> bool:
    """Whether a value of an effect that was there from the start is worth a word."""
    return not isfinite(still) or name not in effect.priors or _is_noticeable(effect.priors[name], value, still)


def _always(calibration: Calibration, documented: Belief) -> dict[EffectType, Values]:
    """Return effects that were there from the start, as they come to with what differs usually.

    What is so between hours alone is told beside what differs at all hours.
    """
    found: dict[EffectType, Values] = {}
    for effect, values in calibration.as_built.always:
        still, whole = effect.neutral(documented) or {}, dict(values)
        for knob, departure in calibration.as_built.chain:
            if knob.effect is effect and not _has_hours(effect, values):
                name = knob.parameter
                usual = knob.values(departure)[name]
                whole[name] = (
                    whole[name] * usual / still[name]
                    if effect.priors[name].is_log
                    else whole[name] + usual - still[name]
                )
        found[effect] = whole
    return found


def _unknown(documented: Belief) -> dict[str, Uncertainty]:
    """Return what is uncertain of the room itself, by name."""
    if documented.room is None:
        return {}
    assert issubclass(documented.room.component, Room)
    return {each.name: each for each in documented.room.component.uncertainties(documented.room.parameters)}


def _of_effect(knob: Knob, departure: float, sd: float, part: Part, values: Mapping[str, float]) -> Calibrated:
    value, still = knob.values(departure)[knob.parameter], knob.neutral[knob.parameter]
    interval = Interval(value, nan, nan)
    if sd == sd:
        known = knob.known_within(sd)
        ends = (knob.values(departure + known.step(way * NORMAL * sd))[knob.parameter] for way in (-1, 1))
        interval = Interval(value, *ends)
    is_clear = _is_noticeable(knob.effect.priors[knob.parameter], value, still) and _leaves_out(interval, still)
    sentence = knob.effect.sentence(knob.effect.Parameters(**values))
    return Calibrated(knob.name, interval, still, sentence, part, is_clear)


def _is_noticeable(prior: Prior, value: float, still: float) -> bool:
    if prior.is_log:
        return abs(log(value / still)) > log(prior.noticeable)
    return abs(value - still) > prior.noticeable


def _leaves_out(interval: Interval, still: float) -> bool:
    """Whether an interval, if there is one, leaves out what the documents say."""
    return not interval.low <= still <= interval.high


def _of_room(knob: Nuisance, departure: float, sd: float, part: Part, unknown: Uncertainty | None) -> Calibrated:
    interval = Interval(departure, departure - NORMAL * sd, departure + NORMAL * sd)
    is_clear = abs(departure) > WEIGHTS.clear_sd * knob.sd / WEIGHTS.wider and _leaves_out(interval, 0.0)
    description, is_log = (unknown.description, unknown.is_log) if unknown else ("", False)
    sentence = _in_words(knob, departure, description, is_log)
    if is_log:
        interval = Interval(*(exp(end) for end in (interval.value, interval.low, interval.high)))
    return Calibrated(knob.name, interval, 1.0 if is_log else 0.0, sentence, part, is_clear, description)


def _in_words(knob: Nuisance, departure: float, description: str, is_log: bool) -> str:
    """Return a departure as a sentence.

    >>> film = Nuisance("film", 0.5, lambda belief, departure: belief)
    >>> _in_words(film, -0.9, "factor on the film", True)
    'film: the factor on the film is 0.41, 1.8 standard deviations of what is usual.'
    >>> _in_words(film, -0.9, "added to the share of the film", False)
    'film: -0.9 is added to the share of the film, 1.8 standard deviations of what is usual.'
    """
    told = f"the {description} is {exp(departure):.2g}" if is_log else f"{departure:.2g} is {description or 'added'}"
    return f"{knob.name}: {told}, {_deviations(knob, departure)} of what is usual."


def _deviations(knob: Nuisance, departure: float) -> str:
    return f"{abs(departure) / knob.sd:.1f} standard deviations"


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


def doubts(calibration: Calibration, documented: Belief) -> Iterator[str]:
    """Yield what of the healthy record makes one doubt that it is healthy."""
    known, always = calibration.as_built, _always(calibration, documented)
    for knob, departure in (*zip(known.knobs, known.departures.tolist(), strict=True), *known.chain):
        if isinstance(knob, Knob) and knob.effect in always:
            continue  # told below, with all of it
        if abs(departure) >= WEIGHTS.at_end * limits()["odd"].value * knob.sd:
            usual = _deviations(knob, departure)
            yield f"the baseline itself: {knob.name} lies {usual} from the documents, or farther; is it healthy?"
    for effect, values in always.items():
        if not _is_there(effect, values, effect.neutral(documented) or {}):
            continue
        sentence = effect.sentence(effect.Parameters(**values))
        yield f"the baseline shows {effect.name} too, so it counts as there from the start; is it healthy? {sentence}"
