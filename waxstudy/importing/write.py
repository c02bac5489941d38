"""The folder of an import: data.csv, and dataset.toml with what was decided and why."""

from __future__ import annotations

import os
import re
import shutil
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import tomli_w

from waxstudy.dataset.channels import DIFFUSE, GLOBAL
from waxstudy.dataset.stand_ins import ASSUMED, GAINS, GAINS_FACTOR, RECORDED, SUN
from waxstudy.dataset.zones import is_zone
from waxstudy.importing.request import Imported, Request
from waxstudy.plugin.files import read_file
from waxstudy.results.atomic import sole_use, whole_file, whole_folder

OWN = ("dataset", "noise", "import")
NEW = "data.new.csv"  # of an import into a folder in use, until it is data.csv
HEAD = """\
# Written by `waxstudy import`. [noise], [import] and the keys of [dataset] below are written anew when the import is
# repeated; whatever else is stated here stays.

"""
STILL = """\
[nominal]
# Still to be stated: the chain that is believed (controller, actuator, valve), in the words of a study file, and
# setpoint_C where none was measured; and the room in [building] or [room] (docs/datasets.md).
"""
HEADING = re.compile(r"^\s*\[\[?\s*\"?(?P<name>[A-Za-z0-9_-]+)")


class OtherImport(Exception):
    """A folder holds something else than an earlier import of the same sources and room; the message says what."""


def write(folder: Path, imported: Imported, *, replaces: bool = False) -> None:
    """Write the dataset; raise `OtherImport` where it would take the place of another, `OSError` if it cannot be."""
    earlier = refuse_other(folder, imported.request, replaces=replaces)
    folder.parent.mkdir(parents=True, exist_ok=True)
    text = described(folder, imported, earlier)
    if not folder.exists():
        with whole_folder(folder) as place:
            _data(place / "data.csv", imported)
            (place / "dataset.toml").write_text(text, encoding="utf-8")
        return
    with sole_use(folder) as is_ours:
        if not is_ours:
            raise OtherImport(f"{folder}: another import is at work in this folder; wait for it")
        _write_over(folder, imported, text, described(folder, imported, earlier, file=NEW))


def _write_over(folder: Path, imported: Imported, text: str, meanwhile: str) -> None:
    """Write both files over others, so that wherever this is cut off dataset.toml names the data that it is of."""
    with whole_file(folder / NEW) as data:
        _data(data, imported)
    with whole_file(folder / "dataset.toml") as about:  # from here on it is the new pair
        about.write_text(meanwhile, encoding="utf-8")
    with whole_file(folder / "data.csv") as data:
        shutil.copyfile(folder / NEW, data)
    with whole_file(folder / "dataset.toml") as about:
        about.write_text(text, encoding="utf-8")
    (folder / NEW).unlink()


def refuse_other(folder: Path, request: Request, *, replaces: bool) -> str:
    """Return the dataset.toml of the same import, "" where there is none; raise `OtherImport` for another."""
    if any(path.resolve().is_relative_to(folder.resolve()) for path in request.sources):
        raise OtherImport(f"{folder}: a source lies in it, and none is written to. Name another folder with --out")
    if not os.path.lexists(folder):
        return ""
    if not folder.is_dir():
        raise OtherImport(f"{folder}: this is a file; nothing was written. Name another folder with --out")
    path = folder / "dataset.toml"
    if not path.exists() and not any(folder.iterdir()):
        return ""
    try:
        text = read_file(path).decode()
        about = tomllib.loads(text).get("import", {})
    except (OSError, ValueError):
        about = {}
    if not isinstance(about, dict) or not about:
        raise OtherImport(
            f"{folder}: this folder is in use and holds no import; nothing was written. Name another with --out"
        )
    is_same = about.get("sources") == _sources(folder, request) and about.get("room") == request.room
    if is_same:
        return text
    if replaces:
        return ""
    held = ", ".join(map(str, about.get("sources", []))) + (f", room '{about['room']}'" if about.get("room") else "")
    raise OtherImport(
        f"{folder}: holds the import of {held}; this one would take its place; nothing was written. Name another "
        "folder with --out, or say --replace"
    )


