"""The classes of the campaign, with how many attacks each has."""

from __future__ import annotations

from tests.attack import disks, files, folders, kills
from tests.attack.campaign import Class
from tests.attack.folders import FORMS
from tests.attack.kills import COMMANDS

CLASSES = (
    Class("study", 400, files.study),
    Class("record", 150, files.record),
    Class("kill", 4 * len(COMMANDS), kills.kill),
    Class("tamper", 2 * len(FORMS), folders.tamper),
    Class("clock", 5, folders.clock),
    Class("full-disk", 2 * len(COMMANDS), disks.full),
    Class("read-only", len(COMMANDS), disks.read_only),
)
