"""Logs of MQTT: a line for each message, `2026-01-31T16:05:00+0100 house/living {"temperature": 21.3}`."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from datetime import UTC, datetime
from typing import NamedTuple

import pandas as pd

from waxstudy.importing.reading import Table

TIME = r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d[\d.:Z+-]*|\d{10}(?:\.\d+)?"
TOPIC = r"(?![Nn]/[Aa]\s)[^\s/]*(?:/[^\s/]*)+"  # it has levels
LINE = re.compile(rf"(?P<time>{TIME})\s+(?P<topic>{TOPIC})\s+(?P<value>\S.*)")
BEGINNING = re.compile(LINE.pattern.encode())


class Message(NamedTuple):
    """A value of a message: a key of its object names it behind the topic."""

    time: str
    name: str
    value: object


def read_message_log(text: str, where: str) -> Table:
    """Return a table with a row for each value; a line that is no message has its text where a stamp should be."""
    rows, places = [], []
    for place, line in enumerate(text.splitlines(), start=1):
        if line.strip():
            values = list(_messages(line))
            rows += values
            places += [place] * len(values)
    return Table(where, pd.DataFrame(rows, index=places, columns=list(Message._fields)))


def _messages(line: str) -> Iterator[Message]:
    found = LINE.fullmatch(line.strip())
    if not found:
        yield Message(f"? {line.strip()}", "", None)  # a stamp that was cut off may be a day
        return
    time, topic, value = found.groups()
    time = datetime.fromtimestamp(float(time), UTC).isoformat() if "-" not in time else time
    for name, each in _values(topic, _object_of(value)):
        yield Message(time, name, each)


def _object_of(value: str) -> object:
    """Return an object of JSON as such, any other value as it is written."""
    if not value.startswith("{"):
        return value
    try:
        return json.loads(value)
    except ValueError:
        return value


def _values(name: str, value: object) -> Iterator[tuple[str, object]]:
    """Yield each value of an object, named by the keys that lead to it; lists hold no readings."""
    if isinstance(value, dict):
        for key, each in value.items():
            yield from _values(f"{name} {key}", each)
    elif not isinstance(value, list):
        yield name, str(value).lower() if isinstance(value, bool) else value
