"""What drives the valve in these tests; EnergyPlus' process imports them from here."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path

Values = tuple[float, float, float, float]


def full(sensed_C: float, time_s: float, step_s: float) -> Values:
    return 1.0, 1.0, 1.0, 1.0


def closed(sensed_C: float, time_s: float, step_s: float) -> Values:
    return 0.0, 0.0, 0.0, 0.0


def divides_by_nothing(sensed_C: float, time_s: float, step_s: float) -> Values:
    return full(sensed_C, 1.0 / (time_s - time_s), step_s)


def dies(sensed_C: float, time_s: float, step_s: float) -> Values:
    os.kill(os.getpid(), signal.SIGKILL)
    return full(sensed_C, time_s, step_s)


@dataclass
class Slow:
    """Leaves its process' number in a file, and then takes its time."""

    path: Path
    ballast: bytes = b""

    def __call__(self, sensed_C: float, time_s: float, step_s: float) -> Values:
        self.path.write_text(str(os.getpid()))
        time.sleep(0.05)
        return full(sensed_C, time_s, step_s)
