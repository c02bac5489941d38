"""Tune a case: search on some weather, then test what was found, what stands and what others say on all other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.loop.linear import linearised
from waxstudy.loop.response import NotLinear
from waxstudy.loop.rules import textbook_rules
from waxstudy.plugin import Choice, FloatArray, SimulationError
from waxstudy.simulation.run import Progress
from waxstudy.study.model import Case, Study
from waxstudy.sweeps.run import points_folder
from waxstudy.tuning.evaluate import EVALUATIONS, Evaluator, Settings, Weather
from waxstudy.tuning.objectives import Goal, NoObjective, misses_comfort
from waxstudy.tuning.search import Budget, landscape, search
from waxstudy.tuning.space import Axis
from waxstudy.tuning.weathers import Split, split

STANDS, CHOSEN = "as it stands", "tuned"
DIGITS = 4  # of what a rule gives


@dataclass(frozen=True)
class Setting:
    """Settings under a name, with their figures on the weather that was tuned on, and on that which took no part."""

    name: str
    values: Settings
    score: float  # of the weather tuned on; 1 is the case as it stands
    tuned: pd.DataFrame
    tested_score: float = np.nan
    tested: pd.DataFrame | None = None


@dataclass(frozen=True)
class Evaluation:
    """One of the settings that the search has seen; its score is inf where `reason` says why it does not count."""

    values: Settings
    score: float
    reason: str = ""


@dataclass(frozen=True)
class Tuned:
    """What a search found."""

    study: Study
    case: Case
    goal: Goal
    axes: Sequence[Axis]
    split: Split
    seed: int
    budget: int
    seen: Sequence[Evaluation]
    settings: Sequence[Setting]  # the case as it stands, what was chosen, then what others say
    warnings: Sequence[str] = field(default_factory=tuple)

    @property
    def start(self) -> Setting:
        return self.settings[0]

    @property
    def chosen(self) -> Setting:
        return self.settings[1]


def tune(
    study: Study,
    case_id: str,
    goal: Goal,
    axes: Sequence[Axis],
    folder: Path,
    *,
    weeks: Sequence[str],
    budget: int,
    seed: int,
    workers: int,
    told: Progress,
    jit: bool = True,
) -> Tuned:
    """Search, and test what was found; what the folder holds is not computed again.

    Raises what `prepare` raises, `NoObjective`, `SimulationError` where the case cannot be had as it stands,
    `RunError` for a folder in other use, `OSError`, and `KeyboardInterrupt`; what was finished before that is kept.
    """
    with points_folder(folder, EVALUATIONS, "tuning"):
        return _Tuning(study, case_id, goal, axes, seed, Evaluator(case_id, folder, workers, told), jit).run(
            split(study, weeks), budget
        )


@dataclass
class _Tuning:
    study: Study
    case_id: str
    goal: Goal
    axes: Sequence[Axis]
    seed: int
    evaluator: Evaluator
    jit: bool
    seen: dict[tuple[float, ...], Evaluation] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    @property
    def case(self) -> Case:
        return self.study.cases[self.case_id]

    @property
    def stands(self) -> dict[str, float]:
        """What is tuned, as the case has it."""
        blocks = self.case.blocks
        return {axis.key: float(getattr(blocks[axis.kind].parameters, axis.name)) for axis in self.axes}

    def run(self, divided: Split, count: int) -> Tuned:
        self.weather = Weather.of(divided.tuned, self.jit)
        budget = Budget.of(count, len(self.axes))
        # the case as it stands comes twice: to be the measure, and with the landscape
        self.evaluator.expect(2 + budget.side ** min(2, len(self.axes)) + budget.generation * budget.generations)
        self.start = self._as_it_stands(self.weather)
        self.goal.refuse(self.start)
        self.scores([self.stands, *landscape(self.axes, self.stands, budget.side)])
        search(self.axes, self._best().values, budget, self.seed, self.scores)
        named = [(STANDS, self.stands), (CHOSEN, self._best().values), *self._of_others()]
        settings = list(self._settings(named))
        if divided.tested is None:
            self._warn(
                f"no weather is left to test on: all of the study's, {divided.tuned_words}, took part; "
                "add a [weather.NAME], or [ensemble.weather.WEEK]"
            )
        else:
            settings = list(self._tested(settings, Weather.of(divided.tested, self.jit)))
        return Tuned(
            self.study,
            self.case,
            self.goal,
            self.axes,
            divided,
            self.seed,
            count,
            list(self.seen.values()),
            settings,
            self.warnings,
        )

    def _as_it_stands(self, weather: Weather) -> pd.DataFrame:
        (found,) = self.evaluator.figures(weather, [self.stands])
        if isinstance(found, str):
            raise SimulationError(f"the case cannot be had as it stands: {found}")
        if wrong := misses_comfort(found, self.study.comfort.hours_below_per_week):
            self._warn(f"case {self.case_id} as it stands is {wrong}")
        weather.stand_at(found)
        return found

    def scores(self, settings: Sequence[dict[str, float]]) -> FloatArray:
        """Return the score of each, inf for those that cannot be had at equal comfort; note what was seen."""
        new = [each for each in settings if tuple(each.values()) not in self.seen]
        for each, figures in zip(new, self.evaluator.figures(self.weather, new), strict=True):
            self.seen[tuple(each.values())] = self._evaluation(each, figures)
        for _ in range(len(settings) - len(new)):
            self.evaluator.told.done(None, False)
        return np.array([self.seen[tuple(each.values())].score for each in settings])

    def _evaluation(self, values: Settings, figures: pd.DataFrame | str) -> Evaluation:
        if isinstance(figures, str):
            return Evaluation(values, np.inf, figures)
        if wrong := misses_comfort(figures, self.study.comfort.hours_below_per_week):
            return Evaluation(values, np.inf, wrong)
        return Evaluation(values, self.goal.score(figures, self.start))

    def _best(self) -> Evaluation:
        best = min(self.seen.values(), key=lambda each: each.score)
        if not np.isfinite(best.score):
            raise SimulationError(f"none of the {len(self.seen)} settings can be had: {best.reason}")
        return best

    def _of_others(self) -> Iterator[tuple[str, dict[str, float]]]:
        """Yield settings that the controller's examples and textbooks name, as far as they set what is tuned."""
        controller = self.case.blocks["controller"]
        for label, values in controller.component.examples.items() if self._of_controller() else ():
            try:
                example = Choice.of(controller.component, values).parameters
            except ValueError:
                continue
            yield label, self._set({axis.name: getattr(example, axis.name) for axis in self._of_controller()})
        names = [getattr(controller.component, role, "") for role in ("gain", "integration_time")]
        if not all(names):
            return
        week = next(iter(self.weather.plan.driven))
        at = self.start[self.start["week"] == week][["conductance_W_K", "drop_K"]].mean()
        try:
            loop = linearised(self.case, self.weather.plan.driven[week], *map(float, at))
        except NotLinear as error:
            self._warn(f"no textbook rules: {error}")
            return
        for rule in textbook_rules(loop):
            given = dict(zip(names, (rule.gain, rule.integration_time_s), strict=True))
            yield rule.name, self._set({name: float(f"{value:.{DIGITS}g}") for name, value in given.items()})

    def _of_controller(self) -> list[Axis]:
        return [axis for axis in self.axes if axis.kind == "controller"]

    def _set(self, of_controller: dict[str, float]) -> dict[str, float]:
        """Return what is tuned with other values of the controller; a rule may set more than is tuned."""
        return {**self.stands, **{f"controller.{name}": float(value) for name, value in of_controller.items()}}

    def _settings(self, named: Sequence[tuple[str, Settings]]) -> Iterator[Setting]:
        named = list(_each_once(named))
        self.evaluator.expect(len(named))
        found = self.evaluator.figures(self.weather, [values for _, values in named])
        for (name, values), figures in zip(named, found, strict=True):
            if isinstance(figures, str):
                self._warn(f"{name}: {figures}")
                continue
            of = self._evaluation(values, figures)
            if of.reason:
                self._warn(f"{name}: {of.reason}")
            yield Setting(name, values, self.goal.score(figures, self.start), figures)

    def _tested(self, settings: Sequence[Setting], weather: Weather) -> Iterator[Setting]:
        self.evaluator.expect(1)
        start = self._as_it_stands(weather)
        try:
            self.goal.refuse(start)
        except NoObjective as error:
            self._warn(f"not tested in {', '.join(weather.plan.driven)}: {error}")
            yield from settings
            return
        self.evaluator.expect(len(settings))
        found = self.evaluator.figures(weather, [each.values for each in settings])
        for setting, figures in zip(settings, found, strict=True):
            if isinstance(figures, str):
                self._warn(f"{setting.name}, tested: {figures}")
                yield setting
            else:
                yield replace(setting, tested=figures, tested_score=self.goal.score(figures, start))

    def _warn(self, text: str) -> None:
        self.warnings.append(text)
        self.evaluator.told.warn(text)


def _each_once(named: Sequence[tuple[str, Settings]]) -> Iterator[tuple[str, Settings]]:
    """Put names of the same settings together; those of the case as it stands stand behind it."""
    (first, stands), tuned, *others = named
    names: dict[tuple[float, ...], list[str]] = {}
    for name, values in others:
        names.setdefault(tuple(values.values()), []).append(name)
    same = names.pop(tuple(stands.values()), [])
    yield (f"{first} ({', '.join(same)})" if same else first), stands
    yield tuned
    by_key = {tuple(values.values()): values for _, values in others}
    yield from ((", ".join(of), by_key[key]) for key, of in names.items())
