"""Intervals of what was fitted and of how far the gap shrinks, from whole cycles or days."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from waxstudy.diagnosis.estimate.fitter import OTHER, Fitter
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import EffectType, Space
from waxstudy.diagnosis.model.conventions import Perturbation
from waxstudy.diagnosis.model.travel import opening, opening_difference_s
from waxstudy.diagnosis.observations.record import CONTINUOUS
from waxstudy.diagnosis.residuals.judge import BOTH, FIT, SELECT, SHRINK, Residual
from waxstudy.diagnosis.result import Interval
from waxstudy.diagnosis.select.null import by_block, whole
from waxstudy.plugin import FloatArray, Prior

DRAWS = 1000
WIDER = 1.4  # chosen: by so much intervals that are straight lines from one fit have to be wider to cover the truth
WIDTH = 0.02  # of a parameter's range, over which slopes are taken
LEAST_WIDTH = 1e-5  # over which it is seen whether anything changes at all
RANGE = (2.5, 97.5)
TIMING = 1.0 / 6.0  # of an interval: standard deviation of a time that switches within it leave open
CLOCK_S = 3.0  # chosen: the same of when a motor was told, by a controller that looks every ten seconds or so


def parameter_intervals(fitter: Fitter, fitted: Hypothesis) -> Mapping[EffectType, Mapping[str, Interval]]:
    """Return the parameters of each effect with 95 % intervals from the scatter of blocks (a sandwich estimate).

    Where an effect takes the place of an uncertainty of the room, that uncertainty's spread is added to its factor.
    Where another convention of the record fits as well, the intervals reach to what it gives.
    """
    others = [dict(other.effects) for other in _as_good(fitter, fitted)]
    return {
        effect: {
            name: _reaching(interval, [other[effect][name] for other in others], effect.priors[name])
            for name, interval in each.items()
        }
        for effect, each in _of_convention(fitter, fitted).items()
    }


def _as_good(fitter: Fitter, fitted: Hypothesis) -> Iterator[Hypothesis]:
    """Yield the fits under other conventions that cannot be told from this one."""
    most = fitter.score(fitted, BOTH) + OTHER * fitter.spread(fitted)
    for convention in fitter.conventions:
        if convention != fitted.convention:
            other = fitter.refined(fitted.effects, fitted.departures, convention, BOTH)
            if other and fitter.score(other, BOTH) <= most:
                yield other


def _reaching(interval: Interval, values: Sequence[float], prior: Prior) -> Interval:
    """Return an interval that holds other values too, with as much around each of them."""
    low, high = [interval.low], [interval.high]
    for value in values:
        low.append(interval.low * value / interval.value if prior.is_log else interval.low + value - interval.value)
        high.append(interval.high * value / interval.value if prior.is_log else interval.high + value - interval.value)
    return Interval(interval.value, max(prior.low, min(low)), min(prior.high, max(high)))


def _of_convention(fitter: Fitter, fitted: Hypothesis) -> dict[EffectType, dict[str, Interval]]:
    spaces = {effect: Space(effect) for effect, _ in fitted.effects}
    slopes, rows = _slopes(fitter, fitted, spaces)
    residual, part, block = whole(fitted)
    seen = (part == FIT) | (part == SELECT)
    if not rows:
        return {effect: {} for effect, _ in fitted.effects}
    missed = np.column_stack((slopes, np.zeros((len(slopes), 0))))[seen]
    normal = missed.T @ missed + _prior(fitter, missed.shape[1])
    numbers, member = np.unique(block[seen], return_inverse=True)
    scores = by_block((missed * residual[seen][:, None]).T, member, len(numbers))
    inverse = np.linalg.pinv(normal)
    spread = inverse @ (scores @ scores.T) @ inverse * len(numbers) / max(1, len(numbers) - len(rows))
    spread += inverse if fitter.nuisances else 0.0
    off = inverse @ (missed.T @ _inexact(fitter, fitted)[seen])
    sd = np.sqrt(np.clip(np.diag(spread), 0.0, None) + off**2)
    return _described(fitter, fitted, spaces, sd, len(numbers))


def _inexact(fitter: Fitter, fitted: Hypothesis) -> FloatArray:
    """Return how far the whitened residual (m,) move with what a prediction is not exact in.

    That is what smoothing the segment's drive once more does, as it may have done before, and of a room its long steps.
    """
    now = fitted.whitened
    belief = fitter.edited(fitted.effects, fitted.departures)
    if fitter.segment.driven_by in CONTINUOUS:
        other = fitter.predicted(belief, fitted.convention, Perturbation(np.random.default_rng(13)))
    elif fitter.segment.with_room:
        other = fitter.predicted.fine(belief, fitted.convention)
    else:
        return np.zeros(len(now))
    return np.concatenate([each.whitened for each in fitter.judge.residuals(other)]) - now


def _prior(fitter: Fitter, count: int) -> FloatArray:
    """Return what the priors of the room's departures add to the normal equations, in standard deviations."""
    nuisance = len(fitter.nuisances)
    return np.diag(np.concatenate((np.ones(nuisance), np.full(count - nuisance, 1e-9))))


