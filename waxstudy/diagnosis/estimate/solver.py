"""Damped Gauss-Newton steps (Levenberg and Marquardt) of one hypothesis at one segment."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from waxstudy.diagnosis.criteria import Question, limit
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Problem
from waxstudy.diagnosis.estimate.parameter_space import Space, valued
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.edits import Edits
from waxstudy.plugin import FloatArray

LITTLE = 5e-4  # share of the loss that is not worth another step
ENOUGH = 0.05  # that is, with slopes from before
MOST_DAMPING = 1e4
WIDE, CLOSE_BY = 0.01, 0.001  # of a range: what switches is jagged; a room's hours are known to minutes
MOST_SD = limit(Question.NUISANCE, "deviations")  # how far a departure may go


class LeastSquares:
    """Least squares of one hypothesis: departures in standard deviations, then the effects' parameters in a cube."""

    def __init__(
        self,
        problem: Problem,
        effects: Edits,
        convention: Convention,
        parts: Sequence[int],
        reach: float = WIDE,  # share of a parameter's range over which its slope is taken
    ) -> None:
        self.problem, self.effects, self.convention, self.parts, self.reach = problem, effects, convention, parts, reach
        self.spaces = [Space(effect) for effect, _ in effects]
        self.count = len(problem.sd)
        round_the_clock = np.concatenate([np.zeros(0), *(space.wraps for space in self.spaces)])  # by a day at most
        self.low = np.concatenate((np.full(self.count, -MOST_SD), -round_the_clock))
        self.high = np.concatenate((np.full(self.count, MOST_SD), 1.0 + round_the_clock))

    def vector(self, departures: FloatArray) -> FloatArray:
        inside = [space.inside(values) for space, (_, values) in zip(self.spaces, self.effects, strict=True)]
        return np.concatenate((departures / self.problem.sd, *inside))

    def at(self, x: FloatArray) -> Hypothesis | None:
        effects = valued(self.effects, self.spaces, x[self.count :])
        return self.problem.at(effects, x[: self.count] * self.problem.sd, self.convention)

    def missed(self, fitted: Hypothesis, x: FloatArray) -> FloatArray:
        chosen = [each.whitened * np.isin(each.part, self.parts) for each in fitted.residuals]
        return np.concatenate((*chosen, self.problem.prior @ x[: self.count]))

    def solved(self, x: FloatArray, most: int, known: FloatArray | None, little: float = LITTLE) -> Hypothesis | None:
        """Return the best fit from a start; `known` are slopes of the departures to be kept throughout, or None."""
        best = self.at(x)
        if best is None:
            return None
        missed = self.missed(best, x)
        if known is None:
            slopes = self.slopes(x, missed, range(len(x)))
        else:
            slopes = np.column_stack((self.kept(best, known), self.slopes(x, missed, range(self.count, len(x)))))
        damping, is_fresh = 1e-3, True
        for _ in range(most):
            if not missed.any():
                break  # nothing is missed
            step = self.step(slopes, missed, damping, x)
            if little < LITTLE and self.promised(slopes, missed, step) < little:
                break  # not even what the slopes promise is worth a simulation
            tried = self.at(x + step)
            new = self.missed(tried, x + step) if tried else None
            gained = 1.0 - (new @ new) / (missed @ missed) if new is not None else -1.0
            if tried is not None and new is not None and gained > 0.0:
                x, best, missed, damping = x + step, tried, new, max(1e-6, 0.1 * damping)
            elif is_fresh:
                damping *= 30.0
                if damping > MOST_DAMPING:
                    break
                continue
            if gained < little and is_fresh:
                break
            # the slopes of the departures hardly change: they are taken again where that has become too little
            is_fresh = known is not None or bool(gained < ENOUGH)
            fresh = range(len(x)) if is_fresh and known is None else range(self.count, len(x))
            slopes[:, list(fresh)] = self.slopes(x, missed, fresh)
        return best

    def kept(self, fitted: Hypothesis, known: FloatArray) -> FloatArray:
        """Return slopes of the departures (per unit) as those of `missed`, per standard deviation."""
        parts = np.concatenate([np.isin(each.part, self.parts) for each in fitted.residuals])
        return np.vstack((known * parts[:, None] * self.problem.sd, self.problem.prior))

    def slopes(self, x: FloatArray, missed: FloatArray, places: Sequence[int]) -> FloatArray:
        columns = []
        for place in places:
            size = 0.1 if place < self.count else self.reach
            if place >= self.count and x[place] + size > 1.0:
                size = -size
            moved = x.copy()
            moved[place] += size
            other = self.at(moved)
            columns.append((self.missed(other, moved) - missed) / size if other else np.zeros(len(missed)))
        return np.column_stack(columns) if columns else np.zeros((len(missed), 0))

    def step(self, slopes: FloatArray, missed: FloatArray, damping: float, x: FloatArray) -> FloatArray:
        """Return the best damped step within the bounds."""
        normal = slopes.T @ slopes
        normal += damping * np.diag(np.diag(normal) + 1e-9)
        step = np.asarray(np.linalg.solve(normal, -slopes.T @ missed))
        return within(normal, step, self.low - x, self.high - x)

    @staticmethod
    def promised(slopes: FloatArray, missed: FloatArray, step: FloatArray) -> float:
        """Return the share of the loss that a step would take away, were all straight."""
        there = missed + slopes @ step
        return float(1.0 - (there @ there) / (missed @ missed))


def within(normal: FloatArray, step: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the best step (n,) between bounds (n,), where `step` (n,) is the best without them.

    Another step that lies d (n,) from that one costs d' `normal` d; `normal` is (n, n).
    """
    if ((step < low) | (step > high)).any():
        from scipy.optimize import lsq_linear

        root = np.linalg.cholesky(normal).T
        step = lsq_linear(root, root @ step, (low, high), method="bvls").x
    return np.asarray(np.clip(step, low, high))
