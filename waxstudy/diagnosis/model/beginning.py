"""The state that a controller is in when a record begins: nobody recorded it, but its first output tells."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
from scipy.optimize import brentq

from waxstudy.plugin import CHAIN, Choice, FloatArray
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.replay import replay

BEGINS_S = 3600.0  # chosen: of the output, whose mean noise of a reading hardly moves
REACH = 100.0  # chosen: beyond what any output of 0 to 1 asks of a state
CLOSE = 1e-4  # chosen: of such a state


def begun(
    blocks: Mapping[str, Choice],
    first: str,
    signal: FloatArray,
    setpoint_C: FloatArray,
    output: FloatArray,
    interval_s: float,
    start_s: float,
    step_s: float,
) -> Mapping[str, Mapping[str, float]]:
    """Return the number of a controller's state, by kind and name, with which its first hour is what was recorded.

    An integral is such a number: driven by a recorded reading, an error of it lasts until the output is at an end.
    Nothing where no number of the state moves the output, or where that (n,) tells none, as at an end.
    """
    count = max(2, round(BEGINS_S / interval_s))
    seen = output[:count]
    tells = (seen > 0.0) & (seen < 1.0)  # false for NaN
    if not tells.any():
        return {}
    chain = {kind: block for kind, block in blocks.items() if kind in ("sensor", "controller")}

    def missed(name: str, value: float) -> float:
        ready = Chain(chain, step_s, {"controller": {name: value}})
        drive = signal[:count], setpoint_C[:count]
        ends, _ = replay(ready, first, *drive, interval_s=interval_s, start_s=start_s, last="controller")
        return float(np.mean(ends["controller"][tells] - seen[tells]))

    for name, value in _numbers(Chain(chain, step_s)):
        if missed(name, value - REACH) * missed(name, value + REACH) < 0.0:
            found = brentq(lambda each, name=name: missed(name, each), value - REACH, value + REACH, xtol=CLOSE)
            return {"controller": {name: float(found)}}
    return {}


def _numbers(chain: Chain) -> list[tuple[str, float]]:
    """Return the numbers of a controller's state as it starts."""
    state = chain.start()[CHAIN.index("controller")]
    values = [(field.name, getattr(state, field.name)) for field in dataclasses.fields(state)]
    return [(name, value) for name, value in values if type(value) is float]
