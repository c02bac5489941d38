"""Run folders that somebody changed: what was changed is refused, or computed again, and never shown as a result."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from random import Random

from tests.attack.campaign import Ground
from tests.attack.files import LIMIT_S, STUDY
from tests.attack.verdict import DONE, wrong_with
from waxstudy.plugin.files import read_file

Tamper = Callable[[Path, Random], object]


def _case(run: Path, random: Random) -> Path:
    return random.choice(sorted((run / "cases").iterdir()))


def _edited(path: Path, random: Random) -> None:
    """Change one digit of a text."""
    text = path.read_text()
    place = random.choice([i for i, c in enumerate(text) if c.isdigit()])
    path.write_text(f"{text[:place]}{(int(text[place]) + random.randint(1, 9)) % 10}{text[place + 1 :]}")


def _flipped(path: Path, random: Random) -> None:
    data = bytearray(path.read_bytes())
    data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    path.write_bytes(data)


def _cut(path: Path, random: Random) -> None:
    path.write_bytes(path.read_bytes()[: random.randrange(path.stat().st_size)])


def _any(folder: Path, random: Random) -> Path:
    return random.choice(sorted(path for path in folder.iterdir() if path.is_file()))


def _replaced(run: Path, random: Random, put: Callable[[Path], object]) -> None:
    """Put something else in the place of any file of the run."""
    path = random.choice(sorted(path for path in run.rglob("*") if path.is_file()))
    path.unlink()
    put(path)


def _swapped(run: Path, random: Random) -> None:
    """Give two cases each other's results."""
    one, other = random.sample(sorted((run / "cases").iterdir()), 2)
    for name in ("kpis.csv", "traces.parquet", "durations.parquet", "SHA256SUMS"):
        first, second = (one / name).read_bytes(), (other / name).read_bytes()
        (one / name).write_bytes(second)
        (other / name).write_bytes(first)


def _linked(run: Path, random: Random) -> None:
    """Put a link to an edited copy in the place of a file."""
    path = _case(run, random) / "kpis.csv"
    copy = run.parent / "elsewhere.csv"
    shutil.copy(path, copy)
    _edited(copy, random)
    path.unlink()
    path.symlink_to(copy)


FORMS: dict[str, Tamper] = {
    "a figure of a case": lambda run, random: _edited(_case(run, random) / "kpis.csv", random),
    "a figure of the run": lambda run, random: _edited(run / "kpis.csv", random),
    "what the run says of itself": lambda run, random: _edited(run / "run.json", random),
    "the study that is kept": lambda run, random: _edited(run / "study.toml", random),
    "a bit of a file": lambda run, random: _flipped(_any(_case(run, random), random), random),
    "a file cut off": lambda run, random: _cut(_any(_case(run, random), random), random),
    "a file removed": lambda run, random: _any(_case(run, random), random).unlink(),
    "a case removed": lambda run, random: shutil.rmtree(_case(run, random)),
    "two cases swapped": _swapped,
    "a link for a file": _linked,
    "a pipe for a file": lambda run, random: _replaced(run, random, os.mkfifo),
    "a device for a file": lambda run, random: _replaced(run, random, lambda path: path.symlink_to("/dev/zero")),
}


def made(ground: Ground) -> Path:
    """Return the folder of a study with its finished run and page."""

    def make(folder: Path) -> None:
        (folder / "s.toml").write_text(STUDY)
        run = ground.worker.call(folder, "run", "s.toml", "--quiet", "--out", "run", limit_s=LIMIT_S)
        page = ground.worker.call(folder, "report", "run", "--out", "page.csv", limit_s=LIMIT_S)
        assert (run.code, page.code) == (DONE, DONE), run.stderr + page.stderr

    return ground.once("run", make)


def tamper(ground: Ground, folder: Path, number: int, random: Random) -> str:
    name = list(FORMS)[number % len(FORMS)]
    whole = made(ground)
    shutil.copytree(whole, folder, dirs_exist_ok=True)
    (folder / "page.csv").unlink()
    FORMS[name](folder / "run", random)
    told = ground.worker.call(folder, "report", "run", "--out", "page.csv", limit_s=LIMIT_S)
    if wrong := wrong_with(told, ["run", "s.toml"]):
        return f"{name}: {wrong}"
    page = folder / "page.csv"
    if page.exists() and page.read_bytes() != (whole / "page.csv").read_bytes():
        return f"{name}: what was changed is shown without a word"
    again = ground.worker.call(folder, "run", "s.toml", "--quiet", "--out", "run", limit_s=LIMIT_S)
    if wrong := wrong_with(again, ["run", "s.toml"]):
        return f"{name}, run once more: {wrong}"
    if again.code == DONE and read_file(folder / "run/kpis.csv") != (whole / "run/kpis.csv").read_bytes():
        return f"{name}, run once more: other figures"
    return ""


def clock(ground: Ground, folder: Path, number: int, random: Random) -> str:
    """Files that come from the future, or from 1970, and a study that is older than its results."""
    whole = made(ground)
    shutil.copytree(whole, folder, dirs_exist_ok=True)
    for path in sorted(folder.rglob("*")):
        time_s = random.choice((0.0, 1e9, 4e9))
        os.utime(path, (time_s, time_s))
    for command in (("run", "s.toml", "--quiet", "--out", "run"), ("report", "run", "--out", "page.csv")):
        told = ground.worker.call(folder, *command, limit_s=LIMIT_S)
        if wrong := wrong_with(told, ["s.toml"], (DONE,)):
            return f"{command[0]}: {wrong}"
    for name in ("page.csv", "run/kpis.csv"):
        if (folder / name).read_bytes() != (whole / name).read_bytes():
            return f"{name} is another"
    return ""
