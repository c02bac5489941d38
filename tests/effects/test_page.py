"""The page on effects says what the code holds: every effect, its range, and what is uncertain of a room."""

from __future__ import annotations

import sys
from types import ModuleType

import pytest

from tests.conftest import ROOT
from tests.effects import regenerate_list
from tests.test_docs import blocks
from waxstudy.conformance import assert_conforms
from waxstudy.plugin.scaffold import NewPlugin

CONTRACT = ROOT / "docs" / "plugins-effects.md"


def test_the_page_has_every_effect_with_its_range_and_what_is_uncertain_of_a_room() -> None:
    assert regenerate_list.PAGE.read_text(encoding="utf-8") == regenerate_list.page()


def test_the_contract_page_shows_the_effect_that_plugins_new_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    new = NewPlugin("night-setback", "effect")
    source = new.files()[f"{new.module}.py"]
    assert source in blocks(CONTRACT, "python")
    module = ModuleType(new.module)
    monkeypatch.setitem(sys.modules, new.module, module)
    exec(compile(source, new.module, "exec"), module.__dict__)
    assert_conforms(module.NightSetback)
