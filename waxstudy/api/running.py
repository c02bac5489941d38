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
import tomli_w

from waxstudy.plugin.registry import installed
from waxstudy.report.content import Content, gather
from waxstudy.report.render import as_csv
from waxstudy.results.run import UNITS, Run
from waxstudy.simulation.run import InputError, Progress
from waxstudy.simulation.run import run as compute
from waxstudy.study.model import Study
from waxstudy.study.problems import StudyError
from waxstudy.study.read import problem_at, read_study

Told = Callable[[int, int], None]  # cases done, cases in all


class Results(Run):
    """A finished run: key figures, differences and traces as frames, with the unit of each column in `attrs["units"]`.

    `Results(folder)` reads one from its folder; raises `RunError`.
    """

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
) -> Results:
    """Run every case of a study and return what came out; what the folder `out` has already is not computed again.

    `study` is a study file, or what one holds as a mapping. Without `out` the results go with the object that is
    returned. `progress` is told how many cases are done, and of how many. Raises `StudyError` for what is wrong with
    the study, `PluginError`, `BackendMissing`, `SimulationError`, and `RunError` for a folder that cannot be used.
    """
    told = progress if isinstance(progress, Progress) else _progress(progress)
    folder = Path(tempfile.mkdtemp(prefix="waxstudy-run-") if out is None else out)
    read = study if isinstance(study, Study) else _read(study)
    try:
        compute(read, folder, jit=jit, progress=told, replaces=replace)
    except InputError as error:
        where = tuple(error.table.split(".", 1))
        raise StudyError([problem_at(read.file or folder, where, str(error), error.key, error.value)]) from error
    results = Results(folder)
    if out is None:
        weakref.finalize(results, shutil.rmtree, folder, ignore_errors=True)
    return results


def _read(study: str | Path | Mapping[str, Any]) -> Study:
    if not isinstance(study, Mapping):
        return read_study(Path(study), installed())
    # what a file says has a line and a folder; what a mapping names is looked for where we are
    with tempfile.NamedTemporaryFile("wb", prefix="study-", suffix=".toml", dir=Path.cwd()) as file:
        file.write(tomli_w.dumps(dict(study)).encode())
        file.flush()
        return read_study(Path(file.name), installed())


def _progress(tell: Told | None) -> Progress:
    if tell is None:
        return Progress()
    counts = [0, 0]

    def total(count: int) -> None:
        counts[1] = count
        tell(0, count)

    def done(case: object, computed: bool) -> None:
        counts[0] += 1
        tell(*counts)

    return Progress(total=total, done=done)
