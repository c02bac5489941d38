"""What an attack is, and how a campaign of them is run and told."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from random import Random
from typing import NamedTuple

from tests.attack.worker import Worker


class Impossible(Exception):
    """An attack cannot be made on this machine; the message says why."""


@dataclass
class Ground:
    """Where a campaign takes place: a folder, and a worker that is started when one is asked for."""

    folder: Path
    made: dict[str, Path] = field(default_factory=dict)

    @cached_property
    def worker(self) -> Worker:
        return Worker()

    def once(self, name: str, make: Callable[[Path], None]) -> Path:
        """Return a folder that is made once in a campaign, and only read after."""
        if name not in self.made:
            folder = self.folder / f"made-{name}"
            folder.mkdir()
            make(folder)
            self.made[name] = folder
        return self.made[name]


class Class(NamedTuple):
    """Attacks of one kind; each is a number, of which alone and the seed it depends what is done."""

    name: str
    count: int
    attack: Callable[[Ground, Path, int, Random], str]  # in an empty folder; returns what failed, or ""


class Failure(NamedTuple):
    name: str
    number: int
    what: str


@dataclass(frozen=True)
class Told:
    """What came of a class."""

    name: str
    tried: int
    failures: Sequence[Failure]
    left_out: str
    took_s: float


def run(classes: Sequence[Class], seed: int, share: float, number: int | None = None) -> Iterator[Told]:
    """Yield what came of each class; of each, a share of its attacks, or the one of a number."""
    with tempfile.TemporaryDirectory(prefix="waxstudy-attack-") as place:
        ground = Ground(Path(place))
        try:
            for each in classes:
                yield _class(ground, each, seed, share, number)
        finally:
            if "worker" in vars(ground):
                ground.worker.__exit__(None, None, None)


def _class(ground: Ground, each: Class, seed: int, share: float, number: int | None) -> Told:
    numbers = [number] if number is not None else chosen(each, seed, share)
    failures, began, tried = [], time.perf_counter(), 0
    for i in numbers:
        with tempfile.TemporaryDirectory(prefix=f"{each.name}-", dir=ground.folder) as folder:
            try:
                what = each.attack(ground, Path(folder), i, Random(f"{seed} {each.name} {i}"))
            except Impossible as error:
                return Told(each.name, tried, failures, str(error), time.perf_counter() - began)
            tried += 1
            if what:
                failures.append(Failure(each.name, i, what))
    return Told(each.name, tried, failures, "", time.perf_counter() - began)


def chosen(each: Class, seed: int, share: float) -> list[int]:
    """Return a share of a class' numbers, at least one, drawn by the seed."""
    count = max(1, round(share * each.count))
    return sorted(Random(f"{seed} {each.name}").sample(range(each.count), count))
