"""Every registered component of every kind keeps its contract, and all speak of the same thing in the same way."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest

from tests.paper.test_weather import write, year_of
from waxstudy.conformance import assert_conforms, check
from waxstudy.plugin import KINDS
from waxstudy.plugin.registry import installed

COMPONENTS = installed().components


@pytest.mark.parametrize(("kind", "name"), sorted(COMPONENTS))
def test_every_registered_component_conforms(kind: str, name: str) -> None:
    assert_conforms(COMPONENTS[kind, name].component)


def test_there_is_a_component_of_every_kind() -> None:
    assert {kind for kind, _ in COMPONENTS} == set(KINDS)


def test_an_exemption_ends_where_the_reason_does(tmp_path: Path) -> None:
    """The weather file that `epw` is exempt for is here a real one, and then nothing is exempt."""
    path = write(tmp_path / "year.epw", year_of(2019))
    outcomes = check(COMPONENTS["weather", "epw"].component, {"year": {"path": path, "start": "01-20"}})
    assert {outcome.status for outcome in outcomes} == {"passed"}


def test_a_parameter_has_the_same_unit_wherever_it_occurs() -> None:
    units: dict[str, set[str]] = defaultdict(set)
    for entry in COMPONENTS.values():
        for name, field in entry.component.Parameters.model_fields.items():
            extra: Any = field.json_schema_extra
            units[name].add(extra["unit"])
    assert {name: sorted(found) for name, found in units.items() if len(found) > 1} == {}
