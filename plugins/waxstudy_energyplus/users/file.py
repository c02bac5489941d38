"""A user's model: read as epJSON whatever it is, if it is of the version that is installed."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from waxstudy.plugin import BackendMissing, Refused
from waxstudy.plugin.files import read_file, why
from waxstudy.results.atomic import scratch_folder
from waxstudy_energyplus.error_file import error_file
from waxstudy_energyplus.installation import installed_version, payload
from waxstudy_energyplus.model import VERSION, Model

KEY = "room.path"
LARGEST_BYTES = 200_000_000  # whole campuses
LONGEST_CONVERSION_S = 300.0
IDF_VERSION = re.compile(rb"^[ \t]*version[ \t]*,\s*(?:![^\n]*\n\s*)*([0-9.]+)", re.IGNORECASE | re.MULTILINE)
# kinds of objects that another program must have worked on -> what to do
NOT_TAKEN = {
    "HVACTemplate:": "run EnergyPlus' ExpandObjects on it, and name the expanded file",
    "PythonPlugin:": "the installed build of EnergyPlus has no Python for plugins",
    "ExternalInterface": "nobody would answer at the other end",
}


@dataclass(frozen=True)
class UsersModel:
    """A model file and its objects: kind -> name -> fields."""

    path: Path
    digest: str
    objects: Model

    def each(self, kind: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
        """Yield name and fields of the objects of a kind."""
        yield from self.objects.get(kind, {}).items()

    def first(self, kind: str) -> Mapping[str, Any]:
        """Return the fields of the first object of a kind, none where there is none."""
        return next(iter(self.objects.get(kind, {}).values()), {})

    def named(self, kind: str, name: object) -> tuple[str, Mapping[str, Any]] | None:
        """Return the object of a kind that a field names, whatever its capitals."""
        return next(((n, fields) for n, fields in self.each(kind) if n.upper() == str(name).upper()), None)


def read_model(path: Path) -> UsersModel:
    """Return a model; raise `BackendMissing` without EnergyPlus, `Refused` for what it cannot run as it is."""
    installed_version()
    try:
        data = read_file(path, LARGEST_BYTES)
    except OSError as error:
        raise Refused(KEY, str(path), f"cannot be read: {why(error)}") from error
    return _understood(path, hashlib.sha256(data).hexdigest(), data)


@lru_cache(maxsize=8)  # every week asks for it
def _understood(path: Path, digest: str, data: bytes) -> UsersModel:
    if path.suffix.lower() == ".idf":
        _refuse_version(path, (found := IDF_VERSION.search(data)) and found[1].decode())
        objects = _loaded(path, _converted(path, data))
    elif path.suffix.lower() in (".epjson", ".json"):
        objects = _loaded(path, data)
        _refuse_version(path, next((v.get("version_identifier") for v in objects.get("Version", {}).values()), None))
    else:
        raise Refused(KEY, str(path), "must be an .idf or an .epJSON file")
    for kind in objects:
        for start, remedy in NOT_TAKEN.items():
            if kind.startswith(start):
                raise Refused(KEY, str(path), f"holds objects {kind}: {remedy}")
    return UsersModel(path, digest, objects)


def _refuse_version(path: Path, found: object) -> None:
    if found is None:
        raise Refused(
            KEY, str(path), f"has no object Version, which says what version of EnergyPlus it is for: {VERSION}"
        )
    if ".".join(str(found).split(".")[:2]) != VERSION:
        raise Refused(
            KEY,
            str(path),
            f"is a model of EnergyPlus {found}, and {VERSION} is installed; update it with IDFVersionUpdater, which "
            "comes with EnergyPlus' own installer in PreProcess/IDFVersionUpdater (an epJSON file as IDF), and name "
            "the new file",
        )


def _converted(path: Path, data: bytes) -> bytes:
    """Return an IDF as epJSON, by EnergyPlus itself."""
    found = [payload() / name for name in ("energyplus", "energyplus.exe") if (payload() / name).exists()]
    if not found:
        raise BackendMissing(f"EnergyPlus is installed but has no program in {payload()}")
    with scratch_folder("waxstudy-energyplus-model-") as folder:
        (folder / "model.idf").write_bytes(data)
        words = [str(found[0]), "--convert-only", "-d", str(folder), str(folder / "model.idf")]
        try:
            done = subprocess.run(words, cwd=folder, capture_output=True, timeout=LONGEST_CONVERSION_S, check=False)
        except subprocess.TimeoutExpired:
            raise Refused(KEY, str(path), f"EnergyPlus did not read it within {LONGEST_CONVERSION_S:g} s") from None
        except OSError as error:
            raise BackendMissing(f"EnergyPlus is installed but cannot be started: {why(error)}") from error
        if done.returncode:
            raise Refused(KEY, str(path), f"is no IDF that EnergyPlus can read{error_file(folder)}")
        return (folder / "model.epJSON").read_bytes()


def _loaded(path: Path, data: bytes) -> Model:
    try:
        objects = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise Refused(KEY, str(path), f"is no epJSON: {error}") from None
    if not isinstance(objects, dict) or not all(
        isinstance(named, dict) and all(isinstance(fields, dict) for fields in named.values())
        for named in objects.values()
    ):
        raise Refused(KEY, str(path), "is no epJSON: it must be a table of kinds, of names, of fields")
    return objects
