"""A tenth of the campaign, another one each time; the session's header tells its seed."""

from __future__ import annotations

import os
import sys

import pytest

from tests.attack.__main__ import line, reproduced
from tests.attack.campaign import run
from tests.attack.classes import CLASSES
from tests.conftest import ATTACK_SEED


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="limits, rights and mounts are those of Linux")
def test_a_tenth_of_a_campaign_finds_nothing() -> None:
    seed = int(os.environ[ATTACK_SEED])
    failures = []
    for told in run(CLASSES, seed, 0.1):
        print(line(told))
        failures += [f"{reproduced(each.name, seed, each.number)}: {each.what}" for each in told.failures]
    assert not failures, "\n".join(failures)
