"""A fortieth of the campaign, another one each time; the session's header tells its seed."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from tests.attack.__main__ import line, reproduced
from tests.attack.campaign import run
from tests.attack.classes import CLASSES
from tests.attack.processes import ended, small_files
from tests.conftest import ATTACK_SEED

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits, rights and mounts are those of Linux")


def test_an_attack_spoils_no_bytecode_that_others_import(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("PYTHONDONTWRITEBYTECODE", raising=False)  # else nothing could be spoilt
    (tmp_path / "one.py").write_text("TWO = 2\n")
    words = (sys.executable, "-c", "import one; print(one.TWO)")
    assert ended(tmp_path, *words, before=small_files(100)).stdout == "2\n"
    assert ended(tmp_path, *words).stdout == "2\n"


@pytest.mark.slow
def test_a_fortieth_of_a_campaign_finds_nothing() -> None:
    seed = int(os.environ[ATTACK_SEED])
    failures = []
    for told in run(CLASSES, seed, 0.025):
        print(line(told))
        failures += [f"{reproduced(each.name, seed, each.number)}: {each.what}" for each in told.failures]
    assert not failures, "\n".join(failures)
