"""The sources keep their types, and their imports go one way; here, so that this is checked beside the tests."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import ROOT


@pytest.mark.slow
@pytest.mark.parametrize("check", ["mypy", "lint-imports"])
def test_the_sources_pass(check: str) -> None:
    command = str(Path(sys.executable).with_name(check))
    done = subprocess.run([command], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
