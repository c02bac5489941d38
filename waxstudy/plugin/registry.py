"""The registry: every component that installed plugins offer, by kind and name."""

from __future__ import annotations

import difflib
import sys
import traceback
from collections.abc import Iterable
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import Distribution, EntryPoint, distributions
from types import ModuleType

import pluggy

from waxstudy.plugin.contracts import Component
from waxstudy.plugin.hook import GROUP, Hooks
from waxstudy.plugin.structure import structure_problems


def nearest(word: str, known: Iterable[str]) -> str:
    """Return the known word most like a misspelled one, or "" if none is near.

    >>> nearest("dealy", ["ideal", "delay"])
    'delay'
    """
    close = difflib.get_close_matches(word, list(known), n=5)
    return next((near for near in close if sorted(near) == sorted(word)), close[0] if close else "")


class PluginError(Exception):
    """A plugin cannot be used; the message says which, why, and what to do."""


def described(error: BaseException) -> str:
    """Return what a stranger's code raised in one line: type, message, and where.

    >>> described(KeyError("flow"))
    "KeyError: 'flow'"
    """
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if not frame.filename.startswith("<frozen")]
    place = f" ({frames[-1].filename}:{frames[-1].lineno})" if frames else ""
    return f"{type(error).__name__}: {error}{place}"


@dataclass(frozen=True)
class Registered:
    """A component and the package it came with."""

    component: type[Component]
    package: str
    version: str

    def __str__(self) -> str:
        return f"{self.component.kind} '{self.component.name}' of {self.package} {self.version}"


@dataclass
class Registry:
    """Components by (kind, name), and the plugins that could not be loaded with their reason."""

    components: dict[tuple[str, str], Registered] = field(default_factory=dict)
    broken: dict[str, str] = field(default_factory=dict)
    contested: dict[tuple[str, str], str] = field(default_factory=dict)  # names that two packages claim

    def add(self, component: type[Component], package: str, version: str) -> None:
        """Register one component; raise `PluginError` for what is none of this API's, or for a duplicate."""
        for problem in structure_problems(component):
            raise PluginError(problem)
        entry = Registered(component, package, version)
        other = self.components.setdefault((component.kind, component.name), entry)
        if other is not entry:
            clash = f"{entry} is registered already by {other.package} {other.version}"
            raise PluginError(self.contested.setdefault((component.kind, component.name), clash))

    def names(self, kind: str) -> list[str]:
        return sorted(name for k, name in self.components if k == kind)

    def get(self, kind: str, name: str) -> type[Component]:
        """Return the component; raise `PluginError` naming the nearest one and what is installed, or who contest it."""
        if (kind, name) in self.contested:
            raise PluginError(f"{self.contested[kind, name]}; uninstall one of them")
        if (kind, name) in self.components:
            return self.components[kind, name].component
        installed = self.names(kind)
        near = nearest(name, installed)
        hint = f"; did you mean '{near}'?" if near else ""
        broken = "".join(f"; plugin '{plugin}' is broken: {why}" for plugin, why in self.broken.items())
        raise PluginError(f"no {kind} '{name}'{hint} (installed: {', '.join(installed) or 'none'}){broken}")

    def package_of(self, component: type[Component]) -> Registered:
        return self.components[component.kind, component.name]


@cache
def installed() -> Registry:
    """Load every installed plugin once and return the registry."""
    registry = Registry()
    seen: set[str] = set()
    found = [(e, d) for d in distributions() for e in d.entry_points if e.group == GROUP]
    # our own first: a stranger that takes one of our names is the one to be refused
    for entry_point, distribution in sorted(found, key=lambda pair: pair[1].name != GROUP):
        if entry_point.value not in seen:
            seen.add(entry_point.value)
            _load(registry, entry_point, distribution)
    return registry


def _load(registry: Registry, entry_point: EntryPoint, distribution: Distribution) -> None:
    """Import one plugin and call its hook; what it prints must not end up in a command's output."""
    try:
        with redirect_stdout(sys.stderr):
            plugin: ModuleType = entry_point.load()
            _register(registry, plugin, distribution.metadata["Name"], distribution.version)
    except (PluginError, pluggy.PluginValidationError) as error:
        registry.broken[entry_point.name] = str(error)
    except (Exception, SystemExit) as error:  # a stranger's import and hook may raise anything
        registry.broken[entry_point.name] = described(error)


def _register(registry: Registry, plugin: ModuleType, package: str, version: str) -> None:
    """Call the plugin's hook; all or nothing, so that a broken plugin leaves no half behind."""
    manager = pluggy.PluginManager(GROUP)
    manager.add_hookspecs(Hooks)
    manager.register(plugin)
    manager.check_pending()
    found: list[type[Component]] = []
    manager.hook.waxstudy_register(register=found.append)
    if not found:
        raise PluginError(f"{plugin.__name__}: registers nothing (is `waxstudy_register` marked @hookimpl?)")
    trial = Registry(dict(registry.components), contested=registry.contested)
    for component in found:
        trial.add(component, package, version)
    registry.components = trial.components
