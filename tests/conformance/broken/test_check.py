"""The kit says of each broken plugin what is wrong and what to do, in a few plain lines."""

from __future__ import annotations

import re
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.conformance.broken.catalogue import UNREGISTERED, USED
from tests.conformance.broken.plugin import CHECK_FAILED, PLUGIN, module_of
from waxstudy.conformance import Outcome, check
from waxstudy.plugin.registry import installed

pytestmark = pytest.mark.usefixtures("all_installed")

MOST_LINES = 12
# numba's and pydantic's own words, and what an author cannot act on: our own lines
NOISE = re.compile(r"pipeline|nopython|lowering|errors\.pydantic\.dev|During: |the check failed with|/waxstudy/\w+/")


@cache
def outcomes(name: str) -> list[Outcome]:
    return check(import_module(module_of(name)).Broken)


def failure(name: str) -> Outcome:
    """The first stage that fails."""
    return next(outcome for outcome in outcomes(name) if outcome.status == "failed")


@pytest.mark.parametrize("name", USED)
def test_the_kit_fails_at_the_stage_that_tells_it(name: str) -> None:
    failed = {outcome.stage: outcome for outcome in outcomes(name) if outcome.status == "failed"}
    assert USED[name].stage in failed
    assert USED[name].says in "\n".join(failed[USED[name].stage].messages)


@pytest.mark.parametrize("name", USED)
def test_its_first_failure_is_told_in_a_few_plain_lines(name: str) -> None:
    said = "\n".join(failure(name).messages)
    assert len(said.splitlines()) <= MOST_LINES
    assert not NOISE.search(said)


@pytest.mark.parametrize("name", UNREGISTERED)
def test_a_plugin_that_offers_nothing_is_listed_with_its_reason(name: str) -> None:
    assert UNREGISTERED[name].reason in installed().broken[name]
    assert len(installed().broken[name].splitlines()) == 1
    assert not NOISE.search(installed().broken[name])


@pytest.mark.parametrize("name", UNREGISTERED)
def test_a_check_by_its_name_says_the_same(entry: Entry, name: str) -> None:
    done = entry("plugins", "check", name)
    assert (done.code, done.stdout) == (PLUGIN, "")
    assert done.stderr == f"error: plugin '{name}' is broken: {installed().broken[name]}\n"


@pytest.mark.parametrize("name", [name for name in UNREGISTERED if UNREGISTERED[name].says is not None])
def test_a_check_of_its_class_says_the_same(entry: Entry, name: str) -> None:
    done = entry("plugins", "check", f"{module_of(name)}:Broken")
    assert (done.code, done.stderr) == (CHECK_FAILED, "")
    assert UNREGISTERED[name].reason in done.stdout
    assert not NOISE.search(done.stdout)


def test_every_plugin_of_the_catalogue_is_either_offered_or_broken(all_installed: Path) -> None:
    registry = installed()
    assert {name for name in UNREGISTERED if name not in registry.broken} == set()
    assert {name for name in USED if ("valve", name) not in registry.components} == set()
