"""What a run folder holds, for comparing it before and after."""

from __future__ import annotations

import os
from hashlib import sha256
from pathlib import Path

from waxstudy.results.atomic import PARTIAL
from waxstudy.results.checksums import SUMS, write_sums
from waxstudy.results.folder import ORIGIN


def contents(folder: Path, below: str = "") -> dict[str, str]:
    """Digest of every file below a folder; what a running or killed process was writing is left out."""
    files = [Path(root) / name for root, _, names in os.walk(folder / below) if PARTIAL not in root for name in names]
    names = {path: path.relative_to(folder).as_posix() for path in files}
    return {names[path]: sha256(path.read_bytes()).hexdigest() for path in files if PARTIAL not in names[path]}


def results(folder: Path) -> dict[str, str]:
    """The same without what says which study's file began the run."""
    return {name: digest for name, digest in contents(folder).items() if name != ORIGIN}


def finished_cases(folder: Path) -> dict[str, str]:
    """The same for the finished cases alone: other files may be written anew at any moment of a run."""
    return contents(folder, "cases")


def computed_at(folder: Path) -> dict[str, tuple[int, int]]:
    """Inode and time of each file of each case, by case id: what tells a case that was computed again."""
    files = {path: path.stat() for path in folder.glob("cases/*/*")}
    return {
        f"{path.parent.name.rpartition('_')[0]}/{path.name}": (stat.st_ino, stat.st_mtime_ns)
        for path, stat in files.items()
    }


def resum(folder: Path) -> None:
    """Write the checksums of a run anew, as if what was changed in it had been written so."""
    for place in folder.glob("cases/*"):
        write_sums(
            place / SUMS, {f"../{place.name}/{path.name}": path for path in place.iterdir() if path.name != SUMS}
        )
    names = ["run.json", "study.toml", "kpis.csv", *(f"cases/{place.name}/{SUMS}" for place in folder.glob("cases/*"))]
    write_sums(folder / SUMS, {name: folder / name for name in names})
