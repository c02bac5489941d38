"""A ladder's steps as edits, and the case that each set of them makes of the simplest one.

A step is what it changes in the ladder's order. Two steps keep that order if either chooses the component of a block
that the other changes as well, or if both set the same parameter; any others may change places, and the case of a set
does not depend on the order in which its steps are taken.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

from waxstudy.plugin import CHAIN
from waxstudy.plugin.registry import installed
from waxstudy.report.attribution.shapley import Subset, closed_sets
from waxstudy.study.check import Check
from waxstudy.study.ladder import read_ladder
from waxstudy.study.model import Case, Choice, Ladder, Study
from waxstudy.study.problems import Problem
from waxstudy.study.source import Source

Edit = Mapping[str, Mapping[str, Any]]  # kind -> what a step says of that block, in the words of a study file

MOST_STEPS = 12  # 4096 sets; a thirteenth step would double hours of computing


class CannotAttribute(ValueError):
    """A ladder's steps cannot be taken in other orders; the message says why."""


@dataclass(frozen=True)
class Subsets:
    """Every set of a ladder's steps that makes sense, and the id of its case.

    `new` holds the cases that are none of the ladder's own, `refused` why a set was left out: a component does not
    take its parameters.
    """

    ladder: Ladder
    edits: Sequence[Edit]
    case: Mapping[Subset, str]
    new: Mapping[str, Case]
    refused: Mapping[Subset, str]

    @property
    def steps(self) -> Sequence[str]:
        """The steps, each named by the case that it makes in the ladder."""
        return self.ladder.cases[1:]

    @property
    def prefixes(self) -> list[Subset]:
        """The sets that the ladder itself goes through."""
        return [frozenset(range(n)) for n in range(len(self.steps) + 1)]


def subsets(study: Study, ladder: Ladder) -> Subsets:
    """Return the sets of a ladder's steps; raise `CannotAttribute` for too many steps or steps that do not lead on."""
    if len(ladder.cases) - 1 > MOST_STEPS:
        raise CannotAttribute(f"ladder '{ladder.name}' has over {MOST_STEPS} steps: too many orders to average over")
    edits = ladder_edits(study, ladder)
    known = {_blocks(study.cases[id]): id for id in reversed(ladder.cases)}
    case: dict[Subset, str] = {}
    new: dict[str, Case] = {}
    refused: dict[Subset, str] = {}
    for chosen in closed_sets(needs(edits)):
        made, problems = made_by(study, ladder, (edits[step] for step in sorted(chosen)))
        if problems:
            refused[chosen] = problems[0].wrong
            continue
        id = known.setdefault(_blocks(made), _unused(ladder, chosen, study))
        case[chosen] = id
        if id not in study.cases:
            new[id] = replace(made, id=id)
    found = Subsets(ladder, edits, case, new, refused)
    for own, chosen in zip(ladder.cases, found.prefixes, strict=True):
        if case.get(chosen) != known[_blocks(study.cases[own])]:
            raise CannotAttribute(f"case {own} is not what its step makes of the case before it")
    return found


def ladder_edits(study: Study, ladder: Ladder) -> list[Edit]:
    """Return what each step changes in the case before it."""
    return [_edit(before, after) for before, after in pairwise(study.cases[id].blocks for id in ladder.cases)]


def _edit(before: Mapping[str, Choice], after: Mapping[str, Choice]) -> Edit:
    changes = {kind: _change(before.get(kind), choice) for kind, choice in after.items()}
    return {kind: change for kind, change in changes.items() if change}


def _change(before: Choice | None, after: Choice) -> dict[str, Any]:
    """The whole block where its component is another, else the parameters that differ."""
    new, old = after.described(), before.described() if before else {}
    if new.get("use") != old.get("use"):
        return new
    return {key: value for key, value in new.items() if old.get(key) != value}


def needs(edits: Sequence[Edit]) -> list[Subset]:
    """Return, for each step, the earlier ones that it cannot come before."""
    return [frozenset(i for i in range(j) if _keep_order(edits[i], edits[j])) for j in range(len(edits))]


def _keep_order(first: Edit, then: Edit) -> bool:
    shared = ((first[kind], then[kind]) for kind in first.keys() & then.keys())
    return any("use" in a or "use" in b or a.keys() & b.keys() for a, b in shared)


def made_by(study: Study, ladder: Ladder, edits: Iterable[Edit]) -> tuple[Case, Sequence[Problem]]:
    """Return the case that edits make of the ladder's first one, and what a reader of study files finds wrong."""
    start = study.cases[ladder.cases[0]].described()
    steps = [{"id": f"step-{n}", **edit} for n, edit in enumerate(edits)]
    table = {"reference": start["id"], "start": start, "steps": steps}
    source = Source("", Path.cwd(), {"ladder": {ladder.name: table}}, {})
    check = Check(source, installed())
    raw = read_ladder(check, ladder.name).cases[-1]
    blocks = {kind: choice for kind in CHAIN if kind in raw.blocks and (choice := check.choice(kind, raw.blocks[kind]))}
    return Case(raw.id, ladder.name, blocks), check.problems


def _blocks(case: Case) -> str:
    """What tells cases apart; sets of steps that make the same case are computed once."""
    return repr({kind: choice.described() for kind, choice in case.blocks.items()})


def _unused(ladder: Ladder, chosen: Subset, study: Study) -> str:
    """A case id such as `on-off.0110`: the steps of the ladder that the case has."""
    id = f"{ladder.name}." + "".join(str(int(step in chosen)) for step in range(len(ladder.cases) - 1))
    while id in study.cases:
        id += "0"
    return id
