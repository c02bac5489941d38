"""Instruments of a room's record that may have come to show something else since the healthy record.

None of them is an effect of the library: what they explain is unknown, and told as what it looks like.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.observations.record import FLOW, Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.gain_spread import gain_spread
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray

STEP = -0.05  # chosen: of the flow, by which what a room makes of less of it is found


@dataclass(frozen=True)
class OffBy:
    """An instrument that shows `off` kelvins more than there are, of a flow that share more than flows."""

    channel: str
    off: float
    told: float  # logarithm of how much likelier the record is so, less what the choice of it costs
    gain: float = 0.0  # the same as if errors of all hours were independent, at no cost

    @property
    def words(self) -> str:
        """What it looks as if.

        >>> OffBy("flow_L_h", -0.2, 9.0).words, OffBy("air_temperature_C", 0.51, 9.0).words
        ('the flow meter showed 0.80 times what flows', 'the thermometer of air_temperature_C read 0.5 K too warm')
        """
        if self.channel == FLOW:
            return f"the flow meter showed {1.0 + self.off:.2f} times what flows"
        too = "warm" if self.off > 0.0 else "cold"
        return f"the thermometer of {self.channel} read {abs(self.off):.1f} K too {too}"


class Instruments:
    """Looks at each instrument of a room beside what a hypothesis misses; what is not known of the room fits again."""

    def __init__(
        self, estimator: Estimator[SegmentProblem], none: Hypothesis, share: Mapping[str, float], healthy: Record
    ) -> None:
        """`share`: how many samples of a channel count as one."""
        problem = estimator.problem
        flows = [each.usual_flow_L_h if each.has(FLOW) else 0.0 for each in (problem.record, healthy)]
        self.shown = flows[0] / flows[1] if all(flows) else 1.0  # flow with the valve open, over that in `healthy`
        self.weight = np.concatenate([each.weights(share) for each in none.residuals])
        self.root = problem.prior / problem.sd
        self.ways, _ = np.linalg.qr(np.vstack((estimator.base_slopes * self.weight[:, None], self.root)))
        self.block = np.concatenate(
            [each.sample * problem.record.interval_s // WEIGHTS.block_s for each in none.residuals]
        )
        nothing = np.zeros(len(self.root))
        self.each = [
            (channel, form, self._not_of_room(np.concatenate((moves * self.weight, nothing))))
            for channel, form, moves in _instruments(problem, none)
        ]

    def best(self, fitted: Hypothesis) -> OffBy | None:
        """Return the instrument that explains most of what a hypothesis misses; None where none does.

        A form may err all the time by as much as the healthy record leaves, of a flow by as much as that of an effect.
        Only what is beyond that shows that there is something; then all of it tells what. A thermometer's channel must
        be missed by more than the form may leave, and a meter must show as much more than before.
        """
        if not self.each:
            return None
        missed = self._not_of_room(np.concatenate((fitted.whitened * self.weight, self.root @ fitted.departures)))
        price, found = WEIGHTS.price + float(np.log(len(self.each))), list[OffBy]()
        for channel, form, change in self.each:
            power = float(change @ change)
            off = float(change @ missed) / power if power else 0.0
            told, by_days = self._gains(missed, missed - off * change)
            beyond = max(0.0, 1.0 - form / abs(off)) if off else 0.0
            if self._is_seen(channel, off, form, fitted) and by_days * beyond**2 > price + WEIGHTS.unknown_price:
                found.append(OffBy(channel, off, told - price, 0.5 * power * off**2))
        return max(found, key=lambda each: each.told, default=None)

    def _is_seen(self, channel: str, off: float, form: float, fitted: Hypothesis) -> bool:
        if channel == FLOW:
            return abs((1.0 + off) / self.shown - 1.0) <= form
        return fitted.residual_of(channel).gap() > WEIGHTS.most_left * form

    def beside(self, alone: OffBy | None, gain: float, ease: float, spread: float, fitted: Hypothesis) -> OffBy | None:
        """Return the same beside an effect that gains so much, as far as that adds to what an instrument gains `alone`.

        The spread of an instrument's gain differs beside an effect; what both gain must not grow by that.
        """
        found = self.best(fitted)
        if found is None or alone is None:
            return found
        both = alone.told + (gain + ease + found.gain - alone.gain) / spread
        return replace(found, told=min(found.told, both - gain / spread - ease))

    def _gains(self, before: FloatArray, after: FloatArray) -> tuple[float, float]:
        """Return what is gained by what is missed and by how far the room need not depart, and as far as days tell."""
        count = len(self.weight)
        spread, most = gain_spread(before[:count], after[:count], self.block)
        gain, ease = (0.5 * float(np.sum(before[of] ** 2 - after[of] ** 2)) for of in (np.s_[:count], np.s_[count:]))
        return gain / spread + ease, min(gain / spread, most) + ease

    def _not_of_room(self, values: FloatArray) -> FloatArray:
        """Return what of whitened residuals and departures (m + nuisances,) no departure of the room explains."""
        return np.asarray(values - self.ways @ (self.ways.T @ values))


def _instruments(problem: SegmentProblem, fitted: Hypothesis) -> Iterator[tuple[str, float, FloatArray]]:
    """Yield each instrument, what a form leaves of it in its unit, and how a unit of it moves what is missed (m,)."""
    belief = problem.belief_of(fitted)
    shown = problem.predicted(belief, fitted.convention)
    ends = np.cumsum([0, *(len(each.whitened) for each in fitted.residuals)])
    for place, each in enumerate(fitted.residuals):
        warmer = problem.judge.ways[each.channel].residual(Predicted({each.channel: shown[each.channel] + 1.0}))
        moves = np.zeros(ends[-1])
        # an error is what a model shows beyond its thermometer: one that reads too warm lowers it
        moves[ends[place] : ends[place + 1]] = each.whitened - warmer.whitened
        yield each.channel, each.form / WEIGHTS.most_left, moves
    inputs = belief.inputs
    if problem.segment.driven_by == FLOW and inputs and inputs.flow_L_h is not None:
        added = 0.0 if inputs.added_flow_L_h is None else inputs.added_flow_L_h
        less = replace(belief, inputs=replace(inputs, added_flow_L_h=added + STEP * inputs.flow_L_h))
        there = problem.judge.residuals(problem.predicted(less, fitted.convention))
        yield FLOW, WEIGHTS.form, (np.concatenate([each.whitened for each in there]) - fitted.whitened) / STEP
