"""Claims about the table of criteria: few limits, each of which says why and is read, and no decision by words."""

from __future__ import annotations

import ast
import csv
import re
from dataclasses import fields
from importlib.resources import files
from pathlib import Path

import pytest

import waxstudy.diagnosis
from tests.diagnosis.regenerate_criteria import PAGE, page
from waxstudy.diagnosis.criteria import CRITERIA, LIMITS, Criterion, Limits

FOLDER = Path(waxstudy.diagnosis.__path__[0])
SOURCES = {path: path.read_text(encoding="utf-8") for path in sorted(FOLDER.rglob("*.py"))}
ASKING = "\n".join(text for path, text in SOURCES.items() if path.name != "criteria.py")
WITH_WORDS = ("reason", "sentence", "summary", "words", "why", "why_not", "warnings", "assumptions")
MOST = 15
EACH = pytest.mark.parametrize("row", CRITERIA, ids=lambda row: row.name)


def test_the_limits_are_few() -> None:
    assert len(CRITERIA) <= MOST


def test_every_row_of_the_table_is_a_limit_by_its_name() -> None:
    text = files("waxstudy.diagnosis").joinpath("criteria.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(text.splitlines()))
    assert {row["name"]: float(row["limit"]) for row in rows} == vars(LIMITS)
    assert [row["name"] for row in rows] == [each.name for each in CRITERIA] == [each.name for each in fields(Limits)]


@EACH
def test_a_limit_says_what_it_decides_why_and_where_it_comes_from(row: Criterion) -> None:
    assert all(words.strip() for words in (row.name, row.decides, row.reason, row.source))


@EACH
def test_every_limit_is_read(row: Criterion) -> None:
    assert re.search(rf"\bLIMITS\.{row.name}\b", ASKING)


def test_the_page_has_the_table() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


def is_of_words(node: ast.expr) -> bool:
    """Whether an expression is something that a user reads."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str) and " " in node.value.strip()
    return isinstance(node, ast.Attribute | ast.Name) and getattr(node, "attr", getattr(node, "id", "")) in WITH_WORDS


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_no_decision_rests_on_words(path: Path) -> None:
    for node in ast.walk(ast.parse(SOURCES[path])):
        if isinstance(node, ast.Compare):
            assert not any(map(is_of_words, (node.left, *node.comparators))), ast.unparse(node)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            is_search = node.func.attr in ("startswith", "endswith", "removeprefix", "find", "match", "search")
            # the unit that a parameter's name ends with is no word
            is_unit = [getattr(each, "value", "") for each in node.args] == ["_s"]
            assert not is_search or is_unit, ast.unparse(node)
