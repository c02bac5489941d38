"""A second look at a room exactly as it is believed: effects in the place of all that nobody knows of it."""

from __future__ import annotations

from collections.abc import Sequence

from waxstudy.diagnosis.criteria import Question, meets
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.model.room_response import OF_AIR_AND_FLOOR
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import in_floors
from waxstudy.diagnosis.select.evidence import Exact
from waxstudy.diagnosis.select.search import Selection, Tick, select


def with_exact_room(loose: Selection, effects: Sequence[EffectType], seed: int, tick: Tick) -> Selection:
    """Return a selection in which nothing of a room departs, where effects then leave nothing but noise; else the same.

    That they do what a dozen nuisances together did is no chance, although these could take each of them.
    """
    if not _is_known_well(loose.problem) or not _is_exact(Exact(over_loose=_most(loose.after, loose.floor))):
        return loose
    estimator = Estimator(loose.problem.exact(), loose.estimator.thorough)
    believed = estimator.base_on_both(estimator.base.convention)
    floor = NoiseFloor.of(estimator.problem, believed)
    blurred_K = max(floor.plain[each.channel] for each in _shown(believed))
    if not _is_exact(Exact(over=_most(believed, floor), left_K=blurred_K)):
        return loose
    exact = select(estimator, effects, seed, tick)
    return exact if exact.found and _is_clear(exact) else loose


def _is_known_well(problem: SegmentProblem) -> bool:
    """Whether a room is no rough guess, and what drives it is known: what a noisy opening lets through is not."""
    segment, record = problem.segment, problem.record
    is_measured = segment.driven_by == "flow_L_h" or segment.driven_by in record.binary
    is_shown = any(channel in OF_AIR_AND_FLOOR for channel in segment.judged)
    is_told = is_measured and not record.stand_ins
    return segment.with_room and is_shown and is_told and problem.room_tolerance <= 1.0


def _is_clear(exact: Selection) -> bool:
    """Whether of air and floor nothing but noise is left, and less than another form of a room would leave."""
    over = min(each.candidate.evidence.over for each in exact.found)
    left_K = max(each.gap() for each in _shown(exact.after))
    return _is_exact(Exact(over=over, left=_most(exact.after, exact.floor), left_K=left_K))


def _is_exact(evidence: Exact) -> bool:
    return meets(Question.EXACT, evidence)


def _shown(model: Hypothesis) -> list[Residual]:
    """Return what is missed of air and floor."""
    return [residual for residual in model.residuals if residual.channel in OF_AIR_AND_FLOOR]


def _most(model: Hypothesis, floor: NoiseFloor) -> float:
    """Return the most that is missed of air or floor over its noise floor."""
    return max(in_floors(residual.gap(), floor.plain[residual.channel]) for residual in _shown(model))
