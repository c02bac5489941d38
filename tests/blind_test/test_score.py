"""Claims about the score as a user gets it."""

from __future__ import annotations

import json
from html import escape
from pathlib import Path

import pytest

from tests.blind_test.conftest import CASES, answered_by, copied
from tests.cli.conftest import Entry
from waxstudy.blind_test.box import open_box
from waxstudy.blind_test.key import Key
from waxstudy.blind_test.make import Place
from waxstudy.plugin.trial import engine_of
from waxstudy.report.blind_test.figures import figure_sizes

CONSTANT = json.dumps({"verdict": "effect", "effects": [{"name": "let-by", "stage": "valve", "group": ["let-by"]}]})


@pytest.fixture(scope="module")
def constant_once(finished_test: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return answered_by(finished_test, tmp_path_factory.mktemp("constant"), "constant", CONSTANT)


@pytest.fixture
def constant(constant_once: Path, tmp_path: Path) -> Path:
    """The small test, answered by one who always says the same."""
    return copied(constant_once, tmp_path)


def test_a_diagnoser_that_always_says_the_same_scores_as_such(constant: Path, entry: Entry, key: Key) -> None:
    done = entry("blind-test", "score", "test", "--key-file", "key", "--json")
    assert done.code == 0, done.stderr
    place = Place(constant)
    truths = [open_box(key, name, place.box(name).read_bytes()) for name in place.names()]
    own = json.loads(done.stdout)["diagnosers"]["constant"]["all"]
    nulls = [truth for truth in truths if truth["kind"] == "null"]
    apart = [truth for truth in nulls if "valve" in engine_of(truth["engine"]).departs]
    let_by = [t for t in truths if t["kind"] == "single" and t["causes"][0]["name"] == "let-by"]
    assert (own["false_alarm"]["count"], own["false_alarm"]["of"]) == (len(nulls) - len(apart), len(nulls))
    assert own["right_group"]["count"] == (len(let_by) if own["right_group"]["of"] else None)
    assert own["unknown_found"]["count"] in (0, None)
    assert own["detection"]["of"] == len(truths) - len(nulls)


def test_the_table_fits_a_screen_and_page_and_json_are_written(constant: Path, entry: Entry) -> None:
    done = entry("blind-test", "score", "test", "--key-file", "key")
    assert done.code == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0].startswith(f"{CASES} records (")
    assert lines[0].endswith("all seals whole")
    assert len(lines) < 50
    assert max(map(len, lines)) <= 160
    page = (constant / "score" / "score.html").read_text()
    told = json.loads((constant / "score" / "score.json").read_text())
    assert told["records"] == CASES
    for failure in told["diagnosers"]["constant"]["failures"]:
        assert failure["record"] in page
    assert "http" not in page.replace("http://www.w3.org", "")
    goals = [goal for each in told["diagnosers"].values() for goal in each["goals"]]
    for name in {goal["name"] for goal in goals}:
        answered = {goal["where"] for goal in goals if goal["name"] == name and goal["value"] is not None}
        assert page.count(f'data-label="figure">{escape(name)}<') == len(answered), name


def test_without_answers_there_is_nothing_to_score(small_test: Path, entry: Entry) -> None:
    done = entry("blind-test", "score", "test", "--key-file", "key")
    assert (done.code, "nobody has answered" in done.stderr) == (2, True)


def test_a_panel_says_over_which_records_its_shares_are() -> None:
    """A wrong effect may be named of two effects as well."""
    shares = {name: {"value": 0.8, "low": 0.7, "high": 0.9} for name in ("right_group", "misdiagnosis")}
    score = {"diagnosers": {"ours": {"by": {"gap over floor": {"1 to 2": shares}}}}}
    labels = [panel.get_ylabel() for panel in figure_sizes(score).axes]
    assert labels == ["share of records with one effect", "share of records with one effect or two"]
