"""What a diagnoser said of a record, read from its JSON, whoever wrote it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from typing import Any

NONE, UNKNOWN = "none", "unknown"  # hypotheses that are no effect's name
SUM = 0.01  # that probabilities may be off 1
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
    when: tuple[tuple[float, float], ...] | None = None  # hours since the record began


@dataclass(frozen=True)
class Answer:
    """A diagnosis: `open_stages` are where something unexplained was found, the form of a room's model aside."""

    verdict: str
    claims: tuple[Claim, ...]
    open_stages: tuple[frozenset[str], ...]
    untestable: frozenset[str]
    has_failed: bool = False
    posterior: Mapping[str, float] | None = None  # hypothesis -> probability

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
        return cls(said["verdict"], claims, open_, untestable, posterior=_posterior(said.get("posterior")))


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
        when=_spans((said.get("when") or {}).get("spans_h")),
    )


def _spans(said: Any) -> tuple[tuple[float, float], ...] | None:
    """Return the hours in which an effect is said to act, in order; None where nothing is said."""
    if said is None:
        return None
    found = tuple(sorted((float(begin), float(end)) for begin, end in said))
    ends = [end for span in found for end in span]
    if not all(map(isfinite, ends)) or any(later < earlier for earlier, later in pairwise(ends)):
        raise ValueError(f"when.spans_h is to be a list of [from, to], apart from each other, not {said!r:.60}")
    return found


def hypothesis(names: Iterable[str]) -> str:
    """Return how several effects are called together: alphabetically, `unknown` behind them.

    >>> hypothesis(["unknown", "let-by"]), hypothesis([])
    ('let-by+unknown', 'none')
    """
    return "+".join(sorted(names, key=lambda name: (name == UNKNOWN, name))) or NONE


def _posterior(said: Any) -> Mapping[str, float] | None:
    if said is None or said == {}:  # where nothing can be judged there are none
        return None
    try:
        found: dict[str, float] = {}
        for name, probability in said.items():
            key = hypothesis(str(name).split("+"))
            found[key] = found.get(key, 0.0) + float(probability)
    except (AttributeError, TypeError, ValueError) as error:
        raise NoAnswer(f"its posterior is no mapping from hypothesis to probability: {error!r}") from error
    total = sum(found.values())
    if not all(value >= 0.0 for value in found.values()) or not abs(total - 1.0) <= SUM:
        raise NoAnswer(f"the probabilities of its posterior are not at least 0 with a sum of 1 (it is {total:g})")
    return {name: value / total for name, value in found.items()}


def _interval(said: Mapping[str, Any]) -> tuple[float, float, float] | None:
    """Return value, low and high; None where one of them is no number."""
    ends = [said.get(name) for name in ("value", "low", "high")]
    return None if None in ends else (float(ends[0]), float(ends[1]), float(ends[2]))  # type: ignore[arg-type]


def _stages(said: Any) -> frozenset[str]:
    return frozenset(str(said).split("+"))


def _is_finding(said: Mapping[str, Any]) -> bool:
    """Whether something unexplained is more than a model's form or what its published uncertainty covers."""
    return not any(said.get(name) for name in ("is_room_form", "is_covered", "is_of_drives"))
