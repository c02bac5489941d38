"""The command's entry point called within the test process, which saves a second of start-up each time."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, NoReturn

import pytest

from waxstudy.cli import main


class Ended(NamedTuple):
    code: int
    stdout: str
    stderr: str


Entry = Callable[..., Ended]


class Typed(io.StringIO):
    """What is typed on a terminal, for the entry point called within the test process."""

    def isatty(self) -> bool:
        return True

    @staticmethod
    def interrupted(*_: object) -> NoReturn:
        """Stand for what is at work when Ctrl-C is pressed."""
        raise KeyboardInterrupt


@pytest.fixture
def entry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Entry:
    """Call the entry point in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")

    def call(*arguments: object) -> Ended:
        with pytest.raises(SystemExit) as ended:
            main([*map(str, arguments)])
        code = ended.value.code
        assert isinstance(code, int)
        return Ended(code, *capsys.readouterr())

    return call


Plugin = Callable[[str, str], dict[str, str]]


@pytest.fixture
def plugin(tmp_path: Path) -> Plugin:
    """Install a one-module plugin as a stranger's package would be, for a process started with this environment."""

    def install(name: str, source: str) -> dict[str, str]:
        place = tmp_path / "strangers"
        about = place / f"{name}-1.0.dist-info"
        about.mkdir(parents=True)
        (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text(f"[waxstudy]\n{name} = {name}\n")
        (place / f"{name}.py").write_text(source)
        return {"PYTHONPATH": str(place)}

    return install