def described(folder: Path, imported: Imported, earlier: str = "", file: str = "") -> str:
    """Return dataset.toml, with the name of its data where it is another; what an earlier one says besides stays."""
    kept = tomllib.loads(earlier).get("dataset", {}) if earlier else {}
    if kept.get("file") == NEW:  # of an import that was cut off
        del kept["file"]
    own = {"dataset": {"name": folder.resolve().name, **kept, **_dataset(imported)}}
    own["dataset"] |= {"file": file} if file else {}
    own |= {"noise": dict(imported.noise)} if imported.noise else {}
    own |= {"import": _import(folder, imported)}
    rest = "".join(_others(earlier)) if earlier else ""
    rest = rest if re.search(r"^\s*\[nominal", rest, re.MULTILINE) else rest + STILL
    if (site := _site(imported)) and not re.search(r"^\s*\[site\b", rest, re.MULTILINE):
        rest = tomli_w.dumps({"site": site}) + "\n" + rest
    return HEAD + tomli_w.dumps(own) + "\n" + rest.lstrip("\n")


def _dataset(imported: Imported) -> dict[str, Any]:
    files = ", ".join(path.name for path in imported.request.sources)
    interval_s = imported.interval_s
    return {
        "interval_s": int(interval_s) if interval_s.is_integer() else interval_s,
        "origin": f"imported from {files}; {_clock(imported)}",
        "inputs": _inputs(imported),
    }


def _inputs(imported: Imported) -> dict[str, float]:
    """Return what is assumed, or stands in for what was not recorded, and how uncertain it is."""
    found = {name: spread for name, spread in ASSUMED.items() if name in imported.matches}
    if GAINS not in imported.matches:
        found[GAINS] = GAINS_FACTOR
    told = [name for name in RECORDED if name in imported.matches and (name != DIFFUSE or GLOBAL in imported.matches)]
    if SUN not in imported.matches and told:
        found[SUN] = RECORDED[DIFFUSE if DIFFUSE in told else told[0]][0]
    return found


def _site(imported: Imported) -> dict[str, Any]:
    """Return where the house is, as its weather says."""
    if imported.place is None:
        return {}
    zone = imported.request.timezone
    return {**imported.place._asdict(), **({"timezone": zone} if zone and is_zone(zone) else {})}


def _clock(imported: Imported) -> str:
    return next((each.rstrip(".") for each in imported.assumptions if each.startswith("Stamps ")), "")


def _import(folder: Path, imported: Imported) -> dict[str, Any]:
    request = imported.request
    stated = {"room": request.room, "timezone": request.timezone or None}
    return {
        "command": request.command(folder),
        "sources": _sources(folder, request),
        **{key: value for key, value in stated.items() if value},
        "hold_s": request.hold_s,
        "not_used": list(imported.unused),
        "assumed": list(imported.assumptions),
        "told": list(imported.warnings),
        "channels": {channel: dict(_channel(imported, channel)) for channel in imported.matches},
    }


def _channel(imported: Imported, channel: str) -> Iterator[tuple[str, Any]]:
    match = imported.matches[channel]
    scale, offset = imported.conversions[channel]
    yield "entity", match.seen.entity
    yield "source", Path(match.seen.logged.where.partition(", ")[0]).name
    yield "unit", match.seen.unit
    if scale != 1.0:
        yield "scale", round(scale, 9)
    if offset != 0.0:
        yield "offset", round(offset, 6)
    yield "confidence", match.confidence
    yield "why", match.why


def _sources(folder: Path, request: Request) -> list[str]:
    """Return the sources as seen from the folder, so that both can be moved together."""
    return [_seen_from(folder.resolve(), path.resolve()) for path in request.sources]


def _seen_from(folder: Path, path: Path) -> str:
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # on another drive
        return path.as_posix()


def _others(text: str) -> Iterator[str]:
    """Yield the lines of the tables that are the user's, each with the comments above it."""
    is_own = True  # what stands above the first table is the head
    above: list[str] = []
    for line in text.splitlines(keepends=True):
        if not line.strip() or line.lstrip().startswith("#"):
            above.append(line)
            continue
        if found := HEADING.match(line):
            is_own = found["name"] in OWN
        yield from [] if is_own else [*above, line]
        above = []
    yield from [] if is_own else above


def _data(path: Path, imported: Imported) -> None:
    imported.values.to_csv(path, date_format="%Y-%m-%dT%H:%M:%S", lineterminator="\n")
