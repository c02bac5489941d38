"""What a link leaves where nothing is amiss: as a healthy record shows it, or as noise alone makes it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from waxstudy.diagnosis.criteria import limits
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.discrepancy import Discrepancy
from waxstudy.diagnosis.model.edits import Edits
from waxstudy.diagnosis.residuals.noise_floor import PERTURBATIONS, of_noise
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray


class HealthyLeft(NamedTuple):
    """What is left of a channel of the healthy record, of so many samples and cycles."""

    whitened: float  # over what it is weighed by
    samples: int
    cycles: int
    noise_square: float  # of the instrument, of a sample
    gap: float  # in the channel's unit


class UsualWhere(NamedTuple):
    """What is usual where something acts, and how many cycles of the healthy record tell it."""

    whitened: float
    cycles: float = np.inf


@dataclass(frozen=True)
class Healthy:
    """A link of the healthy record, with nothing but what was so from the start."""

    problem: SegmentProblem
    fitted: Hypothesis

    @property
    def is_noise(self) -> bool:
        """Whether this is what noise makes, as no healthy record tells."""
        return False

    @property
    def stands_scatter(self) -> float:
        """Standard deviation of the logarithm of what is left, beside which what an effect does stands out."""
        return WEIGHTS.scatter

    def scatter(self, residual: Residual) -> float:
        """Return the same beside which what is left of a channel is amiss."""
        return scatter_of_weeks(residual)

    @cached_property
    def slopes(self) -> FloatArray:
        return Estimator(self.problem).slopes_at(self.fitted)

    def together(self, channel: str) -> float:
        """Return how many samples count as one, at most those of a cycle; what is whitened over time counts each."""
        residual = None if channel in self.whitened else self.fitted.motion_of(channel)
        if residual is None or not residual.judged.any():
            return 1.0
        cycles = len(np.unique(residual.block[residual.judged]))
        return min(together(residual), float(residual.judged.sum()) / cycles)

    @property
    def whitened(self) -> Mapping[str, Discrepancy]:
        return self.problem.as_built.discrepancies if self.problem.as_built else {}

    def room_loss(self, fitted: Hypothesis) -> float:
        """Return what a hypothesis of a room misses of a later record, weighed by what the healthy one leaves."""
        return sum(each.loss() / self.together(each.channel) for each in fitted.residuals)

    @cached_property
    def past_switch_K(self) -> float:
        """How far a thermostat's reading goes on past where it switches, or noise makes it; 0 where none is judged."""
        seen_K = (each.reading_K for each in self.problem.past_switch(self.fitted))
        return max([*seen_K, self.problem.noise_past_switch_K])

    @property
    def tolerated_travel(self) -> float:
        """By how much a motor may be missed with nothing unknown there, over what models miss: not at all."""
        return 0.0

    def left(self, channel: str) -> HealthyLeft | None:
        """Return what is left of a channel, None where it shows nothing."""
        residual = self.fitted.motion_of(channel)
        count = int(residual.judged.sum()) if residual else 0
        if residual is None or not count:
            return None
        cycles = len(np.unique(residual.block[residual.judged]))
        return HealthyLeft(residual.whitened_rms, count, cycles, residual.noise_square, residual.gap())

    def usual(self, residual: Residual) -> float:
        """Return what nothing amiss leaves of a sample of a channel, over what it is weighed by; less is luck."""
        return max(float(np.sqrt(self._usual_square(residual))), least_usual(residual))

    def acts(self, given: Residual, other: Residual) -> FloatArray:
        """Return how much another hypothesis changes each sample of a channel (m,), beside a given one."""
        judged = given.judged if given.judged.any() else True
        return np.asarray(judged * (given.whitened - other.whitened) ** 2)

    def usual_where(self, residual: Residual, effects: Edits, given: Edits) -> UsualWhere:
        """Return what nothing amiss leaves of the samples that effects change beside given ones, as far as they do."""
        healthy = self.fitted.motion_of(residual.channel)
        pair = (self.pair(given, effects, self.fitted.convention) if healthy else None) or ()
        made = [other for each in pair if (other := each.motion_of(residual.channel))]
        acts = self.acts(*made) if made and len(made) == len(pair) else np.zeros(1)
        if healthy is None or not acts.any():
            return UsualWhere(self.usual(residual))
        left = float(np.sqrt(acts @ healthy.whitened**2 / acts.sum()))
        power = np.bincount(healthy.block - healthy.block.min(), acts)
        return UsualWhere(max(left, least_usual(residual)), float(power.sum() ** 2 / (power @ power)))

    def pair(self, given: Edits, effects: Edits, way: Convention) -> tuple[Hypothesis, Hypothesis] | None:
        """Return the healthy link with given effects and with others, read in a way; None where one cannot be."""
        without, with_it = (self.problem.at(each, self.fitted.departures, way) for each in (given, effects))
        return (without, with_it) if without and with_it else None

    def usual_loss(self, residual: Residual) -> float:
        """Return what is missed of a later record's channel where nothing changed."""
        return self._usual_square(residual) * int(residual.judged.sum())

    def _usual_square(self, residual: Residual) -> float:
        """Return the mean square that nothing amiss leaves of a sample; a meter that runs more often has more noise."""
        healthy = self.left(residual.channel)
        if healthy is None:
            return 0.0
        return healthy.whitened**2 + max(0.0, residual.noise_square - healthy.noise_square)

    def had_it(self, effects: Edits) -> tuple[float, FloatArray]:
        """Return by how much more likely the healthy record were with effects, as logarithm, all else fitted again.

        And how far what was calibrated would lie elsewhere (k,) then, as a better wall where a leak is.
        """
        with_it = self.problem.at(effects, self.fitted.departures, self.fitted.convention)
        if with_it is None:
            return -np.inf, np.zeros(len(self.problem.sd))
        (now, here), (then, there) = self._refitted(self.fitted), self._refitted(with_it)
        return then - now, there - here

    def _refitted(self, fitted: Hypothesis) -> tuple[float, FloatArray]:
        """Return the log likelihood with all that was calibrated fitted again, by slopes, and the step (k,) there."""
        share = {each.channel: self.together(each.channel) for each in fitted.by_motion}
        weight = np.concatenate([each.weights(share) for each in fitted.residuals])
        missed, slopes, sd = fitted.whitened * weight, self.slopes * weight[:, None], self.problem.sd
        root = self.problem.prior / sd if len(sd) else np.zeros((0, 0))
        pulled = root @ fitted.departures if len(sd) else np.zeros(0)
        both, ways = np.concatenate((missed, pulled)), np.vstack((slopes, root))
        step = np.linalg.lstsq(ways, -both, rcond=None)[0] if len(sd) else np.zeros(0)
        left = both + ways @ step if len(sd) else both
        return -0.5 * float(left @ left), step


