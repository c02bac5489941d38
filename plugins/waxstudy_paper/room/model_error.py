"""How far rooms `nzeb` and `surfaces` are off by their form: they are the same model, told in other words."""

from __future__ import annotations

from waxstudy.plugin import ModelError

TYPICAL = "seen against rooms of another engine without any effect"
TWICE = f"{TYPICAL}; at most: twice what was seen (air 0.09 K, floor surface 0.08 K)"
# the first minutes of each pulse are others in each engine
HALF_MORE = f"{TYPICAL}; at most: half as much again as was seen, 0.35 K"
MODEL_ERRORS = {
    "air_C": ModelError(0.07, 0.18, TWICE),
    "operative_C": ModelError(0.07, 0.18, TWICE),
    "floor_surface_C": ModelError(0.08, 0.16, TWICE),
    "return_C": ModelError(0.15, 0.5, HALF_MORE),
}
