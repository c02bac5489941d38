"""What a diagnoser said of a record, read from its JSON, whoever wrote it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

VERDICTS = ("effect", "group", "unknown", "untestable", "none")


class NoAnswer(ValueError):
    """What was printed is no diagnosis; the message says why."""


@dataclass(frozen=True)
class Claim:
    """An effect that is claimed, with those that it could not be told from, itself among them."""

    name: str
    stages: frozenset[str]
    group: frozenset[str]
    parameters: Mapping[str, tuple[float, float, float]]  # value, low, high
    shrink: float | None
    channel: str


@dataclass(frozen=True)
class Answer:
    """A diagnosis: `open_stages` are where something unexplained was found, the form of a room's model aside."""

    verdict: str
    claims: tuple[Claim, ...]
    open_stages: tuple[frozenset[str], ...]
    untestable: frozenset[str]
    has_failed: bool = False

    @classmethod
    def failed(cls) -> Answer:
        """A diagnoser that failed has not answered: that counts as `untestable`."""
        return cls("untestable", (), (), frozenset(), has_failed=True)

    @classmethod
    def read(cls, said: Any) -> Answer:
        """Return the answer of a JSON; raise `NoAnswer`."""
        if not isinstance(said, Mapping) or said.get("verdict") not in VERDICTS:
            raise NoAnswer(f"there is no object with a verdict of {', '.join(VERDICTS)}")
        try:
            claims = tuple(_claim(each) for each in said.get("effects") or ())
            open_ = tuple(_stages(each["stage"]) for each in said.get("unexplained") or () if _is_finding(each))
            untestable = frozenset(str(each["name"]) for each in said.get("untestable") or ())
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise NoAnswer(f"its effects, unexplained or untestable cannot be read: {error!r}") from error
        return cls(said["verdict"], claims, open_, untestable)


def _claim(said: Mapping[str, Any]) -> Claim:
    name = str(said["name"])
    parameters = {key: _interval(each) for key, each in (said.get("parameters") or {}).items()}
    shrink, group = (said.get("shrink") or {}).get("value"), said.get("group") or [name]
    if isinstance(group, str):
        raise TypeError(f"group is to be a list of names, not '{group}'")
    return Claim(
        name=name,
        stages=_stages(said["stage"]),
        group=frozenset(map(str, group)) | {name},
        parameters={key: each for key, each in parameters.items() if each},
        shrink=None if shrink is None else float(shrink),
        channel=str(said.get("channel", "")),
    )


def _interval(said: Mapping[str, Any]) -> tuple[float, float, float] | None:
    """Return value, low and high; None where one of them is no number."""
    ends = [said.get(name) for name in ("value", "low", "high")]
    return None if None in ends else (float(ends[0]), float(ends[1]), float(ends[2]))  # type: ignore[arg-type]


def _stages(said: Any) -> frozenset[str]:
    return frozenset(str(said).split("+"))


def _is_finding(said: Mapping[str, Any]) -> bool:
    """Whether something unexplained is more than a model's form or what its published uncertainty covers."""
    return not any(said.get(name) for name in ("is_room_form", "is_covered", "is_of_drives"))
