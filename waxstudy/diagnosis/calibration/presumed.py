"""A link of which no healthy record is known: what noise, and the form of its model, may leave of the record itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from waxstudy.diagnosis.calibration.calibrate import HealthyLeft, together
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.estimate.parameter_space import Edits
from waxstudy.diagnosis.model.as_built import AsBuilt
from waxstudy.diagnosis.model.discrepancy import Discrepancy
from waxstudy.diagnosis.model.nuisance import nuisances
from waxstudy.diagnosis.model.room_response import error_of
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.plugin import Belief, FloatArray

ROUNDS = 2  # of learning what a fit leaves, and fitting again
LONGEST = 16.0  # quarters of an hour over which a form's errors hang together, at most: longer ones a fit must follow
EVEN = 3.2  # standard deviations of misfit at which something unknown is as likely as not


@dataclass(frozen=True)
class Presumed:
    """Stands in for what a healthy record would say of a link. `fitted` leaves the least that is known so far."""

    problem: SegmentProblem
    fitted: Hypothesis
    floor: Mapping[str, float]  # of the whitened errors of each channel of a chain
    _losses: dict[tuple[str, bytes], float] = field(default_factory=dict, repr=False)  # by channel and errors

    def together(self, channel: str) -> float:
        """Return how many samples of a channel count as one."""
        return 1.0 if self.problem.segment.with_room else together(self.fitted.residual_of(channel))

    def left(self, channel: str) -> HealthyLeft | None:
        """Return what noise alone leaves of a channel of a chain."""
        residual = self.fitted.residual_of(channel)
        count = int(residual.judged.sum())
        cycles = len(np.unique(residual.block[residual.judged]))
        return HealthyLeft(self.floor.get(channel, 1.0), count, cycles) if count else None

    def knowing(self, best: Hypothesis) -> Presumed:
        """Return the same where a hypothesis leaves less: less than noise was thought to, it may be."""
        left = {each.channel: each.loss() / max(1, int(each.judged.sum())) for each in best.residuals}
        floor = {channel: min(white, float(left[channel] ** 0.5)) for channel, white in self.floor.items()}
        return replace(self, fitted=best, floor=floor)

    def usual_loss(self, residual: Residual) -> float:
        """Return what is missed of a chain's channel where nothing is amiss."""
        return self.floor[residual.channel] ** 2 * int(residual.judged.sum())

    def usual_K(self, channel: str) -> float:
        """Return what a room is missed by where nothing is amiss, by its form and noise."""
        typical_K = error_of(self.problem.belief, channel).typical_K
        return float(np.hypot(typical_K, self.problem.record.noise[channel]))

    def had_it(self, effects: Edits) -> tuple[float, FloatArray]:
        """Return that nothing speaks against what was there from the start, and nothing would lie elsewhere."""
        return 0.0, np.zeros(len(self.problem.sd))

    def room_loss(self, fitted: Hypothesis) -> float:
        """Return -2 log likelihood of what a hypothesis leaves of a room, by the discrepancy that suits it best."""
        return sum(self._loss(each) for each in fitted.residuals)

    def misfit(self, residual: Residual) -> float:
        """Return by how much a room is missed by more than its form leaves, in standard deviations."""
        error = error_of(self.problem.belief, residual.channel)
        noise_K = self.problem.record.noise[residual.channel]
        typical_K, most_K = np.hypot((error.typical_K, error.most_K), noise_K)
        over = np.log(max(residual.gap(), 1e-9) / typical_K) / np.log(most_K / typical_K)
        return EVEN * max(0.0, float(over))

    def _loss(self, residual: Residual) -> float:
        key = residual.channel, residual.error.tobytes()
        if key not in self._losses:
            assert self.problem.as_built
            known, least_K = self.problem.as_built.discrepancies[residual.channel], _least_K(self.problem, residual)
            expected_K = float(np.hypot(error_of(self.problem.belief, residual.channel).typical_K, least_K))
            _, loss = Discrepancy.likeliest(residual.error, residual.judged, least_K, expected_K)
            self._losses[key] = loss / known.shared
        return self._losses[key]


def presumed(segment: Segment, record: Record, belief: Belief, tolerance: float, thorough: float) -> Presumed:
    """Return what a link may leave by what is known of noise and form; of a room the record itself tells how."""
    parts = np.full(len(record), FIT)
    found = AsBuilt((), np.zeros(0), np.zeros((0, 0)))
    unknowns = nuisances(belief, record, segment.driven_by, tolerance) if segment.with_room else []
    problem = SegmentProblem(segment, record, belief, tolerance, as_built=found, unknowns=unknowns, parts=parts)
    if not segment.with_room:
        fitted = Estimator(problem, thorough, keeps=True).base
        return Presumed(problem, fitted, NoiseFloor.of(problem, fitted).white)
    followed = None
    for _ in range(ROUNDS):
        estimator = Estimator(problem, thorough, keeps=True)
        start = followed.fitted.departures if followed else np.zeros(len(problem.sd))
        followed = estimator.follow(start, problem.conventions[0], (FIT,), followed.place if followed else None)
        found = replace(found, discrepancies=_discrepancies(problem, followed.fitted))
        problem = problem.judged_by(found)
    assert followed
    return Presumed(
        problem, problem.at((), followed.fitted.departures, followed.fitted.convention) or followed.fitted, {}
    )


def _discrepancies(problem: SegmentProblem, fitted: Hypothesis) -> dict[str, Discrepancy]:
    from waxstudy.diagnosis.calibration.calibrate import _shared

    found = {}
    for each in fitted.residuals:
        least_K = _least_K(problem, each)
        expected_K = float(np.hypot(error_of(problem.belief, each.channel).typical_K, least_K))
        likeliest, _ = Discrepancy.likeliest(each.error, each.judged, least_K, expected_K)
        # what a large effect does is no form of a room, and nothing to be lenient about
        most = {"sd_K": min(likeliest.sd_K, expected_K), "length": min(likeliest.length, LONGEST)}
        found[each.channel] = replace(likeliest, noise_K=min(likeliest.noise_K, expected_K), **most)
    shared = _shared([found[each.channel].whitened(each.error, each.judged) for each in fitted.residuals])
    return {channel: replace(each, shared=shared) for channel, each in found.items()}


def _least_K(problem: SegmentProblem, residual: Residual) -> float:
    """Return the noise of means over quarters of an hour."""
    return float(problem.record.noise[residual.channel] * (len(residual.error) / len(problem.record)) ** 0.5)
