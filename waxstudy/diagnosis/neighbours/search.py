"""The search: what stands out most is named first and taken from its room, before the others are held against it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations
from math import inf

import numpy as np

from waxstudy.diagnosis.neighbours.control import Control, controlled
from waxstudy.diagnosis.neighbours.limits import HUBER, LEVEL, MOST_PATTERNS, NEAR_H, NOTICEABLE_K, SHORT_H, SURE_ODDS
from waxstudy.diagnosis.neighbours.pattern import Pattern, Scored
from waxstudy.diagnosis.neighbours.series import House
from waxstudy.diagnosis.neighbours.spans import TAUS_H, scored, tried
from waxstudy.plugin import FloatArray

MOST_ROUNDS = 30  # of the search
SHORTEST = 2  # steps: an hour
TINY = 1e-9
MOVES = (-8, -4, -2, -1, 1, 2, 4, 8)  # steps by which the ends of a span are tried elsewhere
REFINED = 6  # times that both ends and the answer are tried in turn
Tick = Callable[[str, float], None]


def needed(house: House) -> float:
    """Return the score from which a span is told: BIC's price of its size, and of the spans that were tried."""
    return float(np.log(len(house)) + 2.0 * np.log(tried(house) * SURE_ODDS))


def searched(house: House, tick: Tick = lambda what, share: None) -> dict[str, Control]:
    """Return each room held against its neighbours, with what departs in it."""
    healed = {room.name: room.air_C for room in house.rooms}
    controls = {room.name: controlled(house, room, healed) for room in house.rooms}
    for turn in range(MOST_ROUNDS):
        tick("neighbours", turn / MOST_ROUNDS)
        best = {name: _best(control) for name, control in controls.items() if len(control.patterns) < MOST_PATTERNS}
        chosen = _foremost({name: each for name, each in best.items() if each}, len(house))
        if not chosen:
            break
        for name, each in chosen.items():
            controls[name] = _settled(house, controls[name], healed, each.pattern)
            healed[name] = controls[name].room.air_C - controls[name].departure_K
        for name, control in controls.items():
            controls[name] = controlled(house, control.room, healed, control.patterns)
    return {name: _confirmed(control, healed) for name, control in controls.items()}


def _best(control: Control) -> Scored | None:
    """Return what stands out most in a room, None where nothing does; short spans first.

    From the beginning of one short departure to the end of another reaches a long one, which would hide both.
    """
    house = control.house
    for most_h in (SHORT_H, inf):
        found = [each for each in scored(house, control.fit, most_h) if each.score >= needed(house)]
        found = [each for each in found if abs(_mean_K(house, each)) >= NOTICEABLE_K and _shows(control, each)]
        if found:
            return max(found, key=lambda each: each.score)
    return None


def _shows(without: Control, each: Scored) -> bool:
    """Whether a room's level departs as well, not its edges alone: else the hours between two departures are taken."""
    inside, left = each.pattern.inside(len(without.house)), without.fit.left_K
    if np.isfinite(left[inside]).sum() == 0:
        return False
    level = float(np.nanmedian(left[inside]) - np.nanmedian(left[~inside]))
    claimed = _mean_K(without.house, each)
    return bool(level * np.sign(claimed) >= LEVEL * abs(claimed))


def _mean_K(house: House, each: Scored) -> float:
    """Return the mean of a departure over its hours."""
    inside = each.pattern.inside(len(house))
    return float(each.size_K * each.pattern.shapes(house)[inside].mean()) if inside.any() else 0.0


def _foremost(best: dict[str, Scored], count: int) -> dict[str, Scored]:
    """Return what no stronger departure of another room overlaps with: that one is to be taken away first."""
    found: dict[str, Scored] = {}
    for name, each in sorted(best.items(), key=lambda item: -item[1].score):
        if not any(each.pattern.overlaps(other.pattern, count) for other in found.values()):
            found[name] = each
    return found


