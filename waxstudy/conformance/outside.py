"""What a room with an engine of its own must do with the chain that it is given."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.conformance.stage import Problems, Stage, Subject
from waxstudy.plugin import TRACE, BackendMissing, OutsideRoom, Refused, SimulationError, Stopped, WeatherRecord
from waxstudy.plugin.registry import PluginError, told
from waxstudy.simulation.engine import DAY_S, WARM_UP_DAYS
from waxstudy.simulation.outside import engine_of, record_problems
from waxstudy.study.model import Choice

STEPS_S = (60.0, 5.0, 1.0)  # the first that the engine takes
HALF_HOUR_S = 1800.0
OPEN, SHUT = (0.8, 1.0, 0.6, 0.4), (0.0, 0.0, 0.0, 0.0)
CHAIN = slice(TRACE.index("output"), TRACE.index("flow_fraction") + 1)
SETPOINT_C = 21.0
SOON_S = 1.0  # to the end of a run that is told to stop, or half of the time that it takes otherwise


def levels(time_s: float) -> tuple[float, float, float, float]:
    """Return output, signal, opening and flow fraction of a chain that goes by the clock."""
    return OPEN if time_s // HALF_HOUR_S % 2 == 0 else SHUT


@dataclass
class Clock:
    """A chain that opens and shuts by the clock, and raises `SimulationError` if a step is left out or comes twice."""

    step_s: float
    due_s: float = -WARM_UP_DAYS * DAY_S

    def __call__(self, sensed_C: float, time_s: float, step_s: float) -> tuple[float, float, float, float]:
        if abs(time_s - self.due_s) > 1e-6 or step_s != self.step_s:
            called = f"called for the {step_s:g} s from {time_s:g} s on"
            raise SimulationError(f"advance was {called}, where {self.step_s:g} s from {self.due_s:g} s on were due")
        if not np.isfinite(sensed_C):
            raise SimulationError(f"advance was given {sensed_C} C at {time_s:g} s")
        self.due_s += self.step_s
        return levels(time_s)


class Failing:
    """A chain that fails at its first step."""

    says = "this chain was made to fail"

    def __call__(self, sensed_C: float, time_s: float, step_s: float) -> tuple[float, float, float, float]:
        raise SimulationError(self.says)


@dataclass(frozen=True)
class Trial:
    """An example's room in a dark day at -5 C."""

    choice: Choice
    weather: WeatherRecord
    step_s: float

    def record(self, advance: Any, *, stop: bool = False) -> Any:
        component = self.choice.component
        assert issubclass(component, OutsideRoom)
        return component.simulate(
            self.choice.parameters,
            self.weather,
            advance,
            setpoint_C=SETPOINT_C,
            step_s=self.step_s,
            air_K=0.5,
            slab_K=-0.5,
            stop=lambda: stop,
        )


def _trials(subject: Subject) -> Iterator[tuple[str, Trial | None, str]]:
    """Yield each example made ready, or why it is not; raise `BackendMissing`."""
    for label, parameters in subject.models.items():
        trial, wrong = None, ""
        try:
            with told(f"example '{label}'", BackendMissing):
                trial = _trial(Choice(subject.component, parameters))
        except PluginError as error:
            wrong = str(error)
        yield label, trial, wrong


def _trial(choice: Choice) -> Trial:
    assert issubclass(choice.component, OutsideRoom)
    dark = {name: np.zeros(24) for name in choice.component.build(choice.parameters).facades}
    weather = WeatherRecord(3600.0, "2023-01-01", np.full(24, -5.0), dark)
    return Trial(choice, weather, _accepted(choice, weather))


def _accepted(choice: Choice, weather: WeatherRecord) -> float:
    for step_s in STEPS_S:
        try:
            engine_of(choice, weather, step_s)
            return step_s
        except Refused as error:
            refused = error
    raise PluginError(f"ready refuses steps of {', '.join(f'{step:g}' for step in STEPS_S)} s: {refused}")


def outside_simulates(subject: Subject) -> Problems:
    """A day gives a record of numbers with what the chain said at every step, the warm-up's included."""
    for label, trial, wrong in _trials(subject):
        problems = _day_problems(trial) if trial else iter([wrong])
        yield from (f"example '{label}': {problem}" if trial else problem for problem in problems)


def _day_problems(trial: Trial) -> Problems:
    count = round(DAY_S / trial.step_s)
    try:
        with told("", BackendMissing):
            record = trial.record(Clock(trial.step_s))
    except PluginError as error:
        yield str(error)
        return
    wrong = list(record_problems(record, count))
    yield from wrong
    expected = np.array([levels(n * trial.step_s) for n in range(count)])
    if not wrong and not np.allclose(record[:, CHAIN], expected, rtol=0.0, atol=1e-9):
        yield f"its columns {', '.join(TRACE[CHAIN])} are not what advance returned for these steps"


def outside_ends(subject: Subject) -> Problems:
    """What the chain raises comes out, and a run that is asked to stop ends soon."""
    for label, trial, _ in _trials(subject):
        assert trial
        raised = _raised_by(trial)
        if not (isinstance(raised, SimulationError) and Failing.says in str(raised)):
            came = "nothing" if raised is None else repr(raised)
            yield f"example '{label}': advance raised a SimulationError and {came} came out: let it through"
        whole_s, wrong = _timed(trial, stop=False)
        stopped_s, wrong_stop = _timed(trial, stop=True)
        yield from (f"example '{label}': {problem}" for problem in (wrong, wrong_stop) if problem)
        if stopped_s > max(SOON_S, whole_s / 2.0):
            took = f"told to stop from the start, it took {stopped_s:.1f} s of {whole_s:.1f} s"
            yield f"example '{label}': {took}: ask stop() every few steps, and raise Stopped"


def _raised_by(trial: Trial) -> BaseException | None:
    try:
        trial.record(Failing())
    except (Exception, SystemExit) as error:
        return error
    return None


def _timed(trial: Trial, stop: bool) -> tuple[float, str]:
    """Return the seconds that a run takes, and what it raised that it may not."""
    begin, wrong = time.perf_counter(), ""
    try:
        with told("", *([Stopped] if stop else [])):
            trial.record(Clock(trial.step_s), stop=stop)
    except Stopped:
        pass
    except PluginError as error:
        wrong = str(error)
    return time.perf_counter() - begin, wrong


OUTSIDE_STAGES = (
    Stage("simulate", "a day in its own engine: every step, and a record of numbers", outside_simulates, needed=True),
    Stage("stop", "ends soon when asked, and lets out what the chain raises", outside_ends),
)
