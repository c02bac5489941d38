"""How fast a valve answers after a pause: time to full opening and to 90 % of full flow (research question 2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import Block, FloatArray, Parameters
from waxstudy.plugin.registry import installed
from waxstudy.results.kpis import FULLY_OPEN
from waxstudy.simulation.records import plain_parameters
from waxstudy.study.model import Choice, Study

STEP_S = 1.0
CONDITIONING_S = 3600.0  # heated for long before the pause, as the first half of a cycle
LONGEST_S = 3600.0  # a valve that has not opened by then counts as never
OFF_TIMES_MIN = (0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 37.5, 45, 60, 90, 120)
MOST_OF_FLOW = 0.9


@dataclass(frozen=True)
class Activation:
    """Times from the signal to full opening and to 90 % of full flow [s] (off times,); NaN where never."""

    actuator: str
    off_min: FloatArray
    opening_s: FloatArray
    flow_s: FloatArray


def activations(study: Study) -> list[Activation]:
    """Return the curve of every installed actuator's example, behind the valve of the first ladder's reference."""
    reference = next(iter(study.ladders.values())).reference
    valve = study.cases[reference].blocks.get("valve")
    return [activation(label, choice, valve) for label, choice in _examples()]


def _examples() -> Iterator[tuple[str, Choice]]:
    registry = installed()
    for name in registry.names("actuator"):
        block = registry.get("actuator", name)
        assert issubclass(block, Block)
        for label, values in block.examples.items():
            title = name if label == "default" else f"{name}, {label}"
            yield title, Choice(block, block.Parameters.model_validate(dict(values)))


def activation(
    label: str, actuator: Choice, valve: Choice | None, off_min: Sequence[float] = OFF_TIMES_MIN
) -> Activation:
    """Return the curve of one actuator behind one valve (or none: flow is opening)."""
    times = np.array([_after_pause(actuator, valve, 60.0 * minutes) for minutes in off_min])
    return Activation(label, np.array(off_min, dtype=float), times[:, 0], times[:, 1])


def _after_pause(actuator: Choice, valve: Choice | None, off_s: float) -> tuple[float, float]:
    move, flow = _stepper(actuator), _stepper(valve) if valve else lambda u: u
    for signal, seconds in ((1.0, CONDITIONING_S), (0.0, off_s)):
        for _ in range(round(seconds / STEP_S)):
            flow(move(signal))
    opening_s = flow_s = np.nan
    for n in range(1, round(LONGEST_S / STEP_S) + 1):
        opening = move(1.0)
        if flow(opening) >= MOST_OF_FLOW and np.isnan(flow_s):
            flow_s = n * STEP_S
        if opening >= FULLY_OPEN:
            return n * STEP_S, flow_s
    return opening_s, flow_s


def _stepper(choice: Choice) -> Any:
    """One block on its own, stepped in the interpreter."""
    block = choice.component
    assert issubclass(block, Block)
    plain = plain_parameters(choice.parameters)
    state = block.start(plain, STEP_S)
    clock = iter(np.arange(0.0, 1e6, STEP_S).tolist())
    return lambda u: block.step(plain, state, u, next(clock), STEP_S)


def valve_flow(valve: Choice, opening: float) -> float:
    """Return the flow fraction of a valve at an opening."""
    return float(_stepper(valve)(opening))


__all__ = ["Activation", "Parameters", "activation", "activations", "valve_flow"]
