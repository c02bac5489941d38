"""Commands that are killed at a random moment: what is there is whole, and the same command ends as if nothing was."""

from __future__ import annotations

import shutil
import time
from collections.abc import Sequence
from pathlib import Path
from random import Random
from typing import NamedTuple

from tests.attack.campaign import Ground
from tests.attack.files import STUDY
from tests.attack.processes import contents, ended
from tests.attack.verdict import DONE, USAGE, wrong_with
from tests.fleet.conftest import FLEET
from tests.paper.test_weather import HEADER, year_of

Files = dict[str, str]
TOOK = "took_s"  # file of the undisturbed call
KEY = "3-" + 32 * "a"
PROGRAMME = """\
combination,product,exemplar,valve,on_min,off_min,duration_min,measured
B1,B,1,no,15,15,240,displacement
"""

SWEEP = """\
[vary]
"controller.dead_band_K" = [0.4, 0.6]
"""


def swapped(text: str, lines: str, others: str) -> str:
    """Return a text with whole lines in the place of others, which must be there once."""
    assert text.count(f"\n{lines}\n") == 1, f"'{lines}' is not what it was"
    return text.replace(f"\n{lines}\n", f"\n{others}\n")


# two batches of loops in one state
CALLS = FLEET[: FLEET.index("[activation.state.natural]")]
CALLS = swapped(swapped(CALLS, "loops = 10", "loops = 40"), "step_s = 10", "step_s = 20")
# two weeks at the turn of a month, of whose days only the first count
SEASON = swapped(
    STUDY, 'use = "tallinn-week"\nmonth = "january"', 'use = "epw"\npath = "year.epw"\nstart = "02-22"\ndays = 14'
)
FILES = {
    "s.toml": STUDY,
    "programme.csv": PROGRAMME,
    "key": f"{KEY}\n",
    "sweep.toml": SWEEP,
    "calls.toml": CALLS,
    "season.toml": f"{SEASON}\n[season]\nlimit_C = 7.0\n",
    "year.epw": "\n".join([*HEADER, *year_of(2019, 75)]) + "\n",
}


class Writing(NamedTuple):
    """A command that writes, and what it needs."""

    words: str
    needs: Sequence[str] = ()  # commands before it
    is_taken: bool = False  # it refuses to write over what it has finished
    varied: Sequence[str] = ()  # files that begin so hold a time, random numbers or a path


RUN = "run s.toml --quiet --out run"
REALITY = "reality s.toml --case O_WM --days 2 --interval-s 300 --out room"
HEALTHY = "reality s.toml --case O_WM --days 4 --interval-s 300 --out healthy"
RIG = "rig bench --programme programme.csv"
MAKE = "blind-test make --cases 1 --seed 3 --key-file key --out set --quiet --workers 1"
COMMANDS = {
    "run": Writing(RUN),
    "report": Writing("report run --out page.html", [RUN]),
    "reality": Writing(REALITY, is_taken=True),
    "diagnose": Writing("diagnose room --quick --quiet --out out", [REALITY]),
    "calibrate": Writing("calibrate healthy --quiet --out built.toml", [HEALTHY]),
    "rig": Writing(RIG, is_taken=True),
    "fit": Writing("fit actuator bench --out motor.toml", [RIG]),
    "make": Writing(MAKE, varied=["set/boxes/"]),
    "sweep": Writing("run s.toml --sweep sweep.toml --quiet --out swept"),
    "tune": Writing("tune s.toml --case O_WM --budget 40 --quiet --workers 1 --out tuned"),
    "import": Writing("import room/data.csv --timezone Etc/GMT-2 --yes --out brought", [REALITY]),
    "plugin": Writing(
        "export energyplus s.toml --case O_WM --zone Z --radiant R --full-flow-kg-s 0.03 --out motor.py", is_taken=True
    ),
    "solve": Writing("blind-test solve set --with random --quiet --workers 1", [MAKE], varied=["set/answers/"]),
    "activation": Writing("run calls.toml --quiet --out called"),
    "season": Writing(
        "run season.toml --quiet --out seasons",
        varied=[f"seasons/{name}" for name in ("origin.json", "study.toml", "SHA256SUMS")],
    ),
}


def before(ground: Ground, name: str) -> Path:
    """Return a folder with what a command needs."""

    def make(folder: Path) -> None:
        for file, text in FILES.items():
            (folder / file).write_text(text)
        for words in COMMANDS[name].needs:
            done = ended(folder, *words.split())
            assert done.code == DONE, done.stderr

    return ground.once(f"before-{name}", make)


def whole(ground: Ground, name: str) -> tuple[Files, float]:
    """Return what a command that nobody disturbs leaves, and how long it takes [s]."""

    def make(folder: Path) -> None:
        shutil.copytree(before(ground, name), folder, dirs_exist_ok=True)
        began = time.perf_counter()
        done = ended(folder, *COMMANDS[name].words.split())
        assert done.code == DONE, done.stderr
        (folder / TOOK).write_text(str(time.perf_counter() - began))

    folder = ground.once(f"whole-{name}", make)
    return _files(folder, COMMANDS[name]), float((folder / TOOK).read_text())


def _files(folder: Path, writing: Writing) -> Files:
    """Return every file's digest, "" of those that differ from one call to the next."""
    found = {path: digest for path, digest in contents(folder).items() if path != TOOK}
    return {path: "" if path.startswith(tuple(writing.varied)) else digest for path, digest in found.items()}


def kill(ground: Ground, folder: Path, number: int, random: Random) -> str:
    name = list(COMMANDS)[number % len(COMMANDS)]
    writing = COMMANDS[name]
    complete, took_s = whole(ground, name)
    shutil.copytree(before(ground, name), folder, dirs_exist_ok=True)
    ended(folder, *writing.words.split(), kill_s=took_s * random.random())
    left = _files(folder, writing)
    if wrong := [path for path, digest in left.items() if complete.get(path) and complete[path] != digest]:
        return f"{name}: {wrong[0]} is half written"
    again = ended(folder, *writing.words.split())
    if wrong_words := wrong_with(again, FILES, (DONE, USAGE) if writing.is_taken else (DONE,)):
        return f"{name}, once more: {wrong_words}"
    found = _files(folder, writing)
    differing = [path for path in complete.keys() | found.keys() if complete.get(path) != found.get(path)]
    return f"{name}, once more: {sorted(differing)[0]} is another" if differing else ""
