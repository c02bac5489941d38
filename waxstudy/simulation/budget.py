"""What a run will take of memory and disk, told before it begins."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

import psutil

from waxstudy.plugin import OutsideRoom
from waxstudy.results.folder import RunError
from waxstudy.results.kpis import DURATION_CHANNELS, SAMPLE_S
from waxstudy.results.run import CaseFolder
from waxstudy.simulation.kernel import TRACE
from waxstudy.simulation.modes import DrivenRoom
from waxstudy.study.model import Study

MOST_WORKERS = 4
# a year at 5 s took 37 MB for each of two workers beyond what a week takes; its traces 37 bytes a row
WORKER_BYTES = 80e6  # what a worker takes whatever the record's length: a part of a trace and what is made of it
ROW_BYTES = 40.0  # of a row of a trace on the disk
SAMPLES = 1.0 + 2.0 / len(DURATION_CHANNELS)  # of a member: each once, one channel's in a row and sorted as well
KEPT_FREE = 0.1  # share of the memory that is left to others


class TooLarge(RunError):
    """A run fits into neither memory nor disk; the message has the figures and what makes it smaller."""


@dataclass(frozen=True)
class Needs:
    """What each worker takes of memory, and all cases together of the disk, in bytes."""

    worker: float
    disk: float

    @classmethod
    def of(cls, study: Study, driven: Mapping[str, DrivenRoom], jobs: Collection[CaseFolder]) -> Needs:
        """Return what the cases that are to be computed will take."""
        is_outside = issubclass(study.room.component, OutsideRoom)
        worker = disk = 0.0
        for job in jobs:
            room = driven[job.week]
            duration_s = room.weather.duration_s
            samples = duration_s / max(SAMPLE_S, room.step_s) * len(DURATION_CHANNELS)
            # another engine gives its record as a whole, and it is checked
            record = 2.0 * duration_s / room.step_s * len(TRACE) if is_outside else 0.0
            worker = max(worker, WORKER_BYTES + 8.0 * (SAMPLES * samples + record))
            disk += ROW_BYTES * duration_s / study.output.trace_interval_s * study.output.trace_members
        return cls(worker, disk)

    def workers(self, memory: float, disk: float, warn: Callable[[str], None]) -> int:
        """Return how many workers fit into this memory; say so if they are fewer than usual. Raises `TooLarge`."""
        if self.disk > disk:
            smaller = "keep traces of fewer members, or at a longer interval ([output])"
            raise TooLarge(f"the traces take about {_GB(self.disk)}, {_GB(disk)} are free on the disk: {smaller}")
        usual, most = min(MOST_WORKERS, os.cpu_count() or 1), memory * (1.0 - KEPT_FREE)
        fit = int(most // self.worker) if self.worker else usual
        if fit < 1:
            smaller = "take a longer step_s or fewer days"
            raise TooLarge(f"one case takes about {_GB(self.worker)} of memory, {_GB(memory)} are free: {smaller}")
        if fit < usual:
            warn(f"{fit} in place of {usual} cases at a time: each takes {_GB(self.worker)}, {_GB(memory)} are free")
        return min(usual, fit)


def free_memory() -> float:
    """Return what processes may take without others being moved out, in bytes."""
    return float(psutil.virtual_memory().available)


def free_disk(folder: Path) -> float:
    """Return what may be written to a folder's disk, in bytes; raise `OSError`."""
    return float(shutil.disk_usage(folder).free)


def _GB(count: float) -> str:
    return f"{count / 1e9:.2g} GB"
