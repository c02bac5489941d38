"""A block or room that a study file takes from another file: `{ from = "my_actuator.toml" }`."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

from waxstudy.plugin.files import read_file
from waxstudy.study.check import Check
from waxstudy.study.problems import StudyError
from waxstudy.study.source import read_source
from waxstudy.study.spots import RawTable, Spot, Written

FROM = "from"


def table_of(check: Check, kind: str, values: Mapping[str, Any], spot: Spot) -> RawTable | None:
    """Return a table that may name a file to take a block of this kind from. None: what is wrong is noted."""
    return included(check, kind, values, spot) if FROM in values else RawTable.of(values, spot)


def included(check: Check, kind: str, block: Mapping[str, Any], spot: Spot) -> RawTable | None:
    """Return the table named as the kind of the file that `from` names, with what the block says besides put upon it.

    It replaces the block before it. A value of the file has the place of `from`. None: what is wrong is noted.
    """
    place = spot.at(FROM)
    table = _table(check, kind, block[FROM], place)
    if table is None:
        return None
    written = {key: Written(value, place.at(key)) for key, value in table.items()}
    own = {key: Written(value, spot.at(key)) for key, value in block.items() if key != FROM}
    return RawTable({**written, **own}, spot, spot)


def _table(check: Check, kind: str, path: object, place: Spot) -> Mapping[str, Any] | None:
    if not isinstance(path, str):
        check.problem(place, "must be the name of a file in quotes", value=path)
        return None
    full = check.source.folder / path
    try:
        values = read_source(full).values
    except StudyError as error:
        for each in error.problems:
            wrong = f"line {each.line}: {each.wrong}" if each.line else each.wrong
            check.problem(place, wrong, value=path, allowed=f"looked for {full}")
        return None
    table = values.get(kind)
    if not isinstance(table, dict):
        check.problem(place, f"describes no {kind}: it has no table [{kind}]", value=path)
        return None
    check.fragments[path] = _origin(read_file(full), values)
    return table


def _origin(raw: bytes, values: Mapping[str, Any]) -> str:
    """Return what a run tells of a fragment: its hash, and whether what it was fitted to was simulated."""
    fit = values.get("fit")
    mark = ", simulated" if isinstance(fit, dict) and fit.get("simulated") else ""
    return f"sha256 {hashlib.sha256(raw).hexdigest()}{mark}"
