"""Disks that are full and folders that may not be written to: a command says so, and leaves nothing half written."""

from __future__ import annotations

import shutil
from pathlib import Path
from random import Random

from tests.attack.campaign import Ground, Impossible
from tests.attack.kills import COMMANDS, FILES, before, whole
from tests.attack.processes import contents, ended, small_files, without_rights
from tests.attack.verdict import DONE, FAILED, INVALID, USAGE, Ended, wrong_with

SMALL_DISK = 'mount -t tmpfs -o size="$1" none "$2" && cp -r "$3"/. "$2" && cd "$2" && shift 3 && exec "$@"'
CODES = (DONE, USAGE, INVALID, FAILED)


def _on_small_disk(folder: Path, needs: Path, free_kB: int, *command: str) -> Ended | None:
    """Run a command on a disk of its own with little room; None where this user may not make one."""
    used_kB = sum(-(-path.stat().st_size // 4096) * 4 + 4 for path in needs.rglob("*")) + 16
    prefix = ("/usr/bin/env", "unshare", "--mount", "sh", "-c", SMALL_DISK, "sh", f"{used_kB + free_kB}k")
    if ended(folder, *prefix, str(folder), str(needs), "true").code != DONE:
        return None
    return ended(folder, *prefix, str(folder), str(needs), *command)


def full(ground: Ground, folder: Path, number: int, random: Random) -> str:
    """Every second round files are small instead of the disk."""
    name = list(COMMANDS)[number % len(COMMANDS)]
    words = COMMANDS[name].words.split()
    needs = before(ground, name)
    told = None
    if number // len(COMMANDS) % 2 == 0:
        from tests.attack.processes import WAXSTUDY

        told = _on_small_disk(folder, needs, random.choice((0, 4, 16, 64)), str(WAXSTUDY), *words)
    if told is None:
        shutil.copytree(needs, folder, dirs_exist_ok=True)
        told = ended(folder, *words, before=small_files(random.choice((0, 100, 5_000, 60_000))))
        if half := _half_written(ground, name, folder):
            return f"{name}: {half} is half written"
    wrong = wrong_with(told, [*FILES, "set", "room", "healthy", "bench"], CODES)
    return f"{name}: {wrong}" if wrong else ""


def _half_written(ground: Ground, name: str, folder: Path) -> str:
    complete, _ = whole(ground, name)
    found = contents(folder)
    return next((path for path in found if complete.get(path) and complete[path] != found[path]), "")


def read_only(ground: Ground, folder: Path, number: int, random: Random) -> str:
    name = list(COMMANDS)[number % len(COMMANDS)]
    shutil.copytree(before(ground, name), folder, dirs_exist_ok=True)
    earlier = contents(folder)
    folders = [folder, *(path for path in folder.rglob("*") if path.is_dir())]
    for each in folders:
        each.chmod(0o555)
    try:
        try:
            told = ended(folder, *COMMANDS[name].words.split(), before=without_rights)
        except Exception as error:  # of what is done before the command, only the kind is told
            raise Impossible(f"rights cannot be dropped: {error}") from None
    finally:
        for each in folders:
            each.chmod(0o755)
    if contents(folder) != earlier:
        return f"{name}: it wrote"
    wrong = wrong_with(told, [*FILES, "set", "room", "healthy", "bench"], (USAGE, INVALID, FAILED))
    return f"{name}: {wrong}" if wrong else ""
