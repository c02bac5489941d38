"""The run folder, format 2 (format 1 had no corrected heat).

    origin.json         which study file the folder belongs to; written when a run begins
    run.json            what was run, provenance, where the comfort rule was not met (`warnings`), and where each case
                        lies; written last
    study.toml          the resolved study, all defaults filled in
    kpis.csv            one row per case, week and member
    SHA256SUMS          of these three and of each case's own; `sha256sum --check` reads it
    cases/CASE_WEEK_KEY/ kpis.csv, durations.parquet, traces.parquet of one case in one week, and their SHA256SUMS

A trace is stamped at the end of its intervals, as calendar time (`time`) and in seconds from the start of the week
(`time_s`). Folders of earlier versions have no `time`, and `time_s` in single precision.
A folder without run.json is a run that has not finished; its cases are used again when it goes on.
A case that is missing, cut off by a power failure, or changed since it was computed is computed again.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd
import tomli_w

from waxstudy.plugin.files import read_file
from waxstudy.results.atomic import PARTIAL, whole_file, whole_folder
from waxstudy.results.checksums import SUMS, changed, write_sums
from waxstudy.results.comfort import comfort_warnings
from waxstudy.results.folder import CASES, MANIFEST, STUDY, RunError, again
from waxstudy.results.kpis import TRACE_CHANNELS
from waxstudy.results.parquet import TIME, parquet_parts, write_parquet
from waxstudy.study.model import Ladder

FORMAT = 2
OF_CASE = ("kpis.csv", "durations.parquet", "traces.parquet")
UNITS = {"time": TIME, "time_s": "s", "percent": "%", "member": "1", **TRACE_CHANNELS}


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
class CaseWriter:
    """What one case is written to while it runs: traces member after member, each part after part."""

    place: Path
    add_trace: Callable[[pd.DataFrame], None]

    def trace(self, part: pd.DataFrame) -> None:
        # of the channels, seven digits are more than enough; of a stamp they are not
        self.add_trace(part.astype(dict.fromkeys(TRACE_CHANNELS, "float32")))

    def figures(self, kpis: pd.DataFrame, durations: pd.DataFrame) -> None:
        """Write what is told of all members."""
        kpis.to_csv(self.place / "kpis.csv", index=False)
        write_parquet(durations, self.place / "durations.parquet", UNITS)


def is_finished(folder: Path, case: CaseFolder) -> bool:
    """Say whether a case has been computed and is as it was written; its folder appears when all of it is written."""
    return damaged(folder, case) is None


def damaged(folder: Path, case: CaseFolder) -> Path | None:
    """Return the first file of a case that is missing or not as it was written; the case's folder if that is none."""
    place = folder / CASES / case.name
    if place.is_symlink() or not place.is_dir():
        return place
    name = changed(place, _of_case(case))
    return place / Path(name).name if name else None


def _of_case(case: CaseFolder) -> dict[str, str]:
    """Return each file of a case by its name in the checksums, where it has its folder: no case passes as another."""
    return {f"../{case.name}/{name}": name for name in OF_CASE}


@contextmanager
def writing_case(folder: Path, case: CaseFolder) -> Iterator[CaseWriter]:
    """Give what a case is written to; it takes its place when all is written. Raises `OSError` if the disk refuses."""
    with whole_folder(folder / CASES / case.name) as place:
        with parquet_parts(place / "traces.parquet", UNITS) as add:
            yield CaseWriter(place, add)
        write_sums(place / SUMS, {told: place / name for told, name in _of_case(case).items()})


