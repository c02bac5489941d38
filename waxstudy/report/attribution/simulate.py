"""The cases between those of a ladder, computed as a run of their own beside the run's cases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import pandas as pd

from waxstudy.report.attribution.subsets import Subsets
from waxstudy.results.folder import RunError, refuse_link
from waxstudy.results.run import Run
from waxstudy.simulation.run import Progress, prepare, run
from waxstudy.study.model import Case, Ladder, Study

FOLDER = "attribution"  # in the run folder, and a run folder itself


class OtherSources(RunError):
    """A run was computed by other versions than those that would compute the cases between its own."""


def simulate(of: Run, study: Study, ladders: Sequence[Subsets], progress: Progress | None = None) -> pd.DataFrame:
    """Return the key figures of every set's case, computing those that are missing.

    They are kept in the run's folder, each as soon as it is finished. Raises `OtherSources`, and what
    `simulation.run.run` raises.
    """
    new: dict[str, Case] = {id: case for subsets in ladders for id, case in subsets.new.items()}
    if not new:
        return of.kpis
    keys = {(job.case, job.week): job.key for job in prepare(study).jobs()}
    if any(keys[case.case, case.week] != case.key for case in of.cases):
        raise OtherSources(
            f"{of.folder}: computed by other versions, or with another weather file; bring it up to date with "
            f"`waxstudy run {of.study_file} --out {of.folder}`"
        )
    refuse_link(of.folder / FOLDER)
    run(between(study, ladders, new), of.folder / FOLDER, progress=progress)
    return pd.concat([of.kpis, Run(of.folder / FOLDER).kpis], ignore_index=True)


def between(study: Study, ladders: Sequence[Subsets], new: Mapping[str, Case]) -> Study:
    """Return the study with the cases between those of its ladders in their place."""
    ids = {subsets.ladder.name: list(subsets.new) for subsets in ladders if subsets.new}
    named = {name: Ladder(name, cases[0], cases) for name, cases in ids.items()}
    return replace(study, against=None, ladders=named, cases=new, file=None)
