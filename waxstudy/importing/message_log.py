"""Logs of MQTT: a line for each message, `2026-01-31T16:05:00+0100 house/living {"temperature": 21.3}`."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import pandas as pd

from waxstudy.importing.limits import LONGEST, NAMED
from waxstudy.importing.reading import Table
from waxstudy.importing.words import is_reading
from waxstudy.study.problems import listed

TIME = r"(?P<time>\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d[\d.,:Z+-]*(?: [+-]\d\d:?\d\d)?|\d{10}(?:\.\d+)?|\d{13}) +"
BEGIN = re.compile(TIME)
# the first message has a topic of several levels; a table with stamps may have anything else behind them
BEGINNING = re.compile(rf"{TIME}(?!#?[Nn]/[Aa] )[^\s/,;]*(?:/[^\s/,;]*)+ +\S[^\t\r\n]*(?:[\r\n]|$)".encode())
TWO_NUMBERS = re.compile(r"[-+]?\d\S* +[-+]?\d")  # the first may belong to the topic, or not
SETTINGS = "/config"  # behind the topic by which a device tells home automation what it is


def read_message_log(path: Path, where: str) -> Table:
    """Return a table with a row for each value of a message; a key of its object names it behind the topic.

    Names that never hold a number or a state, and what is no message, are left out and told.
    """
    log = _Log()
    with path.open("rb") as file:
        for place, line in enumerate(file, start=1):
            log.take(place, line.decode("utf-8-sig", errors="replace").strip())
    return Table(where, log.frame(), tuple(log.left_out(where)))


class _Log:
    """The readings of a log so far, and its lines that hold none."""

    def __init__(self) -> None:
        self.places: list[int] = []
        self.times: list[str] = []
        self.names: list[str] = []
        self.values: list[object] = []
        self.known: dict[str, bool] = {}  # by name: whether it ever held a number or a state
        self.bad_count, self.first_bad = 0, ""

    def take(self, place: int, line: str) -> None:
        if not line:
            return
        try:
            time, topic, value = _parts(line)
            if not topic.endswith(SETTINGS):
                self._add(place, time, list(_values(topic, _read(value))))
        except (ValueError, RecursionError):  # a message may hold anything
            self.first_bad = self.first_bad or f"line {place}: '{line[:LONGEST]}'"
            self.bad_count += 1

    def _add(self, place: int, time: str, values: list[tuple[str, object]]) -> None:
        for name, value in values:
            is_known = self.known.setdefault(name, False)
            if isinstance(value, list):
                continue
            self.known[name] = is_known or (value is not None and is_reading(str(value)))
            self.places.append(place)
            self.times.append(time)
            self.names.append(name)
            self.values.append(value)

    def frame(self) -> pd.DataFrame:
        whole = pd.DataFrame({"time": self.times, "name": self.names, "value": self.values}, index=self.places)
        return whole[[self.known[name] for name in self.names]]

    def left_out(self, where: str) -> Iterator[str]:
        if self.bad_count:
            count = f"{self.bad_count} lines are" if self.bad_count > 1 else "1 line is"
            yield f"{where}: {count} no message and left out, the first of them {self.first_bad}."
        if worded := [name[:LONGEST] for name, is_known in self.known.items() if not is_known]:
            hold, are = ("hold", "are") if len(worded) > 1 else ("holds", "is")
            yield f"{where}: {listed(worded, NAMED)} never {hold} a number or a state, and {are} left out."


def _parts(line: str) -> tuple[str, str, str]:
    """Return the time, topic and value of a message; raise `ValueError` where they cannot be told apart."""
    found = BEGIN.match(line)
    if not found:
        raise ValueError("no stamp")
    time, rest = found["time"].replace(",", "."), line[found.end() :]
    start = rest.find(" {")  # a topic may have blanks
    topic, value = (rest[:start], rest[start + 1 :]) if start > 0 else rest.partition(" ")[::2]
    if not value.strip() or TWO_NUMBERS.match(value):
        raise ValueError("no topic and value")
    if "-" not in time:
        seconds = float(time) / (1000.0 if len(time.partition(".")[0]) > 10 else 1.0)
        time = datetime.fromtimestamp(seconds, UTC).isoformat()
    return time, topic.strip(), value.strip()


def _read(value: str) -> object:
    """Return an object or a text of JSON as such, any other value as it is written."""
    if not value.startswith(("{", '"')):
        return value
    return json.loads(value, parse_int=float)  # an integer may be larger than any number


def _values(name: str, value: object) -> Iterator[tuple[str, object]]:
    """Yield each value of an object, named by the keys that lead to it."""
    if isinstance(value, dict):
        for key, each in value.items():
            yield from _values(f"{name} {key}", each)
    else:
        yield name, str(value).lower() if isinstance(value, bool) else value
