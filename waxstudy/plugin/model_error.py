"""How far the model of a room is off by its form alone, and what is assumed of a room that does not say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any


@dataclass(frozen=True)
class ModelError:
    """What the form of a room's model misses of an output where nothing is amiss, in means over quarters of an hour.

    `typical_K`, a standard deviation, is what a diagnosis weighs errors by; up to `most_K`, a root mean square over a
    record, nothing is found. `source` tells what both were seen against.
    """

    typical_K: float
    most_K: float
    source: str

    def times(self, factor: float) -> ModelError:
        return replace(self, typical_K=factor * self.typical_K, most_K=factor * self.most_K)


DOUBLED = "twice what room 'nzeb' leaves, as nobody has said what this one was held against"
# the outputs that a diagnosis judges, and what is assumed of each where the room states nothing
ASSUMED: Mapping[str, ModelError] = {
    "air_C": ModelError(0.14, 0.36, DOUBLED),
    "operative_C": ModelError(0.14, 0.36, DOUBLED),
    "floor_surface_C": ModelError(0.16, 0.32, DOUBLED),
    "return_C": ModelError(0.30, 1.0, DOUBLED),
}


@lru_cache(maxsize=256)
def model_errors(room: Any) -> Mapping[str, ModelError]:
    """Return the error of the model of a room, a `Choice`, by output: as stated, and as assumed of the others."""
    return {**ASSUMED, **room.component.model_errors(room.parameters)}
