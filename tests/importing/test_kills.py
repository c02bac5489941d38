"""An import into a folder in use that is killed leaves the old pair of files or the new one."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.importing.exports import Export

# one process for each call that changes a name, which kills itself before it
KILLED = """\
import itertools, os, shutil, signal, sys
from pathlib import Path
from waxstudy.cli.asking import Asking
from waxstudy.importing.bring import bring
from waxstudy.importing.request import Request
from waxstudy.importing.write import write

source, before = map(Path, sys.argv[1:])
asking = Asking(is_terminal=False, takes_proposals=True)
imported = bring(Request(sources=[source], timezone="Europe/Tallinn", room="living", interval_s=600.0), asking)
real = {name: getattr(os, name) for name in ("replace", "unlink")}
for last in itertools.count(1):
    folder = shutil.copytree(before, before.with_name(f"killed-{last}"))
    child = os.fork()
    if not child:
        calls = itertools.count(1)
        for name, call in real.items():
            def counted(*given, call=call, **named):
                if next(calls) == last:
                    os.kill(os.getpid(), signal.SIGKILL)
                return call(*given, **named)
            setattr(os, name, counted)
        write(folder, imported)
        os._exit(0)
    if os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0:
        break
"""


def interval_s(folder: Path) -> tuple[float, float]:
    """The interval that a dataset states, and that of the data which it names."""
    about = tomllib.loads((folder / "dataset.toml").read_text(encoding="utf-8"))["dataset"]
    data = pd.read_csv(folder / about.get("file", "data.csv"), parse_dates=["time"])
    return about["interval_s"], data["time"].diff().median().total_seconds()


@pytest.mark.skipif(sys.platform == "win32", reason="nothing forks there")
def test_one_that_is_killed_leaves_the_old_pair_or_the_new_one(made: dict[str, Export], entry: Entry) -> None:
    export = made["home_assistant_csv"]
    once = ("import", export.source, *export.stated, "--out")
    assert entry(*once, "living").code == 0
    old, new = interval_s(Path("living"))[0], 600.0
    done = subprocess.run([sys.executable, "-c", KILLED, export.source, "living"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    killed = sorted(Path().glob("killed-*"), key=lambda path: int(path.name[7:]))
    stated = [interval_s(folder) for folder in killed]
    assert all(said == found for said, found in stated)
    assert [said for said, _ in stated] == sorted((said for said, _ in stated), reverse=old > new)
    assert {said for said, _ in stated} == {old, new}
    assert entry(*once, killed[-2], "--replace").code == 0  # goes on as if nothing was
    assert sorted(path.name for path in killed[-2].iterdir()) == ["data.csv", "dataset.toml"]
    assert (killed[-2] / "data.csv").read_bytes() == Path("living/data.csv").read_bytes()
