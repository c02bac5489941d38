"""What an import asks: on a terminal of its user, else of nobody, and then it says what to type."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Question:
    """What files leave in doubt."""

    text: str
    choices: Sequence[str]  # none: anything may be answered
    proposal: str | None  # None where no answer is better than another
    option: str  # what states the answer, up to it: "--map flow_L_h="
    where: str
    otherwise: str | None = None  # what is gone on with where nobody answers, to find what else there is to ask
    allowed: Callable[[str], str] = lambda answer: ""  # what is wrong with an answer, "" if nothing


class Proposed(str):
    """A proposal that nobody has typed."""


Ask = Callable[[Question], str]
NONE = "none"
