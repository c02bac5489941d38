"""Drawing a case: what is put into a record, and how it is measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from waxstudy.blind_test.key import Key
from waxstudy.blind_test.plan import Slot, causes_of
from waxstudy.dataset.channels import CHANNELS, LIGHT
from waxstudy.plugin.trial import Cause, Engine, Scene, engine_of
from waxstudy.synthetic.instruments import Instruments

NO_SUN = "no sun or gains"
# channel set -> what it lacks; a return says nothing without flow
CHANNEL_SETS: Mapping[str, tuple[str, ...]] = {
    "all": (),
    "no displacement": ("displacement",),
    "no flow": ("flow_L_h", "return_temperature_C"),
    "no signal": ("control_output", "heating_signal"),
    "temperatures only": ("control_output", "heating_signal", "displacement", "flow_L_h", "return_temperature_C"),
}
# of a house as it was built: channel set -> how often
BUILT_SETS: Mapping[str, float] = {"all": 0.7, "no displacement": 0.15, NO_SUN: 0.15}
# from the second draw on: what drives a room is often not recorded, or by light on level ground
LIT = "sun as irradiance"
SUN, GAINS = SUNLESS = ("solar_gain_W", "internal_gain_W")
LATER_SETS: Mapping[str, tuple[str, ...]] = {
    **CHANNEL_SETS,
    "no sun": (SUN,),
    "no gains": (GAINS,),
    NO_SUN: SUNLESS,
    LIT: (SUN,),
}
LATER_BUILT_SETS: Mapping[str, float] = {
    "all": 0.6, "no displacement": 0.1, "no sun": 0.1, "no gains": 0.1, NO_SUN: 0.1,
}  # fmt: skip
BUILT_INTERVALS_S = {60.0: 0.6, 120.0: 0.2, 300.0: 0.2}
BUILT_DAYS = (7, 13)
INTERVALS_S = {10.0: 0.1, 30.0: 0.15, 60.0: 0.4, 120.0: 0.15, 300.0: 0.12, 900.0: 0.08}  # -> how often
NOISE = (0.5, 4.0)  # factor on the nominal noise, log-uniform
MISSING = (0.0, 0.0, 0.003, 0.02)
PATIENCE = 8  # attempts after which a record is measured in another way: its sampling may hide what it must show


@dataclass(frozen=True)
class Measured:
    """How a record is measured, in JSON's words."""

    channels: str  # of LATER_SETS
    interval_s: float
    days: int
    noise_factor: float
    missing: float
    seed: int

    def with_drives(self) -> Measured:
        """Return the same with sun and gains: they drove the room whether somebody recorded them or not."""
        lacks_drives_only = set(LATER_SETS[self.channels]) <= set(SUNLESS)
        return replace(self, channels="all") if lacks_drives_only else self

    def instruments(self, noise: bool = True) -> Instruments:
        """Return the instruments, or with no noise at all."""
        factor = self.noise_factor if noise else 0.0
        return Instruments(
            interval_s=self.interval_s,
            without=(*LATER_SETS[self.channels], *(() if self.channels == LIT else LIGHT)),
            noise={name: factor * channel.noise for name, channel in CHANNELS.items()},
            resolution={} if noise else dict.fromkeys(CHANNELS, 0.0),
            missing=self.missing if noise else 0.0,
            seed=self.seed,
        )


@dataclass(frozen=True)
class Case:
    """A record that was drawn; `scene["causes"]` is its truth. `baseline` is how the healthy one before is measured."""

    name: str
    stratum: str
    kind: str
    engine: str
    attempt: int
    measured: Measured
    scene: Scene
    baseline: Measured | None = None

    def described(self) -> dict[str, Any]:
        return {name: value for name, value in asdict(self).items() if name != "baseline" or value}

    @property
    def causes(self) -> list[Cause]:
        """The causes in the scene."""
        known = {cause.name: cause for cause in engine_of(self.engine).causes()}
        return [known[each["name"]] for each in self.scene["causes"]]


def drawn(key: Key, slot: Slot, index: int, attempt: int, is_judged: bool) -> Case:
    """Return a case, always the same of the same key; raise `Unmakeable`.

    How it is measured, and all of the scene but its causes, is drawn alike whether there are causes or not. Where the
    scene must be drawn again, for a larger gap, the record stays as it is measured, for a while.
    """
    if slot.has_baseline:
        return _drawn_pair(key, slot, index, attempt, is_judged)
    random, engine = key.random("scene", index, attempt), engine_of(slot.engine)
    measured = _measured(key.random("measured", index, attempt // PATIENCE), slot, engine)
    names = _names(random, slot, causes_of(engine, slot.kind, is_judged))
    scene = engine.draw(random, names, measured.days)
    if slot.kind == "null":
        scene = {**scene, "causes": []}
    return Case(key.record_name(index), slot.stratum, slot.kind, slot.engine, attempt, measured, scene)


def _drawn_pair(key: Key, slot: Slot, index: int, attempt: int, is_judged: bool) -> Case:
    """Return a case of a house as it was built, with a healthy record of it from before."""
    random, engine = key.random("scene", index, attempt), engine_of(slot.engine)
    measured = _measured_built(key.random("measured", index, attempt // PATIENCE), slot)
    scene = engine.draw_built(random, _names(random, slot, causes_of(engine, slot.kind, is_judged)), measured.days)
    if slot.kind == "null":
        scene = {**scene, "causes": []}
    before = engine.baseline_of(scene)
    assert before
    seed = int(key.random("baseline", index, attempt).integers(2**31))
    baseline = replace(measured, days=before["days"], seed=seed)
    name = key.record_name(index)
    return Case(name, slot.stratum, slot.kind, slot.engine, attempt, measured, scene, baseline)


def _measured_built(random: np.random.Generator, slot: Slot) -> Measured:
    sets = BUILT_SETS if slot.draw == 1 else LATER_BUILT_SETS
    channels = str(random.choice(list(sets), p=list(sets.values())))
    interval_s = float(random.choice(list(BUILT_INTERVALS_S), p=list(BUILT_INTERVALS_S.values())))
    days = int(random.integers(BUILT_DAYS[0], BUILT_DAYS[1] + 1))
    return Measured(channels, interval_s, days, 1.0, float(random.choice(MISSING)), int(random.integers(2**31)))


def _measured(random: np.random.Generator, slot: Slot, engine: type[Engine]) -> Measured:
    interval_s = engine.interval_s or float(random.choice(list(INTERVALS_S), p=list(INTERVALS_S.values())))
    days = int(random.integers(engine.days[0], engine.days[1] + 1))
    channels = str(random.choice(list(CHANNEL_SETS if slot.draw == 1 else LATER_SETS)))
    factor = round(float(np.exp(random.uniform(*np.log(NOISE)))), 2)
    missing, seed = float(random.choice(MISSING)), int(random.integers(2**31))
    if not slot.is_free:
        channels, factor = "all", 1.0
    if engine.is_measured:
        missing = 0.0
    if channels == LIT:  # the sun of other engines has no place and date from which light would tell it
        channels, days = (LIT, min(days, engine.lit_days)) if engine.lit_days else ("no sun", days)
    return Measured(channels, interval_s, days, factor, missing, seed)


def _names(random: np.random.Generator, slot: Slot, known: Sequence[str]) -> list[str]:
    count = 2 if slot.kind == "pair" else 1
    if slot.cause:
        return [slot.cause]
    return [str(name) for name in random.choice(known, size=count, replace=False)]
