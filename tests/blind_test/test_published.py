"""What the pages say of judged runs is what their scores say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.blind_test.regenerate_tables import RUNS, Score, pages, scores
from tests.conftest import ROOT

EVERY = scores()


@pytest.mark.parametrize("page", pages(), ids=lambda page: str(page.relative_to(ROOT)))
def test_every_table_of_goals_shows_the_figures_of_the_score(page: Path) -> None:
    current = page.read_text(encoding="utf-8") == pages()[page]
    assert current, f"the tables of {page.relative_to(ROOT)} are old: python -m tests.blind_test.regenerate_tables"


@pytest.mark.parametrize(("run", "score"), EVERY.items(), ids=EVERY)
def test_every_failure_of_a_run_is_listed_and_nothing_else(run: str, score: Score) -> None:
    page = (RUNS / run / "README.md").read_text(encoding="utf-8")
    listed, _, without = page.partition("## Without the true effect")
    ours = score["diagnosers"]["ours"]
    assert _records(listed) == sorted(row["record"][:6] for row in ours["failures"])
    assert _records(without) == sorted(row["record"][:6] for row in ours["left_out"])


@pytest.mark.parametrize(("run", "score"), EVERY.items(), ids=EVERY)
def test_the_index_names_a_run_s_records_and_the_fingerprint_of_its_key(run: str, score: Score) -> None:
    index = (RUNS / "README.md").read_text(encoding="utf-8")
    row = re.search(rf"^\| \[{run}\]\({run}/README.md\) \| [\d-]+ \| (\d+).*\| `(\w+)…(\w+)` \|", index, re.M)
    assert row is not None
    records, first, last = row.groups()
    assert int(records) == score["records"]
    fingerprint = score["key_fingerprint"]
    assert fingerprint.startswith(first)
    assert fingerprint.endswith(last)


def _records(page: str) -> list[str]:
    return sorted(re.findall(r"^\| `([0-9a-f]{6})` \|", page, re.M))
