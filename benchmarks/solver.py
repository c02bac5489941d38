"""Our damped Gauss-Newton steps beside scipy's least_squares: `python -m benchmarks.solver`.

Both fit the same effects to the same segments of one made record, from the same start, with the same slopes' widths.
Printed are the loss that each leaves and how many simulations it took.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from tests.diagnosis.realities import EFFECTS, belief, effects, estimator, planted, record
from waxstudy.diagnosis.criteria import LIMITS
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.solver import LeastSquares
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import FIT

CASES = {
    "let-by": ("valve", {"fraction": 0.05}, {"fraction": 0.01}),
    "constant-times": ("actuator", {}, {}),
    "infiltration": ("room", {"factor": 3.0}, {"factor": 1.2}),
    "thermal-mass": ("room", {"factor": 2.0}, {"factor": 1.1}),
    "neighbour-heat": ("room", {"conductance_W_K": 5.0}, {"conductance_W_K": 1.0}),
}
STEPS = 25


class Counted(LeastSquares):
    """A problem that counts its simulations."""

    runs = 0

    def at(self, x: np.ndarray) -> Hypothesis | None:
        self.runs += 1
        return super().at(x)


def main() -> None:
    seen = record("REAL", days=6)
    believed = belief("REAL", seen)
    cut = segments(seen, believed)
    print(f"{'effect':16} {'loss ours':>10} {'scipy':>10} {'runs ours':>10} {'scipy':>10}")
    for name, (stage, true, start) in CASES.items():
        if not true:
            continue
        segment = next(each for each in cut if stage in each.stages)
        made = planted(segment, seen, believed, effects(**{name.replace("-", "_"): true}))
        fit = estimator(segment, made, believed)
        chosen = [(EFFECTS[name], start)]
        arguments = (fit.problem, chosen, fit.base.convention, (FIT,))
        ours, theirs = Counted(*arguments), Counted(*arguments)
        x = ours.vector(fit.base.departures)
        solved = ours.solved(x, STEPS, None)
        loss = _loss(ours, solved)
        print(f"{name:16} {loss:10.2f} {_by_scipy(theirs, x):10.2f} {ours.runs:10d} {theirs.runs:10d}")


def _loss(problem: Counted, solved: Hypothesis | None) -> float:
    assert solved
    departures = solved.departures / problem.problem.sd if problem.count else np.zeros(0)
    return float(np.sum(problem.missed(solved, departures) ** 2))


def _by_scipy(problem: Counted, x: np.ndarray) -> float:
    def missed(at: np.ndarray) -> np.ndarray:
        found = problem.at(at)
        assert found
        return problem.missed(found, at)

    low = [*[-LIMITS.departure] * problem.count, *[0.0] * (len(x) - problem.count)]
    high: Sequence[float] = [*[LIMITS.departure] * problem.count, *[1.0] * (len(x) - problem.count)]
    widths = [*[0.1] * problem.count, *[0.01] * (len(x) - problem.count)]
    inside = np.clip(x, np.array(low) + 1e-6, np.array(high) - 1e-6)
    found = least_squares(missed, inside, bounds=(low, high), diff_step=_relative(inside, widths), max_nfev=STEPS)
    return float(2.0 * found.cost)


def _relative(x: np.ndarray, widths: Sequence[float]) -> np.ndarray:
    """Return steps as scipy takes them, in units of what it moves."""
    return np.array(widths) / np.maximum(np.abs(x), 1e-3)


if __name__ == "__main__":
    main()
