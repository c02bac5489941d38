"""Making the records of a plan and sealing their truth; what is there already is kept."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import as_completed
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from waxstudy.blind_test.box import close_box, open_box
from waxstudy.blind_test.draw import Case, drawn
from waxstudy.blind_test.key import Key, KeyProblem
from waxstudy.blind_test.plan import Plan, Slot
from waxstudy.blind_test.record import BASELINE, LONG_AGO_S, copy_record, digest_of, set_times, write_record
from waxstudy.plugin.files import read_file, why
from waxstudy.plugin.trial import Staged, Unmakeable, engine_of
from waxstudy.results.atomic import sole_use, whole_file, whole_folder
from waxstudy.simulation.workers import worker_processes

if TYPE_CHECKING:
    from waxstudy.dataset.read import Dataset

FORMAT = 1
ATTEMPTS = 24  # draws until a record has the gap that its stratum asks for
ABOUT, SEALED, RECORDS, BOXES = "blind-test.json", "sealed.json", "records", "boxes"
Tick = Callable[[str, float], None]


class BlindTestError(ValueError):
    """A folder that is no blind test, or another one than was asked for; the message says why."""


@dataclass(frozen=True)
class Place:
    """The folder of a blind test."""

    folder: Path

    @property
    def records(self) -> Path:
        return self.folder / RECORDS

    def record(self, name: str) -> Path:
        return self.records / name

    def box(self, name: str) -> Path:
        return self.folder / BOXES / f"{name}.box"

    @property
    def about(self) -> dict[str, Any]:
        """What is told to everybody: plan, fingerprint of the key; raise `BlindTestError`."""
        path = self.folder / ABOUT
        try:
            found: dict[str, Any] = json.loads(read_file(path))
        except (OSError, ValueError) as error:
            raise BlindTestError(
                f"{self.folder}: this is no blind test: {ABOUT} cannot be read ({why(error)})"
            ) from error
        if found.get("format") != FORMAT:
            raise BlindTestError(f"{path}: format {found.get('format')} is not {FORMAT}, which this version reads")
        return found

    @property
    def plan(self) -> Plan:
        said = self.about["plan"]
        lists = {name: tuple(said[name]) for name in ("strata", "engines")}
        return Plan(cases=said["cases"], share=said["share"], **lists, draw=said.get("draw", 1))

    @property
    def sealed(self) -> dict[str, Any]:
        """The hashes: record -> that of its truth and of its files; raise `BlindTestError`."""
        try:
            found: dict[str, Any] = json.loads(read_file(self.folder / SEALED))
        except (OSError, ValueError) as error:
            raise BlindTestError(
                f"{self.folder}: not all records are made: run `blind-test make` to the end"
            ) from error
        return found

    def names(self) -> list[str]:
        return sorted(self.sealed["records"])

    def check_key(self, key: Key) -> None:
        """Raise `KeyProblem` for another key."""
        if self.about["key_fingerprint"] != key.fingerprint:
            raise KeyProblem("this is not the key of these records")


@contextmanager
def begun(place: Place, plan: Plan, key: Key) -> Iterator[Plan]:
    """Make the folder, or take up one that the same command began, and hold it; give its plan, which draws as it did.

    Raises `BlindTestError`, also where another command is making records there, or `KeyProblem`.
    """
    place.folder.mkdir(parents=True, exist_ok=True)
    with sole_use(place.folder) as is_ours:
        if not is_ours:
            raise BlindTestError(f"{place.folder}: another command is making records in this folder; wait for it")
        yield _plan_begun(place, plan, key)


def _plan_begun(place: Place, plan: Plan, key: Key) -> Plan:
    if (place.folder / ABOUT).exists():
        place.check_key(key)
        earlier = place.plan
        if earlier != replace(plan, draw=earlier.draw):
            raise BlindTestError(f"{place.folder}: another plan was begun here: take another folder")
        return earlier
    if any(place.folder.iterdir()):
        raise BlindTestError(f"{place.folder}: there is something else in this folder")
    about = {"format": FORMAT, "plan": asdict(plan), "key_fingerprint": key.fingerprint}
    _write(place.folder / ABOUT, about)
    return plan


def make(place: Place, plan: Plan, key: Key, workers: int, tick: Tick) -> None:
    """Make every record that is not there yet, then the seals; raise `BlindTestError`, `Unmakeable` or `OSError`."""
    slots = plan.slots(key)
    for folder in (place.records, place.folder / BOXES):
        folder.mkdir(exist_ok=True)
    done = {index for index in range(len(slots)) if is_made(place, key, index)}
    missing = [index for index in range(len(slots)) if index not in done]
    tick(f"{len(done)} of {len(slots)} records", len(done) / max(1, len(slots)))
    names = [key.record_name(index) for index in range(len(slots))]
    if not missing and _is_sealed(place, names):
        return  # somebody may be reading them
    processes = min(workers, max(1, len(missing)))
    with worker_processes(processes) as pool:
        jobs = [pool.submit(make_one, place, key, slots[index], index, plan.is_judged) for index in missing]
        for number, job in enumerate(as_completed(jobs), start=len(done) + 1):
            job.result()
            tick(f"{number} of {len(slots)} records", number / len(slots))
    seal(place, key, names)


def _is_sealed(place: Place, names: Sequence[str]) -> bool:
    try:
        return place.names() == sorted(names)
    except BlindTestError:
        return False


def is_made(place: Place, key: Key, index: int) -> bool:
    """Whether a record and its box are there, whole and unchanged."""
    name = key.record_name(index)
    try:
        truth = open_box(key, name, read_file(place.box(name)))
        return bool(truth["files"] == digest_of(place.record(name)))
    except (OSError, KeyProblem):
        return False


def make_one(place: Place, key: Key, slot: Slot, index: int, is_judged: bool) -> None:
    """Make a record, and then the box with its truth."""
    from waxstudy.blind_test.truth import told

    case, staged, found = settled(place, key, slot, index, is_judged)
    truth = {**told(case, staged, found), "files": digest_of(place.record(case.name))}
    with whole_file(place.box(case.name)) as path:
        path.write_bytes(close_box(key, case.name, truth))


def settled(place: Place, key: Key, slot: Slot, index: int, is_judged: bool) -> tuple[Case, Staged, Sequence[Any]]:
    """Draw until the record can be had and its gaps are as large as its stratum asks for, and write it.

    If no gap is, the last draw that could be had stays, whatever its gap.
    """
    from waxstudy.blind_test.truth import sizes

    small: list[int] = []
    reason = ""
    for attempt in range(ATTEMPTS):
        try:
            case, staged, seen = _tried(place, key, slot, index, attempt, is_judged)
            quick = sizes(case, staged, seen, with_alike=False) if slot.least_over else []
            is_small = not all(each is not None and each.over >= slot.least_over for each in quick)
            if is_small:
                small.append(attempt)
                continue
            _add_baseline(place, slot, case, staged)
            return case, staged, sizes(case, staged, seen)
        except Unmakeable as error:
            reason = str(error)
    for attempt in reversed(small):
        try:
            case, staged, seen = _tried(place, key, slot, index, attempt, is_judged)
            _add_baseline(place, slot, case, staged)
            return case, staged, sizes(case, staged, seen)
        except Unmakeable as error:
            reason = str(error)
    raise Unmakeable(f"{slot.engine}: no record of {slot.cause or slot.kind} can be had: {reason}")


def _add_baseline(place: Place, slot: Slot, case: Case, staged: Staged) -> None:
    """Write a record once more with its baseline, if it has one; raise `Unmakeable` as for the record."""
    if not slot.has_baseline:
        return
    engine = engine_of(case.engine)
    scene = engine.baseline_of(case.scene)
    assert scene
    assert case.baseline
    folder = place.record(case.name)
    write_record(folder, staged, case.measured, (engine.make(scene), case.baseline))
    _read(folder)
    _read(folder / BASELINE)


def _tried(
    place: Place, key: Key, slot: Slot, index: int, attempt: int, is_judged: bool
) -> tuple[Case, Staged, Dataset]:
    """Draw, make and write a record; raise `Unmakeable`, also of one that is refused as a reader would refuse it."""
    case = drawn(key, slot, index, attempt, is_judged)
    staged = engine_of(case.engine).make(case.scene)
    write_record(place.record(case.name), staged, case.measured)
    return case, staged, _read(place.record(case.name))


def _read(folder: Path) -> Dataset:
    """Return a record as a reader sees it; raise `Unmakeable` where that would refuse it."""
    from waxstudy.dataset.read import read_dataset
    from waxstudy.study.problems import StudyError

    try:
        return read_dataset(folder)
    except StudyError as error:
        raise Unmakeable(str(error)) from error


def seal(place: Place, key: Key, names: Sequence[str]) -> None:
    """Write the hash of every truth, which holds that of the record's files, and give all files one time."""
    records: dict[str, Mapping[str, str]] = {}
    for name in sorted(names):
        records[name] = {"truth": key.seal_of(name, open_box(key, name, read_file(place.box(name))))}
        _born_anew(place, name)
    _write(place.folder / SEALED, {"format": FORMAT, "records": records})


def _born_anew(place: Place, name: str) -> None:
    """Copy a record and its box: when a file was born tells how long the next one took to make."""
    with whole_folder(place.record(name)) as folder:
        copy_record(place.record(name), folder)
    set_times(place.record(name))
    with whole_file(place.box(name)) as box:
        shutil.copyfile(place.box(name), box)
    os.utime(place.box(name), (LONG_AGO_S, LONG_AGO_S))


def _write(path: Path, value: Any) -> None:
    with whole_file(path) as temporary:
        temporary.write_text(json.dumps(value, indent=1) + "\n", encoding="utf-8")
