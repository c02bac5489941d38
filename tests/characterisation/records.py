"""The records of the characterisation set: every engine, every channel set, drawn once and for all from a fixed key."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from waxstudy.blind_test.draw import CHANNEL_SETS, PATIENCE, Case, _measured, _names
from waxstudy.blind_test.key import Key
from waxstudy.blind_test.plan import Kind, Slot, causes_of
from waxstudy.blind_test.record import write_record
from waxstudy.plugin.trial import Unmakeable, engine_of

KEY = Key.read("20-" + 32 * "c")
ENGINES = ("fast-room", "energyplus-room", "other-plant", "thin-floor-plant")
HOUSE = "measured-house"
LATER = ("extra-heat",)  # effects that are younger than the set: its records stay as they are
# kinds beside two single effects, by channel set
BESIDE: dict[str, tuple[Kind, ...]] = {
    "all": ("null", "pair", "family"),
    "no signal": ("family",),
    "temperatures only": ("null",),
}
SUN, GAINS = "solar_gain_W", "internal_gain_W"
# records of a room that something drives which nobody recorded
UNRECORDED: tuple[tuple[str, Kind, tuple[str, ...]], ...] = (
    ("fast-room", "null", (SUN,)),
    ("fast-room", "null", (GAINS,)),
    ("fast-room", "null", (SUN, GAINS)),
    ("fast-room", "single", (SUN, GAINS)),
    ("thin-floor-plant", "null", (SUN, GAINS)),
)
ATTEMPTS = 40
# short records at usual intervals, as all of them are diagnosed again and again; the shortest with days held out
DAYS, LEAST_INTERVAL_S = 6, 60.0


@dataclass(frozen=True)
class Recipe:
    """One record of the set; `number` makes its draws its own."""

    number: int
    engine: str
    kind: Kind
    channels: str
    cause: str = ""
    lacks: tuple[str, ...] = ()  # channels that the channel set has, and nobody recorded

    @property
    def is_quick(self) -> bool:
        """Whether a quick look must do: three of four, so that the whole set takes minutes."""
        return self.number % 4 != 0

    @property
    def name(self) -> str:
        lacks = f" without {' '.join(self.lacks)}" if self.lacks else ""
        return "-".join(f"{self.number:02d} {self.engine} {self.kind} {self.channels}{lacks}".split())


def recipes() -> list[Recipe]:
    """Return the recipes; effects take turns, so that most of the library is in the set."""
    found = [(engine, *each) for engine in ENGINES for each in _of_engine(engine)]
    house = _known(HOUSE, "single")
    found += [(HOUSE, kind, "all", cause) for kind, cause in (("null", ""), *(("single", name) for name in house[:3]))]
    found.append((HOUSE, "family", "all", ""))
    found += [(engine, kind, "all", "", lacks) for engine, kind, lacks in UNRECORDED]
    return [Recipe(number, *each) for number, each in enumerate(found)]


def _of_engine(engine: str) -> Iterator[tuple[Kind, str, str]]:
    effects = _known(engine, "single")
    turn = 5 * ENGINES.index(engine)  # engines begin at other effects
    for channels in CHANNEL_SETS:
        for _ in range(2):
            yield "single", channels, effects[turn % len(effects)]
            turn += 3 if len(effects) % 3 else 2
        for kind in BESIDE.get(channels, ()):
            yield kind, channels, ""


def made(recipe: Recipe, folder: Path) -> dict[str, Any]:
    """Write the record of a recipe; return what was drawn. Raises `Unmakeable`."""
    slot = Slot("characterisation", recipe.engine, recipe.kind, recipe.cause, is_free=True)
    reason = ""
    for attempt in range(ATTEMPTS):
        try:
            case = _case(recipe, slot, attempt)
            staged = engine_of(recipe.engine).make(case.scene)
            kept = {name: values for name, values in staged.channels.items() if name not in recipe.lacks}
            write_record(folder, replace(staged, channels=kept), case.measured)
        except Unmakeable as error:
            reason = str(error)
            continue
        return {"measured": asdict(case.measured), "causes": case.scene["causes"]}
    raise Unmakeable(f"{recipe.name}: {reason}")


def _case(recipe: Recipe, slot: Slot, attempt: int) -> Case:
    """Return what `blind_test.draw.drawn` would have drawn when the set was made."""
    random, engine = KEY.random("scene", recipe.number, attempt), engine_of(recipe.engine)
    measured = _measured(KEY.random("measured", recipe.number, attempt // PATIENCE), slot, engine)
    scene = engine.draw(random, _names(random, slot, _known(recipe.engine, recipe.kind)), measured.days)
    if recipe.kind == "null":
        scene = {**scene, "causes": []}
    if not engine.is_measured:
        days, interval_s = min(DAYS, measured.days), max(LEAST_INTERVAL_S, measured.interval_s)
        measured = replace(measured, channels=recipe.channels, days=days, interval_s=interval_s)
        scene = {**scene, "days": days}
    return Case(recipe.name, slot.stratum, recipe.kind, recipe.engine, attempt, measured, scene)


def _known(engine: str, kind: Kind) -> list[str]:
    return [name for name in causes_of(engine_of(engine), kind, is_judged=True) if name not in LATER]
