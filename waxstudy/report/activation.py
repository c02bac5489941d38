"""How fast a valve answers after a pause: time to full opening and to 90 % of full flow (research question 2)."""

from __future__ import annotations

import copy
import logging
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from waxstudy.plugin import Block, FloatArray
from waxstudy.plugin.registry import PluginError, installed, told
from waxstudy.results.kpis import FULLY_OPEN
from waxstudy.simulation.chain import Stepped
from waxstudy.study.model import Choice, Study

STEP_S = 1.0
CONDITIONING_S = 3600.0  # heated for long before the pause, as the first half of a cycle
LONGEST_S = 3600.0  # a valve that has not opened by then counts as never
OFF_TIMES_MIN = (0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30, 37.5, 45, 60, 90, 120)
MOST_OF_FLOW = 0.9
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Activation:
    """Times from the signal to full opening and to 90 % of full flow [s] (off times,); NaN where never."""

    actuator: str
    off_min: FloatArray
    opening_s: FloatArray
    flow_s: FloatArray
    in_study: bool = False  # else an example of its package


def activations(study: Study) -> list[Activation]:
    """Return the curve of each actuator's examples and of the study's own, behind the valve of the first reference.

    Examples are those of the packages that the study's blocks come from.
    """
    reference = next(iter(study.ladders.values())).reference
    valve = study.cases[reference].blocks.get("valve")
    examples = list(_examples(study))
    used = [case.blocks.get("actuator") for case in study.cases.values()]
    found = []
    for label, choice in (*examples, *_own(study, [choice for _, choice in examples])):
        try:
            found.append(replace(activation(label, choice, valve), in_study=choice in used))
        except Exception:  # an actuator that fails here and not in the run is none of this study's
            log.info("no activation curve of %s", label, exc_info=True)
    return found


def _own(study: Study, known: Sequence[Choice]) -> Iterator[tuple[str, Choice]]:
    """Yield the actuators of a study that are no examples, each by the first case that has it."""
    seen = list(known)
    for name, case in study.cases.items():
        choice = case.blocks.get("actuator")
        if choice is not None and choice not in seen:
            seen.append(choice)
            yield f"{choice.component.name}, {name}", choice


def _examples(study: Study) -> Iterator[tuple[str, Choice]]:
    registry = installed()
    used = [choice.component for case in study.cases.values() for choice in case.blocks.values()]
    packages = {registry.package_of(component).package for component in used}
    for name in registry.names("actuator"):
        registered = registry.components["actuator", name]
        block = registered.component
        if registered.package not in packages or not issubclass(block, Block):
            continue
        for label, values in block.examples.items():
            title = name if label == "default" else f"{name}, {label}"
            try:
                with told():  # a stranger's example may be anything
                    example = Choice.of(block, values)
            except PluginError:
                log.info("no activation curve of %s", title, exc_info=True)
            else:
                yield title, example


def activation(
    label: str, actuator: Choice, valve: Choice | None, off_min: Sequence[float] = OFF_TIMES_MIN
) -> Activation:
    """Return the curve of one actuator behind one valve (or none: flow is opening); off times must rise."""
    bench, times, paused_s = _Bench(actuator, valve), [], 0.0
    bench.run(1.0, CONDITIONING_S)
    for minutes in off_min:
        bench.run(0.0, 60.0 * minutes - paused_s)
        paused_s = 60.0 * minutes
        times.append(copy.deepcopy(bench).opening_times_s())
    opening_s, flow_s = np.array(times).T
    return Activation(label, np.array(off_min, dtype=float), opening_s, flow_s)


class _Bench:
    """An actuator and a valve on their own, stepped in the interpreter."""

    def __init__(self, actuator: Choice, valve: Choice | None) -> None:
        self.blocks = [Stepped(choice, STEP_S) for choice in (actuator, valve) if choice]
        self.time_s = 0.0

    def step(self, signal: float) -> tuple[float, float]:
        """Return opening and flow fraction after one step."""
        values = [signal]
        for block in self.blocks:
            values.append(block.step(values[-1], self.time_s))
        self.time_s += STEP_S
        return values[1], values[-1]

    def run(self, signal: float, seconds: float) -> None:
        for _ in range(round(seconds / STEP_S)):
            self.step(signal)

    def opening_times_s(self) -> tuple[float, float]:
        """Switch on and return the times to full opening and to most of the flow; NaN where never."""
        flow_s = np.nan
        for n in range(1, round(LONGEST_S / STEP_S) + 1):
            opening, flow = self.step(1.0)
            if flow >= MOST_OF_FLOW and np.isnan(flow_s):
                flow_s = n * STEP_S
            if opening >= FULLY_OPEN:
                return n * STEP_S, flow_s
        return np.nan, flow_s
