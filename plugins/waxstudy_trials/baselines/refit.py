"""Refit: every effect alone in the loop that runs free, and the one that misses the air temperature least."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.consequence.closed_loop import STEP_S
from waxstudy.diagnosis.diagnose import installed_effects
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.model.room_response import built, coarsened, merging
from waxstudy.diagnosis.observations.record import DAY_S, Record
from waxstudy.plugin import Belief, FloatArray, SimulationError
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import START, Loop
from waxstudy.simulation.modes import DrivenRoom, drive
from waxstudy.simulation.recorded import recorded_room, weather_of
from waxstudy_trials.baselines import Json, answer, taken

THOROUGH = 0.2  # of the points that a diagnosis looks at
DESCENT = 20
A_DAY = 24  # residual of a day that count as one each: they hang together for about an hour
IMPOSSIBLE = 1e9


def diagnose(dataset: Dataset) -> Json:
    """Return the effect of the least Bayesian information criterion, or none."""
    record, belief = taken(dataset)
    if belief.inputs is None or belief.room is None or "controller" not in belief.blocks:
        return answer(dataset, [], "the loop cannot run free")
    inputs, _ = coarsened(record, belief, record.filled_or_zero("flow_L_h"), merging(record.interval_s)[0])
    belief = replace(belief, inputs=inputs)
    free = _FreeLoop(record, belief)
    count = len(record) * record.interval_s / DAY_S * A_DAY
    found: list[tuple[float, EffectType, Mapping[str, float]]] = []
    for effect in installed_effects():
        if not effect.hindrance(belief):
            missed_K, values = _best(effect, belief, free)
            found.append((_criterion(missed_K, len(effect.priors), count), effect, values))
    none = _criterion(free.missed_K(belief), 0, count)
    best = min(found, key=lambda each: each[0], default=None)
    return answer(dataset, [best[1:]] if best and best[0] < none else [])


def _criterion(missed_K: float, parameters: int, count: float) -> float:
    return count * float(np.log(missed_K**2)) + parameters * float(np.log(count))


def _best(effect: EffectType, belief: Belief, free: _FreeLoop) -> tuple[float, Mapping[str, float]]:
    from scipy.optimize import minimize

    space = Space(effect)

    def missed(values: Mapping[str, float]) -> float:
        try:
            return free.missed_K(effect.apply(belief, effect.Parameters(**values)))
        except (ValueError, SimulationError):
            return IMPOSSIBLE

    tried = [*space.points(THOROUGH), *effect.starts(belief)]
    start = min(tried, key=missed)

    def at(x: FloatArray) -> float:
        return missed(space.values(x))

    end = minimize(
        at,
        space.inside(start),
        method="Nelder-Mead",
        bounds=[(0.0, 1.0)] * len(space.names),
        options={"maxfev": DESCENT, "xatol": 1e-3, "fatol": 1e-4},
    )
    return float(end.fun), space.values(end.x)


class _FreeLoop:
    """The loop left to itself; a room that nothing changes is made ready once."""

    def __init__(self, record: Record, belief: Belief) -> None:
        self.record, self.belief = record, belief
        self.setpoint_C = float(np.nanmedian(record.filled("setpoint_C")))
        self.own = _driven(belief)

    def missed_K(self, belief: Belief) -> float:
        """Return the root mean square error of the air; raise `SimulationError` or `ValueError`."""
        is_own = belief.room is self.belief.room and belief.inputs is self.belief.inputs
        driven = self.own if is_own else _driven(belief)
        (week,) = Loop(Chain(belief.blocks, driven.step_s), driven, limit_C=-99.0).weeks(
            self.setpoint_C, [START], trace=True
        )
        steps = max(1, round(self.record.interval_s / driven.step_s))
        air_C: FloatArray = week.trace[:, 0][steps - 1 :: steps]  # at the ends of intervals
        seen_C = self.record.filled(self.record.air_channel)
        count = min(len(air_C), len(seen_C))
        return max(1e-6, float(np.sqrt(np.mean((air_C[:count] - seen_C[:count]) ** 2))))


def _driven(belief: Belief) -> DrivenRoom:
    assert belief.room
    assert belief.inputs
    step_s = belief.inputs.interval_s / max(1, round(belief.inputs.interval_s / STEP_S))
    return drive(recorded_room(built(belief.room), belief.inputs), weather_of(belief.inputs), step_s)
