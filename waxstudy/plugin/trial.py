"""The contract of an engine: where the records of a blind test come from.

No study file can name an engine, so it is none of the registry's kinds, which are what a study is made of; it has
an entry-point group of its own, `waxstudy.engines`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import entry_points
from typing import Any, ClassVar

import numpy as np

from waxstudy.plugin.contracts import Choice, FloatArray
from waxstudy.plugin.registry import PluginError, hint, told

GROUP = "waxstudy.engines"
Scene = dict[str, Any]  # plain JSON: all that an engine needs to make a record once more


class Unmakeable(ValueError):
    """A scene that cannot be had from this engine; another one is drawn in its place."""


@dataclass(frozen=True)
class Cause:
    """Something that an engine can put into a record and that the modeller does not believe in.

    `name` is that of an effect of the library, or of a family that none of its effects describes. An answer may place
    it at one of `stages`, its own first. One that is kept is drawn in judged runs only.
    """

    name: str
    stages: tuple[str, ...]
    is_family: bool = False
    is_kept: bool = False
    about: str = ""


@dataclass(frozen=True)
class Staged:
    """What happened in a scene, free of noise: `Channel.source` -> values at the end of every step.

    `described` holds the tables of dataset.toml that say what is believed: nominal, and room or building. `effects`
    has each cause as an edit of that belief, where it is one, and None where it is not; then `without` has the channels
    that would show another value had the cause not been there and everything before it been the same. `departures`
    say by how much the true room strays from the believed one, as its `uncertainties` take it, and the heat of a
    channel, as the logarithm of a factor, where the engine is the believed model but for them.
    """

    channels: Mapping[str, FloatArray]
    step_s: float
    first_day: str
    described: Mapping[str, Any]
    effects: Sequence[Choice | None] = ()
    without: Sequence[Mapping[str, FloatArray]] = ()
    inputs: tuple[str, ...] = ("solar_gain_W", "internal_gain_W")  # channels that are assumed
    # of each cause the hours since the record began in which it acts; all of them where nothing is said
    when: Sequence[Sequence[tuple[float, float]] | None] = ()
    departures: Mapping[str, float] = field(default_factory=dict)
    is_measured: bool = False  # the noise is in it already, and nobody has stated it
    about: Mapping[str, Any] = field(default_factory=dict)  # whatever the truth should tell besides


class Engine:
    """Draws scenes and makes records of them.

    `departs` names the stages where what is believed differs in form from what the engine does, whatever is put in. One
    that is kept takes part in judged runs only. A record that was measured is shown as it is: `is_measured`; then its
    interval is `interval_s`. `days` are the fewest and the most that a record can have, `lit_days` the most of one that
    shows light on level ground (`global_W_m2`) and [site] in place of the sun's heat, 0 where none can. One that
    `has_baselines` can also draw a house that was not built as it is believed, with a healthy record of it from before.
    """

    name: ClassVar[str]
    is_kept: ClassVar[bool] = False
    is_measured: ClassVar[bool] = False
    has_baselines: ClassVar[bool] = False
    interval_s: ClassVar[float | None] = None
    days: ClassVar[tuple[int, int]] = (3, 14)
    lit_days: ClassVar[int] = 0
    departs: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def hindrance(cls) -> str:
        """Return why no record can be had of it here, or an empty text."""
        return ""

    @classmethod
    def causes(cls) -> Sequence[Cause]:
        """Return what can be put in."""
        raise NotImplementedError

    @classmethod
    def draw(cls, random: np.random.Generator, names: Sequence[str], days: int) -> Scene:
        """Return a scene of some days with these causes, severities log-uniform from below to far above the noise.

        `scene["causes"]` lists them: `name`, and `values` in the engine's own terms, the effect's where it has it so.
        What else is drawn does not depend on them but for what they apply to: without them the scene is a null.
        Raises `Unmakeable`.
        """
        raise NotImplementedError

    @classmethod
    def draw_built(cls, random: np.random.Generator, names: Sequence[str], days: int) -> Scene:
        """Return a scene as `draw` does, of a house as it was built: `scene["as_built"]` says how it differs.

        That is so whatever the causes are, and of its baseline as well; it is nobody's effect.
        """
        raise NotImplementedError

    @classmethod
    def baseline_of(cls, scene: Mapping[str, Any]) -> Scene | None:
        """Return the scene of the same house when it was healthy, on other days before, None where there is none."""
        return None

    @classmethod
    def make(cls, scene: Mapping[str, Any]) -> Staged:
        """Return what happens in a scene, the same for the same scene; raise `Unmakeable`."""
        raise NotImplementedError


@cache
def installed_engines() -> tuple[dict[str, type[Engine]], dict[str, str]]:
    """Return the engines that can be used, and the others with the reason, by name."""
    found: dict[str, type[Engine]] = {}
    broken: dict[str, str] = {}
    for point in sorted(entry_points(group=GROUP), key=lambda each: each.name):
        try:
            with told():
                engine = point.load()
        except PluginError as error:
            broken[point.name] = str(error)
            continue
        if not (isinstance(engine, type) and issubclass(engine, Engine)):
            broken[point.name] = f"it is {engine!r:.60}, no class derived from Engine"
        elif found.setdefault(engine.name, engine) is not engine:
            broken[engine.name] = "two engines have this name: uninstall one of their packages"
    return {name: engine for name, engine in found.items() if name not in broken}, broken


def engines() -> Mapping[str, type[Engine]]:
    """Return the installed engines by name, but for those that cannot be loaded."""
    return installed_engines()[0]


def broken_engines() -> Mapping[str, str]:
    """Return the engines that cannot be loaded, with the reason."""
    return installed_engines()[1]


def engine_of(name: str) -> type[Engine]:
    """Return an engine; raise `PluginError` naming the nearest one and what is installed."""
    known, broken = installed_engines()
    if name in broken:
        raise PluginError(f"engine '{name}' is broken: {broken[name]}")
    if name not in known:
        raise PluginError(f"no engine '{name}'{hint(name, known)} (installed: {', '.join(known) or 'none'})")
    return known[name]


# --- baselines: simple diagnosers to compare with, of the entry-point group `waxstudy.baselines` ---

BASELINES = "waxstudy.baselines"


def baseline_names() -> list[str]:
    return sorted({point.name for point in entry_points(group=BASELINES)})


def baseline_of(name: str) -> Callable[[Any], dict[str, Any]]:
    """Return a baseline: dataset -> a diagnosis' JSON (the keys of `waxstudy diagnose --json`); raise `PluginError`."""
    points = {point.value: point for point in entry_points(group=BASELINES, name=name)}
    if not points:
        raise PluginError(f"no baseline '{name}' (installed: {', '.join(baseline_names()) or 'none'})")
    if len(points) > 1:
        raise PluginError(f"two baselines are called '{name}', {' and '.join(points)}: uninstall one of their packages")
    with told(f"baseline '{name}'"):
        found: Callable[[Any], dict[str, Any]] = next(iter(points.values())).load()
    return found
