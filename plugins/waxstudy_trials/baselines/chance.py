"""Chance: an effect that applies, or none, whatever was recorded."""

from __future__ import annotations

from zlib import crc32

import numpy as np

from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import installed_effects
from waxstudy_trials.baselines import Json, answer, taken

NONE = 0.3  # how often it says that there is nothing


def diagnose(dataset: Dataset) -> Json:
    """Return an effect that is drawn, by nothing but what the record's values come to."""
    _, belief = taken(dataset)
    random = np.random.default_rng(crc32(dataset.values.to_numpy(dtype=float).tobytes()))
    fitting = [effect for effect in installed_effects() if not effect.hindrance(belief)]
    if random.random() < NONE or not fitting:
        return answer(dataset, [])
    return answer(dataset, [(fitting[int(random.integers(len(fitting)))], {})])
