"""Claims about the registry: what a plugin may do wrong, and what it is told."""

from __future__ import annotations

import re
import sys
from importlib.metadata import distributions
from pathlib import Path
from types import ModuleType
from typing import Any

import pluggy
import pytest

from waxstudy.plugin import Actuator, Component, hookimpl
from waxstudy.plugin.registry import PluginError, Registry, _register, installed
from waxstudy_paper import COMPONENTS


def actuator(name: str, **attributes: Any) -> type[Component]:
    return type("Some", (Actuator,), {"name": name, "step": staticmethod(lambda p, x, u, t, dt: u), **attributes})


def plugin(*components: type[Component], hook: str = "waxstudy_register") -> ModuleType:
    """A module as a stranger writes it."""
    module = ModuleType("stranger")

    def register_all(register: Any) -> None:
        for component in components:
            register(component)

    setattr(module, hook, hookimpl(register_all))
    return module


def test_built_in_components_come_from_the_entry_point_group_like_a_strangers() -> None:
    (entry_point,) = [
        e for d in distributions() for e in d.entry_points if e.group == "waxstudy" and e.name == "paper"
    ][:1]
    assert entry_point.value == "waxstudy_paper"
    ours = {component.kind + component.name for component in COMPONENTS}
    packages = {e.package for (kind, name), e in installed().components.items() if kind + name in ours}
    assert packages == {"waxstudy"}
    assert installed().broken == {}


def test_the_core_never_names_a_concrete_component() -> None:
    """Beyond the import check: no module of the core spells the plugin's package."""
    core = Path(sys.modules["waxstudy"].__file__ or "").parent
    texts = {file: file.read_text(encoding="utf-8") for file in core.rglob("*.py")}
    names = ("waxstudy_paper", "waxstudy_ramp", "waxstudy_enthalpy")
    assert [file for file, text in texts.items() if any(name in text for name in names)] == []


def test_a_duplicate_name_is_refused_naming_both_packages_and_versions() -> None:
    registry = Registry()
    registry.add(actuator("wax"), "first", "1.0")
    with pytest.raises(PluginError, match=r"'wax' of second 2\.0 is registered already by first 1\.0"):
        registry.add(actuator("wax"), "second", "2.0")


def test_a_plugin_with_one_duplicate_registers_nothing_at_all() -> None:
    registry = Registry()
    registry.add(actuator("wax"), "first", "1.0")
    with pytest.raises(PluginError):
        _register(registry, plugin(actuator("new"), actuator("wax")), "second", "2.0")
    assert registry.names("actuator") == ["wax"]


def test_another_major_of_the_api_is_refused_with_both_numbers() -> None:
    with pytest.raises(PluginError, match=r"made for plugin API 2\.0, this is 1\."):
        Registry().add(actuator("wax", api_version="2.0"), "stranger", "1")
    Registry().add(actuator("wax", api_version="1.9"), "stranger", "1")


def test_an_unknown_kind_is_refused() -> None:
    with pytest.raises(PluginError, match="unknown kind 'pump'; kinds are sensor, "):
        Registry().add(actuator("wax", kind="pump"), "stranger", "1")


def test_a_misspelled_hook_is_found() -> None:
    with pytest.raises(pluggy.PluginValidationError, match="waxstudy_registre"):
        _register(Registry(), plugin(actuator("wax"), hook="waxstudy_registre"), "stranger", "1")
    bare = ModuleType("bare")
    with pytest.raises(PluginError, match="registers nothing"):
        _register(Registry(), bare, "stranger", "1")


def test_an_unknown_name_answers_with_the_nearest_and_what_is_installed() -> None:
    with pytest.raises(PluginError) as caught:
        installed().get("actuator", "variable-time")
    assert re.fullmatch(
        r"no actuator 'variable-time'; did you mean 'variable-times'\? "
        r"\(installed: constant-times, .*ideal, linear-ramp, variable-times\)",
        str(caught.value),
    )