def _slopes(
    fitter: Fitter, fitted: Hypothesis, spaces: Mapping[EffectType, Space]
) -> tuple[FloatArray, list[tuple[EffectType, str]]]:
    """Return the change of the whitened residuals with each departure and parameter (m, k), and the names."""
    rows = [(effect, name) for effect, space in spaces.items() for name in space.names]
    now = fitted.whitened
    columns = []
    for place, sd in enumerate(fitter.sd):
        moved = fitted.departures.copy()
        moved[place] += 0.1 * sd
        other = fitter.at(fitted.effects, moved, fitted.convention)
        columns.append((other.whitened - now) / 0.1 if other else np.zeros(len(now)))
    for effect, name in rows:
        columns.append(_slope(fitter, fitted, spaces, effect, name, now))
    return np.column_stack(columns) if columns else np.zeros((len(now), 0)), rows


def _slope(
    fitter: Fitter,
    fitted: Hypothesis,
    spaces: Mapping[EffectType, Space],
    effect: EffectType,
    name: str,
    now: FloatArray,
) -> FloatArray:
    """Return the change over the range of one parameter, from both sides where both are possible."""
    space, values = spaces[effect], dict(fitted.effects)
    x = space.inside(values[effect])
    place = space.names.index(name)
    found = []
    for width in (-WIDTH, WIDTH):
        at = x.copy()
        at[place] = np.clip(x[place] + width, 0.0, 1.0)
        if at[place] == x[place]:
            continue
        moved = [(each, space.values(at) if each is effect else dict(v)) for each, v in fitted.effects]
        other = fitter.at(moved, fitted.departures, fitted.convention)
        if other:
            found.append((other.whitened - now) / (at[place] - x[place]))
    return np.asarray(np.mean(found, axis=0)) if found else np.zeros(len(now))


def _described(
    fitter: Fitter, fitted: Hypothesis, spaces: Mapping[EffectType, Space], sd: FloatArray, blocks: int
) -> dict[EffectType, dict[str, Interval]]:
    from scipy.stats import t

    wide = WIDER * float(t.ppf(0.975, max(1, blocks - 1)))
    found: dict[EffectType, dict[str, Interval]] = {}
    at = len(fitter.nuisances)
    absorbed = {nuisance.name: nuisance.sd for nuisance in fitter.nuisances}
    for effect, values in fitted.effects:
        space = spaces[effect]
        x = space.inside(values)
        found[effect] = {}
        for place, name in enumerate(space.names):
            prior = space.priors[place]
            half = float(np.hypot(wide * float(sd[at]), 2.0 * _timing(fitter, fitted, effect, place)))
            if prior.is_log and effect.absorbs:
                spread = sum(absorbed.get(each, 0.0) ** 2 for each in effect.absorbs) ** 0.5
                half = float(np.hypot(half, 1.96 * spread / np.log(prior.high / prior.low)))
            low, high = x.copy(), x.copy()
            low[place] -= max(half, _still(fitter, fitted, effect, place, -1))
            high[place] += max(half, _still(fitter, fitted, effect, place, 1))
            found[effect][name] = Interval(values[name], space.values(low)[name], space.values(high)[name])
            at += 1
    return found


