"""Diagnose a record, and look at what was found."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from waxstudy.api.provenance import FORMAT, provenance
from waxstudy.dataset import read
from waxstudy.dataset.baseline import checked, named_baseline, parted, read_baseline
from waxstudy.dataset.excerpt import excerpt
from waxstudy.diagnosis import diagnose as core
from waxstudy.diagnosis.result import Diagnosis, FoundEffect
from waxstudy.study.model import Study

Record = str | Path | read.Dataset
Told = Callable[[str, float], None]  # what is being done, the share that is done


class Plots:
    """The figures of a diagnosis' page by their names: `found.plot.traces()` returns a matplotlib figure."""

    def __init__(self, diagnosis: Diagnosis) -> None:
        from waxstudy.report.diagnosis.figures import FIGURES  # brings matplotlib along

        for each in FIGURES:
            setattr(self, each.name, partial(each, diagnosis))

    def __getattr__(self, name: str) -> Callable[[], Any]:
        raise AttributeError(f"no figure '{name}': {', '.join(vars(self))}")


class Found:
    """What a diagnosis found; `diagnosis` holds all of it, as diagnosis.json does."""

    def __init__(self, diagnosis: Diagnosis, provenance: Mapping[str, Any] | None = None) -> None:
        self.diagnosis = diagnosis
        self.provenance = dict(provenance or {})  # software, data, what is believed, seed and command

    def described(self) -> dict[str, Any]:
        """Return what diagnosis.json holds, figures that do not exist as no numbers."""
        return {"format": FORMAT, **self.diagnosis.described(), "provenance": self.provenance}

    @property
    def summary(self) -> str:
        """One sentence."""
        return self.diagnosis.summary

    @property
    def verdict(self) -> str:
        """What kind of answer it is."""
        return str(self.diagnosis.verdict)

    @property
    def effects(self) -> pd.DataFrame:
        """A row for each effect that was found: stage, parameters with their intervals, group, probability."""
        columns = [each.name for each in fields(FoundEffect)]
        return pd.DataFrame(self.diagnosis.described()["effects"], columns=columns)

    @property
    def where(self) -> pd.DataFrame:
        """A row for each judged channel: its gap, and how many noise floors that is."""
        columns = ["stage", "channel", "unit", "gap", "noise_floor", "over_floor"]
        return pd.DataFrame(self.diagnosis.described()["stages"], columns=columns)

    @property
    def how_far(self) -> pd.DataFrame:
        """A row for each judged channel: its gap as believed, and with the effects found."""
        columns = ["stage", "channel", "unit", "gap", "gap_after", "noise_floor"]
        return pd.DataFrame(self.diagnosis.described()["stages"], columns=columns)

    @property
    def posterior(self) -> Mapping[str, float]:
        """Probability of each hypothesis; empty where nothing could be judged."""
        return self.diagnosis.posterior

    @property
    def traces(self) -> pd.DataFrame:
        """Each judged channel as measured, as believed and with the effects found, by time."""
        return self.diagnosis.traces

    @property
    def plot(self) -> Plots:
        """The figures of the page."""
        return Plots(self.diagnosis)

    def page(self) -> str:
        """Return the page as one HTML document."""
        from waxstudy.report.diagnosis.page import as_html  # brings matplotlib along

        return as_html(self.diagnosis)

    def __repr__(self) -> str:
        return f"<waxstudy.Found: {self.summary}>"

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{html.escape(self.page())}" width="100%" height="700" style="border:0"></iframe>'


def diagnose(
    record: Record,
    baseline: Record | tuple[str, str] | None = None,
    *,
    study: Study | None = None,
    seed: int = 1,
    quick: bool = False,
    progress: Told | None = None,
) -> Found:
    """Find where a record and what is believed of its loop disagree, which effect causes it, and how far that shrinks.

    `baseline` is a healthy record of the same loop, or the first and last of such days of the record itself; by
    default what the dataset says. `progress` is told what is being done, and the share done. The same record and
    seed give the same diagnosis. Raises `StudyError`, `PluginError`, `BackendMissing`, `SimulationError`.
    """
    # what is not looked at of a long or fine record is not kept meanwhile
    whole = _parted(record if isinstance(record, read.Dataset) else read.read_dataset(Path(record)), baseline)
    judged, healthy = excerpt(whole[0]), excerpt(whole[1]) if whole[1] else None
    del whole
    found = core.diagnose(judged, baseline=healthy, seed=seed, quick=quick, study=study, tick=progress)
    options = [*_typed(baseline), *(["--study", str(study.file)] if study and study.file else [])]
    options += ["--quick"] * quick + ["--seed", str(seed)] * (seed != 1)
    return Found(found, provenance(judged, healthy, seed, options))


def _typed(baseline: Record | tuple[str, str] | None) -> list[str]:
    """Return the option that names a baseline."""
    if isinstance(baseline, tuple):
        return ["--baseline-days", "..".join(map(str, baseline))]
    folder = baseline.folder if isinstance(baseline, read.Dataset) else baseline
    return ["--baseline", str(folder)] if folder else []


def _parted(
    record: read.Dataset, baseline: Record | tuple[str, str] | None
) -> tuple[read.Dataset, read.Dataset | None]:
    if isinstance(baseline, tuple):
        healthy, judged = parted(record, *(pd.Timestamp(day) for day in baseline))
        return judged, healthy
    if isinstance(baseline, read.Dataset):
        return record, checked(record, baseline)
    return record, read_baseline(record, Path(baseline)) if baseline else named_baseline(record)
