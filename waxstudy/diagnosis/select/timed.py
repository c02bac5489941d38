"""An effect on what drives a room that acts between two hours of each day only."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import cache
from typing import Any

import numpy as np
from pydantic import create_model

from waxstudy.diagnosis.model.edits import EffectType, differ_by_inputs_alone
from waxstudy.plugin import HOURS, Belief, FloatArray, Inputs, Parameters, Prior, clock, open_share, parameter
from waxstudy.plugin.hours import DAY_H

HOUR = Prior(0.0, DAY_H, noticeable=0.5)


def can_be_timed(effect: EffectType, belief: Belief) -> bool:
    """Whether an effect gives heat at all hours alike, so that it may as well do so at some of them."""
    starts = effect.starts(belief)
    if effect.stage != "room" or effect.hindrance(belief) or not starts or belief.inputs is None:
        return False
    other = effect.apply(belief, effect.Parameters(**starts[0]))
    if not differ_by_inputs_alone(other, belief) or other.inputs is None or other.inputs.extra_W is None:
        return False
    before = 0.0 if belief.inputs.extra_W is None else belief.inputs.extra_W
    return bool(np.ptp(other.inputs.extra_W - before) == 0.0)


@cache
def timed(effect: EffectType) -> EffectType:
    """Return the effect with two more parameters, the hours of the day from and to which it acts."""
    hours: dict[str, Any] = {each: (float, _hour(each)) for each in HOURS}
    name = f"Timed{effect.__name__}"
    parameters: type[Parameters] = create_model(f"{name}Parameters", __base__=effect.Parameters, **hours)

    class Timed(effect):  # type: ignore[misc, valid-type]
        Parameters = parameters
        priors = {**effect.priors, **dict.fromkeys(HOURS, HOUR)}

        @classmethod
        def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
            return effect.neutral(belief)  # at any hours

        @classmethod
        def apply(cls, belief: Belief, p: Any) -> Belief:
            other = effect.apply(belief, p)
            assert belief.inputs
            assert other.inputs
            share = open_share(belief.inputs, p.from_h, p.to_h)
            return replace(other, inputs=blended(belief.inputs, other.inputs, share))

        @classmethod
        def hours(cls, p: Any) -> tuple[float, float] | None:
            return p.from_h, p.to_h  # whatever the effect says of itself

        @classmethod
        def sentence(cls, p: Any) -> str:
            said = effect.sentence(p).replace(" at all times", "").removesuffix(".")
            return f"{said}, every day from {clock(p.from_h)} to {clock(p.to_h)}."

        @classmethod
        def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
            return [{**each, "from_h": 0.0, "to_h": 0.5 * DAY_H} for each in effect.starts(belief)]

    Timed.__name__ = name
    return Timed


def _hour(name: str) -> Any:
    words = f"Hour of the day {'from' if name == 'from_h' else 'to'} which it acts."
    return parameter(0.0, unit="h", ge=0.0, le=DAY_H, description=words, source="found from the record")


def blended(before: Inputs, after: Inputs, share: FloatArray) -> Inputs:
    """Return inputs of which each course is changed for a share of each interval."""
    changes: dict[str, FloatArray] = {}
    for field in fields(Inputs):
        old, new = getattr(before, field.name), getattr(after, field.name)
        if isinstance(new, np.ndarray) and new is not old:
            start = np.zeros(len(new)) if old is None else old
            changes[field.name] = start + share * (new - start)
    return replace(after, **changes)  # type: ignore[arg-type]
