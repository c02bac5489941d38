"""The legend of a study: what each case adds, in words of the study file and of the components themselves."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import Choice
from waxstudy.report.comparison import FIGURES, member_values
from waxstudy.results.run import Run
from waxstudy.study.activation import bare
from waxstudy.study.model import Study

ALIKE = tuple(figure.key for figure in FIGURES if figure.key != "heat_vs_most_detailed_percent")


@dataclass(frozen=True)
class Added:
    """A case, the one that it changes (empty for the first of a ladder), and what it adds."""

    case: str
    before: str
    words: str


def legend(study: Study) -> list[Added]:
    """Return what each case adds to the one before it, in the order of the study."""
    found = []
    for ladder in study.ladders.values():
        before = ""
        for id in ladder.cases:
            old = study.cases[before].blocks if before else {}
            found.append(Added(id, before, "; ".join(_changes(old, study.cases[id].blocks))))
            before = id
    return found


def same_runs(run: Run) -> list[Sequence[str]]:
    """Return the cases that are one run under several names: their figures agree in every member and week."""
    groups: dict[bytes, list[str]] = {}
    for case in dict.fromkeys(each.case for each in run.cases):
        values = [member_values(run.kpis, case, week, column) for week in run.weeks for column in ALIKE]
        groups.setdefault(b"".join(np.ascontiguousarray(each).tobytes() for each in values), []).append(case)
    return [cases for cases in groups.values() if len(cases) > 1]


def told_same(run: Run) -> list[str]:
    """Return a sentence for each group of such cases."""
    return [
        f"{' and '.join(cases)} are the same run: what the later one adds changes nothing here"
        for cases in same_runs(run)
    ]


def _changes(old: Mapping[str, Choice], new: Mapping[str, Choice]) -> Iterator[str]:
    for kind, choice in new.items():
        before = old.get(kind)
        if before is None or before.component is not choice.component:
            yield f"{kind} “{choice.component.name}”: {_small(one_sentence(choice.component.__doc__))}{_set(choice)}"
        elif changed := list(_parameters(before, choice)):
            yield f"{kind}: {', '.join(changed)}"


def _set(choice: Choice) -> str:
    """The parameters that it takes to say which choice it is; the rest are defaults, or follow from these."""
    given = bare(choice)
    return f" ({', '.join(f'{name} = {_short(value)}' for name, value in given.items())})" if given else ""


def _parameters(before: Choice, after: Choice) -> Iterator[str]:
    old, new = (each.parameters.model_dump(mode="json", exclude_none=True) for each in (before, after))
    for name, value in new.items():
        if value != old.get(name):
            yield f"{name} = {_short(value)}" + (f" instead of {_short(old[name])}" if name in old else "")


def _short(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def one_sentence(docstring: str | None) -> str:
    """Return the first sentence of a docstring, without its equation.

    >>> one_sentence("PI with anti-windup: v = K e + I, y = v. Not in the paper.")
    'PI with anti-windup'
    """
    said = " ".join(inspect.cleandoc(docstring or "").split("\n\n")[0].replace("`", "").split())
    first = said.split(". ")[0].rstrip(".")
    words, colon, rest = first.partition(": ")
    return words if colon and "=" in rest else first


def _small(sentence: str) -> str:
    """A sentence within another one; abbreviations stay as they are."""
    return sentence if sentence[1:2].isupper() else sentence[:1].lower() + sentence[1:]
