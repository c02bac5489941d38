"""A run says where the comfort rule cannot be met, or only by a shift that no study means."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.conftest import ONE_CASE
from waxstudy.results.comfort import FAR_K, LIMIT_K, Reached

COARSE = ONE_CASE.replace('"small"\n', '"small"\nstep_s = 60\n').replace("members = 2", "members = 1")


def with_setpoint(setpoint_C: float) -> str:
    return COARSE.replace("[ensemble]", f"[comfort]\nsetpoint_C = {setpoint_C}\n\n[ensemble]")


def warnings_of(stderr: str) -> list[str]:
    return [line.removeprefix("warning: ") for line in stderr.splitlines() if line.startswith("warning: ")]


@pytest.mark.parametrize(
    ("setpoint_C", "said"),
    [
        (
            40.0,
            "O_0, january: the comfort rule cannot be met: 33 h below the limit are out of reach within 6 K",
        ),
        (25.0, "O_0, january: equal comfort takes a shift of -3."),
    ],
)
def test_terminal_folder_and_report_say_so_alike_and_so_does_a_second_run(
    setpoint_C: float, said: str, entry: Entry, tmp_path: Path
) -> None:
    (tmp_path / "study.toml").write_text(with_setpoint(setpoint_C))
    for _ in ("computed", "taken from the folder"):
        done = entry("run", "study.toml", "--out", "run", "--json")
        assert done.code == 0, done.stderr
        (warning,) = warnings_of(done.stderr)
        assert warning.startswith(said)
        assert json.loads((tmp_path / "run" / "run.json").read_text())["warnings"] == [warning]
        assert warning in json.loads(done.stdout)["notes"]
    assert entry("report", "run", "--format", "html", "--out", "report.html").code == 0
    assert said in (tmp_path / "report.html").read_text()


def test_where_the_rule_is_met_nothing_is_said(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(COARSE)
    done = entry("run", "study.toml", "--out", "run")
    assert (done.code, done.stderr) == (0, "")
    assert json.loads((tmp_path / "run" / "run.json").read_text())["warnings"] == []


@pytest.mark.parametrize(
    ("shift_K", "hours", "said"),
    [
        (0.49, 33.2, ""),  # the paper's largest
        (FAR_K, 33.0, ""),
        (-FAR_K - 0.01, 33.0, "beyond 2 K"),
        (LIMIT_K, 33.4, "beyond 2 K"),  # met at the very bound
        (LIMIT_K, 60.0, "out of reach"),
        (-LIMIT_K, 0.0, "at -6 K it has 0.0 h"),
        (0.3, 40.0, ""),  # jumped over: a note of the report
    ],
)
def test_a_shift_is_warned_of_from_its_stated_size_on(shift_K: float, hours: float, said: str) -> None:
    warning = Reached("O_0", "january", shift_K, hours).warning(33.0)
    assert said in warning
    assert bool(warning) == bool(said)
