"""What an engine of its own equations puts into a record: a change of its own numbers, drawn from ranges."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import Choice
from waxstudy.plugin.trial import Cause, Scene, Unmakeable
from waxstudy_trials.family import Channels, Family, logged

Values = Mapping[str, float]
Change = Callable[[Any, Values], Mapping[str, Any]]
DIGITS = 5


@dataclass(frozen=True)
class Range:
    """Where a value is drawn from: log-uniform from low to high, as a factor to either side, or with either sign."""

    low: float
    high: float
    is_signed: bool = False
    is_factor: bool = False  # low and high are of how far it is from 1
    is_even: bool = False  # drawn evenly

    def drawn(self, random: np.random.Generator) -> float:
        if self.is_even:
            return _rounded(float(random.uniform(self.low, self.high)))
        size = float(np.exp(random.uniform(np.log(self.low), np.log(self.high))))
        sign = 1.0 if random.random() < 0.5 else -1.0
        if self.is_factor:
            return _rounded((1.0 + size) ** (sign if self.is_signed else 1.0))
        return _rounded(sign * size if self.is_signed else size)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


@dataclass(frozen=True)
class Put:
    """A cause with the ranges of its values and what they change; `logger` stands for a family of the logger.

    What it changes is a named tuple: the engine's numbers.
    """

    cause: Cause
    ranges: Mapping[str, Range]
    change: Change
    logger: type[Family] | None = None

    def drawn(self, random: np.random.Generator) -> dict[str, float]:
        return {name: each.drawn(random) for name, each in self.ranges.items()}

    def edited(self, numbers: Any, values: Values) -> Any:
        return numbers._replace(**self.change(numbers, values))


def effect(name: str, stage: str, change: Change, **ranges: Range) -> Put:
    return Put(Cause(name, (stage,)), ranges, change)


def family(name: str, stages: Sequence[str], change: Change, is_kept: bool = False, **ranges: Range) -> Put:
    return Put(Cause(name, tuple(stages), is_family=True, is_kept=is_kept), ranges, change)


def logger(family: type[Family], **ranges: Range) -> Put:
    return Put(family.cause(), ranges, lambda numbers, values: {}, family)


def as_it_is(own: str, name: str) -> Change:
    """Return the change of one number to a value."""
    return lambda numbers, values: {own: values[name]}


def scene_of(
    random: np.random.Generator, puts: Mapping[str, Put], names: Sequence[str], days: int, gains_W: tuple[float, float]
) -> Scene:
    """Return what every scene has: its weather, gains and setpoint; causes are drawn last, by `with_causes`."""
    if len({name for name in names if puts[name].logger}) > 1:
        raise Unmakeable("one logger cannot be wrong in two ways")
    return {
        "days": days,
        "seed": int(random.integers(2**31)),
        "day": int(random.integers(45)),
        "outdoor_C": round(float(random.uniform(-9.0, 4.0)), 1),
        "gains_W": round(float(random.uniform(*gains_W)), 1),
        "setpoint_C": round(float(random.uniform(20.3, 22.0)), 1),
    }


def with_causes(scene: Scene, random: np.random.Generator, puts: Mapping[str, Put], names: Sequence[str]) -> Scene:
    return {**scene, "causes": [{"name": name, "values": puts[name].drawn(random)} for name in names]}


def with_all(numbers: Any, puts: Sequence[tuple[Put, Values]]) -> Any:
    """Return the numbers with all changes."""
    for put, values in puts:
        numbers = put.edited(numbers, values)
    return numbers


def logged_puts(
    channels: Channels, step_s: float, puts: Sequence[tuple[Put, Values]], still: Sequence[Channels]
) -> tuple[Channels, list[Channels]]:
    """Return what is logged, and for each cause what would be without it: a logger's, or as it is in `still`."""
    choices = [Choice.of(put.logger, values) for put, values in puts if put.logger]
    shown, of_loggers = logged(channels, step_s, choices)
    rest = iter(of_loggers)
    return shown, [next(rest) if put.logger else each for (put, _), each in zip(puts, still, strict=True)]