def _still(fitter: Fitter, fitted: Hypothesis, effect: EffectType, place: int, way: int) -> float:
    """Return how far one way a parameter may go before anything recorded would change, as a share of its range."""
    space, values, now = Space(effect), dict(fitted.effects), fitted.whitened
    x = space.inside(values[effect])
    still, width = 0.0, LEAST_WIDTH
    while still < 1.0:
        at = x.copy()
        at[place] += way * width
        moved = [(each, space.values(at) if each is effect else dict(v)) for each, v in fitted.effects]
        other = fitter.at(moved, fitted.departures, fitted.convention)
        if other is None or not np.array_equal(other.whitened, now):
            return width if still else 0.0
        still, width = width, 2.0 * width
    return still


def _timing(fitter: Fitter, fitted: Hypothesis, effect: EffectType, place: int) -> float:
    """Return what the sampling of a drive's switches leaves open of a parameter, as a share of its range.

    Nobody knows when within an interval each of them was thrown; the judge puts it where it fits best, so that a time
    may be off by nearly as much as that lets it, and a motor's pace by what moves its opening as much. A motor's times
    are known no better than when it was told, whatever drives it.
    """
    is_switched, is_motor = fitter.segment.driven_by in fitter.record.binary, effect.stage == "actuator"
    if not is_switched and not is_motor:
        return 0.0
    space, values = Space(effect), dict(fitted.effects)[effect]
    name, prior = space.names[place], space.priors[place]
    open_s = max(TIMING * fitter.record.interval_s if is_switched else 0.0, CLOCK_S if is_motor else 0.0)
    if not name.endswith("_s"):
        return open_s / moved if (moved := _moved_s(fitter, fitted, effect, place)) else 0.0
    return float(
        open_s / max(values[name], open_s) / np.log(prior.high / prior.low)
        if prior.is_log
        else open_s / (prior.high - prior.low)
    )


def _moved_s(fitter: Fitter, fitted: Hypothesis, effect: EffectType, place: int) -> float:
    """Return by how much of a switch [s] a parameter of an actuator moves its opening, over its whole range."""
    if effect.stage != "actuator":
        return 0.0
    space, values = Space(effect), dict(fitted.effects)
    x = space.inside(values[effect])
    x[place] += WIDTH if x[place] < 0.5 else -WIDTH
    moved = [(each, space.values(x) if each is effect else v) for each, v in fitted.effects]
    beliefs = [fitter.edited(each, fitted.departures) for each in (fitted.effects, moved)]
    before, after = (opening(fitter.record, belief) for belief in beliefs)
    return (
        opening_difference_s(fitter.record, before - after) / WIDTH if before is not None and after is not None else 0.0
    )


def shrink(before: Residual, after: Residual, floor: float, random: np.random.Generator) -> Interval:
    """Return 1 - (after^2 - floor^2) / (before^2 - floor^2) on the last part, with its 95 % interval over blocks.

    No number where no gap was above the floor there: nothing could shrink.
    """
    part = SHRINK if (before.part == SHRINK).any() else SELECT
    chosen = before.judged & after.judged & (before.part == part)
    if not chosen.any() or np.mean(before.error[chosen] ** 2) <= floor**2:
        return Interval(float("nan"), float("nan"), float("nan"))
    numbers, member = np.unique(before.block[chosen], return_inverse=True)
    squares = by_block(np.array([before.error[chosen] ** 2, after.error[chosen] ** 2]), member, len(numbers))
    count = np.bincount(member, minlength=len(numbers))
    weights = random.multinomial(len(numbers), np.full(len(numbers), 1.0 / len(numbers)), DRAWS).T
    means = squares @ weights / (count @ weights)
    drawn = _shrunk(means[:, means[0] > floor**2], floor)
    value = float(_shrunk((squares.sum(axis=1) / count.sum())[:, None], floor)[0])
    low, high = np.percentile(np.append(drawn, value), RANGE)
    return Interval(value, float(min(low, value)), float(max(high, value)))


def _shrunk(squares: FloatArray, floor: float) -> FloatArray:
    return np.asarray(1.0 - (squares[1] - floor**2) / (squares[0] - floor**2))
