"""What is believed, written into dataset.toml: comments and what is there stay."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.items import Table

from waxstudy.believing.believe import CURVE, STATED, Believed
from waxstudy.importing.write import STILL
from waxstudy.plugin.files import read_file
from waxstudy.results.atomic import whole_file

HEAD = "by `waxstudy believe`, from the answers in [believe]; what is changed by hand here stays"
WIDENED = "by `waxstudy believe`: [believe] guessed"
ORDER = ("site", "nominal", "building", "room", "believe")


def write(folder: Path, believed: Believed) -> None:
    """Write the tables; raise `OSError` where that cannot be done."""
    path = folder / "dataset.toml"
    text = described(read_file(path).decode("utf-8-sig"), believed)
    with whole_file(path) as file:
        file.write_text(text, encoding="utf-8")


def described(text: str, believed: Believed) -> str:
    """Return dataset.toml with what is believed."""
    document = tomlkit.parse(text.replace(STILL, "[nominal]\n"))
    before = _widened_before(document)
    for name in ORDER:
        if values := believed.tables.get(name):
            _put(_table(document, name), values)
    if "dataset" in believed.tables:
        _put(_table(document, "dataset"), believed.tables["dataset"])
    if believed.answers:
        _put_answers(document, believed)
    if "building" in believed.tables and believed.answers:
        _put_tolerance(_table(document, "dataset"), believed.room_tolerance, before)
    return tomlkit.dumps(document)


def stays(text: str, believed: Believed) -> float | None:
    """Return the room_tolerance that somebody else wrote, which stays; None without one."""
    document = tomlkit.parse(text)
    there = document.get("dataset", {}).get("room_tolerance")
    is_other = there is not None and there not in (_widened_before(document), believed.room_tolerance)
    return float(there) if is_other and there is not None else None


def _widened_before(document: tomlkit.TOMLDocument) -> Any:
    return document.get("believe", {}).get("room_tolerance")


def _put_tolerance(about: Table, value: float, before: Any) -> None:
    if about.get("room_tolerance", before) != before:
        return
    if value > 1.0:
        about["room_tolerance"] = value
        _comment(about, "room_tolerance", WIDENED)
    elif "room_tolerance" in about:
        about.remove("room_tolerance")


def _comment(table: Table, key: str, text: str) -> None:
    """Put a comment behind a value that was just written."""
    item: Any = table.value.item(key)
    item.comment(text)


def _put_answers(document: tomlkit.TOMLDocument, believed: Believed) -> None:
    if "believe" in document:
        document.remove("believe")
    about, answers = tomlkit.table(), tomlkit.table()
    about["command"] = believed.command
    about["room_tolerance"] = believed.room_tolerance
    about["stated"] = [answer.key for answer in believed.answers if answer.source == STATED]
    about["guessed"] = [answer.key for answer in believed.answers if answer.is_guess]
    if believed.curve_C:
        about[CURVE] = believed.curve_C
    for answer in believed.answers:
        answers[answer.key] = answer.text
        _comment(answers, answer.key, answer.source)
    about["answers"] = answers
    document["believe"] = about


def _table(document: tomlkit.TOMLDocument, name: str) -> Any:
    if name not in document:
        table = tomlkit.table()
        if name in ("building", "nominal"):
            table.comment(HEAD)
        document[name] = table
    return document[name]


def _put(table: Any, values: Mapping[str, Any]) -> None:
    for key, value in values.items():
        if value is None:
            table.pop(key, None)
        elif table.get(key) != value:
            table[key] = _item(value)


def _item(value: Any) -> Any:
    """Return a table as one line, as people write blocks."""
    if not isinstance(value, Mapping):
        return value
    inline = tomlkit.inline_table()
    inline.update(value)
    return inline
