"""What a whole command takes of wall time, processors and memory."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

WAXSTUDY = Path(sys.executable).with_name("waxstudy")
HEADINGS = f"{'':40} {'wall':>8} {'processor':>9} {'peak':>8}"
# a small process of its own: a child's peak memory starts with that of the process that forks it
MEASURE = """
import os, subprocess, sys, time
begin = time.perf_counter()
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(child.pid, 0)
processor = usage.ru_utime + usage.ru_stime
print(time.perf_counter() - begin, processor, usage.ru_maxrss * 1024 / 1e6, os.waitstatus_to_exitcode(status))
"""


class Cost(NamedTuple):
    """What a command took; what others do on the machine meanwhile is no part of the processors' time."""

    wall_s: float
    processor_s: float
    peak_MB: float
    code: float

    def beside(self, other: Cost) -> str:
        """Return its time of processors and its memory as multiples of another command's."""
        time, memory = self.processor_s / other.processor_s, self.peak_MB / other.peak_MB
        return f"{time:.2f} times its time, {memory:.2f} its memory"


def command_figure(label: str, arguments: list[str], limit: str, environment: dict[str, str] | None = None) -> Cost:
    """Print and return what a whole command takes."""
    measured = subprocess.run(
        [sys.executable, "-S", "-c", MEASURE, str(WAXSTUDY), *arguments],
        env={**os.environ, **(environment or {})},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    cost = Cost(*map(float, measured.stdout.split()))
    figures = f"{cost.wall_s:6.2f} s {cost.processor_s:7.2f} s {cost.peak_MB:5.0f} MB"
    print(f"{label:40} {figures}  exit {cost.code:.0f}  {limit}", flush=True)
    return cost
