"""Effects at values, and a belief with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from waxstudy.plugin import Belief, Effect

EffectType = type[Effect]
Values = Mapping[str, float]  # of an effect's parameters, by name
Edits = Sequence[tuple[EffectType, Values]]


def with_effects(belief: Belief, edits: Edits) -> Belief:
    """Return a belief with effects; those that replace a block are applied before what acts on it."""
    for effect, values in sorted(edits, key=lambda each: not each[0].replaces):
        belief = effect.apply(belief, effect.Parameters(**values))
    return belief


def differ_by_inputs_alone(one: Belief, other: Belief) -> bool:
    """Whether two beliefs have the same room and blocks: only what drives the room may differ."""
    return (one.room, one.blocks) == (other.room, other.blocks)
