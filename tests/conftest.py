"""What every test may use: the repository's studies, a small study, and the command line as a user starts it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from random import SystemRandom
from types import MappingProxyType

import pytest
from hypothesis import settings

from tests.preloaded import CAN_FORK, LIMIT_S, run_preloaded

# examples differ in length by far; the suite's own time limit is the one that counts
settings.register_profile("waxstudy", deadline=None)
settings.register_profile("landing", deadline=None, derandomize=True)  # what lands must not hang on luck
settings.load_profile("waxstudy")

ROOT = Path(__file__).parents[1]
DATA = Path(os.environ.get("WAXSTUDY_DATA", ROOT.parent / "shared" / "data"))  # from outside; may not be there
WAXSTUDY = Path(sys.executable).with_name("waxstudy")

SMALL = """\
[study]
name = "small"

[room]
use = "nzeb"

[weather.january]
use = "tallinn-week"
month = "january"

[ensemble]
members = 2

[ladder.on-off]
reference = "O_WM"
start = { id = "O_0", controller = { use = "on-off" }, valve = { use = "linear" } }
steps = [
  { id = "O_CP", controller = { dead_band_K = 0.5 } },
  { id = "O_WM", valve = { use = "quick-opening" }, actuator = { use = "variable-times" } },
]
"""

ONE_CASE = SMALL.replace('"O_WM"\n', '"O_0"\n').partition("steps = [")[0]

ATTACK_SEED = "ATTACK_SEED"

# Python keeps bytecode whose writing was cut short, and fails at every later import of it
NO_BYTECODE = {"PYTHONDONTWRITEBYTECODE": "1"}

NO_MORE: Mapping[str, str] = MappingProxyType({})

Waxstudy = Callable[..., "subprocess.CompletedProcess[str]"]


def pytest_configure() -> None:
    """Draw the seed of this session's attack, before processes that share it begin; who names one gets that again."""
    os.environ.setdefault(ATTACK_SEED, str(SystemRandom().randrange(10**6)))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """Two workers for each processor: many tests wait for a process, a lock or a browser."""
    may_be_used = getattr(os, "sched_getaffinity", lambda _: range(os.cpu_count() or 1))(0)
    return 2 * len(may_be_used)


def pytest_report_header() -> str:
    return f"attack: {ATTACK_SEED}={os.environ[ATTACK_SEED]}"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the files that hold slow tests: one that came last would be waited for by idle processes."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in slow)


@pytest.fixture
def small_study(tmp_path: Path) -> Path:
    """Three On/Off cases, one week, two members."""
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    return path


def call(
    folder: Path, *arguments: object, env: Mapping[str, str] = NO_MORE, **options: object
) -> subprocess.CompletedProcess[str]:
    """Run the installed command in a folder; `env` adds to the environment.

    What asks for more than that is started anew, and so is what an interpreter reads of its environment.
    """
    if not CAN_FORK or options or any(name.startswith("PYTHON") for name in env):
        return call_anew(folder, *arguments, env=env, **options)
    return run_preloaded(folder, _words(arguments), _environment(env))


def call_anew(
    folder: Path, *arguments: object, env: Mapping[str, str] = NO_MORE, **options: object
) -> subprocess.CompletedProcess[str]:
    """Run the installed command in a process of its own from the first instruction on."""
    shown = {"capture_output": True, "text": True, "timeout": LIMIT_S, **options}
    return subprocess.run(_words(arguments), cwd=folder, env=_environment(env), **shown)  # type: ignore[call-overload,no-any-return]


def _words(arguments: Iterable[object]) -> list[str]:
    return [str(WAXSTUDY), *map(str, arguments)]


def _environment(more: Mapping[str, str]) -> dict[str, str]:
    return {**os.environ, "COLUMNS": "120", **more}


@pytest.fixture
def waxstudy(tmp_path: Path) -> Waxstudy:
    """Run the installed command in a folder of its own."""
    return partial(call, tmp_path)


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run folder of the small study, made once; not to be changed."""
    folder = tmp_path_factory.mktemp("finished")
    (folder / "small.toml").write_text(SMALL)
    done = call(folder, "run", "small.toml", "--out", "run")
    assert done.returncode == 0, done.stderr
    return folder / "run"


@pytest.fixture
def small_run(finished: Path, tmp_path: Path) -> Path:
    """A copy of the small study's run folder, beside the study of `small_study`."""
    return shutil.copytree(finished, tmp_path / "run")
