"""What reading a dataset has to say: what makes it unusable, what the user must know, and what was assumed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from waxstudy.plugin import FloatArray
from waxstudy.study.problems import Problem


@dataclass
class Notes:
    """Notes on one data file, collected so that all are told at once."""

    file: str
    problems: list[Problem] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    assumptions: list[str] = field(default_factory=list)
    # from the number of a row, its header being 1, to the file's line: they differ after comments and blank lines
    line_of: Callable[[int], int] = lambda row: row

    def refuse(
        self, key: str, wrong: str, *, line: int = 0, value: str = "", near: str = "", allowed: str = ""
    ) -> None:
        """Note what makes the data file unusable."""
        line = self.line_of(line) if line else 0
        self.problems.append(Problem(self.file, line, "", key, value, wrong, near, allowed))

    def warn(self, sentence: str) -> None:
        self.warnings.append(sentence)

    def lost(self, channel: str, bad: FloatArray, what: str) -> None:
        """Tell of samples that were set to missing, if there are any."""
        if len(bad):
            are = "sample is" if len(bad) == 1 else "samples are"
            self.warn(f"{channel}: {len(bad)} {are} {what} (the first is {bad[0]:g}): set to missing")

    def assume(self, sentence: str) -> None:
        self.assumptions.append(sentence)
