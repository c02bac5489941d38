"""Questions of a command: on a terminal they are asked, else it is said what to type."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.errors import INTERRUPTED, CommandError, say

if TYPE_CHECKING:
    from waxstudy.importing.asking import Question

MOST_SHOWN = 12  # choices that are listed; all can be answered


class Asking:
    """Asks on a terminal; else takes what is proposed, and remembers what nobody has settled."""

    def __init__(self, is_terminal: bool, takes_proposals: bool) -> None:
        self.is_terminal, self.takes_proposals = is_terminal, takes_proposals
        self.unsettled: list[Question] = []
        self.typed: list[str] = []  # answers of the user, as options that state them

    def __call__(self, question: Question) -> str:
        if self.is_terminal:
            return self._asked(question)
        if question.proposal is None or not self.takes_proposals:
            self.unsettled.append(question)
        if question.proposal is not None:
            return _proposed(question.proposal)
        if question.otherwise is None:
            self.refuse_unsettled()
        return str(question.otherwise)

    def _asked(self, question: Question) -> str:
        from waxstudy.importing.asking import Proposed

        shown = [f"  {place}  {choice}" for place, choice in enumerate(question.choices[:MOST_SHOWN], 1)]
        more = len(question.choices) - len(shown)
        shown += [f"  and {more} more, by name"] * (more > 0)
        say("\n".join([f"{question.text}?", *shown]))

        def read(answer: str) -> str:
            if not answer.strip() and question.proposal is not None:
                return _proposed(question.proposal)
            by_number = answer.isdigit() and 1 <= int(answer) <= len(question.choices)
            answer = question.choices[int(answer) - 1] if by_number else answer.strip()
            wrong = question.allowed(answer) if answer else "there is no answer to take by Enter alone"
            if question.choices and answer not in question.choices:
                wrong = f"give a number from 1 to {len(question.choices)}"
            if wrong:
                raise click.UsageError(wrong)
            return answer

        usual = "Enter for the first" if question.choices else question.proposal
        ending = f" [{usual}]> " if question.proposal else "> "
        answer: str = click.prompt("", default="", show_default=False, value_proc=read, prompt_suffix=ending, err=True)
        if not isinstance(answer, Proposed):
            self.typed.append(_option(question, answer))
        return answer

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Say of an interrupted command what was typed, so that nobody types it again."""
        try:
            yield
        except (KeyboardInterrupt, click.Abort):
            if not self.typed:
                raise
            told = "interrupted before all was written; to go on, add to the same command:"
            raise CommandError(f"{told} {' '.join(self.typed)}", INTERRUPTED, label="") from None

    def refuse_unsettled(self) -> None:
        """Raise `StudyError` with every question that nobody has answered."""
        from waxstudy.importing.reading import problem
        from waxstudy.study.problems import StudyError

        if self.unsettled:
            raise StudyError([problem(each.where, f"{each.text}?", _next(each)) for each in self.unsettled])


def _proposed(answer: str) -> str:
    from waxstudy.importing.asking import Proposed

    return Proposed(answer)


def _option(question: Question, answer: str) -> str:
    """Return the option that states an answer."""
    from waxstudy.importing.asking import NONE

    option, _, key = question.option.partition(" ")
    is_none = option == "--map" and answer == NONE
    return f"{option} {shlex.quote(key + ('' if is_none else answer))}"


def _next(question: Question) -> str:
    from waxstudy.study.problems import listed

    given = _option(question, question.proposal or "...")
    also = ", or --yes" if question.proposal else ""
    of = f" ({listed(question.choices)})" if question.otherwise is None and question.proposal is None else ""
    return f"say {given}{of}{also}, or answer on a terminal"


def doubts(out: Path) -> list[str]:
    """Return what the checks of datasets say of it: `diagnose` says the same."""
    from waxstudy.dataset.read import read_dataset
    from waxstudy.study.problems import StudyError

    try:
        return list(read_dataset(out).warnings)
    except StudyError as error:
        return [f"diagnose will refuse it until that is mended: {one}" for one in error.problems]
