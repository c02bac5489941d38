"""What a healthy record says of a loop that was not built as its documents have it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import copysign, exp, expm1, hypot, log1p, sqrt

import numpy as np

from waxstudy.diagnosis.model.conventions import Convention, left_by
from waxstudy.diagnosis.model.discrepancy import Discrepancy
from waxstudy.diagnosis.model.edits import Edits, EffectType, Values, with_effects
from waxstudy.diagnosis.model.nuisance import Nuisance, habits
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import Belief, Effect, FloatArray

ROUNDED = 1e-3  # by so much of a departure rounding may put its step beyond the ends that it lies between
MOST_BY_RECORD = 0.99  # of a factor's variance: what no record told keeps it above 0


@dataclass(frozen=True)
class AsBuilt:
    """What differs from the documents, always, with how well it is known, and what the model leaves all the same."""

    knobs: tuple[Nuisance, ...]  # departures from the documents; of room and drives
    departures: FloatArray  # (knobs,) their posterior mean
    covariance: FloatArray  # (knobs, knobs) of their posterior
    chain: tuple[tuple[Knob, float], ...] = ()  # of the control chain, and their departures
    always: Edits = ()  # effects of the chain that were there from the start
    conventions: Mapping[str, Convention] = field(default_factory=dict)  # by segment: how the log is read
    as_good: Mapping[str, Sequence[Convention]] = field(default_factory=dict)  # other ways, which nothing tells apart
    ways: Mapping[str, Sequence[Convention]] = field(default_factory=dict)  # all that its log may be read in
    discrepancies: Mapping[str, Discrepancy] = field(default_factory=dict)  # of a room, by channel
    left: Mapping[str, Left] = field(default_factory=dict)  # of a chain, by channel

    def left_of(self, link: str) -> Mapping[str, Left]:
        """Return what is left of channels where a healthy record shows them by the same link, else nothing."""
        return self.left if link in self.conventions else {}

    def ways_left(self, link: str, ways: Sequence[Convention]) -> Sequence[Convention]:
        """Return the ways to read another record's link that the healthy record leaves, all where it has none."""
        if link not in self.conventions:
            return ways
        return left_by([self.conventions[link], *self.as_good.get(link, ())], self.ways[link], ways)

    def seen_in(self, record: Record) -> AsBuilt:
        """Return the same for another record, which has habits of its own days, or recorded what they stand in for.

        Of one without what drives a room nothing of it can be said.
        """
        if not record.has_inputs:
            return self.as_documented()
        there = {each.name: each for each in habits(record)}
        known = [there.get(knob.name) if knob.is_habit else knob for knob in self.knobs]
        kept = [place for place, knob in enumerate(known) if knob]
        return replace(
            self,
            knobs=tuple(knob for knob in known if knob),
            departures=self.departures[kept],
            covariance=self.covariance[np.ix_(kept, kept)],
        )

    def as_documented(self) -> AsBuilt:
        """Return the same with room and drives as in the documents."""
        return replace(self, knobs=(), departures=np.zeros(0), covariance=np.zeros((0, 0)), discrepancies={})

    def unknowns(self) -> list[Nuisance]:
        """Return what is unknown of room and drives, as departures from what they were built with."""
        sd = np.sqrt(np.diag(self.covariance)).tolist()
        return [knob.known_within(each) for knob, each in zip(self.knobs, sd, strict=True)]

    def believed(self, belief: Belief) -> Belief:
        """Return what is believed of the loop as it was built."""
        for knob, departure in zip(self.knobs, self.departures.tolist(), strict=True):
            belief = knob.apply(belief, departure)
        return self.with_chain(belief)

    def with_chain(self, belief: Belief) -> Belief:
        """Return a belief with the control chain as it was built."""
        for knob, departure in self.chain:
            belief = knob.apply(belief, departure)
        return with_effects(belief, self.always)


@dataclass(frozen=True)
class Left:
    """What a chain's model leaves of a channel of a healthy record: in its unit, and over what noise makes."""

    gap: float
    whitened: float


@dataclass(frozen=True)
class Knob(Nuisance):
    """A parameter of an effect by which a healthy loop may differ from its documents; the effect's others rest."""

    effect: EffectType = Effect
    parameter: str = ""
    neutral: Values = field(default_factory=dict)
    by_record: float = 0.0  # share of a factor's variance that is a healthy record's, neither of belief nor `varies`

    @property
    def tells(self) -> frozenset[str]:
        return frozenset((self.name, *self.effect.absorbs))

    def known_within(self, sd: float) -> Knob:
        left = min(self.sd**2, max(0.0, sd**2 - self.varies**2))  # errors that hang together may widen it beyond belief
        is_factor = self.effect.priors[self.parameter].is_log
        return replace(self, sd=sd, by_record=left * (1.0 - left / self.sd**2) / sd**2 if is_factor else 0.0)

    def step(self, departure: float) -> float:
        """Return the step of a factor's logarithm after a departure.

        What is believed of a factor is normal in its logarithm. What a record tells is normal in the factor itself, as
        heat goes with it: twice a leak is farther from what a record told than half of it.
        """
        from scipy.optimize import brentq

        if not departure or self.by_record <= 0.0:
            return departure
        told = min(self.by_record, MOST_BY_RECORD)
        rest = sqrt(1.0 - told)

        def beyond(step: float) -> float:
            return copysign(hypot(rest * step, sqrt(told) * expm1(step)), step) - departure

        least = log1p(departure) if departure > 0.0 else departure / rest
        margin = ROUNDED * abs(departure)
        return float(brentq(beyond, least - margin, departure + margin))

    def values(self, departure: float) -> dict[str, float]:
        """Return the parameters of the effect after a departure, within the bounds that it is looked for in."""
        return _values(self.effect, self.parameter, self.neutral, departure)


def knobs(effects: Sequence[EffectType], stages: Sequence[str], belief: Belief) -> Iterator[Knob]:
    """Yield what effects of these stages say that may differ from the documents in a healthy loop."""
    for effect in effects:
        if effect.stage in stages and not effect.hindrance(belief) and (neutral := effect.neutral(belief)):
            for name, prior in effect.priors.items():
                if prior.as_built:
                    apply = partial(_applied, effect, name, neutral)
                    told = f"{effect.name} {name}"
                    about = told, prior.as_built, apply
                    yield Knob(*about, varies=prior.varies, effect=effect, parameter=name, neutral=neutral)


def _values(effect: EffectType, name: str, neutral: Values, departure: float) -> dict[str, float]:
    prior, still = effect.priors[name], neutral[name]
    value = still * exp(departure) if prior.is_log else still + departure
    return {**neutral, name: float(np.clip(value, prior.low, prior.high))}


def _applied(effect: EffectType, name: str, neutral: Values, belief: Belief, departure: float) -> Belief:
    values = _values(effect, name, neutral, departure)
    return belief if values == dict(neutral) else effect.apply(belief, effect.Parameters(**values))
