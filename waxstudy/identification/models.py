"""What a fit of one characteristic time comes to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from waxstudy.identification.curves import Test
from waxstudy.identification.scatter import Scatter
from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class Value:
    """A coefficient with its 95 % interval.

    `told` is false where the data do not bound it, and for a constant in place of a curve that they do not tell.
    """

    value: float
    low: float
    high: float
    told: bool = True

    @property
    def width(self) -> float:
        return self.high - self.low


@dataclass(frozen=True)
class ProductCurve:
    """A time of one product: a f(t_in / tau) + b."""

    a_s: Value
    b_s: Value
    tau_s: Value
    form: str  # common, product term, separate, constant
    test: Test | None  # of the model that it is part of; None for a constant
    cycles: int
    before_s: tuple[float, float]  # range of t_in, NaN where it is not known or plays no part


@dataclass(frozen=True)
class TimeModel:
    """A characteristic time of all products."""

    name: str  # dead, rise, hold, fall
    curves: Mapping[str, ProductCurve]
    steps: Sequence[str]  # what was tried and decided, one sentence each
    untold: Sequence[str]  # what these data cannot tell
    scatter: Scatter
    residual_s: FloatArray  # (cycles,)
