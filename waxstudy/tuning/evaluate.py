"""Evaluations: a case with settings, on the ensemble, at equal comfort; each finished one is kept at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.loop.figures import UNITS, heat_of, loop_figures
from waxstudy.plugin import SimulationError, Stopped
from waxstudy.plugin.registry import described
from waxstudy.simulation.run import Plan, Progress, loops_of, prepare
from waxstudy.simulation.sources import digest
from waxstudy.study.model import Study
from waxstudy.sweeps.point import ONE, engine_in, key_of
from waxstudy.sweeps.run import Where, compute_points, is_whole
from waxstudy.tuning.space import with_settings

EVALUATIONS = "evaluations"
Settings = Mapping[str, float]


@dataclass
class Weather:
    """A study's case on some weather, made ready once: settings change neither room nor weather."""

    plan: Plan
    heat_kWh_m2_week: dict[str, float] = field(default_factory=dict)  # of the case as it stands, by week

    @classmethod
    def of(cls, study: Study, jit: bool) -> Weather:
        """Prepare a study; raise what `prepare` raises."""
        return cls(prepare(study, jit))

    def stand_at(self, figures: pd.DataFrame) -> None:
        """Take the heat of the case as it stands for what later evaluations are given."""
        self.heat_kWh_m2_week = {str(week): heat_of(part) for week, part in figures.groupby("week")}


@dataclass
class Evaluator:
    """Computes settings of a case, or takes what its folder holds of them."""

    case: str
    folder: Path
    workers: int
    told: Progress
    expected: int = 0

    def expect(self, count: int) -> None:
        """Tell that so many more settings are to be evaluated."""
        self.expected += count
        self.told.total(self.expected)

    def figures(self, weather: Weather, settings: Sequence[Settings]) -> list[pd.DataFrame | str]:
        """Return a row for each week and member of every settings, or why there is none."""
        study = weather.plan.study
        found: list[pd.DataFrame | str] = [""] * len(settings)
        todo: dict[int, Study] = {}
        files: list[Path] = []
        for number, each in enumerate(settings):
            try:
                changed = with_settings(study, study.cases[self.case], each)
            except ValueError as error:  # parameters may bound each other
                found[number] = str(error)
                files.append(Path())
                self.told.done(None, False)
                continue
            files.append(self._file(changed, weather))
            if is_whole(files[-1]) or files[-1] in files[:-1]:
                self.told.done(None, False)
            else:
                todo[number] = changed
        work = partial(_computed, weather)
        failed = compute_points(todo, files, Where("threads", self.workers), self.told, work, UNITS)
        reasons = {files[number]: reason for number, reason in failed.items()}
        for number, file in enumerate(files):
            if not found[number]:
                found[number] = reasons[file] if file in reasons else pd.read_parquet(file)
        return found

    def _file(self, study: Study, weather: Weather) -> Path:
        """Return where an evaluation is kept: under a digest of all that it depends on."""
        code = Path(loop_figures.__code__.co_filename)
        key = key_of(study, engine=engine_in(weather.plan))
        parts = (key, repr(sorted(weather.heat_kWh_m2_week.items())), code)
        return self.folder / EVALUATIONS / f"{digest(parts)}.parquet"


def _computed(weather: Weather, study: Study, stop: np.ndarray) -> pd.DataFrame:
    plan = replace(weather.plan, study=study, stop=stop)
    return pd.concat(list(_weeks(plan, weather.heat_kWh_m2_week.get)), ignore_index=True)


def _weeks(plan: Plan, heat_of_week: Callable[[str], float | None]) -> Iterator[pd.DataFrame]:
    for job in plan.jobs():
        try:
            with ONE:
                loops = loops_of(plan, job)
            yield loop_figures(plan, job, loops, heat_of_week(job.week))
        except Stopped:
            raise
        except Exception as error:
            reason = str(error) if isinstance(error, SimulationError) else described(error)
            raise SimulationError(f"case {job.case}, {job.week}: {reason}") from error