def scatter_of_weeks(residual: Residual) -> float:
    """Return the standard deviation of the logarithm of what weeks leave of a channel."""
    is_coarse = residual.unit == "s" or residual.channel == "return_temperature_C"
    return WEIGHTS.coarse_scatter if is_coarse else WEIGHTS.scatter


def least_usual(residual: Residual) -> float:
    """Return the least that counts as usual of a sample of a channel: less is luck."""
    return WEIGHTS.least_off if residual.unit == "s" else WEIGHTS.least_left


def together(residual: Residual) -> float:
    """Return how many samples of a channel count as one, as errors hang together (Geyer 1992)."""
    values = residual.whitened[residual.judged]
    if len(values) < 3 or residual.unit == "s" or not values.any():
        return 1.0
    power = np.abs(np.fft.rfft(values, 2 * len(values))) ** 2
    correlation = np.fft.irfft(power)[: len(values)]
    ends = np.flatnonzero(correlation <= 0.0)
    return float(1.0 + 2.0 * correlation[1 : ends[0] if len(ends) else None].sum() / correlation[0])


def blocks_of_room(residual: Residual, interval_s: float) -> np.ndarray:
    """Return the number of the quarter of a day of each residual: errors of a room hang together for hours."""
    return np.asarray(residual.sample * interval_s // WEIGHTS.block_s, dtype=int)


@dataclass(frozen=True)
class AsBelieved(Healthy):
    """A link of the control chain without a healthy record: what noise makes of a model that is taken to be right."""

    @classmethod
    def of(cls, problem: SegmentProblem, right: Hypothesis) -> AsBelieved:
        """Return what one draw of noise makes of a link: of what is believed, or of what tells best when it switched.

        Where no draw can be simulated, noise is as the instruments have it. Raises `SimulationError` where the model
        itself cannot be.
        """
        own = [replace(each, whitened=each.judged.astype(float)) for each in right.residuals]
        return cls(problem, replace(right, residuals=next(of_noise(problem, right, PERTURBATIONS), own)))

    @property
    def is_noise(self) -> bool:
        return True

    @property
    def stands_scatter(self) -> float:
        return WEIGHTS.noise_scatter

    def scatter(self, residual: Residual) -> float:
        return WEIGHTS.part_scatter

    @cached_property
    def past_switch_K(self) -> float:
        return self.problem.noise_past_switch_K

    @property
    def tolerated_travel(self) -> float:
        return limits()["tolerated"].value

    def acts(self, given: Residual, other: Residual) -> FloatArray:
        """Return the same, of what runs on as far at each sample: any other model changes most at edges.

        Noise does not tell what the form of the believed model misses there.
        """
        acts = super().acts(given, other)
        if given.unit == "s" or not given.judged.any():
            return acts
        return np.where(given.judged, acts[given.judged].mean(), 0.0)

    def usual_where(self, residual: Residual, effects: Edits, given: Edits) -> UsualWhere:
        """Return what is usual of a channel anywhere: noise is the same all over it."""
        return UsualWhere(self.usual(residual))

    def pair(self, given: Edits, effects: Edits, way: Convention) -> None:
        """Return nothing: there is no healthy record."""
        return

    def had_it(self, effects: Edits) -> tuple[float, FloatArray]:
        """Return that nothing was there from the start: all is compared with what is believed."""
        return 0.0, np.zeros(len(self.problem.sd))
