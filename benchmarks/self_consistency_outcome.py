"""One record of `benchmarks.self_consistency`: made, diagnosed, and held against what is true of it."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.self_consistency_records import Made, study
from waxstudy.blind_test.sizes.record import Record
from waxstudy.blind_test.sizes.refit import Refit
from waxstudy.blind_test.truth import Stand, cut_of_effect, library
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.diagnosis.diagnose import diagnose
from waxstudy.diagnosis.result import Diagnosis
from waxstudy.plugin import Choice, Effect
from waxstudy.plugin.trial import Cause
from waxstudy.synthetic.effects import with_effects
from waxstudy.synthetic.instruments import Instruments
from waxstudy.synthetic.write import Telling, write

NOTHING = dict.fromkeys(CHANNELS, 0.0)


def outcome(made: Made) -> dict[str, Any]:
    """Return what is true of a record and what the diagnosis says of it."""
    seen, free = datasets(made)
    begin = time.perf_counter()
    diagnosis = diagnose(seen)
    told = {
        "name": made.name,
        "case": made.case,
        "effect": made.effect,
        "severity": made.severity,
        "true": dict(made.values),
        "verdict": diagnosis.verdict,
        "found": [found_as_told(found.name, diagnosis) for found in diagnosis.effects],
        "unexplained": [u.stage for u in diagnosis.unexplained if u.is_finding],
        "seconds": time.perf_counter() - begin,
    }
    return told | (judged(made, seen, free, diagnosis) if made.effect else {})


def found_as_told(name: str, diagnosis: Diagnosis) -> dict[str, Any]:
    found = next(each for each in diagnosis.effects if each.name == name)
    parameters = {key: [each.value, each.low, each.high] for key, each in found.parameters.items()}
    return {"name": name, "group": list(found.group), "parameters": parameters}


def datasets(made: Made) -> tuple[Dataset, Dataset]:
    """Return a reality as instruments show it, and without noise."""
    ours, weeks, setpoint_C = study(), list(made.weeks), study().comfort.setpoint_C + made.shift_K
    case, reality = with_effects(ours, ours.cases[made.case], weeks, None, setpoint_C, made.effects)
    telling = Telling(ours, case, ours.cases[made.case], weeks, setpoint_C, made.effects)
    with tempfile.TemporaryDirectory() as place:
        for name, instruments in (
            ("seen", Instruments(seed=made.seed)),
            ("free", Instruments(noise=NOTHING, resolution=NOTHING)),
        ):
            write(Path(place) / name, telling, reality, instruments)
        return read_dataset(Path(place) / "seen"), read_dataset(Path(place) / "free")


def judged(made: Made, seen: Dataset, free: Dataset, diagnosis: Diagnosis) -> dict[str, Any]:
    """Return the size of the true gap, and whether the diagnosis is right.

    Right is one effect or group: it holds the true one, and no other that the record without noise tells from it.
    """
    size = Size.of(made.effects, seen, free)
    groups = [found.group for found in diagnosis.effects]
    others = [name for group in groups for name in group if name != made.effect]
    told_apart = [name for name in others if size.tells_apart(name)]
    right = len(groups) == 1 and made.effect in groups[0] and not told_apart
    told = {"channel": size.channel, "gap": size.gap, "floor": size.floor, "beyond": size.beyond}
    return told | {"told_apart": told_apart, "right": right}


@dataclass(frozen=True)
class Size:
    """A true gap beside its noise floor, of the channel where it stands out most.

    The gap is what the belief misses of the record without noise, driven by it; the floor what the truth itself misses
    of the noisy record, driven by that. Both at the segment where the effect acts, the first six hours left out.
    """

    channel: str
    gap: float
    floor: float
    refit: Refit

    @classmethod
    def of(cls, effects: Sequence[Choice], seen: Dataset, free: Dataset) -> Size:
        noisy = Record.of(seen.values, seen, is_noisy=True)
        stand = Stand(free, Record.of(free.values, free), [noisy])
        effect = effects[0].component
        assert issubclass(effect, Effect)
        stretch = stand.stretch_of(Cause(effect.name, (effect.stage,)))
        assert stretch
        cut = cut_of_effect(stand, stretch, effects, effects[1:])
        channel = max(cut.gaps, key=lambda name: cut.gaps[name] / cut.floors[name])
        return cls(channel, cut.gaps[channel], cut.floors[channel], stand.refit(stretch, stand.free, (), cut.floors))

    @property
    def beyond(self) -> float:
        """Largest gap over its floor once what nobody knows of the room is fitted; at other segments nothing is."""
        return self.refit.beyond

    def tells_apart(self, name: str) -> bool:
        """Whether an effect, fitted to the record without noise, leaves more of some channel than noise would."""
        effect = next((each for each in library() if each.name == name), None)
        return effect is None or effect.stage not in self.refit.stretch.stages or not self.refit.is_alike(effect)
