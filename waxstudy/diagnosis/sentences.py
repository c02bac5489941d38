"""A found effect in one sentence, in which every member of its group has its say."""

from __future__ import annotations

from waxstudy.diagnosis.result import FoundEffect

MOST_TOLD = 3  # sentences of a group; the others by name


def told(effect: FoundEffect) -> str:
    """Return the sentence of an effect; of a group those of its members, lest the first be taken for the cause."""
    others = effect.alternatives[: MOST_TOLD - 1]
    known = {effect.name, *(each.name for each in others)}
    rest = [name for name in effect.group if name not in known]
    if not others and not rest:
        return effect.sentence
    clauses = [_clause(sentence) for sentence in (effect.sentence, *(each.sentence for each in others))]
    clauses += [f"one of: {', '.join(rest)}" if len(rest) > 1 else rest[0]] if rest else []
    return f"Either {', or '.join(clauses)}."


def _clause(sentence: str) -> str:
    """Return a sentence as a part of another one; a name that it begins with keeps its capitals."""
    text = sentence.rstrip(".")
    return text[:1].lower() + text[1:] if text[1:2].islower() or text[1:2] == " " else text
