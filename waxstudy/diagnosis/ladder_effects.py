"""The steps of a study's ladder as effects: fixed edits of the chain, without parameters to fit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Any

from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.plugin import CHAIN, Belief, Choice, Effect, Parameters
from waxstudy.study.model import Case, Study


def ladder_effects(study: Study) -> Iterator[EffectType]:
    """Yield an effect for each step of each ladder, named by the id of the case that it leads to."""
    for ladder in study.ladders.values():
        for before, after in pairwise(study.cases[name] for name in ladder.cases):
            changed = {kind: choice for kind, choice in after.blocks.items() if choice != before.blocks.get(kind)}
            if changed:
                yield _step(after, changed)


def _step(case: Case, changed: Mapping[str, Choice]) -> EffectType:
    told = "; ".join(f"{kind} {_words(choice)}" for kind, choice in changed.items())

    class Step(Effect):
        """A step of a ladder: blocks of one case in place of the believed ones."""

        name = case.id
        api_version = "1.0"
        stage = next(kind for kind in CHAIN if kind in changed)
        Parameters = Parameters

        @classmethod
        def hindrance(cls, belief: Belief) -> str:
            is_there = all(belief.blocks.get(kind) == choice for kind, choice in changed.items())
            return "its blocks are believed already" if is_there else ""

        @classmethod
        def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
            return None

        @classmethod
        def apply(cls, belief: Belief, p: Any) -> Belief:
            for kind, choice in changed.items():
                belief = belief.with_block(kind, choice)
            return belief

        @classmethod
        def sentence(cls, p: Any) -> str:
            return f"The loop is as in case {case.id}: {told}."

    return Step


def _words(choice: Choice) -> str:
    """Return a block as a study file has it, in one line."""
    values = {key: value for key, value in choice.described().items() if key != "use"}
    numbers = ", ".join(f"{key} = {value}" for key, value in values.items() if isinstance(value, int | float | str))
    return f"'{choice.component.name}'" + (f" ({numbers})" if numbers else "")
