"""Raw parameters, each with the place in the study file where it was written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from waxstudy.study.lines import KeyPath


class Spot(NamedTuple):
    """A place in the study file: the table or case it belongs to, and the key."""

    where: str
    path: KeyPath
    depth: int  # how many keys of the path `where` stands for

    @classmethod
    def table(cls, *path: str) -> Spot:
        return cls(f"[{'.'.join(path)}]" if path else "", path, len(path))

    def at(self, *keys: str | int) -> Spot:
        return self._replace(path=(*self.path, *keys))

    @property
    def key(self) -> str:
        steps = (f"[{key}]" if isinstance(key, int) else f".{key}" for key in self.path[self.depth :])
        return "".join(steps).removeprefix(".")


class Written(NamedTuple):
    """A value and where it was written."""

    value: Any
    spot: Spot


@dataclass(frozen=True)
class RawTable:
    """The parameters of one table, or of one block as the steps so far have made it."""

    written: Mapping[str, Written]
    first: Spot  # where its component was chosen
    last: Spot  # where it was changed last

    @classmethod
    def of(cls, values: Mapping[str, Any], spot: Spot) -> RawTable:
        return cls({key: Written(value, spot.at(key)) for key, value in values.items()}, spot, spot)

    def merged(self, values: Mapping[str, Any], spot: Spot) -> RawTable:
        """Return the block after a step: changed where it uses the same component, replaced where another."""
        new = RawTable.of(values, spot)
        use, before = new.written.get("use"), self.written.get("use")
        if use and (before is None or use.value != before.value):
            return new
        changes = {key: written for key, written in new.written.items() if key != "use"}
        return RawTable({**self.written, **changes}, self.first, spot)

    def without_use(self) -> RawTable:
        return RawTable({k: w for k, w in self.written.items() if k != "use"}, self.first, self.last)

    def place(self, keys: KeyPath) -> Spot:
        """Return where a key was written; for a key that nobody wrote, where the component was chosen."""
        if not keys:
            return self.last
        written = self.written.get(str(keys[0]))
        return written.spot.at(*keys[1:]) if written else self.first.at(*keys)
