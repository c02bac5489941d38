"""What EnergyPlus says of its errors."""

from __future__ import annotations

import contextlib
from pathlib import Path

from waxstudy.simulation.own_process import PRINTED

ERROR_LINES = 40
HARMLESS = "CheckWarmupConvergence"  # the engine's own warm-up is cut short on purpose


def error_file(folder: Path) -> str:
    """Return what the engine's error file says from its first severe line on, or else what was printed."""
    for name, first in (("eplusout.err", "** Severe"), ("eplusout.err", "**  Fatal"), (PRINTED, "")):
        with contextlib.suppress(OSError):
            lines = (folder / name).read_text(encoding="utf-8", errors="replace").splitlines()
            found = [n for n, line in enumerate(lines) if first in line and HARMLESS not in line]
            if found:
                shown = lines[found[0] : found[0] + ERROR_LINES]
                return "\n".join([f"; {name}:", *(f"  {line.strip()}" for line in shown)])
    return ""
