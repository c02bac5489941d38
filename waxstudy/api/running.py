"""Run a study, and look at what came out."""

from __future__ import annotations

import io
import shutil
import tempfile
import weakref
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from waxstudy.fleet.result import Activated
from waxstudy.plugin.registry import installed
from waxstudy.report.content import Content, gather
from waxstudy.report.render import as_csv
from waxstudy.results.run import UNITS, Run
from waxstudy.simulation.run import InputError, Progress
from waxstudy.simulation.run import run as compute
from waxstudy.study.model import Study
from waxstudy.study.problems import Problem, StudyError
from waxstudy.study.read import problem_at, read_study, study_of
from waxstudy.study.source import source_of

Told = Callable[[int, int], None]  # cases done, cases in all


class Results(Run):
    """A finished run: key figures, differences and traces as frames, with the unit of each column in `attrs["units"]`.

    `Results(folder)` reads one from its folder; raises `RunError`.
    """

    def __init__(self, folder: str | Path) -> None:
        super().__init__(Path(folder))

    @cached_property
    def content(self) -> Content:
        """What a report says of the run."""
        return gather(self, read_study(self.study_file, installed(), needs_files=False))

    @cached_property
    def differences(self) -> pd.DataFrame:
        """A row for each case and week: the columns of Table 5 with their spreads, and how sure they are."""
        frame = pd.read_csv(io.StringIO(as_csv(self.content)), dtype={"case": str, "week": str}, keep_default_na=False)
        for name in frame.columns.difference(["case", "week", "resolved", "corrected_resolved"]):
            frame[name] = pd.to_numeric(frame[name])
        return _with_units(frame.set_index(["week", "case"]))

    def traces(self, case: str, week: str) -> pd.DataFrame:
        """Channels of the members that keep a trace, by member and local standard time; raises `KeyError`."""
        self._known(case, week)
        return _with_units(super().traces(case, week).set_index(["member", "time"]))

    def durations(self, case: str, week: str) -> pd.DataFrame:
        """Percentiles 0 to 100 of each channel, for each member; raises `KeyError`."""
        self._known(case, week)
        return _with_units(super().durations(case, week))

    def _known(self, case: str, week: str) -> None:
        if not any((each.case, each.week) == (case, week) for each in self.cases):
            cases = ", ".join(dict.fromkeys(each.case for each in self.cases))
            raise KeyError(f"no case '{case}' in week '{week}': cases {cases}; weeks {', '.join(self.weeks)}")

    def _repr_html_(self) -> str:
        return str(self.differences.to_html())


def _with_units(frame: pd.DataFrame) -> pd.DataFrame:
    frame.attrs["units"] = {str(name): unit for name in frame if (unit := _unit(str(name)))}
    return frame


def _unit(column: str) -> str:
    """Return the unit of a column: as its channel has it, or as its name says."""
    plain = column.removesuffix("_sd")
    ends = {"_K": "K", "_C": "C", "_percent": "%", "_kWh_m2_week": "kWh/m2 a week", "_L_h": "L/h", "_W_m2": "W/m2"}
    return UNITS.get(plain, next((unit for end, unit in ends.items() if plain.endswith(end)), ""))


def run(
    study: str | Path | Mapping[str, Any] | Study,
    out: str | Path | None = None,
    *,
    jit: bool = True,
    replace: bool = False,
    progress: Told | Progress | None = None,
) -> Results | Activated:
    """Run every case of a study and return what came out; what the folder `out` has already is not computed again.

    `study` is a study file, or what one holds as a mapping. Of one with `[activation]` the fleet is called, and an
    `Activated` returned. Without `out` the results go with the object that is returned. `progress` is told how many
    cases (or batches of loops) are done, and of how many. Raises `StudyError` for what is wrong with the study,
    `PluginError`, `BackendMissing`, `SimulationError`, `RunError` for a folder that cannot be used, and `ValueError`
    for `replace` with `[activation]`: it is of runs of cases.
    """
    read = study if isinstance(study, Study) else _read(study)
    if read.activation and replace:
        raise ValueError("replace is of a run of cases; this study has [activation]")
    folder = Path(tempfile.mkdtemp(prefix="waxstudy-run-") if out is None else out)
    results: Results | Activated
    try:
        if read.activation:
            from waxstudy.api.activating import activate  # it draws, which no run of cases does

            results = activate(read, folder, jit=jit, progress=_progress(progress))
        else:
            compute(read, folder, jit=jit, progress=_progress(progress), replaces=replace)
            results = Results(folder)
    except BaseException as error:
        if out is None:
            shutil.rmtree(folder, ignore_errors=True)
        if isinstance(error, InputError):
            raise StudyError([_problem(read, error)]) from error
        raise
    if out is None:
        weakref.finalize(results, shutil.rmtree, folder, ignore_errors=True)
    return results


def _read(study: str | Path | Mapping[str, Any]) -> Study:
    if isinstance(study, Mapping):
        return study_of(source_of(study), installed())
    return read_study(Path(study), installed())


def _problem(study: Study, error: InputError) -> Problem:
    """Return what only showed in use, at its place in the study."""
    table = error.path
    return problem_at(study.file or Path("study"), table, str(error), error.key, error.value)


def _progress(tell: Told | Progress | None) -> Progress:
    if tell is None or isinstance(tell, Progress):
        return tell or Progress()
    counts = [0, 0]

    def total(count: int) -> None:
        counts[1] = count
        tell(0, count)

    def done(case: object, computed: bool) -> None:
        counts[0] += 1
        tell(*counts)

    return Progress(total=total, done=done)