def _settled(house: House, control: Control, healed: dict[str, FloatArray], new: Pattern) -> Control:
    """Return a room with one more pattern, the ends of all of them where they fit best."""
    found = _all_refined(controlled(house, control.room, healed, (*control.patterns, new)), healed)
    for old in control.patterns:
        # an early pattern may have reached for an edge of what is only found now: try it anew
        others = [each for each in found.patterns if each != old]
        if old in found.patterns and _touches(old, others, round(NEAR_H / house.step_h)):
            without = _all_refined(controlled(house, control.room, healed, others), healed)
            if anew := _best(without):
                anew_too = (*without.patterns, anew.pattern)
                other = _all_refined(controlled(house, control.room, healed, anew_too), healed)
                found = max(found, other, key=_likelihood)
    return found


def _all_refined(control: Control, healed: dict[str, FloatArray]) -> Control:
    """Return a room with the ends of its patterns where they fit best, the last one's first."""
    patterns = list(control.patterns)
    for place in reversed(range(len(patterns))):
        others = [each for i, each in enumerate(patterns) if i != place]
        patterns[place] = _refined(controlled(control.house, control.room, healed, others), patterns[place])
    return controlled(control.house, control.room, healed, patterns)


def _touches(pattern: Pattern, others: Sequence[Pattern], near: int) -> bool:
    """Whether a pattern begins or ends at an edge of another."""
    edges = [edge for other in others for span in other.spans for edge in span]
    return any(abs(edge - other) <= near for span in pattern.spans for edge in span for other in edges)


def _likelihood(control: Control) -> float:
    """Return twice the log likelihood of a room's air, outliers counted by less."""
    fit = control.fit
    white = np.abs(fit.white[fit.known])
    loss = np.where(white < HUBER, white**2, 2.0 * HUBER * white - HUBER**2)
    return float(-np.sum(loss) - 2.0 * np.sum(np.log(fit.errors.sd_K[fit.known])))


def _refined(without: Control, pattern: Pattern) -> Pattern:
    """Return a pattern with its ends and its answer where they fit best."""
    best, most = pattern, gained(without, pattern)
    for _ in range(REFINED):
        before = best
        for other in beside(best):
            gain = gained(without, other)
            if gain > most:
                best, most = other, gain
        if best == before:
            break
    return best


def beside(pattern: Pattern) -> Sequence[Pattern]:
    """Return a pattern with other ends, and with other answers."""
    shortest = min(end - begin for begin, end in pattern.spans)
    ends = [(move, 0) for move in MOVES] + [(0, move) for move in MOVES] + [(move, move) for move in MOVES]
    moved = [pattern.moved(*move) for move in ends if shortest + move[1] - move[0] >= SHORTEST]
    answers = [*((each,) for each in TAUS_H), *combinations(TAUS_H, 2)]
    return [*moved, *(replace(pattern, taus_h=each) for each in answers if each != pattern.taus_h)]


def gained(without: Control, pattern: Pattern, unrest: float = 1.0) -> float:
    """Return what a pattern gains beside all else of a room, twice its log likelihood, less the price of its sizes.

    The gain counts by so much less as `unrest` says that sizes vary by more than errors alone would make them.
    """
    size_K, precision = sizes(without, pattern)
    return float(size_K @ precision @ size_K) / unrest - len(size_K) * float(np.log(len(without.house)))


def sizes(without: Control, pattern: Pattern) -> tuple[FloatArray, FloatArray]:
    """Return the sizes of a pattern that fit best (k,) [K], and their precision (k, k), by a room's errors alone."""
    fit = without.fit
    shapes = fit.errors.of_shape(pattern.shapes(without.house)) / fit.errors.sd_K[:, None]
    shapes[~fit.known] = 0.0
    shapes -= fit.basis @ (fit.basis.T @ shapes)
    precision = shapes.T @ shapes + TINY * np.eye(shapes.shape[1])
    return np.asarray(np.linalg.solve(precision, shapes.T @ fit.white), dtype=float), precision


def _confirmed(control: Control, healed: dict[str, FloatArray]) -> Control:
    """Return a room without patterns that are not noticeable beside the rest."""
    kept = [each for i, each in enumerate(control.patterns) if abs(control.mean_K(i)) >= NOTICEABLE_K]
    if len(kept) == len(control.patterns):
        return control
    return controlled(control.house, control.room, healed, kept)
