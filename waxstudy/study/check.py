"""Checking raw tables against what components and the parts of a study declare."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from waxstudy.plugin import Component, Parameters
from waxstudy.plugin.files import lacking
from waxstudy.plugin.registry import PluginError, Registry, nearest
from waxstudy.study.model import Choice
from waxstudy.study.problems import Problem, listed, shown
from waxstudy.study.sentences import refused_default, sentences, value_at
from waxstudy.study.source import Source
from waxstudy.study.spots import RawTable, Spot, Written

DATA = "WAXSTUDY_DATA"  # folder of data that no study holds, such as weather

P = TypeVar("P", bound=Parameters)


@dataclass
class Check:
    """One reading of a study file: notes every problem, and goes on."""

    source: Source
    registry: Registry
    needs_files: bool = True  # a report of a finished run does not
    problems: list[Problem] = field(default_factory=list)
    said: set[tuple[Spot, str]] = field(default_factory=set)
    fragments: dict[str, str] = field(default_factory=dict)  # file as written -> hash, and whether simulated

    def problem(
        self,
        spot: Spot,
        wrong: str,
        *,
        value: object = None,
        near: str = "",
        allowed: str = "",
        of_plugin: bool = False,
    ) -> None:
        """Note a problem once: later cases inherit a value together with its place."""
        text = "" if value is None else shown(value)
        place = (self.source.file, self.source.line(spot.path), spot.where, spot.key)
        problem = Problem(*place, text, wrong, near, allowed, of_plugin)
        if problem not in self.problems:
            self.problems.append(problem)

    def table(self, spot: Spot) -> dict[str, Any] | None:
        """Return the table at a place, empty if there is none; note it if something else is there."""
        value = value_at(self.source.values, spot.path)
        if value is None or isinstance(value, dict):
            return value or {}
        self.problem(spot, f"must be a table, written as {spot.where}", value=value)
        return None

    def unknown_keys(self, spot: Spot, values: Mapping[str, Any], allowed: Iterable[str]) -> None:
        names = list(allowed)
        for key in values:
            if key not in names:
                near = nearest(key, names)
                self.problem(spot.at(key), "unknown key", near=near, allowed=f"allowed: {listed(names)}")

    def choice(self, kind: str, block: RawTable) -> Choice | None:
        """Return the component that `use` names, with its parameters checked."""
        component = self.component(kind, block)
        if component is None:
            return None
        try:
            parameters = self.parameters(component.Parameters, block.without_use())
        except (Exception, SystemExit) as error:  # a stranger's validator may raise anything
            wrong = f"{self.registry.package_of(component)} failed: {type(error).__name__}: {error}"
            self.problem(block.last, wrong, of_plugin=True)
            return None
        return Choice(component, parameters) if parameters else None

    def component(self, kind: str, block: RawTable) -> type[Component] | None:
        """Return the component that `use` names; an unknown name is a plugin's fault if one is broken."""
        use = block.written.get("use")
        installed = f"installed: {listed(self.registry.names(kind))}"
        if use is None:
            self.problem(block.first.at("use"), f"missing: no {kind} is chosen yet", allowed=installed)
            return None
        if not isinstance(use.value, str):
            self.problem(use.spot, "must be a name in quotes", value=use.value, allowed=installed)
            return None
        try:
            return self.registry.get(kind, use.value)
        except PluginError as error:
            self.problem(use.spot, str(error), value=use.value, of_plugin=bool(self.registry.broken))
            return None

    def reference(self, spot: Spot, name: str) -> None:
        """Note a name of published figures that is not registered."""
        try:
            self.registry.get("reference", name)
        except PluginError as error:
            self.problem(spot, str(error), value=name, of_plugin=bool(self.registry.broken))

    def parameters(self, model: type[P], table: RawTable) -> P | None:
        """Return checked parameters; note each problem where its value was written."""
        values = {key: written.value for key, written in table.written.items()}
        given = dict(values)
        if "path" in model.model_fields and isinstance(values.get("path"), str):
            given["path"] = self.resolved(table.written["path"])
        try:
            # as JSON: a strict model takes its lists for tuples, and its texts for paths and dates
            return model.model_validate_json(json.dumps(given, default=str))
        except ValidationError as error:
            if default := refused_default(error, given):
                raise ValueError(f"its own default of '{default}' is not one that it allows") from None
            for keys, value, wrong, near, allowed in sentences(error, model, values):
                # what is wrong with a block as a whole is said once, not again after each change
                if keys or (table.first, wrong) not in self.said:
                    self.problem(table.place(keys), wrong, value=value, near=near, allowed=allowed)
                self.said.add((table.first, wrong))
        return None

    def resolved(self, path: Written) -> str:
        """Return a path relative to the study file's folder as an absolute one; note it if there is no file.

        What begins with `$WAXSTUDY_DATA/` lies in the folder that this variable of the environment names.
        """
        below = path.value.removeprefix(f"${DATA}/")
        if below == path.value:
            full = self.source.folder / path.value
        elif data := os.environ.get(DATA):
            full = Path(data).absolute() / below
        else:
            if self.needs_files:
                self.problem(path.spot, f"{DATA} is not set: it names the folder of the data", value=path.value)
            return str(path.value)
        if self.needs_files and (wrong := lacking(full)):
            self.problem(path.spot, wrong, value=path.value, allowed=f"looked for {full}")
        return str(full)
