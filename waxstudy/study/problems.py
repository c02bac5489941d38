"""Problems of a study file: collected, then reported all at once, one line each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from waxstudy.plugin.registry import did_you_mean
from waxstudy.study.visible import visible

LONGEST_VALUE = 60


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong, where it was written, and what is allowed instead."""

    file: str
    line: int  # 0: the file as a whole
    where: str  # "case O_D", "[ensemble]", or "" for the file
    key: str
    value: str  # as in the file, shortened; "" where there is none
    wrong: str
    near: str = ""  # nearest allowed word
    allowed: str = ""
    of_plugin: bool = False

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}" if self.line else self.file
        where = self.where if self.where.startswith("[") else self.where and f"{self.where}:"
        key = f"{self.key} = {self.value}" if self.value else self.key
        subject = f"{where} {key}".strip()
        allowed = f" ({self.allowed})" if self.allowed else ""
        parts = [place, subject.removesuffix(":"), f"{self.wrong}{did_you_mean(self.near)}{allowed}"]
        return " ".join(visible(": ".join(part for part in parts if part)).split())


class StudyError(Exception):
    """A study cannot be used; `str()` is one line per problem."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = sorted(problems, key=lambda problem: problem.line)
        super().__init__("\n".join(map(str, self.problems)))

    def __reduce__(self) -> tuple[type[StudyError], tuple[list[Problem]]]:
        """Let another process tell of it: an exception is made again from what it was given."""
        return StudyError, (self.problems,)

    @property
    def is_plugin_fault(self) -> bool:
        """Whether nothing but plugins is at fault: the file itself may be right."""
        return all(problem.of_plugin for problem in self.problems)


def shown(value: object) -> str:
    """Return a value as a study file has it, shortened; nothing for lists and tables.

    >>> shown(True), shown(-5.0), shown("B"), shown([1])
    ('true', '-5.0', '"B"', '')
    """
    if isinstance(value, list | dict):
        return ""
    text = f'"{value}"' if isinstance(value, str) else str(value)
    text = text.lower() if isinstance(value, bool) else text
    return text if len(text) <= LONGEST_VALUE else f"{text[:LONGEST_VALUE]}..."


def listed(words: Iterable[str], most: int | None = None) -> str:
    """Return words as a message lists them: the first `most`, and how many more there are."""
    every = list(words)
    first = every[:most]
    more = f" and {len(every) - len(first)} more" if len(every) > len(first) else ""
    return (", ".join(first) or "none") + more
