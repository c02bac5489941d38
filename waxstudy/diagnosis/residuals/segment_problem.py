"""A segment and its record as a problem to fit: what a hypothesis predicts there, and what it misses."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property
from itertools import takewhile
from typing import Any

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.as_built import AsBuilt
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.edits import Edits, EffectType, Values, differ_by_inputs_alone, with_effects
from waxstudy.diagnosis.model.nuisance import Nuisance, departed_inputs, habits, heats, nuisances, of_record
from waxstudy.diagnosis.model.perturbation import Perturbation
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.model.segments import Prediction, Segment
from waxstudy.diagnosis.observations.partition import BOTH
from waxstudy.diagnosis.observations.record import CONTINUOUS, OUTPUT, Record
from waxstudy.diagnosis.residuals.continuous import Continuous
from waxstudy.diagnosis.residuals.judge import Judge, perturbed_by_noise
from waxstudy.diagnosis.residuals.switching import Past, Switching
from waxstudy.plugin import Belief, FloatArray

HEAT_FIELDS = frozenset(("solar_W", "gains_W", "extra_W"))  # of `Inputs`: a room with a given flow is linear in them


class SegmentProblem:
    """Implements `estimate.hypothesis.Problem`. In an exact room nothing departs but for how it began.

    With what a healthy record says (`as_built`), and no `unknowns` to calibrate, the loop given is the documents', and
    the one believed is as built.
    """

    def __init__(
        self,
        segment: Segment,
        record: Record,
        belief: Belief,
        room_tolerance: float = 1.0,
        holds_out: bool = True,
        is_exact_room: bool = False,
        as_built: AsBuilt | None = None,
        unknowns: Sequence[Nuisance] | None = None,
        parts: np.ndarray | None = None,
        alike: SegmentProblem | None = None,  # the same, judged in another way: what it simulated is shared
    ) -> None:
        self.as_built, self.is_calibrating = as_built, unknowns is not None
        known_loop = None if self.is_calibrating else as_built
        self.segment, self.record, self.name = segment, record, segment.name
        self.belief = known_loop.believed(belief) if known_loop else belief
        self.room_tolerance, self.holds_out, self.is_exact_room = room_tolerance, holds_out, is_exact_room
        known = as_built.conventions.get(segment.name) if as_built else None
        ways = known_loop.ways_left(segment.name, segment.conventions) if known_loop else segment.conventions
        self.conventions: Sequence[Convention] = [known] if known and self.is_calibrating else ways
        shared: Prediction | None = alike.predicted if alike else None
        self.predicted: Prediction = shared or Prediction(segment, record, self.belief, is_exact_room)
        self._parts = parts
        self.timed: Hypothesis | None = None  # under which noise is weighed, where that is not what is believed
        self.near: Mapping[EffectType, Values] = {}  # where fits of effects may begin
        self.nuisances = list(unknowns) if unknowns is not None else self._nuisances() if segment.with_room else []
        self.sd = np.array([nuisance.sd for nuisance in self.nuisances])
        self.prior = self._prior()
        # what departures are added to, what both are applied to, and what is edited after them
        self._built, self._undeparted, self._after = np.zeros(len(self.sd)), self.belief, list[tuple[Nuisance, float]]()
        if known_loop and segment.with_room:
            self._built[: len(known_loop.knobs)] = known_loop.departures
            self._undeparted = belief
            self._after = [(Nuisance("chain", 0.0, lambda room, _: known_loop.with_chain(room)), 0.0)]
        self.events: Sequence[int] = [place for place, nuisance in enumerate(self.nuisances) if nuisance.is_event]
        self.is_smooth = not all(channel in record.binary for channel in segment.judged)
        self.discounts_noise = OUTPUT in segment.judged and OUTPUT not in record.binary
        self._seen = record.memory(arrays=4)
        self._edits: list[tuple[float, Belief]] = []  # by nuisance: what was departed to last, and the belief so far

    def _nuisances(self) -> list[Nuisance]:
        if self.as_built is None:
            tolerance = None if self.is_exact_room else self.room_tolerance
            return nuisances(self.belief, self.record, self.segment.driven_by, tolerance)
        known = {name for knob in self.as_built.knobs for name in knob.tells}
        # drives that only one of the two records has
        unseen = [each for each in (*heats(self.record), *habits(self.record)) if each.name not in known]
        return [*self.as_built.unknowns(), *unseen, *of_record(self.belief, self.record, self.segment.driven_by)]

    def _prior(self) -> FloatArray:
        """Return what turns departures over their standard deviations into independent ones (nuisances, nuisances)."""
        found = np.eye(len(self.nuisances))
        if self.as_built is not None and self.nuisances and not self.is_calibrating:
            count = len(self.as_built.knobs)
            sd = self.sd[:count]
            correlation = self.as_built.covariance / np.outer(sd, sd)
            found[:count, :count] = np.linalg.inv(np.linalg.cholesky(correlation + 1e-9 * np.eye(count)))
        return found

    def exact(self) -> SegmentProblem:
        """Return the same with the room exactly as believed."""
        return SegmentProblem(self.segment, self.record, self.belief, self.room_tolerance, self.holds_out, True)

    @cached_property
    def judge(self) -> Judge:
        return self._judge()

    def _judge(self, perturbed: Iterator[Predicted] | None = None) -> Judge:
        about = self.holds_out, self.is_exact_room, self.as_built, self._parts
        return Judge(self.segment, self.record, self.belief, *about, perturbed)

    def noisy(self, fitted: Hypothesis) -> Sequence[Predicted]:
        """Return what a hypothesis predicts, then that with noise of its drive; nothing where it cannot run."""
        return list(perturbed_by_noise(self.segment, self.record, self.belief_of(fitted), fitted.convention))

    def timed_by(self, fits: Sequence[Hypothesis], noisy: Sequence[Predicted]) -> SegmentProblem:
        """Return the same, near these fits, weighed by what noise of its drive does under the first one.

        What runs on is moved by noise at least as far as under what is believed.
        """
        other = copy(self)
        other.timed = fits[0]
        other.judge = self._judge(iter(noisy))
        for channel, way in other.judge.ways.items():
            believed = self.judge.ways[channel]
            if isinstance(way, Continuous) and isinstance(believed, Continuous):
                way.see_at_least(believed)
        other.near = {effect: values for each in fits for effect, values in each.effects}
        other._seen = self.record.memory(arrays=4)
        return other

    def edited(self, effects: Edits, departures: FloatArray) -> Belief:
        return with_effects(self._departed(departures, _absorbed(effects)), effects)

    def _departed(self, departures: FloatArray, absorbed: frozenset[str]) -> Belief:
        """Return the belief with departures of the room, but for those that an effect takes the place of.

        They are added to those that it was built with: an edit on top of another is not the same as both at once.
        """
        pairs = zip(self.nuisances, self._built.tolist(), departures.tolist(), strict=True)
        values = [(knob, at if knob.name in absorbed else at + knob.step(departure)) for knob, at, departure in pairs]
        of_room = [*(pair for pair in values if not pair[0].is_of_inputs), *self._after]
        # slopes change one nuisance at a time: what was edited before it stays
        same = sum(1 for _ in takewhile(lambda pair: pair[0][1] == pair[1][0], zip(of_room, self._edits, strict=False)))
        del self._edits[same:]
        for nuisance, value in of_room[same:]:
            before = self._edits[-1][1] if self._edits else self._undeparted
            self._edits.append((value, nuisance.apply(before, value)))
        return departed_inputs(self._edits[-1][1] if self._edits else self._undeparted, values)

    def at(self, effects: Edits, departures: FloatArray, convention: Convention) -> Hypothesis | None:
        # fits begin and end at places that they have been to
        key = _key(effects, departures)

        def made() -> Hypothesis | None:
            predicted = self.predicted.remembered(key, lambda: self.edited(effects, departures), convention)
            if predicted is None:
                return None
            return Hypothesis(tuple(effects), convention, departures, self.judge.residuals(predicted))

        return self._seen.get((*key, convention), made)

    def drive_noise(self, fitted: Hypothesis, channel: str = "") -> Mapping[int, float]:
        """Return what noise of the drive adds to a model's loss, by part: a low-pass lets less of it through.

        Of one channel, or of all that run on.
        """
        found: dict[int, float] = {}
        for residual, moved in zip(fitted.residuals, self.moved_by_noise(fitted), strict=True):
            if moved is not None and channel in ("", residual.channel):
                for part in BOTH:
                    found[part] = found.get(part, 0.0) + float(np.sum(moved[residual.part == part] ** 2))
        return found

    def moved_by_noise(self, fitted: Hypothesis) -> list[FloatArray | None]:
        """Return how far a draw of the drive's noise moves the whitened error (m,) of each residual that runs on.

        None of what switches, of a room, and where the drive switches or its noise was read by the controller.
        """
        if self.segment.with_room or self.segment.driven_by in self.record.binary or fitted.convention.is_raw:
            return [None] * len(fitted.residuals)
        belief = self.belief_of(fitted)
        perturbation = Perturbation(np.random.default_rng(11), is_twice=False)
        still = self.predicted(belief, fitted.convention)
        moved = self.predicted(belief, fitted.convention, perturbation)
        pairs = zip(self.judge.residuals(still), self.judge.residuals(moved), strict=True)
        return [None if now.channel in self.record.binary else then.whitened - now.whitened for now, then in pairs]

    def past_switch(self, fitted: Hypothesis) -> list[Past]:
        """Return where a thermostat's reading goes on past where a hypothesis switches; empty where none is judged."""
        if self._thermostat is None:
            return []
        return self._thermostat.past(self.predicted(self.belief_of(fitted), fitted.convention))

    @property
    def noise_past_switch_K(self) -> float:
        """How far noise alone makes it go on."""
        return self._thermostat.noise_past_K if self._thermostat else 0.0

    @property
    def _thermostat(self) -> Switching | None:
        way = self.judge.ways.get(OUTPUT)
        return way if isinstance(way, Switching) and way.reads else None

    def belief_of(self, fitted: Hypothesis) -> Belief:
        """Return the belief that a hypothesis has."""
        return self.edited(fitted.effects, fitted.departures)

    def belief_without(self, fitted: Hypothesis, effect: EffectType) -> Belief:
        """Return the belief that a hypothesis has, but for one of its effects."""
        return self.edited([each for each in fitted.effects if each[0] is not effect], fitted.departures)

    def inexact(self, fitted: Hypothesis) -> FloatArray:
        """Return how far the whitened residuals (m,) move with what a prediction is not exact in.

        That is what smoothing the drive once more does, as it may have done before, and of a room its long steps.
        """
        belief, now = self.belief_of(fitted), fitted.whitened
        if self.segment.driven_by in CONTINUOUS:
            other = self.predicted(belief, fitted.convention, Perturbation(np.random.default_rng(13)))
        elif self.segment.with_room:
            other = self.predicted.fine(belief, fitted.convention)
        else:
            return np.zeros(len(now))
        return np.concatenate([each.whitened for each in self.judge.residuals(other)]) - now

    def warmed(
        self, fitted: Hypothesis, heats_W: Sequence[Mapping[str, FloatArray]], repeats_first_day: bool = False
    ) -> FloatArray:
        """Return how far the whitened residuals (m, heats) move with each course of heat, as `Segment.warmed`."""
        belief, convention = self.belief_of(fitted), fitted.convention
        still = self.predicted.remembered(_key(fitted.effects, fitted.departures), lambda: belief, convention)
        assert still is not None
        moved = np.zeros((len(heats_W), len(fitted.whitened)))
        end = np.cumsum([0, *(len(each.whitened) for each in fitted.residuals)])
        changes = self.segment.warmed(self.record, belief, convention, heats_W, repeats_first_day)
        for row, change in zip(moved, changes, strict=True):
            for place, residual in enumerate(fitted.residuals):
                if residual.channel in change:
                    there = Predicted({residual.channel: still[residual.channel] + change[residual.channel]})
                    now = self.judge.ways[residual.channel].residual(there)
                    row[end[place] : end[place + 1]] = now.whitened - residual.whitened
        return moved.T

    def added_heat_slopes(self, fitted: Hypothesis, places: Iterable[int]) -> Mapping[int, FloatArray]:
        """Return the change of the whitened residuals (m,) with nuisances that do no more than add heat, by place.

        A place is left out where an effect makes something else than heat of it.
        """
        of_heat = {place: self.nuisances[place] for place in places if self.nuisances[place].is_added_heat}
        if not of_heat:
            return {}
        absorbed = _absorbed(fitted.effects)
        before = self._departed(fitted.departures, absorbed)
        still = with_effects(before, fitted.effects)
        found, heats_W = dict[int, FloatArray](), dict[int, Mapping[str, FloatArray]]()
        for place, nuisance in of_heat.items():
            if nuisance.name in absorbed:
                found[place] = np.zeros(len(fitted.whitened))
                continue
            after = with_effects(nuisance.apply(before, 0.1 * nuisance.sd), fitted.effects)
            if heat_W := _heat_between(still, after):
                heats_W[place] = heat_W
        moved = self.warmed(fitted, list(heats_W.values()), repeats_first_day=True)
        slopes = {place: column / (0.1 * self.sd[place]) for place, column in zip(heats_W, moved.T, strict=True)}
        return found | slopes

    def without_stand_ins(self, fitted: Hypothesis) -> Hypothesis:
        """Return a hypothesis without anything in the place of drives that nobody recorded."""
        shapes = {shape.name for found in self.record.stand_ins.values() for shape in found.shapes}
        departures = np.where([each.name in shapes for each in self.nuisances], 0.0, fitted.departures)
        belief = self.edited(fitted.effects, departures)
        assert belief.inputs
        none: dict[str, Any] = dict.fromkeys(belief.inputs.stand_ins, np.zeros(len(belief.inputs.solar_W)))
        still = self.predicted(replace(belief, inputs=replace(belief.inputs, **none)), fitted.convention)
        return replace(fitted, residuals=self.judge.residuals(still))


def _absorbed(effects: Edits) -> frozenset[str]:
    return frozenset(name for effect, _ in effects for name in effect.absorbs)


def _heat_between(one: Belief, other: Belief) -> dict[str, FloatArray]:
    """Return the heat [W] by which the inputs of two beliefs differ, by field (n,); nothing where more than it does."""
    assert one.inputs
    assert other.inputs
    found, before, after = dict[str, FloatArray](), vars(one.inputs), vars(other.inputs)
    for name in before:
        if before[name] is after[name] or np.array_equal(before[name], after[name]):
            continue
        if name not in HEAT_FIELDS or after[name] is None:
            return {}
        found[name] = after[name] - (0.0 if before[name] is None else before[name])
    return found if differ_by_inputs_alone(one, other) else {}


def _key(effects: Edits, departures: FloatArray) -> tuple[Hashable, ...]:
    return tuple((effect, *values.items()) for effect, values in effects), departures.tobytes()
