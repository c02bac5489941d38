"""The run folder, format 1.

    run.json            what was run, provenance, and where each case lies; written last
    study.toml          the resolved study, all defaults filled in
    kpis.csv            one row per case, week and member
    cases/CASE_WEEK_KEY/ kpis.csv, durations.parquet, traces.parquet of one case in one week

A trace is stamped at the end of its intervals, as calendar time (`time`) and in seconds from the start of the week
(`time_s`). Folders of earlier versions have no `time`, and `time_s` in single precision.
A folder without run.json is a run that has not finished; its cases are used again when it goes on.
A case that is missing, or cut off by a power failure, is computed again.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd
import tomli_w

from waxstudy.results.atomic import PARTIAL, sole_use, whole_file, whole_folder
from waxstudy.results.kpis import TRACE_CHANNELS
from waxstudy.results.parquet import TIME, write_parquet
from waxstudy.study.model import Ladder

FORMAT = 1
MANIFEST = "run.json"
CASES = "cases"
PARQUET_END = b"PAR1"
AGAIN = "`waxstudy run` the study again"
UNITS = {"time": TIME, "time_s": "s", "percent": "%", "member": "1", **TRACE_CHANNELS}


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


@contextmanager
def run_folder(folder: Path) -> Iterator[None]:
    """Make a folder for a run, and hold it.

    Raises `RunError` where it holds something else or another run is at work, `OSError` if it cannot be made.
    """
    if folder.is_dir() and any(folder.iterdir()) and not holds_run(folder):
        raise RunError(f"{folder}: this folder is in use and holds no run; choose another with --out")
    (folder / CASES).mkdir(parents=True, exist_ok=True)
    with sole_use(folder) as is_ours:
        if not is_ours:
            raise RunError(
                f"{folder}: another run is at work in this folder; wait for it, or choose another with --out"
            )
        yield


def holds_run(folder: Path) -> bool:
    """Say whether a folder holds what a run leaves, finished or not; False for what cannot be a path."""
    return any(os.path.exists(folder / name) for name in (MANIFEST, CASES))


def is_finished(folder: Path, case: CaseFolder, members: int) -> bool:
    """Say whether a case has been computed; its folder appears only when all its files are written."""
    return _cut_off(folder / CASES / case.name, members) is None


def _cut_off(place: Path, members: int) -> Path | None:
    """Return the first file of a case that is missing or not whole: what a power failure or a full copy leaves."""
    for name, is_whole in FILES.items():
        try:
            if is_whole(place / name, members):
                continue
        except (OSError, ValueError):
            pass
        return place / name
    return None


def _is_whole_csv(path: Path, rows: int) -> bool:
    text = path.read_text(encoding="utf-8")
    return text.endswith("\n") and text.count("\n") == 1 + rows


def _is_whole_parquet(path: Path, members: int) -> bool:
    """Parquet files begin and end with their magic number."""
    with path.open("rb") as file:
        size = file.seek(-len(PARQUET_END), os.SEEK_END)
        return size > 0 and file.read() == PARQUET_END


FILES = {"kpis.csv": _is_whole_csv, "durations.parquet": _is_whole_parquet, "traces.parquet": _is_whole_parquet}


def write_case(folder: Path, case: CaseFolder, result: CaseResult) -> None:
    """Write one case; raise `OSError` if the disk refuses."""
    with whole_folder(folder / CASES / case.name) as place:
        result.kpis.to_csv(place / "kpis.csv", index=False)
        write_parquet(result.durations, place / "durations.parquet", UNITS)
        # of the channels, seven digits are more than enough; of a stamp they are not
        traces = result.traces.astype(dict.fromkeys(TRACE_CHANNELS, "float32"))
        write_parquet(traces, place / "traces.parquet", UNITS)


def finish(
    folder: Path,
    study: Mapping[str, Any],
    ladders: Sequence[Ladder],
    weeks: Sequence[str],
    cases: Sequence[CaseFolder],
    provenance: Mapping[str, Any],
) -> None:
    """Put the finished cases together and publish them by writing the manifest last."""
    frames = [_read_kpis(folder / CASES / case.name / "kpis.csv") for case in cases]
    manifest = {
        "format": FORMAT,
        "study": study["study"]["name"],
        "members": study["ensemble"]["members"],
        "ladders": [asdict(ladder) for ladder in ladders],
        "weeks": list(weeks),
        "cases": [asdict(case) for case in cases],
        "provenance": dict(provenance),
    }
    # all are written before the first takes its place, and the manifest, outermost, takes its place last
    with (
        whole_file(folder / MANIFEST) as manifest_path,
        whole_file(folder / "study.toml") as study_path,
        whole_file(folder / "kpis.csv") as kpis_path,
    ):
        manifest_path.write_text(json.dumps(manifest, indent=1) + "\n")
        study_path.write_bytes(tomli_w.dumps(dict(study)).encode())
        pd.concat(frames, ignore_index=True).to_csv(kpis_path, index=False)
        (folder / MANIFEST).unlink(missing_ok=True)  # no moment at which it names other figures
    _remove_others(folder, {case.name for case in cases})


def _read_kpis(path: Path) -> pd.DataFrame:
    """A case or week may be called 01, NA or True."""
    frame: pd.DataFrame = pd.read_csv(path, dtype={"case": str, "week": str}, keep_default_na=False, na_values=[""])
    return frame


def _remove_others(folder: Path, keep: set[str]) -> None:
    """Remove cases of earlier studies and what killed runs left unfinished; nothing that a run did not make."""
    cases = [place for place in (folder / CASES).iterdir() if re.fullmatch(r".+_[0-9a-f]{16}", place.name)]
    partial = [*folder.glob(f"{PARTIAL}*"), *folder.glob(f"{CASES}/{PARTIAL}*")]
    for place in [*cases, *partial]:
        if place.name not in keep:
            shutil.rmtree(place) if place.is_dir() else place.unlink()


class Run:
    """A finished run, read from its folder; raises `RunError` where that is cut off or of another version."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        manifest = _manifest(folder)
        try:
            self.study = str(manifest["study"])
            self.members = int(manifest["members"])
            self.weeks = [str(week) for week in manifest["weeks"]]
            self.ladders = [Ladder(**ladder) for ladder in manifest["ladders"]]
            self.cases = [CaseFolder(**case) for case in manifest["cases"]]
            self.provenance: dict[str, Any] = manifest["provenance"]
        except KeyError as error:
            raise RunError(f"{folder / MANIFEST}: damaged: {error} is missing; {AGAIN}") from None
        except (TypeError, ValueError):
            raise RunError(f"{folder / MANIFEST}: damaged: not as a run writes it; {AGAIN}") from None
        for case in self.cases:
            if path := _cut_off(folder / CASES / case.name, self.members):
                raise RunError(f"{path}: missing or cut off; {AGAIN}")

    @cached_property
    def kpis(self) -> pd.DataFrame:
        """One row per ladder case, week and member (columns of `results.kpis.key_figures` and the shift)."""
        path = self.folder / "kpis.csv"
        frame: pd.DataFrame = self._read(path)
        expected = [(case.case, case.week) for case in self.cases for _ in range(self.members)]
        found = [frame[name] for name in ("case", "week") if name in frame]
        if list(zip(*found, strict=True)) != expected or not _is_whole_csv(path, len(expected)):
            raise RunError(f"{path}: cut off or changed; {AGAIN}")
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
        return next(self.folder / CASES / c.name for c in self.cases if (c.case, c.week) == (case, week))

    def _read(self, path: Path) -> pd.DataFrame:
        try:
            if path.suffix == ".csv":
                return _read_kpis(path)
            return pd.read_parquet(path)
        except (OSError, ValueError) as error:
            raise RunError(f"{path}: cut off or damaged; {AGAIN}") from error


def _manifest(folder: Path) -> dict[str, Any]:
    path = folder / MANIFEST
    if not folder.is_dir():
        raise RunError(f"{folder}: no such run folder")
    if not path.is_file():
        if not (folder / CASES).is_dir():
            below = sorted(path.parent.name for path in folder.glob(f"*/{MANIFEST}"))
            runs = f"; runs in it: {', '.join(below)}" if below else ""
            raise RunError(f"{folder}: holds no run (no {MANIFEST}){runs}")
        n = sum(1 for _ in folder.glob(f"{CASES}/[!.]*"))
        raise RunError(
            f"{folder}: this run has not finished ({n} cases computed so far); "
            f"`waxstudy run STUDY.toml --out {folder}` goes on from there"
        )
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise RunError(f"{path}: cut off or damaged; {AGAIN}") from None
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        found = manifest.get("format") if isinstance(manifest, dict) else None
        raise RunError(f"{path}: run folder of format {found}, this version reads {FORMAT}; {AGAIN}")
    return manifest
