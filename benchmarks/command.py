"""Time and peak memory of a whole command."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

WAXSTUDY = Path(sys.executable).with_name("waxstudy")
# a small process of its own: a child's peak memory starts with that of the process that forks it
MEASURE = """
import os, subprocess, sys, time
begin = time.perf_counter()
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(child.pid, 0)
used = usage.ru_utime + usage.ru_stime
print(time.perf_counter() - begin, used, usage.ru_maxrss * 1024 / 1e6, os.waitstatus_to_exitcode(status))
"""


def command_figure(label: str, arguments: list[str], limit: str, environment: dict[str, str] | None = None) -> float:
    """Print the time of a command, by the clock and of processor, with its peak memory; return that by the clock."""
    measured = subprocess.run(
        [sys.executable, "-S", "-c", MEASURE, str(WAXSTUDY), *arguments],
        env={**os.environ, **(environment or {})},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    seconds, used_s, megabytes, code = map(float, measured.stdout.split())
    print(f"{label:40} {seconds:6.2f} s  {used_s:9.2f} s  {megabytes:5.0f} MB  exit {code:.0f}  {limit}", flush=True)
    return seconds
