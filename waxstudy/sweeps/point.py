"""One point of a sweep: every case in every week, without traces."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, MutableMapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.plugin import Choice, Component, SimulationError, Stopped
from waxstudy.plugin.registry import described, installed
from waxstudy.results.run import CaseFolder
from waxstudy.simulation.run import InputError, Plan, loops_of, prepare, simulate_case
from waxstudy.simulation.sources import component_digest, digest, source_digest
from waxstudy.study.model import Study
from waxstudy.study.read import study_of
from waxstudy.study.source import source_of

ONE = threading.Lock()  # rooms are built and blocks compiled by one thread at a time; simulated by all


def key_of(study: Study, digests: MutableMapping[type[Component], str] | None = None) -> str:
    """Return a digest of everything that a point's figures depend on: what is stated, files that it names, sources.

    `digests` holds those of components that were asked for before, as many points have the same.
    """
    choices, digests = list(_choices(study)), {} if digests is None else digests
    for component in {choice.component for choice in choices} - digests.keys():
        digests[component] = component_digest(component)
    sources = sorted({digests[choice.component] for choice in choices})
    files = sorted(
        {value for choice in choices for value in vars(choice.parameters).values() if isinstance(value, Path)}
    )
    said = {key: value for key, value in study.described().items() if key not in ("study", "output")}
    return digest([repr((said, study.step_s)), source_digest(__name__), *sources, *files])


def _choices(study: Study) -> Iterator[Choice]:
    yield study.room
    for week in study.weeks:
        yield from study.weathers(week)
    for case in study.cases.values():
        yield from case.blocks.values()


def computed(stated: Mapping[str, Any], stop: np.ndarray, jit: bool) -> pd.DataFrame:
    """Return the key figures of a resolved study, a row for each case, week and member.

    Raises `SimulationError` with the case and week that failed, or what the room or the weather refused; `Stopped` at
    the next weather interval once `stop` (1,) is 1.
    """
    with ONE:
        study = study_of(source_of(stated), installed())
        try:
            plan = replace(prepare(study, jit), stop=stop)
        except InputError as error:
            raise SimulationError(f"[{error.table}]: {error}") from error
    return pd.concat([_figures(plan, job) for job in plan.jobs()], ignore_index=True)


def _figures(plan: Plan, job: CaseFolder) -> pd.DataFrame:
    try:
        with ONE:
            loops = loops_of(plan, job)
        return simulate_case(plan, job, loops, lambda trace: None)[0]
    except Stopped:
        raise
    except Exception as error:
        reason = str(error) if isinstance(error, SimulationError) else described(error)
        raise SimulationError(f"case {job.case}, {job.week}: {reason}") from error
