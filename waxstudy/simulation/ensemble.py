"""Initial states of an ensemble: drawn once per member and shared by all cases, so that cases compare in pairs.

They are drawn before the warm-up, wide enough to reach every cycle that repeated weather pulls the loop into.
"""

from __future__ import annotations

import numpy as np

from waxstudy.simulation.engine import Start
from waxstudy.study.model import Ensemble

AIR_SPREAD_K = 1.0
SLAB_SPREAD_K = 2.0


def starts(ensemble: Ensemble) -> list[Start]:
    """Return one start per member, uniform in air and slab temperature; a single member is not displaced."""
    if ensemble.members == 1:
        return [Start(0.0, 0.0)]
    random = np.random.default_rng(ensemble.seed)
    draws = random.uniform(-1.0, 1.0, size=(ensemble.members, 2))
    return [Start(AIR_SPREAD_K * float(air), SLAB_SPREAD_K * float(slab)) for air, slab in draws]
