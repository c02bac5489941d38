"""One more actuator is one more row of the ladder, and nothing else."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.cli.folders import finished_cases
from tests.conftest import SMALL
from waxstudy.plugin.registry import installed

LAST = '  { id = "O_WM", valve'
ROW = '  { id = "O_X", valve = { use = "quick-opening" }, actuator = { use = "%s" } },\n'


def rows(entry: Entry) -> dict[str, str]:
    """The comparison's rows by case, each to the last digit that is written."""
    done = entry("report", "run", "--format", "csv")
    assert done.code == 0, done.stderr
    return {row["case"]: str(row) for row in csv.DictReader(io.StringIO(done.stdout))}


@pytest.mark.parametrize("actuator", installed().names("actuator"))
def test_an_actuator_added_as_a_row_changes_no_figure_of_the_other_rows(
    entry: Entry, small_study: Path, small_run: Path, actuator: str
) -> None:
    before, files = rows(entry), finished_cases(small_run)
    small_study.write_text(SMALL.replace(LAST, ROW % actuator + LAST))
    assert entry("run", small_study, "--out", "run").code == 0
    after = rows(entry)
    assert after.keys() - before.keys() == {"O_X"}
    assert {case: after[case] for case in before} == before
    assert finished_cases(small_run).items() >= files.items()


@pytest.mark.parametrize("actuator", ["linear-ramp", "constant-times"])
def test_an_added_actuator_s_row_is_its_own_and_the_others_computed_beside_it_are_the_same(
    entry: Entry, small_study: Path, small_run: Path, actuator: str
) -> None:
    before = rows(entry)
    small_study.write_text(SMALL.replace(LAST, ROW % actuator + LAST))
    assert entry("run", small_study, "--out", "fresh").code == 0
    done = entry("report", "fresh", "--format", "csv")
    after = {row["case"]: str(row) for row in csv.DictReader(io.StringIO(done.stdout))}
    assert {case: after[case] for case in before} == before
    figures = [value.split("'week'")[1] for value in after.values()]
    assert len(set(figures)) == len(after)
