"""The classes of the campaign, with how many attacks each has."""

from __future__ import annotations

from tests.attack import disks, files, folders, kills
from tests.attack.campaign import Class

CLASSES = (
    Class("study", 400, files.study),
    Class("record", 150, files.record),
    Class("kill", 40, kills.kill),
    Class("tamper", 20, folders.tamper),
    Class("clock", 5, folders.clock),
    Class("full-disk", 18, disks.full),
    Class("read-only", 9, disks.read_only),
)
