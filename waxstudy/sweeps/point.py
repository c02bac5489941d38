"""One point of a sweep: every case in every week, without traces."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, MutableMapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.plugin import Choice, Component, OutsideRoom, SimulationError, Stopped
from waxstudy.plugin.registry import described, installed
from waxstudy.results.run import CaseFolder
from waxstudy.simulation.run import InputError, Plan, loops_of, prepare, simulate_case
from waxstudy.simulation.sources import component_digest, digest, source_digest
from waxstudy.study.model import Study
from waxstudy.study.read import study_of
from waxstudy.study.source import source_of

ONE = threading.Lock()  # rooms are built and blocks compiled by one thread at a time; simulated by all


def key_of(study: Study, digests: MutableMapping[type[Component], str] | None = None, engine: str = "") -> str:
    """Return a digest of everything that a point's figures depend on: what is stated, files that it names, sources.

    `digests` holds those of components that were asked for before, as many points have the same. `engine` is that of an
    outside room, with its version.
    """
    choices, digests = list(_choices(study)), {} if digests is None else digests
    for component in {choice.component for choice in choices} - digests.keys():
        digests[component] = component_digest(component)
    sources = sorted({digests[choice.component] for choice in choices})
    files = sorted(
        {value for choice in choices for value in vars(choice.parameters).values() if isinstance(value, Path)}
    )
    said = {key: value for key, value in study.described().items() if key not in ("study", "output")}
    engines = [engine] if engine else []
    return digest([repr((said, study.step_s)), source_digest(__name__), *sources, *files, *engines])


def engines_of(studies: Sequence[Study], jit: bool) -> Iterator[str]:
    """Yield the engine of each study's room with its version, "" for a linear room; raise what `prepare` raises.

    Every room is asked once on every weather, whatever else differs. Of what it refuses the point tells.
    """
    asked: dict[str, str] = {}
    for study in studies:
        if not issubclass(study.room.component, OutsideRoom):
            yield ""
            continue
        stated = repr((study.room.described(), [each.described() for each in _weathers(study)], study.step_s))
        if stated not in asked:
            try:
                with ONE:
                    asked[stated] = engine_in(prepare(study, jit))
            except InputError:
                asked[stated] = ""
        yield asked[stated]


def engine_in(plan: Plan) -> str:
    """Return the engine of a plan's outside room with its version, "" for a linear room."""
    return "; ".join(sorted({driven.engine for week in plan.driven for driven in plan.weathers(week)} - {""}))


def _choices(study: Study) -> Iterator[Choice]:
    yield study.room
    yield from _weathers(study)
    for case in study.cases.values():
        yield from case.blocks.values()


def _weathers(study: Study) -> Iterator[Choice]:
    for week in study.weeks:
        yield from study.weathers(week)


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
