"""Distributions as a study file states them: values, values with shares, a range, or mean and deviation."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from statistics import NormalDist
from typing import Any, Protocol

WIDEST_SD = 3.0  # where a normal distribution is cut off, so that it has ends that can be checked
FORMS = "allowed: [1, 2], { values = [1, 2], shares = [0.3, 0.7] }, { low = 1, high = 2 }, { mean = 1, sd = 0.2 }"


class Spread(Protocol):
    """A distribution: `ends` are the values that have to be possible, `at` is its quantile function."""

    @property
    def ends(self) -> Sequence[Any]: ...

    def at(self, share: float) -> Any: ...

    def described(self) -> object: ...


@dataclass(frozen=True)
class OneOf:
    """Values, each with its share of all."""

    values: tuple[Any, ...]
    shares: tuple[float, ...]

    @property
    def ends(self) -> Sequence[Any]:
        return self.values

    def at(self, share: float) -> Any:
        total = list(accumulate(self.shares))
        return self.values[min(bisect_right(total, share * total[-1]), len(self.values) - 1)]

    def described(self) -> object:
        return {"values": list(self.values), "shares": list(self.shares)}


@dataclass(frozen=True)
class Between:
    """Any number between two, each as likely."""

    low: float
    high: float

    @property
    def ends(self) -> Sequence[Any]:
        return (self.low, self.high)

    def at(self, share: float) -> Any:
        return self.low + share * (self.high - self.low)

    def described(self) -> object:
        return {"low": self.low, "high": self.high}


@dataclass(frozen=True)
class Normal:
    """A normal distribution within three standard deviations."""

    mean: float
    sd: float

    @property
    def ends(self) -> Sequence[Any]:
        return (self.mean - WIDEST_SD * self.sd, self.mean + WIDEST_SD * self.sd)

    def at(self, share: float) -> Any:
        cut = NormalDist().cdf(-WIDEST_SD)
        return self.mean + self.sd * NormalDist().inv_cdf(cut + share * (1.0 - 2.0 * cut))

    def described(self) -> object:
        return {"mean": self.mean, "sd": self.sd}


def spread_of(value: object) -> Spread:
    """Return the distribution that a file writes so; raise `ValueError` with what is wrong.

    >>> spread_of({"low": 1, "high": 3}).at(0.25), spread_of(["A", "B"]).at(0.25)
    (1.5, 'A')
    """
    if isinstance(value, list):
        return _one_of(value, [1.0] * len(value))
    if not isinstance(value, Mapping):
        raise ValueError(f"must be a distribution ({FORMS})")
    if value.keys() == {"values", "shares"}:
        return _one_of(value["values"], value["shares"])
    if value.keys() == {"low", "high"} and all(map(_is_number, value.values())):
        if not value["low"] < value["high"]:
            raise ValueError(f"low must be less than high, not {value['low']:g} and {value['high']:g}")
        return Between(float(value["low"]), float(value["high"]))
    if value.keys() == {"mean", "sd"} and all(map(_is_number, value.values())):
        if not value["sd"] > 0.0:
            raise ValueError(f"sd must be more than 0, not {value['sd']:g}")
        return Normal(float(value["mean"]), float(value["sd"]))
    raise ValueError(f"is no distribution ({FORMS})")


def _one_of(values: object, shares: object) -> OneOf:
    if not isinstance(values, list) or not values or any(isinstance(each, list | Mapping) for each in values):
        raise ValueError(f"needs a list of at least one value ({FORMS})")
    if not isinstance(shares, list) or len(shares) != len(values):
        raise ValueError("needs a share for each of its values")
    if not all(map(_is_number, shares)) or min(shares) < 0.0 or sum(shares) <= 0.0:
        raise ValueError("its shares must be numbers from 0, not all of them 0")
    return OneOf(tuple(values), tuple(map(float, shares)))


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
