"""The run folder, format 1.

    run.json            what was run, provenance, and where each case lies; written last
    study.toml          the resolved study, all defaults filled in
    kpis.csv            one row per case, week and member
    cases/CASE_WEEK_KEY/ kpis.csv, durations.parquet, traces.parquet of one case in one week

A folder without run.json is a run that has not finished; its cases are used again when it goes on.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd
import tomli_w

from waxstudy.results.atomic import PARTIAL, whole_file, whole_folder

FORMAT = 1
MANIFEST = "run.json"


class RunError(Exception):
    """A run folder cannot be read; the message says which file and why."""


@dataclass(frozen=True)
class CaseFolder:
    """One case in one week; `key` is the digest of everything that its figures depend on."""

    case: str
    week: str
    key: str

    @property
    def name(self) -> str:
        return f"{self.case}_{self.week}_{self.key}"


@dataclass(frozen=True)
class CaseResult:
    """What the simulation gives for one case in one week, members below each other."""

    kpis: pd.DataFrame
    durations: pd.DataFrame
    traces: pd.DataFrame


@dataclass(frozen=True)
class Ladder:
    name: str
    reference: str
    cases: Sequence[str]


def is_finished(folder: Path, case: CaseFolder) -> bool:
    """Say whether a case has been computed; its folder appears only when all its files are written."""
    return (folder / "cases" / case.name).is_dir()


def write_case(folder: Path, case: CaseFolder, result: CaseResult) -> None:
    """Write one case; raise `OSError` if the disk refuses."""
    with whole_folder(folder / "cases" / case.name) as place:
        result.kpis.to_csv(place / "kpis.csv", index=False)
        result.durations.to_parquet(place / "durations.parquet", index=False)
        result.traces.astype("float32").to_parquet(place / "traces.parquet", index=False, compression="zstd")


def finish(
    folder: Path,
    study: Mapping[str, Any],
    ladders: Sequence[Ladder],
    weeks: Sequence[str],
    cases: Sequence[CaseFolder],
    provenance: Mapping[str, Any],
) -> None:
    """Put the finished cases together and publish them by writing the manifest last."""
    frames = [pd.read_csv(folder / "cases" / case.name / "kpis.csv") for case in cases]
    with whole_file(folder / "study.toml") as path:
        path.write_bytes(tomli_w.dumps(dict(study)).encode())
    with whole_file(folder / "kpis.csv") as path:
        pd.concat(frames, ignore_index=True).to_csv(path, index=False)
    manifest = {
        "format": FORMAT,
        "study": study["study"]["name"],
        "ladders": [asdict(ladder) for ladder in ladders],
        "weeks": list(weeks),
        "cases": [asdict(case) for case in cases],
        "provenance": dict(provenance),
    }
    with whole_file(folder / MANIFEST) as path:
        path.write_text(json.dumps(manifest, indent=1) + "\n")
    _remove_others(folder / "cases", {case.name for case in cases})


def _remove_others(cases: Path, keep: set[str]) -> None:
    """Remove cases of earlier studies and what killed runs left unfinished."""
    for place in [*cases.iterdir(), *cases.parent.glob(f"{PARTIAL}*")]:
        if place.name not in keep:
            shutil.rmtree(place) if place.is_dir() else place.unlink()


class Run:
    """A finished run, read from its folder; raises `RunError` where that is cut off or of another version."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        manifest = _manifest(folder)
        try:
            self.study: str = manifest["study"]
            self.weeks: list[str] = manifest["weeks"]
            self.ladders = [Ladder(**ladder) for ladder in manifest["ladders"]]
            self.cases = [CaseFolder(**case) for case in manifest["cases"]]
            self.provenance: dict[str, Any] = manifest["provenance"]
        except (KeyError, TypeError) as error:
            raise RunError(f"{folder / MANIFEST}: damaged: {error} is missing or wrong; run the study again") from None
        missing = [case.name for case in self.cases if not is_finished(folder, case)]
        if missing:
            raise RunError(
                f"{folder}: {len(missing)} case folders are missing ({missing[0]}, ...); run the study again"
            )

    @cached_property
    def kpis(self) -> pd.DataFrame:
        """One row per ladder case, week and member (columns of `results.kpis.key_figures` and the shift)."""
        frame: pd.DataFrame = self._read(self.folder / "kpis.csv")
        expected = sum(1 for _ in self.cases)
        if frame.groupby(["case", "week"]).ngroups != expected:
            raise RunError(f"{self.folder / 'kpis.csv'}: cut off; run the study again")
        return frame

    def durations(self, case: str, week: str) -> pd.DataFrame:
        """Percentiles 0 to 100 of each channel, for each member."""
        return self._read(self._case(case, week) / "durations.parquet")

    def traces(self, case: str, week: str) -> pd.DataFrame:
        """Traces of the members that the study keeps."""
        return self._read(self._case(case, week) / "traces.parquet")

    @property
    def study_file(self) -> Path:
        return self.folder / "study.toml"

    def _case(self, case: str, week: str) -> Path:
        return next(self.folder / "cases" / c.name for c in self.cases if (c.case, c.week) == (case, week))

    def _read(self, path: Path) -> pd.DataFrame:
        try:
            if path.suffix == ".csv":
                return pd.read_csv(path)
            return pd.read_parquet(path)
        except (OSError, ValueError) as error:
            raise RunError(f"{path}: cannot be read ({type(error).__name__}); run the study again") from error


def _manifest(folder: Path) -> dict[str, Any]:
    path = folder / MANIFEST
    if not folder.is_dir():
        raise RunError(f"{folder}: no such run folder")
    if not path.is_file():
        n = len(list(folder.glob("cases/[!.]*")))
        raise RunError(f"{folder}: not a finished run ({n} cases computed); `waxstudy run` the study to finish it")
    try:
        manifest = json.loads(path.read_text())
    except ValueError:
        raise RunError(f"{path}: cut off or damaged; run the study again") from None
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        found = manifest.get("format") if isinstance(manifest, dict) else None
        raise RunError(f"{path}: run folder format {found!r}, this version reads {FORMAT}; run the study again")
    return manifest
