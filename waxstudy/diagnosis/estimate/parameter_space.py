"""The parameters of an effect as a unit cube: points to look at first, and ways downhill from one of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from waxstudy.diagnosis.model.edits import Edits, EffectType, Values
from waxstudy.plugin import HOURS, FloatArray, Prior

SCAN = {1: 17, 2: 45}  # points of a first look, by the number of parameters
SCAN_MORE = 64
TIE = 1e-9  # of losses that are alike
LEAST_STEPS = 0.5  # chosen: noticeable ones; a search begins with no less of an effect, and a fit may end there
NARROW, QUICK_NARROW = 1e-5, 1e-3  # share of a range that is not looked into


class Space:
    """The parameters of an effect as a unit cube."""

    def __init__(self, effect: EffectType) -> None:
        self.effect, self.names, self.priors = effect, list(effect.priors), list(effect.priors.values())
        self.wraps = np.array([effect.has_hours() and name in HOURS for name in self.names], dtype=bool)

    def values(self, x: FloatArray) -> Values:
        """Return the values at a place; hours go on round the clock."""
        x = np.where(self.wraps & ((x < 0.0) | (x > 1.0)), x % 1.0, x)
        return {name: _value(prior, float(at)) for name, prior, at in zip(self.names, self.priors, x, strict=True)}

    def inside(self, values: Values) -> FloatArray:
        return np.array([_place(prior, values[name]) for name, prior in zip(self.names, self.priors, strict=True)])

    def at_end(self, values: Values) -> list[str]:
        """Return the parameters that are the least or the most that is tried, and might lie beyond: hours go on."""
        places = zip(self.names, self.priors, self.wraps, self.inside(values), strict=True)
        return [name for name, prior, wraps, at in places if not wraps and self._is_at_end(name, prior, float(at))]

    def _is_at_end(self, name: str, prior: Prior, at: float) -> bool:
        limits = self.effect.Parameters.model_fields[name].metadata
        possible = {getattr(each, way) for each in limits for way in ("ge", "gt", "le", "lt") if hasattr(each, way)}
        is_low, is_high = at <= QUICK_NARROW, at >= 1.0 - QUICK_NARROW
        return (is_low and prior.low not in possible) or (is_high and prior.high not in possible)

    def scaled(self, values: Values, neutral: Values, strength: float) -> Values:
        """Return values that lie a number of times as far from neutral ones, within the cube."""
        at, still = self.inside(values), self.inside({**values, **neutral})
        return self.values(np.clip(still + strength * (at - still), 0.0, 1.0))

    def away(self, neutral: Values, x: FloatArray, most: float = 1.0) -> Values:
        """Return values either way of neutral ones, from `LEAST_STEPS` in the middle to the ends of what is tried.

        In between they are spread by the logarithm of their noticeable steps, of which they go so far as `most` says.
        Others lie where a place in the cube is.
        """
        return {**self.values(x), **{name: self._away(name, neutral[name], x, most) for name in neutral}}

    def _away(self, name: str, still: float, x: FloatArray, most: float) -> float:
        prior, way = self.effect.priors[name], 2.0 * float(x[self.names.index(name)]) - 1.0
        farthest = max(abs(steps(prior, end, still)) for end in (prior.low, prior.high))
        size = LEAST_STEPS * (farthest / LEAST_STEPS) ** (most * abs(way))
        return stepped(prior, still, float(np.copysign(size, way)))

    def points(self, thorough: float) -> list[Values]:
        """Return points spread over the cube: evenly for one parameter, else a Sobol sequence."""
        count = len(self.names)
        if not count:
            return [{}]
        wanted = max(5, round(SCAN.get(count, SCAN_MORE) * thorough))
        if count == 1:
            return [self.values(np.array([at])) for at in np.linspace(0.0, 1.0, wanted)]
        from scipy.stats import qmc

        spread = qmc.Sobol(count, scramble=False).random_base2(int(np.ceil(np.log2(wanted + 1))))
        return [self.values(point) for point in spread[1 : wanted + 1]]

    def near(self, neutral: Values | None) -> list[Values]:
        """Return points a noticeable step from neutral, either way of each parameter: others may lie far apart."""
        if neutral is None or not set(self.names) <= neutral.keys():
            return []
        pairs = zip(self.names, self.priors, strict=True)
        steps = [(name, stepped(prior, neutral[name], way)) for name, prior in pairs for way in (-1, 1)]
        return [{**neutral, name: value} for name, value in steps if value != neutral[name]]


def stepped(prior: Prior, still: float, steps: float) -> float:
    """Return a value so many noticeable steps from a neutral one, within the range that is looked at."""
    value = still * prior.noticeable**steps if prior.is_log else still + steps * prior.noticeable
    return float(min(prior.high, max(prior.low, value)))


def steps(prior: Prior, value: float, still: float) -> float:
    """Return the distance of a value from a neutral one in noticeable steps."""
    if prior.is_log:
        return float(abs(np.log(value / still)) / np.log(prior.noticeable))
    return abs(value - still) / prior.noticeable


def _value(prior: Prior, at: float) -> float:
    at = min(1.0, max(0.0, at))
    return prior.low * (prior.high / prior.low) ** at if prior.is_log else prior.low + (prior.high - prior.low) * at


def _place(prior: Prior, value: float) -> float:
    if prior.is_log:
        return float(np.log(max(value, prior.low) / prior.low) / np.log(prior.high / prior.low))
    return (value - prior.low) / (prior.high - prior.low)


def valued(effects: Edits, spaces: Sequence[Space], x: FloatArray) -> list[tuple[EffectType, Values]]:
    """Return effects with the values that a point in all their cubes, one after the other, stands for."""
    places = np.split(x, np.cumsum([len(space.names) for space in spaces], dtype=int))[:-1]
    return [(effect, space.values(at)) for (effect, _), space, at in zip(effects, spaces, places, strict=True)]


def descend(loss: Callable[[FloatArray], float], start: FloatArray, most: int, narrow: float = NARROW) -> FloatArray:
    """Return the best point found downhill from a start in the unit cube (Nelder and Mead)."""
    from scipy.optimize import minimize

    size = 0.06
    if len(start) == 1:
        start, size = _zoomed(loss, start, size, max(5, most // 3))
    corners = np.tile(start, (len(start) + 1, 1))
    for place in range(len(start)):
        corners[place + 1, place] += size if start[place] < 0.5 else -size
    found = minimize(
        loss,
        start,
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * len(start),
        options={"maxfev": most, "initial_simplex": corners, "xatol": 1e-4, "fatol": 1e-3},
    )
    return _centred(loss, np.asarray(found.x), narrow) if len(start) == 1 else np.asarray(found.x)


def _centred(loss: Callable[[FloatArray], float], x: FloatArray, narrow: float) -> FloatArray:
    """Return the middle of the range of one parameter that is as good: a threshold says nothing between samples."""
    least = loss(x) + TIE
    ends = []
    for way in (-1.0, 1.0):
        reach, step = 0.0, narrow
        while step >= narrow:
            at = x + way * (reach + step)
            is_as_good = bool(0.0 <= at[0] <= 1.0 and loss(at) <= least)
            reach, step = (reach + step, 2.0 * step) if is_as_good else (reach, 0.25 * step)
        ends.append(way * reach)
    middle = x + 0.5 * sum(ends)
    return middle if loss(middle) <= least else x


def _zoomed(
    loss: Callable[[FloatArray], float], start: FloatArray, size: float, points: int
) -> tuple[FloatArray, float]:
    """Return the best place of one parameter near a start, and how far around it is not looked at.

    What hangs on single switches is jagged, and a descent would end in the nearest notch.
    """
    for _ in range(2):
        near = np.clip(start + size * np.linspace(-1.0, 1.0, points | 1)[:, None], 0.0, 1.0)
        start = min(near, key=loss)
        size *= 2.0 / (points | 1)
    return start, size
