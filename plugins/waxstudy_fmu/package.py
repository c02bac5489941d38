"""An FMU's file: what it is, and whether it can run here."""

from __future__ import annotations

import hashlib
import zipfile
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from waxstudy.plugin import BackendMissing, Refused
from waxstudy.plugin.files import read_file, why

LARGEST_BYTES = 500_000_000  # with the libraries and tables of a whole building
KEY = "room.path"


@dataclass(frozen=True)
class Package:
    """An FMU that can be run here."""

    path: Path
    fmi: int
    identifier: str
    description: Any
    digest: str

    @property
    def engine(self) -> str:
        """What results depend on: the file, and what runs it."""
        return f"{self.path.name} (FMI {self.fmi}.0, sha256 {self.digest[:16]}), FMPy {version('fmpy')}"


def opened(path: Path) -> Package:
    """Return an FMU; raise `BackendMissing` without FMPy, `Refused` for one that cannot be run here."""
    if find_spec("fmpy") is None:
        raise BackendMissing(
            'a room in an FMU needs FMPy, which comes with the extra `fmu`: python -m pip install "waxstudy[fmu]"'
        )
    import fmpy

    try:
        digest = hashlib.sha256(read_file(path, LARGEST_BYTES)).hexdigest()
        description = fmpy.read_model_description(str(path), validate=False)
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except OSError as error:
        raise Refused(KEY, str(path), f"cannot be read: {why(error)}") from error
    except Exception as error:  # whatever a damaged archive or description makes of its readers
        raise Refused(KEY, str(path), f"is no FMU that can be read: {type(error).__name__}: {error}") from error
    edition = str(description.fmiVersion).split(".")[0]
    if edition not in ("2", "3"):
        raise Refused(KEY, str(path), f"is of FMI {description.fmiVersion}; 2.0 and 3.0 are taken")
    if description.coSimulation is None:
        raise Refused(KEY, str(path), "is not for co-simulation; export it for co-simulation, with its solver")
    folder = fmpy.platform if edition == "2" else fmpy.platform_tuple
    identifier = description.coSimulation.modelIdentifier
    if f"binaries/{folder}/{identifier}{fmpy.sharedLibraryExtension}" not in names:
        there = sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and name.count("/") > 1})
        raise Refused(KEY, str(path), f"has no library for {folder}; it has {', '.join(there) or 'none at all'}")
    return Package(path, int(edition), identifier, description, digest)
