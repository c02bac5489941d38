"""A fitted model beside its records: displacement modelled from the signal, and its errors (Table A1)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.identification.records import BoolArray, Record
from waxstudy.plugin import Choice, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.replay import replay

ACTUATOR = "variable-times"  # whose coefficients are fitted
LONGEST_STEP_S = 1.0


@dataclass(frozen=True)
class Errors:
    """Of a record's opening, over the stroke."""

    mae: float
    rmse: float


def block(kind: str, values: Mapping[str, Any]) -> Choice:
    """Return the block of a fragment's table; raises `ValueError` and `PluginError`."""
    rest = {key: value for key, value in values.items() if key != "use"}
    return Choice.of(installed().get(kind, str(values.get("use"))), rest)


def modelled(actuator: Choice, on: BoolArray, interval_s: float, pace: float = 1.0) -> tuple[FloatArray, FloatArray]:
    """Return the opening at each sample, and its mean over the interval before.

    A switch lies in the middle between two samples. The motor starts closed, after a long pause. A `pace` above 1 makes
    all of its times longer by that factor: its own time is slower.
    """
    own_s = interval_s / pace
    parts = 2 * int(np.ceil(0.5 * own_s / LONGEST_STEP_S))
    chain, still = Chain({"actuator": actuator}, own_s / parts), np.zeros(len(on))
    ends, means = replay(chain, "actuator", on.astype(float), still, interval_s=own_s, start_s=0.0, jump=still + 0.5)
    return ends["actuator"], means["actuator"]


def errors_of(record: Record, opening: FloatArray) -> Errors:
    """Return the errors where the record has no gap."""
    wrong = (opening - record.opening)[~record.missing]
    return Errors(float(np.mean(np.abs(wrong))), float(np.sqrt(np.mean(wrong**2))))
