"""Hypotheses at fitted values, what they miss, and what an estimator needs to know of what they are fitted to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.edits import Edits, EffectType, Values
from waxstudy.plugin import Belief, FloatArray

MOTIONS = ("resting", "moving")  # of a motor or valve


@dataclass(frozen=True)
class Residual:
    """What is missed of one channel: `error` in `unit`, and over its standard deviation (`whitened`), both (m,)."""

    channel: str
    unit: str
    error: FloatArray  # 0 where nothing is judged
    whitened: FloatArray  # 0 where nothing is judged
    judged: np.ndarray  # (m,) bool
    block: np.ndarray  # (m,) cycle or day
    part: np.ndarray  # (m,) FIT, SELECT, SHRINK
    sample: np.ndarray  # (m,) index of the record's sample
    form: float = 0.0  # in `unit`: the most that the form of a room's model may leave, as a root mean square
    motion: np.ndarray | None = None  # (m,) place in `MOTIONS`, where each is weighed by itself; None where none is
    noise: FloatArray | None = None  # (m,) standard deviation of the instrument's, whitened; None where none is told

    def loss(self, part: int | None = None) -> float:
        chosen = self.whitened if part is None else self.whitened[self.part == part]
        return float(chosen @ chosen)

    @property
    def whitened_rms(self) -> float:
        """Root mean square of what is judged, over its standard deviation."""
        return float(np.sqrt(self.loss() / max(1, int(self.judged.sum()))))

    def gap(self, part: int | None = None) -> float:
        """Root mean square error in the channel's unit, over what is judged."""
        chosen = self.judged if part is None else self.judged & (self.part == part)
        return float(np.sqrt(np.mean(self.error[chosen] ** 2))) if chosen.any() else 0.0

    def count(self, part: int) -> int:
        """Samples that are judged of a part, at least 1."""
        return max(1, int(np.sum(self.judged & (self.part == part))))

    @property
    def measured(self) -> str:
        """The channel, be this all of it, its rest or its moves."""
        return self.channel.partition(" ")[0]

    @property
    def is_at_rest(self) -> bool:
        return self.channel == motions_of(self.measured)[0]

    @property
    def noise_square(self) -> float:
        """What the instrument's noise leaves of a sample, as a mean of whitened squares; a meter at rest has none."""
        return float(np.mean(self.noise[self.judged] ** 2)) if self.noise is not None and self.judged.any() else 0.0

    @property
    def by_motion(self) -> list[Residual]:
        """What is missed at rest and on the move, by names of their own; itself where these are not told apart."""
        if self.motion is None:
            return [self]
        return [self._where(self.motion == place, name) for place, name in enumerate(motions_of(self.channel))]

    def _where(self, chosen: np.ndarray, name: str) -> Residual:
        error, whitened = self.error * chosen, self.whitened * chosen
        return replace(self, channel=name, error=error, whitened=whitened, judged=self.judged & chosen, motion=None)

    def weights(self, share: Mapping[str, float]) -> FloatArray:
        """Return the root of what each sample counts (m,), from how many of a motion count as one."""
        if self.motion is None:
            return np.full(len(self.whitened), share.get(self.channel, 1.0) ** -0.5)
        each = np.array([share.get(name, 1.0) ** -0.5 for name in motions_of(self.channel)])
        return np.asarray(each[self.motion])


def motions_of(channel: str) -> list[str]:
    """Return what a motor's or valve's channel is called at rest and on the move."""
    return [f"{channel} {each}" for each in MOTIONS]


@dataclass(frozen=True)
class Hypothesis:
    """A belief with effects and departures fitted to a problem, and what it misses."""

    effects: tuple[tuple[EffectType, Values], ...]
    convention: Convention
    departures: FloatArray
    residuals: Sequence[Residual] = field(repr=False)
    is_at_times: bool = False  # whether its last effect acts in what it misses at some times only

    def loss(self, part: int) -> float:
        return sum(each.loss(part) for each in self.residuals)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(effect.name for effect, _ in self.effects)

    @property
    def by_motion(self) -> list[Residual]:
        """What is missed of every channel, at rest and on the move where these are weighed apart."""
        return [motion for each in self.residuals for motion in each.by_motion]

    def motion_of(self, name: str) -> Residual | None:
        """Return what is missed of a channel, or of one of its motions, by its name; None where it is not judged."""
        return next((each for each in self.by_motion if each.channel == name), None)

    def residual_of(self, channel: str) -> Residual:
        return next(each for each in self.residuals if each.channel == channel)

    @property
    def whitened(self) -> FloatArray:
        """Whitened residuals of all channels, one after the other."""
        return np.concatenate([each.whitened for each in self.residuals])

    def missed(self, parts: Sequence[int]) -> FloatArray:
        """Whitened residuals of all channels on some parts."""
        return np.concatenate([each.whitened[np.isin(each.part, parts)] for each in self.residuals])


class Problem(Protocol):
    """A part of a loop and its record, as something to fit. Nuisances are departures from the belief, 0 as believed."""

    name: str
    belief: Belief
    conventions: Sequence[Convention]  # ways in which the record may have been logged, the likeliest first
    sd: FloatArray  # (nuisances,) of the normal prior of each
    prior: FloatArray  # (nuisances, nuisances): turns departures over these into independent ones
    events: Sequence[int]  # nuisances that happened once and are fitted to all days
    is_smooth: bool  # whether anything that is judged has slopes, as nothing has that only switches
    discounts_noise: bool  # whether ways to log it let more or less of the drive's noise through

    def edited(self, effects: Edits, departures: FloatArray) -> Belief:
        """Return the belief with departures and effects; raise `ValueError` where it cannot be."""

    def at(self, effects: Edits, departures: FloatArray, convention: Convention) -> Hypothesis | None:
        """Return what a hypothesis misses at given values, or None where it cannot be simulated."""

    def added_heat_slopes(self, fitted: Hypothesis, places: Iterable[int]) -> Mapping[int, FloatArray]:
        """Return the change of the whitened residuals (m,) with nuisances that do no more than add heat, by place."""

    def drive_noise(self, fitted: Hypothesis) -> Mapping[int, float]:
        """Return what noise of the drive adds to a hypothesis' loss, by part of the record."""