def finish(
    folder: Path,
    study: Mapping[str, Any],
    ladders: Sequence[Ladder],
    weeks: Sequence[str],
    cases: Sequence[CaseFolder],
    provenance: Mapping[str, Any],
) -> list[str]:
    """Put the finished cases together and publish them by writing the manifest last.

    Returns the warnings that the manifest holds: where the comfort rule was not met, or by a very large shift only.
    """
    places = [f"{CASES}/{case.name}" for case in cases]
    kpis = pd.concat([_read_kpis(folder / place / "kpis.csv") for place in places], ignore_index=True)
    warnings = comfort_warnings(kpis, study["comfort"]["hours_below_per_week"])
    manifest = {
        "format": FORMAT,
        "study": study["study"]["name"],
        "members": study["ensemble"]["members"],
        "ladders": [asdict(ladder) for ladder in ladders],
        "weeks": list(weeks),
        "cases": [asdict(case) for case in cases],
        "provenance": dict(provenance),
        "warnings": warnings,
    }
    # all are written before the first takes its place, and the manifest, outermost, takes its place last
    with (
        whole_file(folder / MANIFEST) as manifest_path,
        whole_file(folder / SUMS) as sums_path,
        whole_file(folder / STUDY) as study_path,
        whole_file(folder / "kpis.csv") as kpis_path,
    ):
        manifest_path.write_text(json.dumps(manifest, indent=1) + "\n")
        study_path.write_bytes(tomli_w.dumps(dict(study)).encode())
        kpis.to_csv(kpis_path, index=False)
        of_cases = {f"{place}/{SUMS}": folder / place / SUMS for place in places}
        write_sums(sums_path, {MANIFEST: manifest_path, STUDY: study_path, "kpis.csv": kpis_path, **of_cases})
        (folder / MANIFEST).unlink(missing_ok=True)  # no moment at which it names other figures
    _remove_others(folder, {case.name for case in cases})
    return warnings


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
            # a link is removed, and what it leads to stays
            shutil.rmtree(place) if place.is_dir() and not place.is_symlink() else place.unlink()


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
            raise RunError(f"{folder / MANIFEST}: damaged: {error} is missing; {again(folder)}") from None
        except (TypeError, ValueError):
            raise RunError(f"{folder / MANIFEST}: damaged: not as a run writes it; {again(folder)}") from None
        self._check()

    @cached_property
    def kpis(self) -> pd.DataFrame:
        """One row per ladder case, week and member (columns of `results.kpis.key_figures` and the shift)."""
        frame: pd.DataFrame = self._read(self.folder / "kpis.csv")
        return frame

    def durations(self, case: str, week: str) -> pd.DataFrame:
        """Percentiles 0 to 100 of each channel, for each member."""
        return self._read(self._case(case, week) / "durations.parquet")

    def traces(self, case: str, week: str) -> pd.DataFrame:
        """Traces of the members that the study keeps."""
        return self._read(self._case(case, week) / "traces.parquet")

    @property
    def study_file(self) -> Path:
        return self.folder / STUDY

    def _check(self) -> None:
        """Raise `RunError` naming a file that is not as the run wrote it."""
        wrong = (path for case in self.cases if (path := damaged(self.folder, case)))
        if path := next(wrong, None):
            raise RunError(f"{path}: {what_is_wrong(path)}; {again(self.folder)}")
        of_cases = [f"{CASES}/{case.name}/{SUMS}" for case in self.cases]
        if name := changed(self.folder, [MANIFEST, STUDY, "kpis.csv", *of_cases]):
            raise RunError(f"{self.folder / name}: {what_is_wrong(self.folder / name)}; {again(self.folder)}")

    def _case(self, case: str, week: str) -> Path:
        return next(self.folder / CASES / c.name for c in self.cases if (c.case, c.week) == (case, week))

    def _read(self, path: Path) -> pd.DataFrame:
        try:
            if path.suffix == ".csv":
                return _read_kpis(path)
            return pd.read_parquet(path)
        except (OSError, ValueError) as error:
            raise RunError(f"{path}: cut off or damaged; {again(self.folder)}") from error


def what_is_wrong(path: Path) -> str:
    """Say what keeps a file or folder of a run from being as it was written."""
    if path.is_symlink():
        return f"a link to {os.readlink(path)}, which a run does not follow"
    return "cut off or changed since it was computed" if path.exists() else "missing"


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
        manifest = json.loads(read_file(path))
    except (OSError, ValueError):
        raise RunError(f"{path}: cut off or damaged; {again(folder)}") from None
    if not isinstance(manifest, dict) or manifest.get("format") != FORMAT:
        found = manifest.get("format") if isinstance(manifest, dict) else None
        raise RunError(f"{path}: run folder of format {found}, this version reads {FORMAT}; {again(folder)}")
    return manifest
