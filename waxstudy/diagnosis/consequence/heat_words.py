"""What is said of missing heat, and whether there is any."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from waxstudy.diagnosis.result import NORMAL, HeatBy, HeatPer, Interval, MissingHeat
from waxstudy.diagnosis.weights import WEIGHTS

COURSES = {"outdoor difference": ("the cold outside", "kelvin"), "sun": ("the sun", "watt of sun")}


def is_off(value: Interval, times: float = 1.0) -> bool:
    """Whether an interval, so many times as wide, leaves out 0."""
    return abs(value.value) > times * 0.5 * (value.high - value.low)


def is_resolved(heat: MissingHeat) -> bool:
    """Whether the data tell that heat is missing, on average or with a driver."""
    return heat.mean_before is not None and (_has_mean(heat.mean_before) or any(True for _ in _drivers(heat)))


def sentence(heat: MissingHeat, names: Sequence[str]) -> str:
    """Return what is said of heat as believed, and of what stays of it with effects of some names."""
    mean = heat.mean_before
    if mean is None or heat.mean_after is None:
        return ""
    drivers, sign = list(_drivers(heat)), _sign(mean)
    if _has_mean(mean):
        less = f"On average {_watts(mean, sign)} of heat are missing in the room"
        more = f"On average the room gets {_watts(mean, sign)} of heat more than is believed"
        told = ", ".join((less if mean.value < 0.0 else more, *(_course(each, sign) for each in drivers)))
    elif drivers:
        told = f"On average no heat is missing as far as can be told ({_range(mean)}), but "
        told += ", ".join(map(_alone, drivers))
    else:
        return f"No heat is missing as far as this record can tell: on average {_range(mean)}."
    return f"{told}.{_after(heat.mean_after, sign, names)}"


def _after(mean: Interval, sign: float, names: Sequence[str]) -> str:
    """Return what stays of the mean, whose sign is given, with effects."""
    if not names:
        return ""
    start = f" With {' and '.join(names)}"
    if not _has_mean(mean):
        return f"{start} none stays as far as can be told ({_range(mean)})."
    way = "of it stay" if mean.value * sign > 0.0 else "are missing" if mean.value < 0.0 else "are too much"
    return f"{start} {_watts(mean, _sign(mean))} {way}."


def _has_mean(mean: Interval) -> bool:
    return is_off(mean) and abs(mean.value) >= WEIGHTS.heat_least_W


def _drivers(heat: MissingHeat) -> Iterator[HeatPer | HeatBy]:
    """Yield the slope that most of the heat goes with, and the hours that stand out most, where they are sure."""
    slopes = [
        each for each in heat.per if is_off(each.before, WEIGHTS.heat_sd / NORMAL) and each.share >= WEIGHTS.heat_share
    ]
    if slopes:
        yield max(slopes, key=lambda each: each.share)
        return
    hours = [each for each in heat.by if each.driver == "hour" and is_off(each.beside, WEIGHTS.heat_sd / NORMAL)]
    if hours:
        yield max(hours, key=lambda each: abs(each.beside.value))


def _course(each: HeatPer | HeatBy, sign: float) -> str:
    """Return how heat of a sign, of which there is some on average, goes with a driver."""
    if isinstance(each, HeatBy):
        way = "most" if each.beside.value * sign > 0.0 else "least"
        return f"{way} from {each.name}: {_watts(each.before, sign)}"
    words, unit = COURSES[each.driver]
    way = "growing" if each.before.value * sign > 0.0 else "shrinking"
    return f"{way} with {words}: {_watts(each.before, _sign(each.before))} per {unit}"


def _alone(each: HeatPer | HeatBy) -> str:
    """Return how heat goes with a driver, where there is none on average."""
    if isinstance(each, HeatBy):
        way = "missing" if each.beside.value < 0.0 else "too much"
        return f"from {each.name} {_watts(each.beside, _sign(each.beside))} are {way} beside the other hours"
    words, unit = COURSES[each.driver]
    way = "missing" if each.before.value < 0.0 else "too much"
    return f"heat is {way} with {words}: {_watts(each.before, _sign(each.before))} per {unit}"


def _sign(value: Interval) -> float:
    return -1.0 if value.value < 0.0 else 1.0


def _watts(value: Interval, sign: float) -> str:
    """Return watts with their interval, of heat that is missing (-1) or more than believed (1)."""
    ends = sorted((sign * value.low, sign * value.high))
    figure, low, high = _rounded(sign * value.value, *ends)
    return f"{figure} W ({low} to {high})"


def _range(value: Interval) -> str:
    _, low, high = _rounded(value.value, value.low, value.high)
    return f"{low} to {high} W"


def _rounded(value: float, low: float, high: float) -> list[str]:
    """Return watts with as many decimals as the farther end of their interval deserves."""
    most = max(abs(low), abs(high))
    places = 0 if most >= 10.0 else 1 if most >= 1.0 else 2
    return [f"{each:z.{places}f}" for each in (value, low, high)]
