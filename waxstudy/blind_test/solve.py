"""Letting a diagnoser loose on the records, each alone in a temporary folder."""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from waxstudy.blind_test import child
from waxstudy.blind_test.box import open_box
from waxstudy.blind_test.key import Key
from waxstudy.blind_test.make import BlindTestError, Place, Tick
from waxstudy.blind_test.record import BASELINE, NAME, copy_record, copy_without_baseline
from waxstudy.plugin.files import read_file
from waxstudy.plugin.trial import baseline_names
from waxstudy.results.atomic import scratch_folder, sole_use, whole_file

OURS = "ours"
LEAVE_ONE_OUT = "ours-leave-one-out"
WITHOUT_BASELINES = "-without-baselines"  # behind the name of whoever gets none
PROGRAM = (sys.executable, "-c", "from waxstudy.cli import main; main()")
HERE = "{}"  # where a command wants the dataset's folder, if not at its end


@dataclass(frozen=True)
class Diagnoser:
    """A command that reads a dataset's folder and prints a diagnosis as JSON; `words` are put in by record."""

    name: str
    command: tuple[str, ...]
    words: Mapping[str, tuple[str, ...]] = field(default_factory=dict)  # record -> what replaces the word RECORD
    sees_baselines: bool = True

    def called(self, record: str, folder: Path) -> list[str]:
        command = [*self.command, *self.words.get(record, ())]
        if HERE not in command:
            command.append(HERE)
        return [str(folder) if word == HERE else word for word in command]


def known() -> list[str]:
    """Return the diagnosers that can be named."""
    return [OURS, *baseline_names()]


def diagnoser(name: str) -> Diagnoser:
    """Return ours or a baseline; raise `BlindTestError`."""
    if name == OURS:
        return Diagnoser(name, (*PROGRAM, "diagnose", "--json", "--quiet"))
    if name not in known():
        raise BlindTestError(f"no diagnoser '{name}' (there are: {', '.join(known())}; or -- and a command)")
    return Diagnoser(name, (*PROGRAM, "blind-test", "baseline", name))


def external(name: str, command: Sequence[str]) -> Diagnoser:
    """Return any command; what is a file here is named so that it is found from elsewhere."""
    if name in (*known(), LEAVE_ONE_OUT) or name.endswith(WITHOUT_BASELINES):
        raise BlindTestError(f"'{name}' is kept for a diagnoser of waxstudy: give yours another name")
    if not re.fullmatch(r"\w[\w.-]*", name):
        raise BlindTestError(f"'{name}' is to be a folder's name: letters, digits, and -, _ or . behind the first")
    return Diagnoser(name, tuple(str(Path(word).absolute()) if Path(word).is_file() else word for word in command))


def without_baselines(place: Place, who: Diagnoser) -> tuple[Diagnoser, list[str]]:
    """Return a diagnoser that gets no baseline, and the records that have one; raise `BlindTestError`."""
    names = [name for name in place.names() if (place.record(name) / BASELINE).is_dir()]
    if not names:
        raise BlindTestError(f"{place.folder}: no record has a baseline")
    return replace(who, name=f"{who.name}{WITHOUT_BASELINES}", sees_baselines=False), names


def leaving_one_out(place: Place, key: Key) -> tuple[Diagnoser, list[str]]:
    """Return ours with the true effect taken out of its library, and the records that this can be asked of.

    Their ordinary answers must be there: what is told here cannot have helped them. Raises `BlindTestError`.
    """
    removed = {}
    for name in place.names():
        truth = open_box(key, name, read_file(place.box(name)))
        if truth["kind"] == "single" and truth["stratum"] in ("goal", "mixture"):
            removed[name] = (truth["causes"][0]["name"],)
    if missing := [name for name in place.names() if not is_answered(answer_path(place, OURS, name))]:
        raise BlindTestError(f"first solve all records with {OURS}: {len(missing)} are not answered yet")
    found = Diagnoser(LEAVE_ONE_OUT, (*PROGRAM, "blind-test", "without"), removed)
    return found, list(removed)


def chosen(names: Sequence[str], share: float) -> list[str]:
    """Return a share of the records, the first by name: names are random."""
    return list(names)[: math.ceil(share * len(names))]


def answer_path(place: Place, diagnoser: str, record: str) -> Path:
    return place.folder / "answers" / diagnoser / f"{record}.json"


def solve(place: Place, who: Diagnoser, names: Sequence[str], workers: int, timeout_s: float, tick: Tick) -> int:
    """Store the answer to every record that has none yet; return how many are failures. Raise `BlindTestError`."""
    with _begun(place, who):
        return _solved(place, who, names, workers, timeout_s, tick)


def _solved(place: Place, who: Diagnoser, names: Sequence[str], workers: int, timeout_s: float, tick: Tick) -> int:
    child.begin()
    paths = {name: answer_path(place, who.name, name) for name in names}
    missing = [name for name in names if not is_answered(paths[name])]
    done = len(names) - len(missing)
    tick(f"{done} of {len(names)} records", done / max(1, len(names)))
    with ThreadPoolExecutor(workers) as pool:
        jobs = [pool.submit(_solve_one, place, who, name, timeout_s) for name in missing]
        try:
            for number, job in enumerate(as_completed(jobs), start=done + 1):
                job.result()
                tick(f"{number} of {len(names)} records", number / len(names))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            child.end_all()
            raise
    return sum(stored(path)["answer"] is None for path in paths.values())


@contextmanager
def _begun(place: Place, who: Diagnoser) -> Iterator[None]:
    """Note the command of a diagnoser's name and hold its folder.

    Raises `BlindTestError` if answers of another are there, or its answers are being written.
    """
    folder = place.folder / "answers" / who.name
    folder.mkdir(parents=True, exist_ok=True)
    with sole_use(folder) as is_ours:
        if not is_ours:
            raise BlindTestError(f"{folder}: another command is answering here; wait for it")
        _note_command(folder, who)
        yield


def _note_command(folder: Path, who: Diagnoser) -> None:
    path = folder / "command.json"
    said = list(who.command[len(PROGRAM) :] if who.command[:3] == PROGRAM else who.command)
    if path.exists() and json.loads(read_file(path)) != said:
        raise BlindTestError(f"{folder}: here are answers of another command; give a name with --name")
    with whole_file(path) as temporary:
        temporary.write_text(json.dumps(said) + "\n", encoding="utf-8")


def stored(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(read_file(path))
    return found


def is_answered(path: Path) -> bool:
    try:
        return "answer" in stored(path)
    except (OSError, ValueError):
        return False


def _solve_one(place: Place, who: Diagnoser, record: str, timeout_s: float) -> None:
    with scratch_folder("waxstudy-solve-") as temporary:
        folder = temporary / NAME
        folder.mkdir()
        copy = copy_record if who.sees_baselines else copy_without_baseline
        copy(place.record(record), folder)
        told = child.answered(who.called(record, folder), temporary, timeout_s)
    if told is None:
        return
    with whole_file(answer_path(place, who.name, record)) as path:
        path.write_text(json.dumps({"record": record, **told}, indent=1) + "\n", encoding="utf-8")
