"""The registry: every component that installed plugins offer, by kind and name."""

from __future__ import annotations

import difflib
import io
import os
import sys
import traceback
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import Distribution, EntryPoint, distributions
from types import ModuleType

import numpy as np
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


def hint(word: str, known: Iterable[str]) -> str:
    """Return what a message on an unknown word ends with where a known one is near, or "".

    >>> hint("dealy", ["ideal", "delay"])
    "; did you mean 'delay'?"
    """
    return did_you_mean(nearest(word, known))


def did_you_mean(near: str) -> str:
    return f"; did you mean '{near}'?" if near else ""


class PluginError(Exception):
    """A plugin cannot be used; the message says which, why, and what to do."""


# where a stranger's fault may show, but never lies
CALLERS = ("waxstudy", "pluggy", "pydantic", "pydantic_core", "numpy", "numba", "scipy", "pandas", "pvlib")
NOT_STRANGE = {*sys.stdlib_module_names, *CALLERS}
LONGEST = 500


def one_line(text: str) -> str:
    """Return a message as one line, without a library's link to its manual and cut off where it gets long.

    >>> one_line("no type\\n\\nFor further information visit https://example.org")
    'no type'
    """
    lines = [" ".join(line.split()) for line in text.splitlines() if "For further information" not in line]
    line = " ".join(filter(None, lines))
    return line if len(line) <= LONGEST else f"{line[:LONGEST]} ..."


def described(error: BaseException) -> str:
    """Return what a stranger's code raised in one line: type, message, and where in that code.

    >>> described(KeyError("flow"))
    "KeyError: 'flow'"
    """
    try:
        said = one_line(str(error))
    except Exception:  # a stranger's error may fail itself
        said = ""
    places = [
        f" ({frame.f_code.co_filename}:{line})"
        for frame, line in traceback.walk_tb(error.__traceback__)
        if str(frame.f_globals.get("__name__")).split(".")[0] not in NOT_STRANGE
    ]
    return ": ".join(filter(None, (type(error).__name__, said))) + "".join(places[-1:])


@contextmanager
def told(what: str = "", *passed: type[BaseException]) -> Iterator[None]:
    """Turn whatever a stranger's code raises into a `PluginError` of one line, except Ctrl-C and what is `passed`."""
    prefix = f"{what}: " if what else ""
    untold: tuple[type[BaseException], ...] = (KeyboardInterrupt, *passed)
    try:
        yield
    except untold:
        raise
    except (PluginError, pluggy.PluginValidationError) as error:
        raise PluginError(prefix + one_line(str(error))) from error
    except BaseException as error:
        raise PluginError(prefix + described(error)) from error


@contextmanager
def contained() -> Iterator[None]:
    """Undo what a stranger's import does to the whole program: folder, warnings, numpy's treatment of rounding."""
    try:
        here = os.getcwd()
    except OSError:  # it has been deleted
        here = ""
    try:
        with np.errstate(), warnings.catch_warnings():
            yield
    finally:
        if here:
            os.chdir(here)


@dataclass(frozen=True)
class Registered:
    """A component and the package it came with."""

    component: type[Component]
    package: str
    version: str

    @property
    def summary(self) -> str:
        """What it is: the first line of its docstring, up to its colon or full stop."""
        lines = (self.component.__doc__ or "").strip().splitlines()
        return lines[0].split(": ")[0].split(". ")[0].rstrip(".") if lines else ""

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

    def add_broken(self, plugin: str, package: str, reason: str) -> None:
        """Note why a plugin cannot be loaded; one whose name is taken is told apart by its package."""
        key = f"{plugin} of {package}" if plugin in self.broken else plugin
        self.broken[key] = "; ".join([*filter(None, [self.broken.get(key)]), reason])

    def names(self, kind: str) -> list[str]:
        return sorted(name for k, name in self.components if k == kind)

    def get(self, kind: str, name: str) -> type[Component]:
        """Return the component; raise `PluginError` naming the nearest one and what is installed, or who contest it."""
        if (kind, name) in self.contested:
            raise PluginError(f"{self.contested[kind, name]}; uninstall one of them")
        if (kind, name) in self.components:
            return self.components[kind, name].component
        installed = self.names(kind)
        broken = "".join(f"; plugin '{plugin}' is broken: {why}" for plugin, why in self.broken.items())
        raise PluginError(
            f"no {kind} '{name}'{hint(name, installed)} (installed: {', '.join(installed) or 'none'}){broken}"
        )

    def package_of(self, component: type[Component]) -> Registered:
        return self.components[component.kind, component.name]


@cache
def installed() -> Registry:
    """Load every installed plugin once and return the registry."""
    registry = Registry()
    seen: set[str] = set()
    found = [(_stated(d, "Name"), e, d) for d in distributions() for e in _entry_points(registry, d)]
    # our own first: a stranger that takes one of our names is the one to be refused
    for _, entry_point, distribution in sorted(found, key=lambda one: (one[0] != GROUP, one[0])):
        if entry_point.value not in seen:
            seen.add(entry_point.value)
            _load(registry, entry_point, distribution)
    return registry


def _entry_points(registry: Registry, distribution: Distribution) -> list[EntryPoint]:
    """Return a package's plugins; note it as broken if it has some and its list of them cannot be read."""
    try:
        return [entry_point for entry_point in distribution.entry_points if entry_point.group == GROUP]
    except Exception:
        with suppress(Exception):  # what cannot be read at all is not known to be for us
            if f"[{GROUP}]" in (distribution.read_text("entry_points.txt") or ""):
                package = _stated(distribution, "Name")
                registry.add_broken(
                    package, package, "entry_points.txt cannot be read: write NAME = MODULE in each line"
                )
        return []


def _stated(distribution: Distribution, key: str) -> str:
    """What a package states of itself; a damaged one states nothing."""
    try:
        return str((distribution.metadata.get_all(key) or ["unknown"])[0])
    except Exception:
        return "unknown"


def _load(registry: Registry, entry_point: EntryPoint, distribution: Distribution) -> None:
    """Import one plugin and call its hook; what it prints or warns of is nobody's result and is dropped."""
    package, version = _stated(distribution, "Name"), _stated(distribution, "Version")
    nowhere = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", errors="replace")
    try:
        with told(), contained(), redirect_stdout(nowhere), redirect_stderr(nowhere):
            warnings.simplefilter("ignore")
            plugin: ModuleType = entry_point.load()
            _register(registry, plugin, package, version)
    except PluginError as error:
        registry.add_broken(entry_point.name, package, str(error))


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
